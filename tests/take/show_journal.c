/* core/show/writer_store.h, the journal: lets go of what is old and nobody holds on to, and of
 * nothing else. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "take/show_scene.h"

enum { PER_SECOND = 150 };

static void record(scene_recording *out, const scene *s, int64_t journal_s)
{
    error err = {""};
    show *made;
    writer_options options = scene_options();
    options.journal_ns = journal_s * NS_PER_S;
    scene_must(show_create(&made, s->path, &err), &err);
    scene_record(out, made, &options);
}

/* The journal takes a step when something was committed: a second of samples at a time. */
static void give_seconds(scene_recording *r, int64_t from_s, int64_t to_s)
{
    for (int64_t second = from_s; second < to_s; ++second) {
        scene_give(r, second * PER_SECOND, (second + 1) * PER_SECOND);
        scene_flush(r);
    }
}

static int64_t first_left_ns(scene_recording *r, int64_t track)
{
    error err = {""};
    show_track got;
    scene_must(show_track_read(r->show, track, &got, &err), &err);
    int64_t out = got.from_ns - scene_utc_ns;
    show_track_finish(&got);
    return out;
}

/* Every sample of [from, to], and no word of missing ones. */
static int64_t count_within(show *s, int64_t track, int64_t from_ns, int64_t to_ns)
{
    error err = {""};
    show_reader *reader;
    mrt_sample got;
    mrt_result result;
    int64_t count = 0;
    scene_must(show_reader_open(&reader, s, track, from_ns, to_ns, &err), &err);
    while ((result = show_reader_next(reader, &got, &err)) == MRT_OK)
        ++count;
    if (result < 0)
        fail_msg("%s", err.text);
    show_reader_close(reader);
    return count;
}

static void what_is_older_than_the_ring_goes(void **state)
{
    scene_recording r;
    record(&r, *state, 20);
    give_seconds(&r, 0, 60);
    int64_t now_ns = scene_sample(r.track, 60 * PER_SECOND - 1).time_ns;
    int64_t first_ns = first_left_ns(&r, r.track);
    assert_true(first_ns >= now_ns - 24 * NS_PER_S);
    assert_true(first_ns <= now_ns - 20 * NS_PER_S);
    int64_t left = count_within(r.show, r.track, INT64_MIN, INT64_MAX);
    assert_in_range(left, 20 * PER_SECOND, 24 * PER_SECOND);
    scene_stop(&r);
    show_close(r.show);
}

static void takes_are_held_on_to(void **state)
{
    scene_recording r;
    error err = {""};
    int64_t recorded, kept;
    record(&r, *state, 10);
    give_seconds(&r, 0, 8);
    scene_must(writer_take_begin(r.writer, 8 * NS_PER_S, &(writer_slate){0}, &recorded, &err),
               &err);
    give_seconds(&r, 8, 12);
    scene_must(writer_take_end(r.writer, recorded, 12 * NS_PER_S, &err), &err);
    give_seconds(&r, 12, 30);
    scene_must(writer_keep(r.writer, 24 * NS_PER_S, 27 * NS_PER_S, &(writer_slate){0}, &kept, &err),
               &err);
    scene_must(show_edit_append(r.show, recorded, "{\"op\":\"take.delete\"}", 1, NULL, 0, &err),
               &err); /* a deleted take can be restored */
    give_seconds(&r, 30, 80);
    for (int64_t id = recorded; id <= kept; ++id) {
        show_take got;
        scene_must(show_take_read(r.show, id, &got, &err), &err);
        int64_t count = count_within(r.show, r.track, got.start_ns, got.end_ns);
        int64_t seconds = (got.end_ns - got.start_ns) / NS_PER_S;
        assert_in_range(count, seconds * PER_SECOND - 1, seconds * PER_SECOND + 1);
    }
    /* The performance began at 0: a replay of the first take starts there. */
    assert_in_range(count_within(r.show, r.track, scene_utc_ns, scene_utc_ns + 12 * NS_PER_S),
                    12 * PER_SECOND - 1, 12 * PER_SECOND + 1);
    /* Between the takes' end and the ring's start it is gone. */
    assert_int_equal(
        count_within(r.show, r.track, scene_utc_ns + 40 * NS_PER_S, scene_utc_ns + 60 * NS_PER_S),
        0);
    scene_stop(&r);
    show_close(r.show);
}

/* A hand that is away for some seconds leaves no samples, and none are missing. */
static void a_take_that_ends_while_a_hand_is_away_is_whole(void **state)
{
    scene_recording r;
    error err = {""};
    int64_t id;
    record(&r, *state, 10);
    give_seconds(&r, 0, 8);
    scene_must(writer_take_begin(r.writer, 8 * NS_PER_S, &(writer_slate){0}, &id, &err), &err);
    give_seconds(&r, 8, 10);
    scene_must(writer_take_end(r.writer, id, 12 * NS_PER_S, &err), &err);
    give_seconds(&r, 15, 80);
    assert_true(first_left_ns(&r, r.track) < NS_PER_S); /* the performance began at 0 */
    assert_true(count_within(r.show, r.track, INT64_MIN, INT64_MAX) >= 20 * PER_SECOND);
    assert_int_equal(
        count_within(r.show, r.track, scene_utc_ns + 20 * NS_PER_S, scene_utc_ns + 60 * NS_PER_S),
        0);
    scene_stop(&r);
    show_close(r.show);
}

static void a_take_that_begins_while_a_hand_is_away_is_whole(void **state)
{
    scene_recording r;
    error err = {""};
    int64_t id;
    record(&r, *state, 10);
    give_seconds(&r, 0, 10);
    take_performance next = scene_performance(r.track);
    scene_must(writer_begin_performance(r.writer, &next, 12 * NS_PER_S, &err), &err);
    scene_must(writer_take_begin(r.writer, 13 * NS_PER_S, &(writer_slate){0}, &id, &err), &err);
    give_seconds(&r, 15, 17);
    scene_must(writer_take_end(r.writer, id, 17 * NS_PER_S, &err), &err);
    give_seconds(&r, 17, 80);
    assert_true(first_left_ns(&r, r.track) > 8 * NS_PER_S);
    assert_true(count_within(r.show, r.track, INT64_MIN, INT64_MAX) >= 12 * PER_SECOND);
    assert_int_equal(
        count_within(r.show, r.track, scene_utc_ns + 20 * NS_PER_S, scene_utc_ns + 60 * NS_PER_S),
        0);
    scene_stop(&r);
    show_close(r.show);
}

/* The whole ring is kept, behind an older take of the same hand. */
static void what_is_kept_from_where_the_ring_begins_is_whole(void **state)
{
    scene_recording r;
    error err = {""};
    int64_t older, kept;
    record(&r, *state, 10);
    give_seconds(&r, 0, 4);
    scene_must(writer_keep(r.writer, NS_PER_S, 3 * NS_PER_S, &(writer_slate){0}, &older, &err),
               &err);
    give_seconds(&r, 4, 20);
    take_performance next = scene_performance(r.track);
    scene_must(writer_begin_performance(r.writer, &next, 20 * NS_PER_S, &err), &err);
    give_seconds(&r, 20, 60);
    scene_must(writer_keep(r.writer, 22 * NS_PER_S, 60 * NS_PER_S, &(writer_slate){0}, &kept, &err),
               &err);
    give_seconds(&r, 60, 70);
    assert_true(count_within(r.show, r.track, INT64_MIN, INT64_MAX) >= 20 * PER_SECOND);
    scene_stop(&r);
    show_close(r.show);
}

static void a_checkpoint_shortens_what_a_take_needs(void **state)
{
    scene_recording r;
    error err = {""};
    int64_t id;
    record(&r, *state, 10);
    for (int64_t second = 0; second < 60; ++second) {
        give_seconds(&r, second, second + 1);
        if (second % 5 == 4) {
            uint8_t *buffer = writer_checkpoint_buffer(r.writer);
            assert_non_null(buffer);
            memset(buffer, (int)second, 100);
            writer_checkpoint(r.writer, r.performance, (second + 1) * NS_PER_S, 1, buffer, 100);
        }
        if (second == 30) /* from 28 s: the checkpoint before is that of 25 s */
            scene_must(
                writer_keep(r.writer, 28 * NS_PER_S, 30 * NS_PER_S, &(writer_slate){0}, &id, &err),
                &err);
    }
    assert_in_range(first_left_ns(&r, r.track), 24 * NS_PER_S, 25 * NS_PER_S);
    assert_in_range(
        count_within(r.show, r.track, scene_utc_ns + 25 * NS_PER_S, scene_utc_ns + 30 * NS_PER_S),
        5 * PER_SECOND - 1, 5 * PER_SECOND + 1);
    assert_int_equal(
        count_within(r.show, r.track, scene_utc_ns + 33 * NS_PER_S, scene_utc_ns + 43 * NS_PER_S),
        0);
    show_checkpoint got;
    scene_must(
        show_checkpoint_before(r.show, r.performance, scene_utc_ns + 28 * NS_PER_S, 0, &got, &err),
        &err);
    assert_int_equal(got.time_ns, scene_utc_ns + 25 * NS_PER_S);
    show_checkpoint_finish(&got);
    /* The ring itself begins at a checkpoint, so that all of it can be kept and replayed. */
    scene_must(
        show_checkpoint_before(r.show, r.performance, scene_utc_ns + 49 * NS_PER_S, 0, &got, &err),
        &err);
    assert_int_equal(got.time_ns, scene_utc_ns + 45 * NS_PER_S);
    show_checkpoint_finish(&got);
    scene_must(
        show_checkpoint_before(r.show, r.performance, scene_utc_ns + 42 * NS_PER_S, 0, &got, &err),
        &err);
    assert_int_equal(got.time_ns, scene_utc_ns + 30 * NS_PER_S); /* the take's last */
    show_checkpoint_finish(&got);
    scene_stop(&r);
    show_close(r.show);
}

/* What an edit took from elsewhere is held on to like the take itself. */
static void what_an_edit_refers_to_is_held_on_to(void **state)
{
    scene_recording r;
    error err = {""};
    int64_t id;
    record(&r, *state, 10);
    give_seconds(&r, 0, 5);
    take_performance next = scene_performance(r.track);
    scene_must(writer_begin_performance(r.writer, &next, 5 * NS_PER_S, &err), &err);
    give_seconds(&r, 5, 8);
    scene_must(show_take_create(r.show,
                                &(show_new_take){.scene = "", .shot = "", .origin = "comped"}, &id,
                                &err),
               &err);
    show_span span = {.performance = next.id,
                      .from_ns = scene_utc_ns + 6 * NS_PER_S,
                      .to_ns = scene_utc_ns + 7 * NS_PER_S};
    scene_must(show_edit_append(r.show, id, "{\"op\":\"x\"}", 1, &span, 1, &err), &err);
    give_seconds(&r, 8, 60);
    assert_in_range(first_left_ns(&r, r.track), 4 * NS_PER_S, 5 * NS_PER_S);
    assert_in_range(count_within(r.show, r.track, span.from_ns, span.to_ns), PER_SECOND - 1,
                    PER_SECOND + 1);
    scene_stop(&r);
    show_close(r.show);
}

static void keeping_reaches_back_as_far_as_there_is_something(void **state)
{
    scene_recording r;
    error err = {""};
    int64_t id;
    show_take got;
    record(&r, *state, 10);
    give_seconds(&r, 0, 40);
    scene_must(writer_keep(r.writer, 0, 40 * NS_PER_S, &(writer_slate){0}, &id, &err), &err);
    scene_flush(&r);
    scene_must(show_take_read(r.show, id, &got, &err), &err);
    assert_in_range(got.start_ns, scene_utc_ns + 25 * NS_PER_S, scene_utc_ns + 30 * NS_PER_S);
    assert_in_range(got.start_ns, scene_utc_ns + first_left_ns(&r, r.track) - NS_PER_S,
                    scene_utc_ns + first_left_ns(&r, r.track));
    scene_stop(&r);
    show_close(r.show);
}

/* Twenty minutes through a ring of ten seconds. */
static void the_file_does_not_grow_for_ever(void **state)
{
    scene *s = *state;
    scene_recording r;
    struct stat late;
    record(&r, s, 10);
    give_seconds(&r, 0, 1200);
    scene_stop(&r);
    show_close(r.show);
    assert_int_equal(stat(s->path, &late), 0);
    assert_true(late.st_size < 1000000);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scene_set_up, scene_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(what_is_older_than_the_ring_goes),
        TEST(takes_are_held_on_to),
        TEST(a_take_that_ends_while_a_hand_is_away_is_whole),
        TEST(a_take_that_begins_while_a_hand_is_away_is_whole),
        TEST(what_is_kept_from_where_the_ring_begins_is_whole),
        TEST(a_checkpoint_shortens_what_a_take_needs),
        TEST(what_an_edit_refers_to_is_held_on_to),
        TEST(keeping_reaches_back_as_far_as_there_is_something),
        TEST(the_file_does_not_grow_for_ever),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
