/* core/show/spool.h: what a program that was killed had been given is found when the show opens
 * next. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "take/show_scene.h"
#include "show/spool.h"
#include "show/writer_store.h"

#include <signal.h>
#include <sys/wait.h>
#include <time.h>

/* A program that was killed between being given samples and committing them, and a stranger's
 * spool. */
static void what_a_killed_writer_was_given_is_found(void **state)
{
    scene *at = *state;
    pid_t child = fork();
    if (child == 0) {
        error err;
        show *s;
        scene_recording r;
        writer_options options = scene_options();
        if (show_create(&s, at->path, &err) < 0)
            _exit(1);
        scene_record(&r, s, &options);
        scene_give(&r, 0, 1000);
        scene_flush(&r);
        scene_give(&r, 1000, 21000); /* more than a commit takes, less than the ring holds */
        raise(SIGKILL);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
    if (access("/dev/shm", W_OK) != 0)
        skip();
    show *s = scene_open(at, SHOW_WRITE);
    scene_expect(s, 1, 0, 21000);
    show_take *takes;
    size_t count;
    error err = {""};
    scene_must(show_takes(s, &takes, &count, &err), &err);
    free(takes);
    show_performance performance;
    scene_must(show_performance_read(s, 1, &performance, &err), &err);
    assert_int_equal(performance.to_ns, scene_shown(1, 20999).time_ns);
    show_performance_finish(&performance);
    show_close(s);
    s = scene_open(at, SHOW_WRITE);
    scene_expect(s, 1, 0, 21000); /* once */
    show_close(s);
}

/* Samples 0..9 were given, the last of them as the kill came; 10..14 wait, and 15..19 with channels
 * that have no track yet. Another input's have none at all. */
static void record_and_wait(const scene *at)
{
    error err;
    show *s;
    scene_recording r;
    writer_options options = scene_options();
    if (show_create(&s, at->path, &err) < 0)
        _exit(1);
    scene_record(&r, s, &options);
    const uint32_t place = writer_arrivals_open(r.writer), other = writer_arrivals_open(r.writer);
    for (uint32_t n = 0; n < 20; ++n) {
        const mrt_sample sample = scene_sample(r.track, n);
        writer_arrived(r.writer, place, n + 7, n < 15 ? 3 : 4, &sample);
        writer_arrived(r.writer, other, n, 0, &sample);
    }
    writer_arrivals_follow(r.writer, place, r.track, 3);
    scene_give(&r, 0, 9);
    writer_arrivals_performed(r.writer, place, 9 + 7);
    scene_give(&r, 9, 10);
    scene_flush(&r);
    raise(SIGKILL);
}

static void what_had_arrived_and_was_not_performed_is_added_once(void **state)
{
    scene *at = *state;
    int status;
    pid_t child = fork();
    if (child == 0)
        record_and_wait(at);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
    if (access("/dev/shm", W_OK) != 0)
        skip();
    for (int i = 0; i < 2; ++i) {
        show *s = scene_open(at, SHOW_WRITE);
        scene_expect(s, 1, 0, 15);
        show_close(s);
    }
}

/* Of a lane that has gone round all but the oldest, which may be half overwritten. */
static void a_lane_keeps_the_newest(void **state)
{
    scene *at = *state;
    os_file_id of;
    int64_t context;
    uint32_t record;
    const spool_shape shape = {.record_size = sizeof record,
                               .record_count = 8,
                               .lane_record_size = sizeof record,
                               .lane_record_count = 8};
    assert_true(os_id_of_path(at->folder, &of));
    spool *made = spool_create(&of, at->path, &shape, 5);
    assert_non_null(made);
    for (uint32_t i = 0; i < 100; ++i)
        spool_lane_push(made, SPOOL_LANES - 1, &i);
    for (uint32_t i = 0; i < 3; ++i)
        spool_lane_push(made, 0, &i);
    spool_lane_mark(made, 0, 77);
    spool_lane_done(made, 0, 1);
    spool_abandon(made);
    if (access("/dev/shm", W_OK) != 0)
        skip();
    spool *found = spool_find(&of, &shape, &context);
    assert_non_null(found);
    spool_lane last = spool_lane_of(found, SPOOL_LANES - 1), first = spool_lane_of(found, 0);
    assert_int_equal(last.count, 7);
    assert_int_equal(last.whose, 0);
    for (uint32_t i = 0; i < 7; ++i) {
        spool_lane_read(found, SPOOL_LANES - 1, i, &record);
        assert_int_equal(record, 93 + i);
    }
    assert_true(first.count == 3 && first.whose == 77 && first.done == 1);
    spool_lane_read(found, 0, 2, &record);
    assert_int_equal(record, 2);
    assert_int_equal(spool_lane_of(found, 1).count, 0);
    spool_destroy(found);
}

static void a_spool_of_another_session_is_left_out(void **state)
{
    scene *at = *state;
    show *s = scene_create(at);
    writer_options options = scene_options();
    scene_recording r;
    scene_record(&r, s, &options);
    scene_give(&r, 0, 10);
    scene_stop(&r);
    show_close(s);
    os_file_id of;
    int64_t context;
    assert_true(os_id_of_path(at->path, &of));
    spool_shape shape = writer_spool_shape;
    shape.record_count = 8;
    spool *stranger = spool_create(&of, at->path, &shape, 12345);
    assert_non_null(stranger);
    writer_record record = {
        .kind = WRITER_RECORD_SAMPLE, .id = 1, .of.sample = scene_sample(1, 50)};
    assert_true(spool_push(stranger, &record));
    spool_abandon(stranger);
    s = scene_open(at, SHOW_WRITE);
    scene_expect(s, 1, 0, 10);
    show_close(s);
    assert_null(spool_find(&of, &writer_spool_shape, &context));
}

static void a_ring_gives_what_it_took_in_order(void **state)
{
    scene *at = *state;
    os_file_id of;
    uint32_t record, count = 0;
    int64_t context = 0;
    const spool_shape shape = {.record_size = sizeof record, .record_count = 8};
    const spool_shape other = {.record_size = sizeof record + 4, .record_count = 8};
    assert_true(os_id_of_path(at->folder, &of));
    spool *ring = spool_create(&of, at->path, &shape, 77);
    assert_non_null(ring);
    for (uint32_t i = 0; i < 8; ++i)
        assert_true(spool_push(ring, &i));
    assert_false(spool_push(ring, &(uint32_t){9}));
    assert_int_equal(spool_loss_count(ring), 1);
    for (uint32_t i = 0; i < 5; ++i)
        assert_true(spool_pop(ring, &record) && record == i);
    spool_settle(ring);
    for (uint32_t i = 8; i < 12; ++i)
        assert_true(spool_push(ring, &i));
    assert_true(spool_pop(ring, &record) && record == 5); /* taken, not settled */
    spool_abandon(ring);
    if (access("/dev/shm", W_OK) != 0)
        skip();
    assert_null(spool_find(&of, &other, &context)); /* of another shape: removed */
    ring = spool_create(&of, at->path, &shape, 78);
    for (uint32_t i = 0; i < 6; ++i)
        assert_true(spool_push(ring, &i) && (i >= 3 || spool_pop(ring, &record)));
    spool_abandon(ring);
    ring = spool_find(&of, &shape, &context);
    assert_non_null(ring);
    assert_int_equal(context, 78);
    while (spool_pop(ring, &record))
        assert_int_equal(record, count++);
    assert_int_equal(count, 6);
    spool_destroy(ring);
    assert_null(spool_find(&of, &shape, &context));
}

static const spool_shape small = {.record_size = sizeof(uint32_t), .record_count = 8};

static bool is_kept(const os_file_id *of)
{
    int64_t context;
    spool *found = spool_find(of, &small, &context);
    spool_abandon(found);
    return found != NULL;
}

/* A killed program's: it keeps nothing open. */
static void leave_spool(const scene *at, const os_file_id *of, bool is_settled)
{
    const pid_t child = fork();
    if (child == 0) {
        uint32_t record = 7;
        spool *ring = spool_create(of, at->path, &small, 1);
        if (!ring || !spool_push(ring, &record))
            _exit(1);
        if (is_settled && spool_pop(ring, &record))
            spool_settle(ring);
        (void)raise(SIGKILL);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
}

static void what_nobody_will_ask_for_is_removed(void **state)
{
    scene *at = *state;
    os_file_id of;
    char renamed[SCENE_PATH + 8];
    const int64_t now_s = (int64_t)time(NULL), later_s = now_s + 2 * 3600;
    if (access("/dev/shm", W_OK) != 0)
        skip();
    show_close(scene_create(at));
    assert_true(os_id_of_path(at->path, &of));
    (void)snprintf(renamed, sizeof renamed, "%s.renamed", at->path);
    leave_spool(at, &of, true); /* nothing waits in it */
    assert_true(is_kept(&of));
    spool_remove_abandoned(now_s);
    assert_false(is_kept(&of));
    leave_spool(at, &of, false);
    spool_remove_abandoned(later_s); /* its show is there */
    assert_true(is_kept(&of));
    assert_int_equal(rename(at->path, renamed), 0);
    spool_remove_abandoned(later_s);
    assert_true(is_kept(&of));
    assert_int_equal(unlink(renamed), 0);
    spool_remove_abandoned(now_s); /* it was used just now */
    assert_true(is_kept(&of));
    uint32_t record = 7;
    spool *ring = spool_create(&of, at->path, &small, 1); /* somebody uses it */
    assert_true(spool_push(ring, &record));
    spool_remove_abandoned(later_s);
    assert_true(is_kept(&of));
    spool_abandon(ring);
    spool_remove_abandoned(later_s);
    assert_true(is_kept(&of)); /* of a show that was never at a path */
    spool_destroy(spool_find(&of, &small, &(int64_t){0}));
    FILE *again = fopen(at->path, "wb");
    assert_true(again && fclose(again) == 0 && os_id_of_path(at->path, &of));
    leave_spool(at, &of, false);
    char command[SCENE_PATH];
    (void)snprintf(command, sizeof command, "rm -r '%s'", at->folder);
    assert_int_equal(system(command), 0);
    spool_remove_abandoned(later_s);
    assert_false(is_kept(&of)); /* with its folder */
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scene_set_up, scene_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(what_a_killed_writer_was_given_is_found),
        TEST(what_had_arrived_and_was_not_performed_is_added_once),
        TEST(a_lane_keeps_the_newest),
        TEST(a_spool_of_another_session_is_left_out),
        TEST(what_nobody_will_ask_for_is_removed),
        TEST(a_ring_gives_what_it_took_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
