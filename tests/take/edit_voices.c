/* core/show/take.h: which clips speak at an instant, and how loudly. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

#include <math.h>

static void nothing_speaks_where_there_is_no_clip(void **state)
{
    (void)state;
    take t = help_take();
    take_layer empty = {.id = 1};
    take_voice voice[2];
    assert_int_equal(take_at(voice, &empty, 0), 0);
    assert_string_equal(help_shown(t.layer, -1), "");
    assert_string_equal(help_shown(t.layer, 0), "2@0*1");
    assert_string_equal(help_shown(t.layer, 10 * help_s), "");
    take_finish(&t);
}

static void fades_at_free_ends_go_to_nothing(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.fade','clip':2,'fade_in_ns':2000m,'fade_out_ns':4000m}");
    assert_string_equal(help_shown(t.layer, 0), "2@0*0");
    assert_string_equal(help_shown(t.layer, help_s), "2@1*0.5");
    assert_string_equal(help_shown(t.layer, 2 * help_s), "2@2*1");
    assert_string_equal(help_shown(t.layer, 6 * help_s), "2@6*1");
    assert_string_equal(help_shown(t.layer, 9 * help_s), "2@9*0.25");
    take_finish(&t);
}

static void a_muted_clip_leaves_its_neighbour_alone(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':4000m}");
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':6000m}");
    assert_string_equal(help_shown(t.layer, 5 * help_s), "2@5*0.5 3@5*0.5");
    help_do(&t, "{'op':'clip.mute','clip':3,'muted':true}");
    assert_string_equal(help_shown(t.layer, 5 * help_s), "2@5*1");
    help_do(&t, "{'op':'clip.fade','clip':2,'fade_out_ns':2000m}");
    assert_string_equal(help_shown(t.layer, 5 * help_s), "2@5*0.5");
    take_finish(&t);
}

/* ---- properties of a layer in which all meets: cross-fades, fades, curves, gaps ---- */

static take busy_take(void)
{
    take t = help_take();
    help_do(&t, "{'op':'clip.curve','clip':2,'warp':[[0,0],[3000m,1000m],[10000m,10000m]]}");
    help_do(&t, "{'op':'clip.fade','clip':2,'fade_in_ns':1500m}");
    help_do(&t, "{'op':'clip.split','clip':2,'at_ns':3000m}");
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':4500m}");
    help_do(&t, "{'op':'clip.fade','clip':3,'fade_in_ns':3000m,'fade_out_ns':4000m}");
    help_do(&t, "{'op':'clip.add','layer':1,'performance':8,'start_ns':9000m,'end_ns':12000m}");
    help_do(&t, "{'op':'clip.speed','clip':4,'speed':0.5}");
    help_do(&t, "{'op':'clip.fade','clip':4,'fade_out_ns':6000m}");
    help_do(&t, "{'op':'clip.add','layer':1,'performance':9,'start_ns':17000m,'end_ns':18000m}");
    help_do(&t, "{'op':'clip.fade','clip':5,'fade_in_ns':500m,'fade_out_ns':500m}");
    help_check(&t);
    return t;
}

static double weight_of(const take_layer *layer, uint32_t id, int64_t at_ns)
{
    take_voice voice[2];
    uint32_t count = take_at(voice, layer, at_ns);
    for (uint32_t i = 0; i < count; ++i)
        if (voice[i].clip->id == id)
            return voice[i].weight;
    return 0.0;
}

/* The steepest ramp of the take lasts 0.5 s. */
static void weights_are_continuous(void **state)
{
    (void)state;
    const int64_t step_ns = help_ms;
    take t = busy_take();
    for (uint32_t i = 0; i < t.layer->clip_count; ++i)
        for (int64_t at_ns = -help_s; at_ns < 19 * help_s; at_ns += step_ns) {
            uint32_t id = t.layer->clip[i].id;
            double change = weight_of(t.layer, id, at_ns + step_ns) - weight_of(t.layer, id, at_ns);
            if (fabs(change) > 0.002 + 1e-12)
                fail_msg("clip %u at %g s: %g", id, (double)at_ns / 1e9, change);
        }
    take_finish(&t);
}

static void weights_sum_to_1_where_clips_overlap(void **state)
{
    (void)state;
    take t = busy_take();
    uint32_t overlaps = 0;
    for (int64_t at_ns = 0; at_ns < 19 * help_s; at_ns += help_ms) {
        take_voice voice[2];
        uint32_t count = take_at(voice, t.layer, at_ns);
        for (uint32_t i = 0; i < count; ++i)
            assert_true(voice[i].weight >= 0.0 && voice[i].weight <= 1.0);
        if (count != 2)
            continue;
        ++overlaps;
        assert_true(fabs(voice[0].weight + voice[1].weight - 1.0) < 1e-15);
    }
    assert_int_equal(overlaps, 1500 + 1000);
    take_finish(&t);
}

static void source_time_only_goes_forward(void **state)
{
    (void)state;
    take t = busy_take();
    for (uint32_t i = 0; i < t.layer->clip_count; ++i) {
        const take_clip *clip = &t.layer->clip[i];
        int64_t last_ns = -1;
        for (int64_t at_ns = clip->start_ns; at_ns < clip->end_ns; at_ns += 1234567) {
            int64_t source_ns = take_warp_to_source(clip, at_ns);
            assert_true(source_ns > last_ns && source_ns <= clip->to_ns - clip->from_ns);
            last_ns = source_ns;
        }
    }
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_speaks_where_there_is_no_clip),
        cmocka_unit_test(fades_at_free_ends_go_to_nothing),
        cmocka_unit_test(a_muted_clip_leaves_its_neighbour_alone),
        cmocka_unit_test(weights_are_continuous),
        cmocka_unit_test(weights_sum_to_1_where_clips_overlap),
        cmocka_unit_test(source_time_only_goes_forward),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
