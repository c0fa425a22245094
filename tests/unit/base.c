/* core/base: what every room stands on. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/budget.h"
#include "base/error.h"
#include "base/file.h"
#include "base/log.h"
#include "base/rigid.h"
#include "base/ring.h"
#include "base/slot.h"
#include "base/text.h"

#include <dirent.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static text_view view(const char *text)
{
    return text_view_of(text, strlen(text));
}

static void error_text_is_cut_and_prefixed_within_its_room(void **state)
{
    (void)state;
    error err;
    char longest[3000];
    memset(longest, 'x', sizeof longest);
    longest[sizeof longest - 1] = '\0';
    assert_int_equal(error_set(&err, MRT_ERR_IO, "%s", longest), MRT_ERR_IO);
    assert_int_equal(strlen(err.text), sizeof err.text - 1);
    error_prefix(&err, "file.obj");
    assert_int_equal(strlen(err.text), sizeof err.text - 1);
    assert_memory_equal(err.text, "file.obj: xxx", 13);
    assert_int_equal(error_set(NULL, MRT_ERR_MEMORY, "nobody reads this"), MRT_ERR_MEMORY);
}

static void numbers_are_whole_words_and_finite(void **state)
{
    (void)state;
    double d = 7;
    assert_true(text_double(view("-1.25e2"), &d) && fabs(d + 125.0) < 1e-12);
    assert_true(text_double(view(".5"), &d) && fabs(d - 0.5) < 1e-12);
    static const char *const bad[] = {"",    ".",    "1.2.3", "1e",    "1e+", "nan",
                                      "inf", "0x10", "1,5",   "1e999", "--1", "1 "};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i)
        assert_false(text_double(view(bad[i]), &d));
    float f;
    assert_false(text_float(view("1e39"), &f));
    int64_t n;
    assert_true(text_int(view("-9223372036854775808"), &n) && n == INT64_MIN);
    assert_true(text_int(view("9223372036854775807"), &n) && n == INT64_MAX);
    assert_false(text_int(view("9223372036854775808"), &n));
    assert_false(text_int(view("12a"), &n));
    assert_false(text_int(view("-"), &n));
}

static void lines_words_and_fields_are_taken_apart(void **state)
{
    (void)state;
    text_view rest = view("one  two\r\n\nlast"), line, word;
    assert_true(text_next_line(&rest, &line) && text_equals(line, "one  two"));
    assert_true(text_next_word(&line, &word) && text_equals(word, "one"));
    assert_true(text_next_word(&line, &word) && text_equals(word, "two"));
    assert_false(text_next_word(&line, &word));
    assert_true(text_next_line(&rest, &line) && text_equals(line, ""));
    assert_true(text_next_line(&rest, &line) && text_equals(line, "last"));
    assert_false(text_next_line(&rest, &line));
    rest = view("a, ,c,");
    assert_true(text_next_field(&rest, ',', &word) && text_equals(word, "a"));
    assert_true(text_next_field(&rest, ',', &word) && text_equals(word, ""));
    assert_true(text_next_field(&rest, ',', &word) && text_equals(word, "c"));
    assert_true(text_next_field(&rest, ',', &word) && text_equals(word, ""));
    assert_false(text_next_field(&rest, ',', &word));
}

/* A title for the window, a bell, a forged line, letters written backwards: a person sees that
 * something was there, and nothing happens. */
static void foreign_text_cannot_steer_a_terminal(void **state)
{
    (void)state;
    static const struct {
        const char *foreign, *shown;
    } texts[] = {
        {"\x1b]0;owned\x07night", "?]0;owned?night"},
        {"one\ntwo\r\tthree\x7f", "one?two??three?"},
        {"\xc2\x9b"
         "31mred",
         "?31mred"}, /* CSI as a letter of C1 */
        {"\x9b"
         "31mred",
         "?31mred"}, /* and as a byte */
        {"ab\xe2\x80\xae"
         "gpj.exe",
         "ab?gpj.exe"},                                        /* right-to-left override */
        {"\xe2\x81\xa6x\xe2\x81\xa9\xe2\x80\xa8", "?x??"},     /* isolates, line separator */
        {"\xf3\xa0\x81\x81", "?"},                             /* an invisible tag */
        {"\xc0\x9b\xed\xa0\x80\xf4\x90\x80\x80", "?????????"}, /* longer than need be, no letters */
        {"cut \xe2\x82", "cut ??"},
        {"na\xc3\xafve \xe2\x82\xac \xf0\x9f\x8e\xad",
         "na\xc3\xafve \xe2\x82\xac \xf0\x9f\x8e\xad"},
        {"", ""},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        char copy[64], place[64];
        text_view foreign = view(texts[i].foreign);
        text_copy(copy, sizeof copy, foreign);
        assert_string_equal(copy, texts[i].shown);
        memcpy(place, texts[i].foreign, strlen(texts[i].foreign) + 1);
        text_make_printable(place);
        assert_string_equal(place, texts[i].shown);
        assert_true(text_is_printable(view(copy)));
        assert_int_equal(text_is_printable(foreign), strcmp(copy, texts[i].foreign) == 0);
    }
    char small[6]; /* cut at a whole letter */
    text_copy(small, sizeof small, view("abc\xe2\x82\xac"));
    assert_string_equal(small, "abc");
    text_copy(small, sizeof small, view("ab\xe2\x82\xac"));
    assert_string_equal(small, "ab\xe2\x82\xac");
}

static void ring_keeps_order_and_refuses_when_full(void **state)
{
    (void)state;
    ring *r = ring_create(sizeof(int), 4);
    for (int i = 0; i < 4; ++i)
        assert_true(ring_push(r, &i));
    int value = 99;
    assert_false(ring_push(r, &value));
    assert_true(ring_peek(r, &value));
    assert_int_equal(value, 0);
    for (int i = 0; i < 4; ++i) {
        assert_true(ring_pop(r, &value));
        assert_int_equal(value, i);
    }
    assert_false(ring_pop(r, &value));
    ring_destroy(r);
}

enum { CROSSINGS = 200000 };

static void *push_numbers(void *data)
{
    ring *r = data;
    for (uint32_t i = 0; i < CROSSINGS; ++i)
        while (!ring_push(r, &i))
            continue;
    return NULL;
}

static void ring_crosses_threads_without_loss_or_reordering(void **state)
{
    (void)state;
    ring *r = ring_create(sizeof(uint32_t), 64);
    pthread_t producer;
    assert_int_equal(pthread_create(&producer, NULL, push_numbers, r), 0);
    for (uint32_t expected = 0; expected < CROSSINGS;) {
        uint32_t value;
        if (!ring_pop(r, &value))
            continue;
        assert_int_equal(value, expected);
        expected += 1;
    }
    pthread_join(producer, NULL);
    ring_destroy(r);
}

static void slot_gives_the_newest_value_only_once(void **state)
{
    (void)state;
    publish_slot slot;
    int value[3] = {0, 0, 0};
    slot_init(&slot);
    assert_false(slot_receive(&slot));
    for (int i = 1; i <= 3; ++i) {
        value[slot_back(&slot)] = i;
        slot_publish(&slot);
    }
    assert_true(slot_receive(&slot));
    assert_int_equal(value[slot_front(&slot)], 3);
    assert_false(slot_receive(&slot));
    assert_int_not_equal(slot_back(&slot), slot_front(&slot));
}

enum { TALKERS = 4, WORDS = 2000 };

static void *talk(void *data)
{
    for (int i = 0; i < WORDS; ++i)
        log_pushf(data, MRT_LOG_INFO, "talker", "word %d", i);
    return NULL;
}

static void log_loses_nothing_silently_with_many_writers(void **state)
{
    (void)state;
    log_queue *queue = log_queue_create();
    pthread_t talkers[TALKERS];
    for (int i = 0; i < TALKERS; ++i)
        assert_int_equal(pthread_create(&talkers[i], NULL, talk, queue), 0);
    uint32_t got = 0;
    log_record record;
    for (int i = 0; i < 1000; ++i)
        while (log_pop(queue, &record))
            got += 1;
    for (int i = 0; i < TALKERS; ++i)
        pthread_join(talkers[i], NULL);
    while (log_pop(queue, &record)) {
        assert_memory_equal(record.text, "word ", 5);
        got += 1;
    }
    assert_int_equal(got + log_pop_lost(queue), TALKERS * WORDS);
    log_queue_destroy(queue);
}

static void rigid_motions_compose_invert_and_keep_lengths(void **state)
{
    (void)state;
    vec3 axis = vec3_normalised((vec3){1, 2, -0.5}, (vec3){1, 0, 0});
    rigid turn = rigid_turn((vec3){3, -1, 2}, axis, 0.7);
    vec3 p = {5, 6, 7};
    rigid back = rigid_inverse(&turn);
    rigid both = rigid_compose(&back, &turn);
    vec3 q = rigid_apply(&both, p);
    assert_true(vec3_length(vec3_sub(p, q)) < 1e-14 * 20);
    vec3 pivot = rigid_apply(&turn, (vec3){3, -1, 2});
    assert_true(vec3_length(vec3_sub(pivot, (vec3){3, -1, 2})) < 1e-14 * 20);
    /* A quarter turn about z takes x to y. */
    rigid quarter = rigid_turn((vec3){0, 0, 0}, (vec3){0, 0, 1}, 1.5707963267948966);
    vec3 y = rigid_apply(&quarter, (vec3){1, 0, 0});
    assert_true(vec3_length(vec3_sub(y, (vec3){0, 1, 0})) < 1e-15 * 4);
    const double quaternion[4] = {0, 0, 0.7071067811865476, 0.7071067811865476};
    rigid same = rigid_from_quaternion(quaternion, (vec3){0, 0, 0});
    vec3 z = rigid_apply(&same, (vec3){1, 0, 0});
    assert_true(vec3_length(vec3_sub(z, (vec3){0, 1, 0})) < 1e-15 * 4);
}

static void turns_about_the_axes_have_the_bits_of_any_turn(void **state)
{
    (void)state;
    for (int i = -5000; i <= 5000; ++i) {
        const double angle_rad = i * 0.00123;
        const rigid own[3] = {rigid_turn_x(angle_rad), rigid_turn_y(angle_rad),
                              rigid_turn_z(angle_rad)};
        for (int axis = 0; axis < 3; ++axis) {
            const vec3 along = {axis == 0, axis == 1, axis == 2};
            const rigid any = rigid_turn((vec3){0, 0, 0}, along, angle_rad);
            assert_memory_equal(&own[axis], &any, sizeof any);
        }
    }
}

static void files_are_written_whole_or_not_at_all(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte-base-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char path[128];
    snprintf(path, sizeof path, "%s/a.txt", folder);
    error err;
    assert_int_equal(file_write(path, "first", 5, &err), MRT_OK);
    file_writer writer;
    assert_int_equal(file_writer_open(&writer, path, &err), MRT_OK);
    fputs("second, but abandoned", writer.stream);
    file_writer_abandon(&writer);
    file_bytes bytes;
    assert_int_equal(file_read(&bytes, path, 100, &err), MRT_OK);
    assert_int_equal(bytes.size, 5);
    assert_memory_equal(bytes.data, "first", 6); /* with the 0 behind it */
    file_bytes_finish(&bytes);

    assert_true(file_read(&bytes, path, 4, &err) < 0); /* over the cap */
    assert_non_null(strstr(err.text, path));
    assert_true(file_read(&bytes, folder, 100, &err) < 0);
    assert_non_null(strstr(err.text, "directory"));
    assert_true(file_write(folder, "x", 1, &err) < 0);
    assert_non_null(strstr(err.text, "directory"));
    assert_true(file_write("/dev/null", "x", 1, &err) < 0); /* not to be renamed over */
    assert_non_null(strstr(err.text, "device"));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0); /* nothing else was left there */
}

static void missing_folders_of_a_file_are_created(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte-base-XXXXXX", path[128], below[256];
    error err = {""};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/new/folder", folder);
    snprintf(below, sizeof below, "%s/a.txt", path);
    assert_int_equal(file_write(below, "x", 1, &err), MRT_OK);
    assert_int_equal(access(below, R_OK), 0);
    /* A file in the way: the message names it, and nothing is created. */
    snprintf(below, sizeof below, "%s/a.txt/more/b.txt", path);
    assert_true(file_write(below, "x", 1, &err) < 0);
    snprintf(below, sizeof below, "%s/a.txt: cannot create this folder: Not a directory", path);
    assert_string_equal(err.text, below);
    /* Of a folder that is about to be written, the folders above; with or without its last '/'. */
    snprintf(below, sizeof below, "%s/pictures/of/it/", folder);
    assert_int_equal(file_make_parent(below, &err), MRT_OK);
    assert_int_not_equal(access(below, F_OK), 0);
    snprintf(below, sizeof below, "%s/pictures/of", folder);
    assert_int_equal(rmdir(below), 0);
    snprintf(below, sizeof below, "%s/pictures", folder);
    assert_int_equal(rmdir(below), 0);
    assert_int_equal(file_make_parent("here.txt", &err), MRT_OK);
    assert_int_equal(file_make_parent("/", &err), MRT_OK);
    snprintf(below, sizeof below, "%s/a.txt", path);
    assert_int_equal(unlink(below), 0);
    assert_int_equal(rmdir(path), 0);
    *strrchr(path, '/') = '\0';
    assert_int_equal(rmdir(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

static void reading_refuses_what_is_not_a_file_with_bytes(void **state)
{
    (void)state;
    char path[] = "/tmp/marotte-base-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    close(fd);
    error err;
    file_bytes bytes;
    assert_true(file_read(&bytes, path, 100, &err) < 0);
    assert_non_null(strstr(err.text, "empty"));
    unlink(path);
    assert_true(file_read(&bytes, path, 100, &err) < 0);
    assert_non_null(strstr(err.text, "No such file"));
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_true(file_read(&bytes, path, 100, &err) < 0); /* and does not hang */
    unlink(path);
    assert_true(file_read(&bytes, "/dev/zero", 100, &err) < 0);
}

/* How many files lie in the folder whose names end so. */
static int count_files(const char *folder, const char *ending)
{
    int count = 0;
    DIR *list = opendir(folder);
    assert_non_null(list);
    for (struct dirent *e; (e = readdir(list));) {
        const size_t length = strlen(e->d_name), end = strlen(ending);
        count += length > end && strcmp(e->d_name + length - end, ending) == 0;
    }
    closedir(list);
    return count;
}

/* Two programs write one file and are killed: the next one that writes it removes what they left,
 * and nothing else. One that still writes is left alone. */
static void what_a_killed_writer_left_is_removed_by_the_next_one(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte-base-XXXXXX", path[64], other[4][96], command[64];
    error err = {""};
    pid_t child[2];
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/x.mp4", folder);
    (void)snprintf(other[0], sizeof other[0], "%s/x.mp4.backup.tmp", folder);
    (void)snprintf(other[1], sizeof other[1], "%s/x.mp4.tmp", folder);
    (void)snprintf(other[2], sizeof other[2], "%s/y.mp4.marotte-0.tmp", folder);
    for (int i = 0; i < 3; ++i)
        assert_int_equal(file_write(other[i], "theirs", 6, &err), MRT_OK);
    for (int i = 0; i < 2; ++i) {
        int ready[2];
        char byte;
        assert_int_equal(pipe(ready), 0);
        child[i] = fork();
        assert_true(child[i] >= 0);
        if (child[i] == 0) {
            file_writer w;
            if (file_writer_open(&w, path, &err) < 0 || fputs("half", w.stream) < 0 ||
                fflush(w.stream) != 0 || write(ready[1], "x", 1) != 1)
                _exit(1);
            (void)alarm(600); /* where the test fails before it is killed */
            pause();
            _exit(1);
        }
        close(ready[1]);
        assert_int_equal(read(ready[0], &byte, 1), 1);
        close(ready[0]);
    }
    assert_int_equal(count_files(folder, ".tmp"), 5);
    assert_int_equal(file_write(path, "whole", 5, &err), MRT_OK); /* both still write */
    assert_int_equal(count_files(folder, ".tmp"), 5);
    for (int i = 0; i < 2; ++i) {
        assert_int_equal(kill(child[i], SIGKILL), 0);
        assert_int_equal(waitpid(child[i], NULL, 0), child[i]);
    }
    file_writer w; /* one that is open meanwhile in this program */
    assert_int_equal(file_writer_open(&w, path, &err), MRT_OK);
    assert_int_equal(count_files(folder, ".tmp"), 4);
    assert_int_equal(file_write(path, "again", 5, &err), MRT_OK);
    assert_int_equal(count_files(folder, ".tmp"), 4);
    assert_true(fputs("last", w.stream) >= 0);
    assert_int_equal(file_writer_commit(&w, &err), MRT_OK);
    assert_int_equal(count_files(folder, ".tmp"), 3);
    file_bytes bytes;
    assert_int_equal(file_read(&bytes, path, 10, &err), MRT_OK);
    assert_string_equal((const char *)bytes.data, "last");
    file_bytes_finish(&bytes);
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

/* In a folder where others may write, a temporary file's name may lead anywhere. */
static void what_lies_at_a_temporary_name_is_not_written_or_followed(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte-base-XXXXXX", path[64], name[96], victim[64], command[64];
    error err = {""};
    file_bytes bytes;
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/x", folder);
    (void)snprintf(victim, sizeof victim, "%s/victim", folder);
    assert_int_equal(file_write(victim, "theirs", 6, &err), MRT_OK);
    for (int i = 0; i < 2; ++i) {
        (void)snprintf(name, sizeof name, "%s.marotte-%d.tmp", path, i);
        assert_int_equal(i ? mkfifo(name, 0600) : symlink(victim, name), 0);
    }
    assert_int_equal(file_write(path, "whole", 5, &err), MRT_OK);
    assert_int_equal(count_files(folder, ".tmp"), 2);
    assert_int_equal(file_read(&bytes, victim, 10, &err), MRT_OK);
    assert_string_equal((const char *)bytes.data, "theirs");
    file_bytes_finish(&bytes);
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

static void holes_of_a_file_do_not_count(void **state)
{
    (void)state;
    char path[] = "/tmp/marotte-base-XXXXXX";
    const off_t far = (off_t)1 << 40;
    uint64_t begin, end;
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_true(file_data_size(path) == 0);
    assert_int_equal(pwrite(fd, "near", 4, 0), 4);
    assert_int_equal(pwrite(fd, "far", 3, far), 3);
    const uint64_t size = file_data_size(path);
    assert_true(size >= 7);
    assert_true(file_next_data(fd, 0, &begin, &end));
    assert_true(begin == 0 && end >= 4);
    const bool knows_holes = end <= (uint64_t)far;
    if (knows_holes) {
        assert_true(size < 1u << 20);
        assert_true(file_next_data(fd, end, &begin, &end));
        assert_true(begin <= (uint64_t)far && end == (uint64_t)far + 3);
    }
    assert_false(file_next_data(fd, (uint64_t)far + 3, &begin, &end));
    close(fd);
    unlink(path);
    assert_true(file_data_size(path) == 0);
    assert_true(file_data_size("/tmp") == 0);
    if (!knows_holes)
        skip();
}

static void a_budget_grows_with_the_file_and_says_when_it_is_used_up(void **state)
{
    (void)state;
    error err = {""};
    for (int kind = 0; kind < BUDGET_KINDS; ++kind) {
        budget small = budget_of((budget_kind)kind, 0);
        budget large = budget_of((budget_kind)kind, 100u << 20);
        assert_true(large.bytes_left >= small.bytes_left + (100u << 20));
        assert_true(large.work_left > small.work_left);
    }
    budget b = budget_of(BUDGET_RIG, 4096);
    const uint64_t all = b.work_left;
    assert_int_equal(budget_spend_work(&b, all - 1, &err), MRT_OK);
    assert_int_equal(budget_spend_work(&b, 2, &err), MRT_ERR_UNSUPPORTED);
    char number[32];
    (void)snprintf(number, sizeof number, "%llu steps of work", (unsigned long long)all);
    assert_non_null(strstr(err.text, number));
    assert_non_null(strstr(err.text, "a rig of 4096 bytes"));
    assert_non_null(strstr(err.text, "damaged"));
    assert_int_equal(b.work_left, 1);
    assert_int_equal(budget_spend_work(&b, 1, &err), MRT_OK);
    assert_true(budget_spend_bytes(&b, UINT64_MAX, &err) < 0);
    assert_non_null(strstr(err.text, "bytes of memory"));
    /* No size of a file makes it overflow. */
    assert_true(budget_of(BUDGET_SHOW, UINT64_MAX).work_left == UINT64_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(error_text_is_cut_and_prefixed_within_its_room),
        cmocka_unit_test(numbers_are_whole_words_and_finite),
        cmocka_unit_test(lines_words_and_fields_are_taken_apart),
        cmocka_unit_test(foreign_text_cannot_steer_a_terminal),
        cmocka_unit_test(ring_keeps_order_and_refuses_when_full),
        cmocka_unit_test(ring_crosses_threads_without_loss_or_reordering),
        cmocka_unit_test(slot_gives_the_newest_value_only_once),
        cmocka_unit_test(log_loses_nothing_silently_with_many_writers),
        cmocka_unit_test(rigid_motions_compose_invert_and_keep_lengths),
        cmocka_unit_test(turns_about_the_axes_have_the_bits_of_any_turn),
        cmocka_unit_test(files_are_written_whole_or_not_at_all),
        cmocka_unit_test(missing_folders_of_a_file_are_created),
        cmocka_unit_test(reading_refuses_what_is_not_a_file_with_bytes),
        cmocka_unit_test(what_a_killed_writer_left_is_removed_by_the_next_one),
        cmocka_unit_test(what_lies_at_a_temporary_name_is_not_written_or_followed),
        cmocka_unit_test(holes_of_a_file_do_not_count),
        cmocka_unit_test(a_budget_grows_with_the_file_and_says_when_it_is_used_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
