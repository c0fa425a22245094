/* core/show/edit.h: clips: add, trim, split, move, retime, fade. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

static void a_clip_is_shown_where_it_happened(void **state)
{
    (void)state;
    take t = help_take();
    const take_clip *clip = t.layer->clip;
    assert_true(clip->id == 2 && clip->start_ns == 0 && clip->end_ns == 10 * help_s);
    assert_true(clip->from_ns == 1000 * help_s && clip->to_ns == 1010 * help_s);
    help_do(&t, "{'op':'layer.add','name':'more'}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':8,'from_ns':1002000m,'to_ns':1030000m,"
                "'source_ns':500m}");
    clip = t.layer[1].clip;
    assert_true(clip->start_ns == 2500 * help_ms && clip->end_ns == 30 * help_s);
    assert_string_equal(help_shown(&t.layer[1], 3 * help_s), "4@1*1");
    assert_true(t.duration_ns == 30 * help_s);
    take_finish(&t);
}

static void a_clip_can_show_any_span_of_its_performance(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'layer.add','name':'more'}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':8,'from_ns':0,'to_ns':5000m,"
                "'source_ns':1000m,'start_ns':2000m,'end_ns':4000m}");
    assert_string_equal(help_shown(&t.layer[1], 2 * help_s), "4@1*1");
    assert_string_equal(help_shown(&t.layer[1], 4 * help_s), "");
    help_refused(&t,
                 "{'op':'clip.add','layer':3,'performance':8,'from_ns':0,'to_ns':5000m,"
                 "'source_ns':1000m,'start_ns':5000m,'end_ns':9500m}",
                 "performance 8 can be shown only at 4 .. 9 s");
    help_refused(&t, "{'op':'clip.add','layer':3,'performance':8,'from_ns':5000m,'to_ns':5000m}",
                 "$.to_ns: expected an end after from_ns");
    help_refused(&t, "{'op':'clip.add','layer':3,'performance':8,'source_ns':1,'warp':[[0,0]]}",
                 "$.source_ns: the warp already sets");
    help_refused(&t, "{'op':'clip.add','layer':9,'performance':8}", "layer 9: the take has no");
    take_finish(&t);
}

static void trim_keeps_what_is_shown_in_its_place(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.trim','clip':2,'start_ns':2100m,'end_ns':8000m}");
    assert_string_equal(help_shown(t.layer, 2100 * help_ms - 1), "");
    assert_string_equal(help_shown(t.layer, 2100 * help_ms), "2@2.1*1");
    assert_string_equal(help_shown(t.layer, 8 * help_s), "");
    help_do(&t, "{'op':'clip.trim','clip':2,'start_ns':0}");
    assert_string_equal(help_shown(t.layer, 0), "2@0*1");
    help_refused(&t, "{'op':'clip.trim','clip':2,'end_ns':10001m}",
                 "clip 2 of 'face' (0 .. 8 s): it cannot be trimmed to 0 .. 10.001 s; its "
                 "recording is 0 .. 10 s");
    help_refused(&t, "{'op':'clip.trim','clip':2,'start_ns':-1}", "its recording is 0 .. 10 s");
    help_refused(&t, "{'op':'clip.trim','clip':2,'start_ns':8000m}", "cannot be trimmed");
    help_refused(&t, "{'op':'clip.trim','clip':2}", "expected start_ns or end_ns, or both");
    help_refused(&t, "{'op':'clip.trim','clip':1,'end_ns':1}", "clip 1: the take has no such clip");
    take_finish(&t);
}

static void times_are_as_shown_with_the_layers_offset(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'layer.offset','layer':1,'offset_ns':-1000m}");
    help_do(&t, "{'op':'clip.trim','clip':2,'start_ns':2000m}");
    assert_string_equal(help_shown(t.layer, 2 * help_s), "2@3*1");
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':4000m}");
    assert_string_equal(help_shown(t.layer, 4 * help_s), "3@5*1");
    help_do(&t, "{'op':'clip.move','clip':3,'start_ns':5000m}");
    assert_string_equal(help_shown(t.layer, 5 * help_s), "3@5*1");
    help_do(&t, "{'op':'clip.curve','clip':3,'warp':[[5000m,5000m],[6000m,6500m],[10000m,9000m]]}");
    assert_string_equal(help_shown(t.layer, 5500 * help_ms), "3@5.75*1");
    take_finish(&t);
}

static void a_split_changes_nothing_that_is_shown(void **state)
{
    (void)state;
    take t = help_take(), whole;
    help_do(&t, "{'op':'clip.curve','clip':2,'warp':[[0,0],[3000m,1000m],[10000m,10000m]]}");
    help_do(&t, "{'op':'clip.fade','clip':2,'fade_in_ns':500m,'fade_out_ns':700m}");
    assert_int_equal(take_copy(&whole, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':2345m}");
    assert_int_equal(t.layer->clip_count, 2);
    for (int64_t at_ns = -help_s; at_ns < 11 * help_s; at_ns += 12345678) {
        take_voice a[2], b[2];
        uint32_t count = take_at(a, t.layer, at_ns);
        assert_int_equal(count, take_at(b, whole.layer, at_ns));
        assert_true(count == 0 ||
                    (a->source_ns == b->source_ns && a->weight == b->weight && count == 1));
    }
    take_finish(&whole);
    take_finish(&t);
}

static void a_split_is_inside_and_out_of_cross_fades(void **state)
{
    (void)state;
    take t = help_take();
    help_refused(&t, "{'op':'clip.split','clip':2,'at_ns':0}", "it cannot be split at 0 s");
    help_refused(&t, "{'op':'clip.split','clip':2,'at_ns':10000m}", "cannot be split at 10 s");
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':6000m}");
    help_do(&t, "{'op':'clip.add','layer':1,'performance':8,'start_ns':5000m,'source_ns':0}");
    help_refused(&t, "{'op':'clip.split','clip':2,'at_ns':5500m}",
                 "split it outside its cross-fades, in 0.000000001 .. 5 s");
    help_refused(&t, "{'op':'clip.split','clip':3,'at_ns':5500m}", "in 6 .. 14.999999999 s");
    help_do(&t, "{'op':'clip.split','clip':3,'at_ns':6000m}");
    help_check(&t);
    take_finish(&t);
}

static void a_moved_clip_takes_its_timing_along(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.curve','clip':2,'warp':[[0,0],[10000m,5000m]]}");
    help_do(&t, "{'op':'clip.move','clip':2,'start_ns':3000m}");
    assert_string_equal(help_shown(t.layer, 5 * help_s), "2@1*1");
    assert_true(t.duration_ns == 13 * help_s);
    help_do(&t, "{'op':'layer.add','name':'other'}");
    help_do(&t, "{'op':'layer.offset','layer':3,'offset_ns':250m}");
    help_do(&t, "{'op':'clip.move','clip':2,'layer':3}");
    assert_int_equal(t.layer[0].clip_count, 0);
    assert_string_equal(help_shown(&t.layer[1], 5 * help_s), "2@1*1");
    help_refused(&t, "{'op':'clip.move','clip':2}", "expected start_ns or layer, or both");
    help_refused(&t, "{'op':'clip.move','clip':2,'layer':77}", "layer 77");
    take_finish(&t);
}

static void three_clips_at_an_instant_are_refused(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':4000m}");
    help_do(&t, "{'op':'clip.split','clip':3,'at_ns':6000m}");
    help_refused(&t, "{'op':'clip.move','clip':4,'start_ns':3000m}",
                 "clip 3 of 'face' (4 .. 6 s) would lie within clip 4 (3 .. 7 s)");
    help_do(&t, "{'op':'clip.move','clip':4,'start_ns':5000m}");
    help_refused(&t, "{'op':'clip.trim','clip':2,'end_ns':5500m}",
                 "clip 4 of 'face' (5 .. 9 s) would overlap clips 2 and 3 at 5 s");
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':5000m}");
    help_check(&t);
    take_finish(&t);
}

static void speed_is_about_a_point(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.speed','clip':2,'speed':2}");
    assert_true(t.layer->clip->end_ns == 5 * help_s);
    assert_string_equal(help_shown(t.layer, 3 * help_s), "2@6*1");
    help_do(&t, "{'op':'clip.speed','clip':2,'speed':0.5,'at_ns':5000m}");
    assert_true(t.layer->clip->start_ns == -5 * help_s && t.layer->clip->end_ns == 5 * help_s);
    assert_string_equal(help_shown(t.layer, 0), "2@5*1");
    take_finish(&t);
}

static void speeds_do_not_leave_the_recording(void **state)
{
    (void)state;
    static const char *const speeds[] = {"3", "0.7", "1.1", "0.333", "7.7", "0.01", "99"};
    take t = help_take();
    help_do(&t, "{'op':'clip.trim','clip':2,'start_ns':1234567891,'end_ns':9876543211}");
    for (size_t i = 0; i < sizeof speeds / sizeof speeds[0]; ++i) {
        char brief[128];
        (void)snprintf(brief, sizeof brief, "{'op':'clip.speed','clip':2,'speed':%s,'at_ns':777}",
                       speeds[i]);
        help_do(&t, brief);
        const take_clip *clip = t.layer->clip;
        int64_t first_ns = take_warp_to_source(clip, clip->start_ns);
        int64_t last_ns = take_warp_to_source(clip, clip->end_ns);
        assert_in_range(first_ns - 1234567891 + 2000, 0, 4000); /* within 2 us */
        assert_in_range(last_ns - 9876543211 + 2000, 0, 4000);
    }
    take_finish(&t);
}

static void a_speed_out_of_bounds_is_refused(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.speed','clip':2,'speed':100}");
    help_refused(&t, "{'op':'clip.speed','clip':2,'speed':11}",
                 "outside 1/1000 to 1000 times the recorded speed");
    help_do(&t, "{'op':'clip.speed','clip':2,'speed':0.01}");
    help_do(&t, "{'op':'clip.trim','clip':2,'start_ns':5000m,'end_ns':5000000001}");
    help_refused(&t, "{'op':'clip.speed','clip':2,'speed':4}", "or leaves nothing of it");
    take_finish(&t);
}

static void a_curve_stays_within_the_recording(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.curve','clip':2,'warp':[[1000m,1500m],[9000m,8500m]]}");
    assert_string_equal(help_shown(t.layer, 5 * help_s), "2@5*1");
    help_refused(&t, "{'op':'clip.curve','clip':2,'warp':[[0,0],[9000m,9500m]]}",
                 "that curve shows 0 .. 10.555555555 s of a recording of 0 .. 10 s");
    help_refused(&t, "{'op':'clip.curve','clip':2,'warp':[[0,-1]]}", "shows -0.000000001 ..");
    take_finish(&t);
}

static void a_clip_is_set(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.smooth','clip':2,'smooth_s':0.05}");
    help_do(&t, "{'op':'clip.gain','clip':2,'gain':1.5}");
    help_do(&t, "{'op':'clip.mute','clip':2,'muted':true}");
    help_do(&t, "{'op':'clip.perform','clip':2,'performance':9}");
    const take_clip *clip = t.layer->clip;
    assert_true(clip->smooth_s == 0.05 && clip->gain == 1.5 && clip->is_muted);
    assert_true(clip->performance == 9 && clip->from_ns == 1000 * help_s);
    help_do(&t, "{'op':'clip.remove','clip':2}");
    assert_int_equal(t.layer->clip_count, 0);
    take_finish(&t);
}

static void fades_fit_into_their_clip(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.fade','clip':2,'fade_in_ns':4000m}");
    help_do(&t, "{'op':'clip.fade','clip':2,'fade_out_ns':6000m}");
    help_refused(&t, "{'op':'clip.fade','clip':2,'fade_in_ns':4001m}",
                 "fades of 4.001 s and 6 s are longer than its 10 s");
    help_refused(&t, "{'op':'clip.fade','clip':2}", "expected fade_in_ns or fade_out_ns, or both");
    help_do(&t, "{'op':'clip.trim','clip':2,'start_ns':5000m}");
    assert_true(t.layer->clip->fade_in_ns == 4 * help_s && t.layer->clip->fade_out_ns == help_s);
    take_finish(&t);
}

/* ---- ripple ---- */

/* Layers 'face' (clips 2: 0..3 s, 3: 6..10 s) and 'mouth' (clips 5: 1..4 s, 6: 4..7 s), markers at
 * 2, 3.5 and 8 s. */
static take to_ripple(void)
{
    take t = help_take();
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':3000m}");
    help_do(&t, "{'op':'clip.trim','clip':3,'start_ns':6000m}");
    help_do(&t, "{'op':'layer.add','name':'mouth','own':['mouth']}");
    help_do(&t, "{'op':'clip.add','layer':4,'performance':7,'source_ns':1000m,'start_ns':1000m,"
                "'end_ns':7000m}");
    help_do(&t, "{'op':'clip.split','clip':5,'at_ns':4000m}");
    help_do(&t, "{'op':'marker.add','at_ns':2000m,'text':'a'}");
    help_do(&t, "{'op':'marker.add','at_ns':3500m,'text':'b'}");
    help_do(&t, "{'op':'marker.add','at_ns':8000m,'text':'c'}");
    return t;
}

static void expect_starts(const take *t, int64_t face_ms, int64_t mouth_ms, int64_t end_ms)
{
    const take_layer *mouth = &t->layer[1];
    assert_int_equal(t->layer[0].clip[0].start_ns, 0);
    assert_int_equal(t->layer[0].clip[1].start_ns, face_ms * help_ms);
    assert_int_equal(mouth->clip[mouth->clip_count - 1].start_ns, mouth_ms * help_ms);
    assert_int_equal(t->duration_ns, end_ms * help_ms);
}

static void what_follows_a_removed_clip_closes_its_gap(void **state)
{
    (void)state;
    take t = to_ripple();
    help_do(&t, "{'op':'clip.remove','clip':5,'ripple':true}"); /* 1..4 s */
    expect_starts(&t, 3000, 1000, 7000);
    assert_int_equal(t.marker[0].at_ns, help_s); /* was within: it goes to the start of the gap */
    assert_int_equal(t.marker[1].at_ns, help_s);
    assert_int_equal(t.marker[2].at_ns, 5 * help_s);
    take_finish(&t);
    t = to_ripple(); /* without ripple nothing else moves */
    help_do(&t, "{'op':'clip.remove','clip':5}");
    expect_starts(&t, 6000, 4000, 10000);
    assert_int_equal(t.marker[2].at_ns, 8 * help_s);
    take_finish(&t);
}

static void a_trim_a_speed_and_a_move_ripple(void **state)
{
    (void)state;
    take t = to_ripple();
    help_do(&t, "{'op':'clip.trim','clip':5,'end_ns':3000m,'ripple':true}");
    expect_starts(&t, 5000, 3000, 9000);
    assert_int_equal(t.marker[1].at_ns, 3 * help_s);
    assert_int_equal(t.marker[2].at_ns, 7 * help_s);
    take_finish(&t);
    t = to_ripple();
    help_do(&t, "{'op':'clip.trim','clip':5,'start_ns':1500m,'ripple':true}");
    expect_starts(&t, 5500, 3500, 9500);
    assert_string_equal(help_shown(&t.layer[1], 1200 * help_ms), "5@1.7*1"); /* slid under it */
    take_finish(&t);
    t = to_ripple();
    help_do(&t, "{'op':'clip.speed','clip':5,'speed':0.5,'ripple':true}"); /* 3 s become 6 */
    expect_starts(&t, 9000, 7000, 13000);
    assert_int_equal(t.marker[0].at_ns, 2 * help_s);
    assert_int_equal(t.marker[2].at_ns, 11 * help_s);
    take_finish(&t);
    t = to_ripple();
    help_do(&t, "{'op':'clip.move','clip':6,'start_ns':5000m,'ripple':true}");
    expect_starts(&t, 7000, 5000, 11000);
    assert_int_equal(t.marker[1].at_ns, 3500 * help_ms);
    assert_int_equal(t.marker[2].at_ns, 9 * help_s);
    take_finish(&t);
}

/* Sound that begins later moves along; sound that plays already would lose sync. */
static void sound_ripples_or_refuses(void **state)
{
    (void)state;
    take t = to_ripple();
    help_do(&t, "{'op':'audio.attach','audio':3,'offset_ns':5000m}");
    help_do(&t, "{'op':'clip.trim','clip':5,'end_ns':3000m,'ripple':true}");
    assert_int_equal(t.audio.offset_ns, 4 * help_s);
    help_refused(&t, "{'op':'clip.trim','clip':6,'end_ns':5000m,'ripple':true}",
                 "the take's audio begins before 6 s and would lose sync");
    help_do(&t, "{'op':'clip.trim','clip':6,'end_ns':5000m}");
    help_do(&t, "{'op':'audio.trim','end_ns':4500m}"); /* it has ended by then */
    help_do(&t, "{'op':'clip.trim','clip':6,'end_ns':4800m,'ripple':true}");
    assert_int_equal(t.audio.offset_ns, 4 * help_s);
    take_finish(&t);
}

static void a_colour_stays_with_its_clip(void **state)
{
    (void)state;
    take t = to_ripple();
    help_do(&t, "{'op':'clip.colour','clip':5,'colour':4}");
    help_do(&t, "{'op':'layer.colour','layer':1,'colour':6}");
    help_do(&t, "{'op':'clip.split','clip':5,'at_ns':2000m}");
    assert_int_equal(t.layer[1].clip[0].colour, TAKE_COLOUR_GREEN);
    assert_int_equal(t.layer[1].clip[1].colour, TAKE_COLOUR_GREEN);
    assert_int_equal(t.layer[1].clip[2].colour, TAKE_COLOUR_NONE);
    assert_int_equal(t.layer[0].colour, TAKE_COLOUR_BLUE);
    help_refused(&t, "{'op':'clip.colour','clip':5,'colour':8}",
                 "$.colour: expected a whole number");
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clip_is_shown_where_it_happened),
        cmocka_unit_test(a_clip_can_show_any_span_of_its_performance),
        cmocka_unit_test(trim_keeps_what_is_shown_in_its_place),
        cmocka_unit_test(times_are_as_shown_with_the_layers_offset),
        cmocka_unit_test(a_split_changes_nothing_that_is_shown),
        cmocka_unit_test(a_split_is_inside_and_out_of_cross_fades),
        cmocka_unit_test(a_moved_clip_takes_its_timing_along),
        cmocka_unit_test(three_clips_at_an_instant_are_refused),
        cmocka_unit_test(speed_is_about_a_point),
        cmocka_unit_test(speeds_do_not_leave_the_recording),
        cmocka_unit_test(a_speed_out_of_bounds_is_refused),
        cmocka_unit_test(a_curve_stays_within_the_recording),
        cmocka_unit_test(a_clip_is_set),
        cmocka_unit_test(fades_fit_into_their_clip),
        cmocka_unit_test(what_follows_a_removed_clip_closes_its_gap),
        cmocka_unit_test(a_trim_a_speed_and_a_move_ripple),
        cmocka_unit_test(sound_ripples_or_refuses),
        cmocka_unit_test(a_colour_stays_with_its_clip),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
