/* What is under the pointer, what a drag makes of a take, and comping from another take. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "take/edit_help.h"
#include "window/timeline/drag.h"

/* Layers 'face' (clip 2: 0..10 s) and 'mouth' above it (clips 4: 1..4 s, 5: 4..7 s). */
static take two_layers(void)
{
    take t = help_take();
    help_do(&t, "{'op':'layer.add','name':'mouth','own':['mouth']}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':7,'source_ns':1000m,'start_ns':1000m,"
                "'end_ns':7000m}");
    help_do(&t, "{'op':'clip.split','clip':4,'at_ns':4000m}");
    return t;
}

/* 1000 points of lanes for 10 s: 10 ms a point, from x 186. */
typedef struct stand {
    take take;
    timeline_rows rows;
    timeline_axis axis;
    timeline_snap snap;
} stand;

static stand stand_of(take t)
{
    stand s = {.take = t};
    timeline_rows_lay(&s.rows, &s.take, 0, 0.0f, 0.0f, 1186.0f, 42.0f + 92.0f, 0.0f);
    s.axis = (timeline_axis){186.0f, 1000.0f, 0, 1e7};
    return s;
}

static timeline_hit hit(const stand *s, double time_s, float y)
{
    timeline_under under = {&s->rows, &s->axis, &s->take, 0, 0, 60.0f, 0};
    return timeline_hit_at(&under, 186.0f + (float)time_s * 100.0f, y);
}

static timeline_snap frames_of(const take *t)
{
    return (timeline_snap){
        .take = t, .code = {{25, 1, false}, 0}, .head_ns = INT64_MIN, .without_marker = -1};
}

/* ---- hits ---- */

static void the_top_layer_lies_on_top(void **state)
{
    (void)state;
    stand s = stand_of(two_layers());
    assert_int_equal(s.rows.count, 2);
    assert_int_equal(s.rows.row[0].index, 1);
    assert_int_equal(hit(&s, 2.0, 42.0f + 25.0f).clip, 4);
    assert_int_equal(hit(&s, 2.0, 42.0f + 46.0f + 25.0f).clip, 2);
    take_finish(&s.take);
}

static void the_parts_of_a_clip_are_told_apart(void **state)
{
    (void)state;
    stand s = stand_of(two_layers());
    float low = 42.0f + 35.0f, top = 42.0f + 5.0f;
    assert_int_equal(hit(&s, 2.0, low).part, TIMELINE_CLIP);
    assert_int_equal(hit(&s, 1.03, low).part, TIMELINE_CLIP_START);
    assert_int_equal(hit(&s, 3.97, low).part, TIMELINE_CLIP_END);
    assert_int_equal(hit(&s, 3.97, low).clip, 4);
    assert_int_equal(hit(&s, 4.03, low).clip, 5);
    assert_int_equal(hit(&s, 4.03, low).part, TIMELINE_CLIP_START);
    assert_int_equal(hit(&s, 1.05, top).part, TIMELINE_FADE_IN);
    assert_int_equal(hit(&s, 3.93, top).part, TIMELINE_FADE_OUT);
    assert_int_equal(hit(&s, 8.0, low).part, TIMELINE_LANE);
    assert_int_equal(hit(&s, 8.0, low).layer, 3);
    take_finish(&s.take);
}

static void a_fade_is_taken_where_it_ends(void **state)
{
    (void)state;
    take t = two_layers();
    help_do(&t, "{'op':'clip.fade','clip':4,'fade_in_ns':1000m}");
    stand s = stand_of(t);
    assert_int_equal(hit(&s, 2.0, 47.0f).part, TIMELINE_FADE_IN);
    assert_int_equal(hit(&s, 1.5, 47.0f).part, TIMELINE_CLIP);
    take_finish(&s.take);
}

static void the_ruler_has_markers_range_and_time(void **state)
{
    (void)state;
    take t = two_layers();
    help_do(&t, "{'op':'marker.add','at_ns':6000m,'text':'here'}");
    stand s = stand_of(t);
    timeline_under under = {&s.rows, &s.axis, &s.take, 2 * help_s, 3 * help_s, 60.0f, 0};
    assert_int_equal(timeline_hit_at(&under, 186.0f + 201.0f, 8.0f).part, TIMELINE_RANGE_IN);
    assert_int_equal(timeline_hit_at(&under, 186.0f + 301.0f, 8.0f).part, TIMELINE_RANGE_OUT);
    assert_int_equal(timeline_hit_at(&under, 186.0f + 250.0f, 8.0f).part, TIMELINE_RANGE);
    assert_int_equal(timeline_hit_at(&under, 186.0f + 610.0f, 8.0f).part, TIMELINE_MARKER);
    assert_int_equal(timeline_hit_at(&under, 186.0f + 610.0f, 8.0f).marker, 0);
    assert_int_equal(timeline_hit_at(&under, 186.0f + 610.0f, 30.0f).part, TIMELINE_SCRUB);
    assert_int_equal(timeline_hit_at(&under, 20.0f, 8.0f).part, TIMELINE_NOWHERE);
    take_finish(&s.take);
}

static void the_head_has_switches_and_a_gain(void **state)
{
    (void)state;
    stand s = stand_of(two_layers());
    timeline_under under = {&s.rows, &s.axis, &s.take, 0, 0, 60.0f, 0};
    static const timeline_part part[] = {TIMELINE_MUTE, TIMELINE_SOLO, TIMELINE_ADDITIVE,
                                         TIMELINE_ARM};
    for (uint32_t i = 0; i < TIMELINE_SWITCHES; ++i) {
        ui_rectangle box = timeline_switch_box(&s.rows, &s.rows.row[0], i);
        timeline_hit at = timeline_hit_at(&under, box.x + 3.0f, box.y + 3.0f);
        assert_int_equal(at.part, part[i]);
        assert_int_equal(at.layer, 3);
    }
    ui_rectangle box = timeline_gain_box(&s.rows, &s.rows.row[1]);
    assert_int_equal(timeline_hit_at(&under, box.x + 3.0f, box.y + 3.0f).part, TIMELINE_GAIN);
    assert_int_equal(timeline_hit_at(&under, 20.0f, 50.0f).part, TIMELINE_NAME);
    take_finish(&s.take);
}

static void rows_scroll_only_as_far_as_there_are_some(void **state)
{
    (void)state;
    take t = two_layers();
    timeline_rows rows;
    timeline_rows_lay(&rows, &t, 3, 0.0f, 0.0f, 800.0f, 42.0f + 100.0f, 1000.0f);
    assert_int_equal(rows.count, 5);
    assert_float_equal(rows.scroll, 2 * 46.0f + 3 * 24.0f - 100.0f, 0.01f);
    timeline_rows_lay(&rows, &t, 0, 0.0f, 0.0f, 800.0f, 42.0f + 100.0f, 1000.0f);
    assert_float_equal(rows.scroll, 0.0f, 0.01f);
    take_finish(&t);
}

/* ---- drags ---- */

static edit drag(const take *t, timeline_drag_kind kind, uint32_t clip, int64_t from_ms,
                 int64_t to_ms, uint32_t onto)
{
    timeline_drag d;
    timeline_snap snap = frames_of(t);
    timeline_hit at = {.clip = clip, .marker = 0, .layer = onto};
    timeline_drag_begin(&d, kind, t, at, from_ms * help_ms, 4 * help_s);
    timeline_drag_to(&d, t, &snap, (from_ms + to_ms) / 2 * help_ms, onto, 0.0f);
    timeline_drag_to(&d, t, &snap, to_ms * help_ms, onto, 0.0f);
    edit made = d.made;
    take_finish(&d.preview);
    return made;
}

static void a_clip_moves_in_time(void **state)
{
    (void)state;
    take t = two_layers();
    edit e = drag(&t, TIMELINE_DRAG_MOVE, 5, 5000, 6500, 3);
    assert_int_equal(e.kind, EDIT_CLIP_MOVE);
    assert_int_equal(e.clip, 5);
    assert_int_equal(e.start_ns, 5500 * help_ms);
    assert_int_equal(e.layer, 0);
    e = drag(&t, TIMELINE_DRAG_MOVE, 5, 5000, 5000, 3);
    assert_int_equal(e.kind, EDIT_NONE);
    take_finish(&t);
}

static void a_clip_moves_to_another_layer(void **state)
{
    (void)state;
    take t = two_layers();
    help_do(&t, "{'op':'layer.add','name':'more'}");
    edit e = drag(&t, TIMELINE_DRAG_MOVE, 4, 2000, 2000, 6);
    assert_int_equal(e.kind, EDIT_CLIP_MOVE);
    assert_int_equal(e.layer, 6);
    assert_int_equal(e.start_ns, 1000 * help_ms);
    take_finish(&t);
}

static void where_a_clip_cannot_be_the_last_place_stays_and_why_is_said(void **state)
{
    (void)state;
    take t = two_layers();
    timeline_drag d;
    timeline_snap snap = frames_of(&t);
    timeline_drag_begin(&d, TIMELINE_DRAG_MOVE, &t, (timeline_hit){.clip = 5}, 5000 * help_ms, 0);
    timeline_drag_to(&d, &t, &snap, 4000 * help_ms, 3, 0.0f); /* overlaps: cross-fades */
    assert_string_equal(d.why.text, "");
    assert_int_equal(d.made.start_ns, 3000 * help_ms);
    assert_int_equal(d.preview.layer[1].clip[1].start_ns, 3000 * help_ms);
    timeline_drag_to(&d, &t, &snap, 1500 * help_ms, 3, 0.0f); /* 0.5 .. 3.5 s: within */
    timeline_drag_to(&d, &t, &snap, 2000 * help_ms, 1, 0.0f); /* within clip 2 of 'face' */
    assert_non_null(strstr(d.why.text, "would lie within"));
    assert_int_equal(d.made.kind, EDIT_CLIP_MOVE);
    assert_ptr_equal(timeline_drag_shown(&d, &t), &d.preview);
    timeline_drag_to(&d, &t, &snap, 5000 * help_ms, 3, 0.0f);
    assert_ptr_equal(timeline_drag_shown(&d, &t), &t);
    timeline_drag_finish(&d);
    take_finish(&t);
}

static void edges_trim_as_far_as_it_was_recorded(void **state)
{
    (void)state;
    take t = two_layers();
    edit e = drag(&t, TIMELINE_DRAG_START, 4, 1000, 1800, 3);
    assert_int_equal(e.kind, EDIT_CLIP_TRIM);
    assert_int_equal(e.start_ns, 1800 * help_ms);
    assert_true(e.end_ns == EDIT_UNSAID);
    e = drag(&t, TIMELINE_DRAG_START, 4, 1000, -4000, 3);
    assert_int_equal(e.start_ns, 0); /* its source began there */
    e = drag(&t, TIMELINE_DRAG_END, 5, 7000, 99000, 3);
    assert_int_equal(e.end_ns, 10 * help_s);
    e = drag(&t, TIMELINE_DRAG_END, 5, 7000, 0, 3);
    assert_int_equal(e.end_ns, 4001 * help_ms);
    take_finish(&t);
}

static void ctrl_on_an_edge_retimes_about_the_other(void **state)
{
    (void)state;
    assert_int_equal(timeline_drag_kind_of(TIMELINE_CLIP_END, true), TIMELINE_DRAG_SPEED_END);
    take t = two_layers();
    edit e = drag(&t, TIMELINE_DRAG_SPEED_END, 5, 7000, 10000, 3);
    assert_int_equal(e.kind, EDIT_CLIP_SPEED);
    assert_float_equal(e.speed, 0.5, 1e-12);
    assert_int_equal(e.at_ns, 4000 * help_ms);
    edit_apply(&t, &e, NULL) < 0 ? fail() : (void)0;
    assert_int_equal(t.layer[1].clip[1].end_ns, 10 * help_s);
    e = drag(&t, TIMELINE_DRAG_SPEED_START, 4, 1000, 2500, 3);
    assert_float_equal(e.speed, 2.0, 1e-12);
    assert_int_equal(e.at_ns, 4000 * help_ms);
    take_finish(&t);
}

static void upper_corners_fade_as_far_as_the_clip_goes(void **state)
{
    (void)state;
    take t = two_layers();
    edit e = drag(&t, TIMELINE_DRAG_FADE_IN, 4, 1000, 1400, 3);
    assert_int_equal(e.kind, EDIT_CLIP_FADE);
    assert_int_equal(e.fade_in_ns, 400 * help_ms);
    assert_true(e.fade_out_ns == EDIT_UNSAID);
    help_do(&t, "{'op':'clip.fade','clip':4,'fade_out_ns':1000m}");
    e = drag(&t, TIMELINE_DRAG_FADE_IN, 4, 1000, 9000, 3);
    assert_int_equal(e.fade_in_ns, 2000 * help_ms);
    e = drag(&t, TIMELINE_DRAG_FADE_OUT, 4, 3000, 3600, 3);
    assert_int_equal(e.fade_out_ns, 400 * help_ms);
    take_finish(&t);
}

static void a_layer_that_is_offset_is_dragged_where_it_is_seen(void **state)
{
    (void)state;
    take t = two_layers();
    help_do(&t, "{'op':'layer.offset','layer':3,'offset_ns':1000m}");
    edit e = drag(&t, TIMELINE_DRAG_MOVE, 5, 6000, 6400, 3);
    assert_int_equal(e.start_ns, 5400 * help_ms);
    e = drag(&t, TIMELINE_DRAG_START, 4, 2000, 2400, 3);
    assert_int_equal(e.start_ns, 2400 * help_ms);
    e = drag(&t, TIMELINE_DRAG_SPEED_END, 5, 8000, 11000, 3);
    edit_apply(&t, &e, NULL) < 0 ? fail() : (void)0;
    assert_int_equal(t.layer[1].clip[1].end_ns, 10 * help_s);
    take_finish(&t);
}

static void markers_sound_gains_and_layers_are_dragged(void **state)
{
    (void)state;
    take t = two_layers();
    help_do(&t, "{'op':'marker.add','at_ns':6000m,'text':'here'}");
    help_do(&t, "{'op':'audio.attach','audio':3,'offset_ns':200m}");
    edit e = drag(&t, TIMELINE_DRAG_MARKER, 0, 6000, 99000, 0);
    assert_int_equal(e.kind, EDIT_MARKER_MOVE);
    assert_int_equal(e.at_ns, 10 * help_s);
    e = drag(&t, TIMELINE_DRAG_SOUND, 0, 1000, 777, 0);
    assert_int_equal(e.kind, EDIT_AUDIO_OFFSET);
    assert_int_equal(e.offset_ns, -23 * help_ms);
    e = drag(&t, TIMELINE_DRAG_ORDER, 0, 0, 0, 3);
    assert_int_equal(e.kind, EDIT_NONE);
    e = drag(&t, TIMELINE_DRAG_SOUND_START, 0, 200, 900, 0);
    assert_int_equal(e.kind, EDIT_AUDIO_TRIM);
    assert_true(e.start_ns == 900 * help_ms && e.end_ns == EDIT_UNSAID);
    e = drag(&t, TIMELINE_DRAG_SOUND_START, 0, 200, -900, 0); /* there is no more */
    assert_int_equal(e.kind, EDIT_NONE);
    e = drag(&t, TIMELINE_DRAG_SOUND_END, 0, 4200, 3000, 0);
    assert_true(e.kind == EDIT_AUDIO_TRIM && e.end_ns == 3 * help_s);
    e = drag(&t, TIMELINE_DRAG_SOUND_END, 0, 4200, 99000, 0);
    assert_int_equal(e.kind, EDIT_NONE);

    timeline_drag d;
    timeline_snap snap = frames_of(&t);
    timeline_drag_begin(&d, TIMELINE_DRAG_GAIN, &t, (timeline_hit){.layer = 3}, 0, 0);
    timeline_drag_to(&d, &t, &snap, 0, 0, -60.0f);
    assert_int_equal(d.made.kind, EDIT_LAYER_GAIN);
    assert_float_equal(d.made.gain, 0.5, 1e-12);
    timeline_drag_to(&d, &t, &snap, 0, 0, -1000.0f);
    assert_float_equal(d.made.gain, 0.0, 1e-12);
    timeline_drag_finish(&d);
    timeline_drag_begin(&d, TIMELINE_DRAG_ORDER, &t, (timeline_hit){.layer = 3}, 0, 0);
    timeline_drag_to(&d, &t, &snap, 0, 1, 0.0f);
    assert_int_equal(d.made.kind, EDIT_LAYER_ORDER);
    assert_int_equal(d.made.place, 0);
    timeline_drag_finish(&d);
    take_finish(&t);
}

/* ---- comping ---- */

static void comp(take *t, const take *from, int64_t later_ms, uint32_t regions, int64_t in_ms,
                 int64_t out_ms)
{
    edit made[TIMELINE_DRAG_EDITS];
    error err = {""};
    int64_t in_ns = in_ms * help_ms, out_ns = out_ms * help_ms;
    uint32_t count =
        timeline_comp_edits(made, t, from, later_ms * help_ms, regions, &in_ns, &out_ns, &err);
    if (count == 0)
        fail_msg("%s", err.text);
    for (uint32_t i = 0; i < count; ++i) {
        if (edit_apply(t, &made[i], &err) < 0)
            fail_msg("%s", err.text);
        edit_finish(&made[i]);
    }
}

static void a_swipe_comps_a_region_at_the_same_instant_of_the_other_take(void **state)
{
    (void)state;
    take t = help_take(), from = two_layers();
    from.layer[0].clip[0].performance = 8;
    from.layer[1].clip[0].performance = 9;
    comp(&t, &from, 0, 1u << OWN_MOUTH | 1u << OWN_BROWS, 2000, 3000);
    assert_int_equal(t.layer_count, 3);
    const take_layer *mouth = &t.layer[1], *brows = &t.layer[2];
    assert_string_equal(mouth->name, "mouth");
    assert_int_equal(mouth->clip[0].performance, 9); /* of the layer that owns it */
    assert_int_equal(take_warp_to_source(&mouth->clip[0], 2500 * help_ms), 2500 * help_ms);
    assert_string_equal(brows->name, "brows");
    assert_int_equal(brows->clip[0].performance, 8);
    assert_int_equal(brows->clip[0].fade_in_ns, 100 * help_ms);
    take_finish(&t);
    take_finish(&from);
}

static void a_swipe_over_all_parts_is_punched_into_the_lowest_layer(void **state)
{
    (void)state;
    take t = help_take(), from = help_take();
    from.layer[0].clip[0].performance = 8;
    comp(&t, &from, 500, TIMELINE_ALL_REGIONS, 2000, 3000);
    assert_int_equal(t.layer_count, 1);
    assert_int_equal(t.layer[0].clip_count, 3);
    const take_clip *middle = &t.layer[0].clip[1];
    assert_int_equal(middle->performance, 8);
    assert_int_equal(take_warp_to_source(middle, 2500 * help_ms), 2000 * help_ms);
    take_finish(&t);
    take_finish(&from);
}

static void a_retimed_take_is_comped_with_its_curve(void **state)
{
    (void)state;
    take t = help_take(), from = help_take();
    help_do(&from, "{'op':'clip.speed','clip':2,'speed':2.0}");
    comp(&t, &from, 0, 1u << OWN_JAW, 1000, 2000);
    assert_int_equal(take_warp_to_source(&t.layer[1].clip[0], 1500 * help_ms), 3000 * help_ms);
    take_finish(&t);
    take_finish(&from);
}

static void a_swipe_is_kept_to_what_there_is(void **state)
{
    (void)state;
    take t = help_take(), from = two_layers();
    edit made[TIMELINE_DRAG_EDITS];
    error err = {""};
    int64_t in_ns = 200 * help_ms, out_ns = 2000 * help_ms;
    assert_int_equal(
        timeline_comp_edits(made, &t, &from, 0, 1u << OWN_MOUTH, &in_ns, &out_ns, &err), 1);
    assert_int_equal(in_ns, 1000 * help_ms);
    edit_finish(&made[0]);
    in_ns = 20 * help_s, out_ns = 22 * help_s;
    assert_int_equal(
        timeline_comp_edits(made, &t, &from, 0, 1u << OWN_MOUTH, &in_ns, &out_ns, &err), 0);
    assert_non_null(strstr(err.text, "no movement of these parts"));
    take_finish(&t);
    take_finish(&from);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_top_layer_lies_on_top),
        cmocka_unit_test(the_parts_of_a_clip_are_told_apart),
        cmocka_unit_test(a_fade_is_taken_where_it_ends),
        cmocka_unit_test(the_ruler_has_markers_range_and_time),
        cmocka_unit_test(the_head_has_switches_and_a_gain),
        cmocka_unit_test(rows_scroll_only_as_far_as_there_are_some),
        cmocka_unit_test(a_clip_moves_in_time),
        cmocka_unit_test(a_clip_moves_to_another_layer),
        cmocka_unit_test(where_a_clip_cannot_be_the_last_place_stays_and_why_is_said),
        cmocka_unit_test(edges_trim_as_far_as_it_was_recorded),
        cmocka_unit_test(ctrl_on_an_edge_retimes_about_the_other),
        cmocka_unit_test(upper_corners_fade_as_far_as_the_clip_goes),
        cmocka_unit_test(a_layer_that_is_offset_is_dragged_where_it_is_seen),
        cmocka_unit_test(markers_sound_gains_and_layers_are_dragged),
        cmocka_unit_test(a_swipe_comps_a_region_at_the_same_instant_of_the_other_take),
        cmocka_unit_test(a_swipe_over_all_parts_is_punched_into_the_lowest_layer),
        cmocka_unit_test(a_retimed_take_is_comped_with_its_curve),
        cmocka_unit_test(a_swipe_is_kept_to_what_there_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
