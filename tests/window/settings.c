/* What is kept between runs: it comes back, and nothing that is in its place stops the window. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/file.h"
#include "window/app/news_list.h"
#include "window/app/settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/marotte_settings_XXXXXX", path[128], damaged[140];

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    (void)snprintf(path, sizeof path, "%s/deep/er/window.json", folder);
    (void)snprintf(damaged, sizeof damaged, "%s.damaged", path);
    return 0;
}

static int remove_folder(void **state)
{
    char command[160];
    (void)state;
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command) == 0 ? 0 : -1;
}

static settings *open_settings(char *out_note, size_t capacity)
{
    settings *s = NULL;
    error err = {0};
    assert_int_equal(settings_open(&s, path, out_note, capacity, &err), MRT_OK);
    return s;
}

static void write_text(const char *text)
{
    error err = {0};
    assert_int_equal(file_write(path, text, strlen(text), &err), MRT_OK);
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

static void a_damaged_file_is_set_aside_with_a_note(void **state)
{
    (void)state;
    static const char *const texts[] = {"{\"looks\": ", "[1]", "\xff\xfe", "{} {}"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        char note[512];
        error err = {0};
        write_text(texts[i]);
        settings *s = open_settings(note, sizeof note);
        assert_non_null(strstr(note, ".damaged"));
        assert_int_equal(access(damaged, F_OK), 0);
        assert_int_not_equal(access(path, F_OK), 0);
        settings_set_number(s, "a", 1);
        assert_int_equal(settings_write(s, &err), MRT_OK);
        settings_close(s);
        s = open_settings(note, sizeof note);
        assert_string_equal(note, "");
        assert_float_equal(settings_number(s, "a", 0), 1, 0);
        settings_close(s);
    }
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
        cmocka_unit_test(a_damaged_file_is_set_aside_with_a_note),
        cmocka_unit_test(what_has_not_changed_is_not_written),
        cmocka_unit_test(an_empty_path_keeps_nothing),
        cmocka_unit_test(a_folder_that_cannot_be_made_is_an_error_that_names_it),
        cmocka_unit_test(keys_are_listed_one_level_deep),
        cmocka_unit_test(news_keep_the_last_ones_and_say_nothing_twice),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
