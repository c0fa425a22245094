/* core/show/edit.h: ranges over layers: keep, cut, insert. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

/* 'face' with clip 2, and 'late' (3), one second later, with clip 4; markers at 1, 4, 8 s. */
static take two_layers(void)
{
    take t = help_take();
    help_do(&t, "{'op':'layer.add','name':'late'}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':8,'end_ns':9000m}");
    help_do(&t, "{'op':'layer.offset','layer':3,'offset_ns':1000m}");
    help_do(&t, "{'op':'marker.add','at_ns':1000m,'text':'one'}");
    help_do(&t, "{'op':'marker.add','at_ns':4000m,'text':'four'}");
    help_do(&t, "{'op':'marker.add','at_ns':8000m,'text':'eight'}");
    return t;
}

/* What b shows at b_ns is what a showed at a_ns: the same sources with the same weights. */
static bool shows_same(const take *a, int64_t a_ns, const take *b, int64_t b_ns)
{
    for (uint32_t i = 0; i < a->layer_count; ++i) {
        take_voice first[2], second[2];
        uint32_t count = take_at(first, &a->layer[i], a_ns);
        if (take_at(second, &b->layer[i], b_ns) != count)
            return false;
        for (uint32_t k = 0; k < count; ++k)
            if (first[k].source_ns != second[k].source_ns || first[k].weight != second[k].weight ||
                first[k].clip->performance != second[k].clip->performance)
                return false;
    }
    return true;
}

static void require_same(const take *a, int64_t from_ns, int64_t until_ns, const take *b,
                         int64_t later_ns)
{
    for (int64_t at_ns = from_ns; at_ns < until_ns; at_ns += 9876543)
        if (!shows_same(a, at_ns, b, at_ns + later_ns))
            fail_msg("what was at %g s is not at %g s", (double)at_ns / 1e9,
                     (double)(at_ns + later_ns) / 1e9);
    assert_true(shows_same(a, until_ns - 1, b, until_ns - 1 + later_ns));
}

static void keep_trims_the_take_and_changes_nothing_within(void **state)
{
    (void)state;
    take t = two_layers(), before;
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':3000m}");
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':4000m}");
    help_do(&t, "{'op':'take.fps','fps':25}");
    help_do(&t, "{'op':'audio.attach','audio':1,'offset_ns':500m}");
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'range.keep','in_ns':3500m,'out_ns':8000m}");
    assert_true(t.duration_ns == 4500 * help_ms && t.start_ns == 1003500 * help_ms);
    assert_true(t.timecode_frame == 88 || t.timecode_frame == 87);
    assert_true(t.audio.offset_ns == -3 * help_s);
    assert_int_equal(t.marker_count, 2);
    assert_true(t.marker[0].at_ns == 500 * help_ms && t.marker[1].at_ns == 4500 * help_ms);
    require_same(&before, 3500 * help_ms, 8 * help_s, &t, -3500 * help_ms);
    take_finish(&before);
    take_finish(&t);
}

static void keep_lets_go_of_clips_outside_without_waking_their_fades(void **state)
{
    (void)state;
    take t = help_take(), before;
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':4000m}");
    help_do(&t, "{'op':'clip.fade','clip':3,'fade_in_ns':5000m}");
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':5000m}");
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'range.keep','in_ns':6000m,'out_ns':9000m}");
    assert_int_equal(t.layer->clip_count, 1);
    require_same(&before, 6 * help_s, 9 * help_s, &t, -6 * help_s);
    take_finish(&before);
    take_finish(&t);
}

static void a_cut_with_ripple_joins_what_is_around_it(void **state)
{
    (void)state;
    take t = two_layers(), before;
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'range.cut','in_ns':3000m,'out_ns':5000m,'ripple':true}");
    assert_true(t.duration_ns == 8 * help_s);
    require_same(&before, 0, 3 * help_s, &t, 0);
    require_same(&before, 5 * help_s, 10 * help_s, &t, -2 * help_s);
    assert_int_equal(t.marker_count, 2);
    assert_true(t.marker[0].at_ns == help_s && t.marker[1].at_ns == 6 * help_s);
    assert_int_equal(t.layer[0].clip[0].id, 2);
    assert_int_equal(t.layer[0].clip[1].id, 5);
    assert_int_equal(t.layer[1].clip[1].id, 6);
    take_finish(&before);
    take_finish(&t);
}

static void a_cut_can_leave_a_gap(void **state)
{
    (void)state;
    take t = two_layers(), before;
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'range.cut','in_ns':3000m,'out_ns':5000m,'layers':[3]}");
    assert_true(t.duration_ns == 10 * help_s && t.marker_count == 3);
    assert_int_equal(t.layer[0].clip_count, 1);
    assert_int_equal(t.layer[1].clip_count, 2);
    require_same(&before, 0, 3 * help_s, &t, 0);
    require_same(&before, 5 * help_s, 10 * help_s, &t, 0);
    assert_string_equal(help_shown(&t.layer[1], 4 * help_s), "");
    take_finish(&before);
    take_finish(&t);
}

static void a_cut_through_a_cross_fade_ends_it_there(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':4000m}");
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':6000m}");
    help_do(&t, "{'op':'range.cut','in_ns':5000m,'out_ns':5500m,'ripple':true}");
    help_check(&t);
    assert_string_equal(help_shown(t.layer, 4500 * help_ms), "2@4.5*0.5 3@4.5*0.5");
    assert_string_equal(help_shown(t.layer, 5 * help_s), "4@5.5*1 5@5.5*0");
    assert_string_equal(help_shown(t.layer, 5250 * help_ms), "4@5.75*0.5 5@5.75*0.5");
    take_finish(&t);
}

static void an_insert_opens_the_take(void **state)
{
    (void)state;
    take t = two_layers(), before;
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'range.insert','at_ns':4000m,'length_ns':2500m}");
    assert_true(t.duration_ns == 12500 * help_ms);
    require_same(&before, 0, 4 * help_s, &t, 0);
    require_same(&before, 4 * help_s, 10 * help_s, &t, 2500 * help_ms);
    assert_string_equal(help_shown(t.layer, 5 * help_s), "");
    assert_true(t.marker[0].at_ns == help_s && t.marker[1].at_ns == 6500 * help_ms);
    help_do(&t, "{'op':'range.insert','at_ns':0,'length_ns':1000m,'layers':[1]}");
    assert_true(t.duration_ns == 13500 * help_ms);
    assert_string_equal(help_shown(t.layer, help_s), "2@0*1");
    assert_string_equal(help_shown(&t.layer[1], help_s), "4@0*1");
    take_finish(&before);
    take_finish(&t);
}

static void an_insert_and_a_cut_of_it_show_the_same(void **state)
{
    (void)state;
    take t = two_layers(), before;
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'range.insert','at_ns':4000m,'length_ns':2500m}");
    help_do(&t, "{'op':'range.cut','in_ns':4000m,'out_ns':6500m,'ripple':true}");
    assert_true(t.duration_ns == before.duration_ns && t.marker_count == 3);
    require_same(&before, 0, 10 * help_s, &t, 0);
    take_finish(&before);
    take_finish(&t);
}

static void audio_does_not_run_out_of_step(void **state)
{
    (void)state;
    take t = two_layers();
    help_do(&t, "{'op':'audio.attach','audio':1,'offset_ns':2000m}");
    help_refused(&t, "{'op':'range.cut','in_ns':1000m,'out_ns':3000m,'ripple':true}",
                 "the take's audio begins before 3 s");
    help_refused(&t, "{'op':'range.insert','at_ns':3000m,'length_ns':1}", "audio begins before");
    help_do(&t, "{'op':'range.cut','in_ns':1000m,'out_ns':3000m}");
    help_do(&t, "{'op':'range.cut','in_ns':1000m,'out_ns':3000m,'ripple':true,'layers':[1,3]}");
    assert_true(t.audio.offset_ns == 2 * help_s && t.duration_ns == 10 * help_s);
    help_do(&t, "{'op':'range.cut','in_ns':500m,'out_ns':1500m,'ripple':true}");
    assert_true(t.audio.offset_ns == help_s);
    help_do(&t, "{'op':'range.insert','at_ns':0,'length_ns':4000m}");
    assert_true(t.audio.offset_ns == 5 * help_s);
    take_finish(&t);
}

static void ranges_lie_within_the_take(void **state)
{
    (void)state;
    take t = two_layers();
    help_refused(&t, "{'op':'range.keep','in_ns':-1,'out_ns':2000m}",
                 "range.keep -0.000000001 .. 2 s: expected a range within the take's 0 .. 10 s");
    help_refused(&t, "{'op':'range.cut','in_ns':2000m,'out_ns':10001m}", "the take's 0 .. 10 s");
    help_refused(&t, "{'op':'range.cut','in_ns':2000m,'out_ns':2000m}", "range.cut 2 .. 2 s");
    help_refused(&t, "{'op':'range.insert','at_ns':10001m,'length_ns':1}", "at 10.001 s");
    help_refused(&t, "{'op':'range.cut','in_ns':0,'out_ns':1,'layers':[1,2]}",
                 "layer 2: the take has no such layer");
    take_finish(&t);
}

static void a_layer_has_at_most_4096_clips(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'layer.add','name':'many'}");
    edit add;
    error err;
    mrt_result result = MRT_OK;
    edit_init(&add, EDIT_CLIP_ADD);
    add.layer = 3;
    add.performance = 8;
    for (int i = 0; result >= 0 && i < EDIT_CLIPS_MAX; ++i) {
        add.start_ns = i * help_ms;
        add.end_ns = (i + 1) * help_ms;
        result = edit_apply_onto(&t, &add, &err);
    }
    assert_int_equal(result, MRT_OK);
    assert_int_equal(edit_apply(&t, &add, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "layer 3 'many': the limit of 4096 is reached"));
    help_refused(&t, "{'op':'range.insert','at_ns':1500000,'length_ns':1}",
                 "the cut would create too many clips");
    help_do(&t, "{'op':'range.insert','at_ns':1m,'length_ns':1}");
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keep_trims_the_take_and_changes_nothing_within),
        cmocka_unit_test(keep_lets_go_of_clips_outside_without_waking_their_fades),
        cmocka_unit_test(a_cut_with_ripple_joins_what_is_around_it),
        cmocka_unit_test(a_cut_can_leave_a_gap),
        cmocka_unit_test(a_cut_through_a_cross_fade_ends_it_there),
        cmocka_unit_test(an_insert_opens_the_take),
        cmocka_unit_test(an_insert_and_a_cut_of_it_show_the_same),
        cmocka_unit_test(audio_does_not_run_out_of_step),
        cmocka_unit_test(ranges_lie_within_the_take),
        cmocka_unit_test(a_layer_has_at_most_4096_clips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
