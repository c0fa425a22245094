/* A disk that is full while something is recorded: said at once, held, written when there is space.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "take/show_disk.h"
#include "take/show_scene.h"

static int tear_down(void **state)
{
    atomic_store(&disk_answer, SQLITE_OK);
    return scene_tear_down(state);
}

/* Gives samples as if time went on, and lets the writer look at them. */
static void give_in_pieces(scene_recording *r, int64_t from_n, int64_t to_n)
{
    error err;
    for (int64_t n = from_n; n < to_n; n += 500) {
        scene_give(r, n, n + 500 < to_n ? n + 500 : to_n);
        (void)!writer_flush(r->writer, &err);
    }
}

/* A minute and a half of two gloves at 150 Hz is 27000 samples. */
static void a_full_disk_loses_nothing(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    char message[600];
    int64_t take_id;
    scene_record(&r, s, &options);
    give_in_pieces(&r, 0, 1000);
    atomic_store(&disk_answer, SQLITE_FULL);
    scene_give(&r, 1000, 1010);
    assert_int_equal(writer_flush(r.writer, &err), MRT_ERR_IO);
    assert_int_equal(writer_status_of(r.writer).state, WRITER_WAITING);
    assert_int_equal(writer_status_of(r.writer).backlog, 10);
    writer_message(r.writer, message, sizeof message);
    assert_non_null(strstr(message, "free space on the disk"));
    assert_non_null(strstr(message, "10 samples are held"));
    scene_expect(s, r.track, 0, 1000); /* what was there before is there */

    scene_must(writer_take_begin(r.writer, 1, &(writer_slate){.scene = "f"}, &take_id, &err), &err);
    give_in_pieces(&r, 1010, 28000);
    scene_must(writer_take_end(r.writer, take_id, 5, &err), &err);
    writer_status status = writer_status_of(r.writer);
    assert_int_equal(status.lost_count, 0);
    assert_int_equal(status.backlog, 27000);
    assert_true(status.held_bytes > 0 && status.held_bytes < 8 * 1024 * 1024);

    atomic_store(&disk_answer, SQLITE_OK);
    scene_flush(&r);
    status = writer_status_of(r.writer);
    assert_int_equal(status.state, WRITER_OK);
    assert_int_equal(status.backlog, 0);
    assert_int_equal(status.held_bytes, 0);
    writer_message(r.writer, message, sizeof message);
    assert_string_equal(message, "");
    scene_expect(s, r.track, 0, 28000);
    show_take got;
    scene_must(show_take_read(s, take_id, &got, &err), &err);
    assert_int_equal(got.end_ns, scene_utc_ns + 5);
    scene_stop(&r);
    show_close(s);
}

/* The same with a disk that answers with errors, again and again. */
static void a_disk_that_comes_and_goes_loses_nothing(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err;
    scene_record(&r, s, &options);
    scene_flush(&r);
    for (int64_t i = 0; i < 60; ++i) {
        atomic_store(&disk_answer, i % 3 == 1 ? SQLITE_IOERR_WRITE : SQLITE_OK);
        scene_give(&r, i * 37, i * 37 + 37);
        mrt_result result = writer_flush(r.writer, &err);
        assert_true((result < 0) == (i % 3 == 1));
    }
    atomic_store(&disk_answer, SQLITE_OK);
    scene_flush(&r);
    assert_true(atomic_load(&disk_refused_count) >= 20);
    assert_int_equal(writer_status_of(r.writer).lost_count, 0);
    scene_stop(&r);
    scene_expect(s, r.track, 0, 60 * 37);
    show_close(s);
}

/* Memory runs out too: what is lost is counted, and told in the show. */
static void what_memory_cannot_hold_is_counted(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    options.memory_bytes = 20000;
    scene_record(&r, s, &options);
    give_in_pieces(&r, 0, 1000);
    atomic_store(&disk_answer, SQLITE_FULL);
    give_in_pieces(&r, 1000, 20000);
    writer_status status = writer_status_of(r.writer);
    assert_true(status.lost_count > 1000);
    assert_true(status.held_bytes < 30000);
    assert_int_equal(status.lost_count + status.backlog, 19000);
    atomic_store(&disk_answer, SQLITE_OK);
    scene_flush(&r);
    give_in_pieces(&r, 20000, 21000);
    status = writer_status_of(r.writer);
    assert_int_equal(status.backlog, 0);
    assert_int_equal(status.committed_count + status.lost_count, 21000);
    scene_stop(&r);

    take_event *events;
    size_t count;
    double told = 0;
    scene_must(show_events(s, INT64_MIN, INT64_MAX, &events, &count, &err), &err);
    for (size_t i = 0; i < count; ++i)
        if (events[i].kind == TAKE_EVENT_LOST) {
            assert_int_equal(events[i].track, r.track);
            told += events[i].value;
        }
    free(events);
    assert_true(told == (double)status.lost_count);

    show_reader *reader;
    mrt_sample got;
    mrt_result result;
    int64_t n = 0, read = 0;
    scene_must(show_reader_open(&reader, s, r.track, INT64_MIN, INT64_MAX, &err), &err);
    while ((result = show_reader_next(reader, &got, &err)) == MRT_OK) {
        while (scene_shown(r.track, n).time_ns < got.time_ns)
            ++n;
        mrt_sample expected = scene_shown(r.track, n);
        assert_true(scene_is_same(&got, &expected));
        ++read;
    }
    assert_int_equal(result, MRT_END);
    assert_int_equal(read, status.committed_count);
    show_reader_close(reader);
    show_close(s);
}

/* The next one who opens it for writing finds what could not be written, as after a kill. */
static void stopping_on_a_full_disk_leaves_the_rest_to_the_next_opening(void **state)
{
    show *s = scene_create(*state);
    writer_options options = scene_options();
    scene_recording r;
    error err = {""};
    scene_record(&r, s, &options);
    give_in_pieces(&r, 0, 100);
    atomic_store(&disk_answer, SQLITE_FULL);
    scene_give(&r, 100, 150);
    assert_true(writer_stop(r.writer, &err) < 0);
    assert_non_null(strstr(err.text, "50 samples could not be written"));
    atomic_store(&disk_answer, SQLITE_OK);
    scene_expect(s, r.track, 0, 100);
    show_close(s);
    scene_must(show_open(&s, ((scene *)*state)->path, SHOW_WRITE, &err), &err);
    scene_expect(s, r.track, 0, 150);
    show_close(s);
    scene_must(show_open(&s, ((scene *)*state)->path, SHOW_WRITE, &err), &err);
    scene_expect(s, r.track, 0, 150); /* once */
    show_close(s);
}

static void edits_on_a_full_disk_are_refused_whole(void **state)
{
    show *s = scene_create(*state);
    error err = {""};
    int64_t id;
    scene_must(
        show_take_create(s, &(show_new_take){.scene = "", .shot = "", .origin = ""}, &id, &err),
        &err);
    atomic_store(&disk_answer, SQLITE_FULL);
    assert_int_equal(show_edit_append(s, id, "{}", 1, NULL, 0, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "free space"));
    atomic_store(&disk_answer, SQLITE_OK);
    show_take got;
    scene_must(show_take_read(s, id, &got, &err), &err);
    assert_int_equal(got.edit_count, 0);
    assert_int_equal(got.edit_head, 0);
    scene_must(show_edit_append(s, id, "{}", 1, NULL, 0, &err), &err);
    show_close(s);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scene_set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_full_disk_loses_nothing),
        TEST(a_disk_that_comes_and_goes_loses_nothing),
        TEST(what_memory_cannot_hold_is_counted),
        TEST(stopping_on_a_full_disk_leaves_the_rest_to_the_next_opening),
        TEST(edits_on_a_full_disk_are_refused_whole),
    };
    disk_install();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
