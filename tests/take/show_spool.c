/* core/take/spool.h: what a program that was killed had been given is found when the show opens
 * next. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "take/show_scene.h"
#include "take/spool.h"
#include "take/writer_store.h"

#include <signal.h>
#include <sys/wait.h>

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
    struct stat of;
    int64_t context;
    assert_int_equal(stat(at->path, &of), 0);
    spool *stranger = spool_create(&of, sizeof(writer_record), 8, 12345);
    assert_non_null(stranger);
    writer_record record = {
        .kind = WRITER_RECORD_SAMPLE, .id = 1, .of.sample = scene_sample(1, 50)};
    assert_true(spool_push(stranger, &record));
    spool_abandon(stranger);
    s = scene_open(at, SHOW_WRITE);
    scene_expect(s, 1, 0, 10);
    show_close(s);
    assert_null(spool_find(&of, sizeof(writer_record), &context));
}

static void a_ring_gives_what_it_took_in_order(void **state)
{
    scene *at = *state;
    struct stat of;
    uint32_t record, count = 0;
    int64_t context = 0;
    assert_int_equal(stat(at->folder, &of), 0);
    spool *ring = spool_create(&of, sizeof record, 8, 77);
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
    assert_null(spool_find(&of, sizeof record + 4, &context)); /* of another shape: removed */
    ring = spool_create(&of, sizeof record, 8, 78);
    for (uint32_t i = 0; i < 6; ++i)
        assert_true(spool_push(ring, &i) && (i >= 3 || spool_pop(ring, &record)));
    spool_abandon(ring);
    ring = spool_find(&of, sizeof record, &context);
    assert_non_null(ring);
    assert_int_equal(context, 78);
    while (spool_pop(ring, &record))
        assert_int_equal(record, count++);
    assert_int_equal(count, 6);
    spool_destroy(ring);
    assert_null(spool_find(&of, sizeof record, &context));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scene_set_up, scene_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(what_a_killed_writer_was_given_is_found),
        TEST(a_spool_of_another_session_is_left_out),
        TEST(a_ring_gives_what_it_took_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
