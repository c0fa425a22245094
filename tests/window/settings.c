/* What is kept between runs: it comes back, and nothing that is in its place stops the window. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/file.h"
#include "window/app/news_list.h"
#include "window/app/settings.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[] = "/tmp/marotte_settings_XXXXXX", path[128];

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    (void)snprintf(path, sizeof path, "%s/deep/er/window.json", folder);
    return setenv("XDG_CONFIG_HOME", folder, 1);
}

static int remove_folder(void **state)
{
    char command[160];
    (void)state;
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command) == 0 ? 0 : -1;
}

static settings *open_at(const char *at, char *out_note, size_t capacity)
{
    settings *s = NULL;
    error err = {0};
    const mrt_result result = settings_open(&s, at, out_note, capacity, &err);
    if (result != MRT_OK)
        fail_msg("%s", err.text);
    return s;
}

static settings *open_settings(char *out_note, size_t capacity)
{
    return open_at(path, out_note, capacity);
}

static void write_at(const char *at, const char *text)
{
    error err = {0};
    assert_int_equal(file_write(at, text, strlen(text), &err), MRT_OK);
}

static void write_text(const char *text)
{
    write_at(path, text);
}

static void assert_holds(const char *at, const char *text)
{
    file_bytes bytes;
    error err = {0};
    assert_int_equal(file_read(&bytes, at, 1 << 16, &err), MRT_OK);
    assert_string_equal((const char *)bytes.data, text);
    file_bytes_finish(&bytes);
}

static void write_settings(settings *s)
{
    error err = {0};
    if (settings_write(s, &err) != MRT_OK)
        fail_msg("%s", err.text);
}

static void what_was_set_comes_back(void **state)
{
    (void)state;
    char note[256];
    error err = {0};
    settings *s = open_settings(note, sizeof note);
    assert_string_equal(note, "");
    settings_set_number(s, "looks.timeline_height", 212.5);
    settings_set_text(s, "mapping.one_hand.preset.soft", "smile=8,jaw=Ünïcode");
    settings_set_number(s, "looks.has_timeline", 1);
    assert_int_equal(settings_write(s, &err), MRT_OK);
    settings_close(s);
    s = open_settings(note, sizeof note);
    assert_float_equal(settings_number(s, "looks.timeline_height", 0), 212.5, 0);
    assert_string_equal(settings_text(s, "mapping.one_hand.preset.soft", ""),
                        "smile=8,jaw=Ünïcode");
    assert_float_equal(settings_number(s, "looks.nothing", 7), 7, 0);
    assert_string_equal(settings_text(s, "looks.timeline_height", "no text"), "no text");
    settings_close(s);
}

static void keys_of_another_version_are_kept(void **state)
{
    (void)state;
    char note[256];
    error err = {0};
    file_bytes bytes;
    write_text("{\"later\": {\"a\": [1, 2]}, \"looks\": 3}");
    settings *s = open_settings(note, sizeof note);
    assert_string_equal(note, "");
    settings_set_number(s, "looks.panel", 2);
    assert_int_equal(settings_write(s, &err), MRT_OK);
    settings_close(s);
    assert_int_equal(file_read(&bytes, path, 1 << 16, &err), MRT_OK);
    assert_non_null(strstr((const char *)bytes.data, "\"later\""));
    assert_non_null(strstr((const char *)bytes.data, "\"panel\": 2"));
    file_bytes_finish(&bytes);
}

static void settings_of_a_newer_marotte_are_read_and_not_changed(void **state)
{
    (void)state;
    static const char newer[] = "{\"looks\": {\"panel\": 4}, \"version\": 2}";
    char note[256];
    error err = {0};
    write_text(newer);
    settings *s = open_settings(note, sizeof note);
    assert_non_null(strstr(note, "was written by a newer marotte"));
    assert_float_equal(settings_number(s, "looks.panel", 0), 4, 0);
    settings_set_number(s, "looks.panel", 2);
    assert_int_equal(settings_write_last(s, &err), MRT_OK);
    settings_close(s);
    assert_holds(path, newer);
    /* It was updated while this one ran. */
    assert_int_equal(unlink(path), 0);
    s = open_settings(note, sizeof note);
    assert_string_equal(note, "");
    write_text(newer);
    settings_set_number(s, "looks.panel", 2);
    assert_true(settings_write_last(s, &err) < 0);
    assert_non_null(strstr(err.text, "was written by a newer marotte"));
    settings_close(s);
    assert_holds(path, newer);
    assert_int_equal(unlink(path), 0);
}

static void a_damaged_default_file_is_renamed_with_a_note_and_over_nothing(void **state)
{
    (void)state;
    static const char *const texts[] = {"{\"looks\": ", "[1]", "\xff\xfe", "{} {}"};
    char usual[160], aside[200];
    (void)snprintf(usual, sizeof usual, "%s/marotte/window.json", folder);
    error err = {0};
    (void)snprintf(aside, sizeof aside, "%s/marotte/", folder);
    assert_int_equal(file_make_folders(aside, &err), MRT_OK);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        char note[1024];
        write_at(usual, texts[i]);
        settings *s = open_at(NULL, note, sizeof note);
        assert_non_null(strstr(note, ".damaged"));
        assert_int_not_equal(access(usual, F_OK), 0);
        settings_set_number(s, "a", 1);
        write_settings(s);
        settings_close(s);
        s = open_at(NULL, note, sizeof note);
        assert_string_equal(note, "");
        assert_float_equal(settings_number(s, "a", 0), 1, 0);
        settings_close(s);
    }
    (void)snprintf(aside, sizeof aside, "%s.damaged", usual);
    assert_holds(aside, texts[0]); /* those that follow are beside it */
    (void)snprintf(aside, sizeof aside, "%s.damaged-4", usual);
    assert_holds(aside, texts[3]);
}

/* What the person names and is no settings file stays as it is, whatever is done. */
static void a_named_file_that_is_no_settings_file_is_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"My thesis.", "{\"name\": \"a package\"}", "[1]",
                                        "{\"looks\": "};
    char thesis[160], aside[200], link[160], note[64];
    error err = {0};
    settings *s = NULL;
    (void)snprintf(thesis, sizeof thesis, "%s/thesis.txt", folder);
    (void)snprintf(link, sizeof link, "%s/link.json", folder);
    (void)snprintf(aside, sizeof aside, "%s.damaged", thesis);
    assert_int_equal(symlink(thesis, link), 0);
    assert_true(settings_open(&s, link, note, sizeof note, &err) < 0); /* it leads nowhere */
    assert_null(s);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        write_at(thesis, texts[i]);
        for (int of_link = 0; of_link < 2; ++of_link) {
            err.text[0] = '\0';
            assert_true(settings_open(&s, of_link ? link : thesis, note, sizeof note, &err) < 0);
            assert_null(s);
            assert_non_null(strstr(err.text, of_link ? link : thesis));
            assert_non_null(strstr(err.text, "choose another file"));
        }
        assert_holds(thesis, texts[i]);
        assert_int_not_equal(access(aside, F_OK), 0);
    }
    /* A folder, with all that is in it. */
    assert_true(settings_open(&s, folder, note, sizeof note, &err) < 0);
    assert_non_null(strstr(err.text, "is a directory"));
    assert_holds(thesis, texts[3]);
    /* One that became something else while it was open. */
    (void)unlink(thesis);
    s = open_at(thesis, note, sizeof note);
    write_at(thesis, texts[0]);
    settings_set_number(s, "a", 1);
    assert_true(settings_write(s, &err) < 0);
    settings_close(s);
    assert_holds(thesis, texts[0]);
    (void)unlink(thesis);
    (void)unlink(link);
}

static void a_link_to_settings_stays_a_link(void **state)
{
    (void)state;
    char link[160], note[64];
    struct stat status;
    (void)snprintf(link, sizeof link, "%s/link.json", folder);
    settings *s = open_settings(note, sizeof note);
    settings_set_number(s, "a", 3);
    write_settings(s);
    settings_close(s);
    assert_int_equal(symlink(path, link), 0);
    s = open_at(link, note, sizeof note);
    assert_float_equal(settings_number(s, "a", 0), 3, 0);
    settings_set_number(s, "a", 4);
    write_settings(s);
    settings_close(s);
    assert_true(lstat(link, &status) == 0 && S_ISLNK(status.st_mode));
    s = open_settings(note, sizeof note);
    assert_float_equal(settings_number(s, "a", 0), 4, 0);
    settings_close(s);
    (void)unlink(link);
}

/* ---- two stages ---- */

static void expect(const char *key, const char *value)
{
    char note[64];
    settings *s = open_settings(note, sizeof note);
    assert_string_equal(settings_text(s, key, "none"), value);
    settings_close(s);
}

/* In each order of their writes. */
static void what_two_stages_change_is_kept_of_both(void **state)
{
    (void)state;
    for (int order = 0; order < 4; ++order) {
        char note[64];
        (void)unlink(path);
        settings *s = open_settings(note, sizeof note);
        settings_set_text(s, "preset.old", "1");
        settings_set_text(s, "preset.older", "1");
        settings_set_text(s, "looks.panel", "1");
        write_settings(s);
        settings_close(s);
        settings *one = open_settings(note, sizeof note), *two = open_settings(note, sizeof note);
        settings_set_text(one, "preset.of_one", "a");
        if (order & 1)
            write_settings(one);
        settings_set_text(two, "preset.of_two", "b");
        settings_set_text(two, "preset.older", NULL);
        if (order & 2)
            write_settings(two);
        settings_set_text(one, "preset.old", NULL);
        settings_set_text(one, "looks.panel", "2");
        write_settings(one);
        settings_set_text(two, "preset.later.deeper", "c");
        settings_set_text(two, "preset.of_two", "b2");
        write_settings(two);
        write_settings(one); /* the last one to end has nothing new, and brings nothing back */
        settings_close(one);
        settings_close(two);
        expect("preset.of_one", "a");
        expect("preset.of_two", "b2");
        expect("preset.later.deeper", "c");
        expect("preset.old", "none");
        expect("preset.older", "none");
        expect("looks.panel", "2");
    }
}

static void a_list_is_replaced_as_one_value(void **state)
{
    (void)state;
    char note[64];
    const char *const three[] = {"a", "b", "c"}, *const one_text[] = {"d"}, *got[4];
    settings *one = open_settings(note, sizeof note), *two = open_settings(note, sizeof note);
    settings_set_list(one, "recent", three, 3, 4);
    write_settings(one);
    settings_set_list(two, "recent", one_text, 1, 4);
    write_settings(two);
    settings_close(one);
    settings_close(two);
    two = open_settings(note, sizeof note);
    assert_int_equal(settings_list(two, "recent", got, 4), 1);
    assert_string_equal(got[0], "d");
    settings_close(two);
}

static void while_another_program_writes_the_changes_wait(void **state)
{
    (void)state;
    char note[64];
    error err = {0};
    (void)unlink(path);
    settings *s = open_settings(note, sizeof note);
    settings_set_text(s, "preset.x", "1");
    const int fd = open(settings_folder(s), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    assert_true(fd >= 0 && flock(fd, LOCK_EX) == 0);
    assert_int_equal(settings_write(s, &err), MRT_END);
    assert_int_not_equal(access(path, F_OK), 0);
    close(fd);
    assert_int_equal(settings_write_last(s, &err), MRT_OK);
    settings_close(s);
    expect("preset.x", "1");
}

/* Killed anywhere while it writes: all that was there before is still there. */
static void a_kill_while_it_is_written_loses_nothing(void **state)
{
    (void)state;
    char note[64];
    settings *s = open_settings(note, sizeof note);
    settings_set_text(s, "preset.old", "kept");
    write_settings(s);
    for (int i = 0; i < 10; ++i) {
        int ready[2];
        char byte;
        assert_int_equal(pipe(ready), 0);
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            settings *mine = open_settings(note, sizeof note);
            error err = {0};
            for (double n = 0;; ++n) {
                settings_set_number(mine, "looks.count", n);
                if (settings_write(mine, &err) < 0 || write(ready[1], "x", 1) != 1)
                    _exit(1);
            }
        }
        for (int k = 0; k <= i; ++k)
            assert_int_equal(read(ready[0], &byte, 1), 1);
        assert_int_equal(kill(child, SIGKILL), 0);
        assert_int_equal(waitpid(child, NULL, 0), child);
        close(ready[0]);
        close(ready[1]);
        expect("preset.old", "kept");
        char key[32];
        (void)snprintf(key, sizeof key, "preset.%d", i);
        settings_set_text(s, key, "kept"); /* the lock went with it */
        write_settings(s);
        expect(key, "kept");
    }
    settings_close(s);
}

static void what_has_not_changed_is_not_written(void **state)
{
    (void)state;
    char note[64];
    error err = {0};
    settings *s = open_settings(note, sizeof note);
    settings_set_number(s, "a", 5);
    assert_int_equal(settings_write(s, &err), MRT_OK);
    assert_int_equal(unlink(path), 0);
    settings_set_number(s, "a", 5);
    settings_set_number(s, "b", NAN);
    settings_set_text(s, "c", NULL);
    assert_int_equal(settings_write(s, &err), MRT_OK);
    assert_int_not_equal(access(path, F_OK), 0);
    settings_close(s);
}

static void an_empty_path_keeps_nothing(void **state)
{
    (void)state;
    settings *s = NULL;
    char note[64];
    error err = {0};
    assert_int_equal(settings_open(&s, "", note, sizeof note, &err), MRT_OK);
    settings_set_number(s, "a", 5);
    assert_float_equal(settings_number(s, "a", 0), 5, 0);
    assert_int_equal(settings_write(s, &err), MRT_OK);
    assert_string_equal(settings_folder(s), "");
    settings_close(s);
}

static void a_folder_that_cannot_be_made_is_an_error_that_names_it(void **state)
{
    (void)state;
    settings *s = NULL;
    char note[64];
    error err = {0};
    assert_int_equal(settings_open(&s, "/dev/null/marotte/window.json", note, sizeof note, &err),
                     MRT_OK);
    settings_set_number(s, "a", 5);
    assert_true(settings_write(s, &err) < 0);
    assert_non_null(strstr(err.text, "/dev/null"));
    settings_close(s);
}

static void keys_are_listed_one_level_deep(void **state)
{
    (void)state;
    char note[64], **keys;
    settings *s = open_settings(note, sizeof note);
    settings_set_text(s, "preset.soft", "1");
    settings_set_text(s, "preset.hard", "2");
    settings_set_text(s, "preset.soft", NULL);
    settings_set_text(s, "preset.more", "3");
    const uint32_t count = settings_keys(s, "preset", &keys);
    assert_int_equal(count, 2);
    assert_string_equal(keys[0], "hard");
    assert_string_equal(keys[1], "more");
    free(keys);
    assert_int_equal(settings_keys(s, "nothing", &keys), 0);
    assert_null(keys);
    settings_close(s);
}

static void news_keep_the_last_ones_and_say_nothing_twice(void **state)
{
    (void)state;
    news_list *list = news_list_create();
    log_queue *log = log_queue_create();
    char text[32];
    for (int i = 0; i < NEWS_MAX + 20; ++i) {
        (void)snprintf(text, sizeof text, "line\n%d", i);
        news_list_add(list, MRT_LOG_INFO, "test", text);
        news_list_add(list, MRT_LOG_INFO, "test", text);
    }
    assert_int_equal(news_list_count(list), NEWS_MAX);
    assert_string_equal(news_list_at(list, 0)->text, "line 20");
    log_push(log, MRT_LOG_ERROR, "glove", "it went away");
    log_push(log, MRT_LOG_DEBUG, "glove", "not for people");
    news_list_update(list, log, 0.5);
    const news_item *last = news_list_at(list, news_list_count(list) - 1);
    assert_string_equal(last->text, "it went away");
    assert_float_equal(last->age_s, 0, 0);
    news_list_update(list, log, 0.5);
    assert_float_equal(last->age_s, 0.5, 1e-9);
    log_queue_destroy(log);
    news_list_destroy(list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_set_comes_back),
        cmocka_unit_test(keys_of_another_version_are_kept),
        cmocka_unit_test(settings_of_a_newer_marotte_are_read_and_not_changed),
        cmocka_unit_test(a_damaged_default_file_is_renamed_with_a_note_and_over_nothing),
        cmocka_unit_test(a_named_file_that_is_no_settings_file_is_refused),
        cmocka_unit_test(a_link_to_settings_stays_a_link),
        cmocka_unit_test(what_two_stages_change_is_kept_of_both),
        cmocka_unit_test(a_list_is_replaced_as_one_value),
        cmocka_unit_test(while_another_program_writes_the_changes_wait),
        cmocka_unit_test(a_kill_while_it_is_written_loses_nothing),
        cmocka_unit_test(what_has_not_changed_is_not_written),
        cmocka_unit_test(an_empty_path_keeps_nothing),
        cmocka_unit_test(a_folder_that_cannot_be_made_is_an_error_that_names_it),
        cmocka_unit_test(keys_are_listed_one_level_deep),
        cmocka_unit_test(news_keep_the_last_ones_and_say_nothing_twice),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
