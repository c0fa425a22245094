/* The time axis, its ticks and what draws a drag. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "take/edit_help.h"
#include "window/timeline/axis.h"

#include <math.h>

static timeline_axis axis_of(float width, int64_t from_ns, int64_t to_ns)
{
    timeline_axis axis = {.x = 100.0f, .width = width, .from_ns = from_ns};
    axis.ns_per_point = (double)(to_ns - from_ns) / (double)width;
    return axis;
}

/* ---- axis ---- */

static void an_instant_has_its_place(void **state)
{
    (void)state;
    timeline_axis axis = axis_of(1000.0f, 2 * help_s, 12 * help_s);
    assert_float_equal(timeline_axis_x(&axis, 2 * help_s), 100.0, 1e-3);
    assert_float_equal(timeline_axis_x(&axis, 7 * help_s), 600.0, 1e-3);
    assert_int_equal(timeline_axis_ns(&axis, 600.0f), 7 * help_s);
    assert_int_equal(timeline_axis_until_ns(&axis), 12 * help_s);
}

static void fitting_shows_all_with_air(void **state)
{
    (void)state;
    timeline_axis axis = axis_of(1000.0f, 0, 1);
    timeline_axis_fit(&axis, 0, 3600 * help_s);
    assert_float_equal(timeline_axis_x(&axis, 0), 120.0, 0.1);
    assert_float_equal(timeline_axis_x(&axis, 3600 * help_s), 1080.0, 0.1);
}

static void zoom_keeps_what_is_under_the_pointer(void **state)
{
    (void)state;
    timeline_axis axis = axis_of(1000.0f, 0, 600 * help_s);
    int64_t at_ns = timeline_axis_ns(&axis, 433.0f);
    for (int i = 0; i < 40; ++i) {
        timeline_axis_zoom(&axis, 433.0f, 1.25);
        assert_float_equal(timeline_axis_x(&axis, at_ns), 433.0, 0.02);
    }
}

static void zoom_goes_from_a_day_to_ten_samples(void **state)
{
    (void)state;
    timeline_axis axis = axis_of(1000.0f, 0, 600 * help_s);
    for (int i = 0; i < 200; ++i)
        timeline_axis_zoom(&axis, 600.0f, 1.5);
    assert_int_equal(timeline_axis_span_ns(&axis, 1000.0f), 200000);
    for (int i = 0; i < 200; ++i)
        timeline_axis_zoom(&axis, 600.0f, 1.0 / 1.5);
    assert_int_equal(timeline_axis_span_ns(&axis, 1000.0f), 86400 * help_s);
}

static void something_stays_in_sight(void **state)
{
    (void)state;
    timeline_axis axis = axis_of(1000.0f, 0, 10 * help_s);
    timeline_axis_pan(&axis, -100000.0f);
    timeline_axis_hold(&axis, 0, 20 * help_s);
    assert_int_equal(axis.from_ns, 19 * help_s);
    timeline_axis_pan(&axis, 100000.0f);
    timeline_axis_hold(&axis, 0, 20 * help_s);
    assert_int_equal(axis.from_ns, -9 * help_s);
}

static void following_turns_pages_only(void **state)
{
    (void)state;
    timeline_axis axis = axis_of(1000.0f, 0, 10 * help_s);
    assert_false(timeline_axis_follow(&axis, 9 * help_s));
    assert_int_equal(axis.from_ns, 0);
    assert_true(timeline_axis_follow(&axis, 10 * help_s + help_ms));
    assert_int_equal(axis.from_ns, 10 * help_s + help_ms - 800 * help_ms);
}

/* ---- ticks ---- */

static timeline_code code_of(uint32_t num, uint32_t den, bool is_drop, int64_t first_frame)
{
    return (timeline_code){{num, den, is_drop}, first_frame};
}

static void check_ticks(const timeline_axis *axis, const timeline_code *code)
{
    static timeline_tick tick[TIMELINE_TICKS_MAX];
    uint32_t count = timeline_ticks(tick, axis, code, 90.0f);
    float label = -1e9f, any = -1e9f;
    uint32_t labels = 0;
    if (count < 4 || count == TIMELINE_TICKS_MAX)
        fail_msg("%u ticks at %g ns a point from %lld, %u/%u", count, axis->ns_per_point,
                 (long long)axis->from_ns, code->rate.num, code->rate.den);
    for (uint32_t i = 0; i < count; ++i) {
        float x = timeline_axis_x(axis, tick[i].at_ns);
        if (x < any + 2.5f)
            fail_msg("ticks %g points apart at %g ns a point, %u/%u", (double)(x - any),
                     axis->ns_per_point, code->rate.num, code->rate.den);
        any = x;
        assert_int_equal(tick[i].label[0] != '\0', tick[i].is_major);
        if (!tick[i].is_major)
            continue;
        if (x < label + 89.0f)
            fail_msg("'%s' is %g points after the label before, at %g ns a point, %u/%u",
                     tick[i].label, (double)(x - label), axis->ns_per_point, code->rate.num,
                     code->rate.den);
        label = x;
        labels += x >= axis->x && x <= axis->x + axis->width;
        if (tick[i].label[0] == '+')
            continue;
        char exact[TIMECODE_TEXT];
        timeline_code_write(exact, code, tick[i].at_ns);
        assert_string_equal(tick[i].label, exact);
    }
    assert_true(labels >= 1);
}

static void ticks_are_apart_and_say_the_time_code_at_every_zoom(void **state)
{
    (void)state;
    const timeline_code codes[] = {code_of(24, 1, false, 0),
                                   code_of(25, 1, false, 90000),
                                   code_of(30000, 1001, true, 107892),
                                   code_of(60000, 1001, true, 17),
                                   code_of(24000, 1001, false, 0),
                                   code_of(1000, 1, false, 0),
                                   code_of(1, 1, false, 0)};
    for (size_t c = 0; c < sizeof codes / sizeof codes[0]; ++c)
        for (double span_ns = 200000.0; span_ns < 86400e9; span_ns *= 1.31) {
            int64_t from_ns = 83 * help_s + 123456789;
            timeline_axis axis = axis_of(1100.0f, from_ns, from_ns + (int64_t)span_ns);
            check_ticks(&axis, &codes[c]);
            axis.from_ns = -(int64_t)span_ns / 2;
            check_ticks(&axis, &codes[c]);
        }
}

static void seconds_are_labelled_at_their_first_frame(void **state)
{
    (void)state;
    static timeline_tick tick[TIMELINE_TICKS_MAX];
    timeline_code code = code_of(25, 1, false, 0);
    timeline_axis axis = axis_of(1000.0f, 0, 10 * help_s);
    uint32_t count = timeline_ticks(tick, &axis, &code, 90.0f);
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (tick[i].is_major) {
            assert_int_equal(tick[i].at_ns % help_s, 0);
            found += strcmp(tick[i].label, "00:00:03:00") == 0 && tick[i].at_ns == 3 * help_s;
        }
    assert_int_equal(found, 1);
}

static void drop_frame_labels_that_do_not_exist_are_not_written(void **state)
{
    (void)state;
    static timeline_tick tick[TIMELINE_TICKS_MAX];
    timeline_code code = code_of(30000, 1001, true, 0);
    timeline_axis axis = axis_of(1000.0f, 0, 610 * help_s);
    uint32_t count = timeline_ticks(tick, &axis, &code, 90.0f);
    bool has_first = false, has_tenth = false;
    for (uint32_t i = 0; i < count; ++i) {
        assert_null(strstr(tick[i].label, "00:01:00;00"));
        has_first |= strcmp(tick[i].label, "00:01:00;02") == 0;
        has_tenth |= strcmp(tick[i].label, "00:10:00;00") == 0;
    }
    assert_true(has_first && has_tenth);
}

/* ---- snapping ---- */

static timeline_snap snap_of(const take *t)
{
    return (timeline_snap){.take = t,
                           .code = code_of(25, 1, false, 0),
                           .head_ns = 5 * help_s + 3 * help_ms,
                           .reach_ns = 100 * help_ms,
                           .without_marker = -1};
}

static void a_drag_is_drawn_to_the_nearest_thing(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'marker.add','at_ns':5090m,'text':'here'}");
    timeline_snap snap = snap_of(&t);
    timeline_target to;
    char words[128];
    assert_int_equal(timeline_snap_to(&snap, 5030 * help_ms, &to), 5003 * help_ms);
    assert_int_equal(to.at_ns, 5003 * help_ms);
    timeline_target_words(words, &to, &t);
    assert_string_equal(words, "Snaps to the playhead");
    assert_int_equal(timeline_snap_to(&snap, 5060 * help_ms, &to), 5090 * help_ms);
    timeline_target_words(words, &to, &t);
    assert_string_equal(words, "Snaps to marker 'here'");
    snap.without_marker = 0;
    assert_int_equal(timeline_snap_to(&snap, 5060 * help_ms, &to), 5003 * help_ms);
    assert_int_equal(timeline_snap_to(&snap, 9950 * help_ms, &to), 10 * help_s);
    timeline_target_words(words, &to, &t);
    assert_string_equal(words, "Snaps to the end of a clip of 'face'");
    snap.without_clip = 2;
    (void)timeline_snap_to(&snap, 9950 * help_ms, &to);
    timeline_target_words(words, &to, &t);
    assert_string_equal(words, "Snaps to the end of the take");
    take_finish(&t);
}

static void away_from_everything_frames_draw(void **state)
{
    (void)state;
    take t = help_take();
    timeline_snap snap = snap_of(&t);
    timeline_target to;
    char words[128];
    assert_int_equal(timeline_snap_to(&snap, 2017 * help_ms, &to), 2000 * help_ms);
    timeline_target_words(words, &to, &t);
    assert_string_equal(words, "Snaps to frames");
    assert_int_equal(timeline_snap_to(&snap, 2023 * help_ms, NULL), 2040 * help_ms);
    snap.reach_ns = 0;
    assert_int_equal(timeline_snap_to(&snap, 2017 * help_ms, &to), 2017 * help_ms);
    assert_int_equal(to.kind, TIMELINE_TARGET_NONE);
    timeline_target_words(words, &to, &t);
    assert_string_equal(words, "");
    take_finish(&t);
}

/* Unless they would catch every drag: then only frames do. */
static void beats_and_seconds_draw_where_they_are_apart(void **state)
{
    (void)state;
    take t = help_take();
    timeline_snap snap = snap_of(&t);
    timeline_target to;
    char words[128];
    snap.beat_ns = help_s;
    assert_int_equal(timeline_snap_to(&snap, 2917 * help_ms, &to), 3 * help_s);
    timeline_target_words(words, &to, &t);
    assert_string_equal(words, "Snaps to a full second");
    assert_int_equal(timeline_snap_to(&snap, -1050 * help_ms, &to), -help_s);
    snap.is_beat = true;
    snap.beat_ns = 750 * help_ms;
    assert_int_equal(timeline_snap_to(&snap, 2217 * help_ms, &to), 2250 * help_ms);
    assert_int_equal(to.kind, TIMELINE_TARGET_BEAT);
    snap.beat_ns = 500 * help_ms;
    assert_int_equal(timeline_snap_to(&snap, 2467 * help_ms, &to), 2480 * help_ms);
    assert_int_equal(to.kind, TIMELINE_TARGET_FRAME);
    take_finish(&t);
}

static void a_span_is_drawn_by_its_nearer_end(void **state)
{
    (void)state;
    take t = help_take();
    timeline_snap snap = snap_of(&t);
    timeline_target to;
    /* starts 90 ms from the head, ends 40 ms from the end of the take */
    int64_t length_ns = 10 * help_s - 5003 * help_ms - 50 * help_ms;
    assert_int_equal(timeline_snap_span(&snap, 5093 * help_ms, length_ns, &to),
                     10 * help_s - length_ns);
    assert_int_equal(to.at_ns, 10 * help_s);
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_instant_has_its_place),
        cmocka_unit_test(fitting_shows_all_with_air),
        cmocka_unit_test(zoom_keeps_what_is_under_the_pointer),
        cmocka_unit_test(zoom_goes_from_a_day_to_ten_samples),
        cmocka_unit_test(something_stays_in_sight),
        cmocka_unit_test(following_turns_pages_only),
        cmocka_unit_test(ticks_are_apart_and_say_the_time_code_at_every_zoom),
        cmocka_unit_test(seconds_are_labelled_at_their_first_frame),
        cmocka_unit_test(drop_frame_labels_that_do_not_exist_are_not_written),
        cmocka_unit_test(a_drag_is_drawn_to_the_nearest_thing),
        cmocka_unit_test(away_from_everything_frames_draw),
        cmocka_unit_test(beats_and_seconds_draw_where_they_are_apart),
        cmocka_unit_test(a_span_is_drawn_by_its_nearer_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
