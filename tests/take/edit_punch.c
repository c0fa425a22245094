/* core/show/edit.h: punching a span in, and comping parts of the face from other takes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

#include "show/own.h"

#include <math.h>

#define PUNCH(in, out, fade)                                                                       \
    "{'op':'punch','layer':1,'performance':8,'from_ns':0,'to_ns':20000m,'source_ns':5000m,"        \
    "'in_ns':" in ",'out_ns':" out ",'fade_ns':" fade "}"

/* Outside of in_ns .. out_ns the layer shows, bit by bit, what it showed before. */
static void require_same_outside(const take_layer *before, const take_layer *after, int64_t in_ns,
                                 int64_t out_ns)
{
    for (int64_t at_ns = -help_s; at_ns < 20 * help_s; at_ns += 7654321) {
        take_voice a[2], b[2];
        if (at_ns >= in_ns && at_ns < out_ns)
            continue;
        uint32_t count = take_at(a, before, at_ns);
        assert_int_equal(count, take_at(b, after, at_ns));
        for (uint32_t i = 0; i < count; ++i)
            assert_true(a[i].source_ns == b[i].source_ns && a[i].weight == b[i].weight &&
                        a[i].clip->performance == b[i].clip->performance);
    }
}

static void a_punch_replaces_its_span_and_nothing_else(void **state)
{
    (void)state;
    take t = help_take(), before;
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, PUNCH("3000m", "6000m", "500m"));
    assert_int_equal(t.layer->clip_count, 3);
    require_same_outside(before.layer, t.layer, 3 * help_s, 6 * help_s);
    assert_string_equal(help_shown(t.layer, 3 * help_s), "2@3*1 3@5*0");
    assert_string_equal(help_shown(t.layer, 3250 * help_ms), "2@3.25*0.5 3@5.25*0.5");
    assert_string_equal(help_shown(t.layer, 3500 * help_ms), "3@5.5*1");
    assert_string_equal(help_shown(t.layer, 5625 * help_ms), "3@7.625*0.75 4@5.625*0.25");
    assert_string_equal(help_shown(t.layer, 6 * help_s), "4@6*1");
    take_finish(&before);
    take_finish(&t);
}

static void a_punch_without_fade_is_a_hard_cut(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, PUNCH("3000m", "6000m", "0"));
    assert_string_equal(help_shown(t.layer, 3 * help_s - 1), "2@3*1");
    assert_string_equal(help_shown(t.layer, 3 * help_s), "3@5*1");
    assert_string_equal(help_shown(t.layer, 6 * help_s), "4@6*1");
    take_finish(&t);
}

static void the_same_punch_again_replaces_the_first(void **state)
{
    (void)state;
    take t = help_take(), before;
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, PUNCH("3000m", "6000m", "500m"));
    help_do(&t, PUNCH("3000m", "6000m", "500m"));
    assert_int_equal(t.layer->clip_count, 3);
    assert_int_equal(t.layer->clip[1].id, 5);
    require_same_outside(before.layer, t.layer, 3 * help_s, 6 * help_s);
    take_finish(&before);
    take_finish(&t);
}

static void a_punch_at_the_end_of_the_recording_meets_it_there(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, PUNCH("10000m", "12000m", "500m"));
    assert_true(t.duration_ns == 12 * help_s);
    assert_string_equal(help_shown(t.layer, 10 * help_s - 1), "2@10*1");
    assert_string_equal(help_shown(t.layer, 10 * help_s), "3@5*1");
    assert_string_equal(help_shown(t.layer, 11750 * help_ms), "3@6.75*0.5");
    take_finish(&t);
}

static void what_was_trimmed_off_serves_the_cross_fade(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':5000m}");
    help_do(&t, PUNCH("5000m", "8000m", "1000m"));
    assert_string_equal(help_shown(t.layer, 5500 * help_ms), "2@5.5*0.5 3@5.5*0.5");
    take_finish(&t);
}

static void a_punch_into_nothing_fades_in_and_out(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.remove','clip':2}");
    help_do(&t, PUNCH("3000m", "6000m", "500m"));
    assert_string_equal(help_shown(t.layer, 3250 * help_ms), "3@5.25*0.5");
    assert_string_equal(help_shown(t.layer, 5750 * help_ms), "3@7.75*0.5");
    take_finish(&t);
}

static void a_short_fade_gives_way_and_a_long_one_stays(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'clip.trim','clip':2,'end_ns':5000m}");
    help_do(&t, "{'op':'clip.fade','clip':2,'fade_out_ns':500m}");
    take other;
    assert_int_equal(take_copy(&other, &t, NULL), MRT_OK);
    help_do(&t, PUNCH("5000m", "8000m", "500m"));
    assert_string_equal(help_shown(t.layer, 5250 * help_ms), "2@5.25*0.5 3@5.25*0.5");
    help_do(&other, PUNCH("5000m", "8000m", "499m"));
    assert_string_equal(help_shown(other.layer, 4750 * help_ms), "2@4.75*0.5");
    assert_true(other.layer->clip[1].fade_in_ns == 499 * help_ms);
    take_finish(&other);
    take_finish(&t);
}

static void fades_are_not_cut(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, PUNCH("3000m", "6000m", "500m"));
    help_refused(&t, PUNCH("3100m", "5000m", "100m"),
                 "punch: 3.1 s is within a fade of layer 1 'face'; choose 3 s or 3.5 s");
    help_refused(&t, PUNCH("4000m", "5600m", "100m"), "choose 5.5 s or 6 s");
    help_do(&t, PUNCH("3500m", "5500m", "100m"));
    help_check(&t);
    take_finish(&t);
}

static void a_punch_needs_room_and_material(void **state)
{
    (void)state;
    take t = help_take();
    help_refused(&t, PUNCH("3000m", "3000m", "0"), "punch 3 .. 3 s: expected an end after");
    help_refused(&t, PUNCH("3000m", "4000m", "501m"), "use at most 0.5 s");
    help_refused(&t, PUNCH("3000m", "18001m", "0"),
                 "performance 8 can be shown only at -2 .. 18 s");
    help_do(&t, PUNCH("3000m", "4000m", "500m"));
    take_finish(&t);
}

static void a_punch_goes_by_the_time_that_is_shown(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'layer.offset','layer':1,'offset_ns':1000m}");
    help_do(&t, PUNCH("3000m", "6000m", "500m"));
    assert_string_equal(help_shown(t.layer, 3250 * help_ms), "2@2.25*0.5 3@5.25*0.5");
    take_finish(&t);
}

/* ---- comp ---- */

#define COMP(what, performance, in, out)                                                           \
    "{'op':'comp'," what ",'performance':" performance ",'from_ns':0,'to_ns':20000m,'in_ns':" in   \
    ",'out_ns':" out ",'fade_ns':200m}"

static double weight_of(const take *t, uint32_t layer, const char *name, int64_t at_ns)
{
    double weight[EDIT_LAYERS_MAX];
    own_weights(weight, t, name, at_ns);
    return weight[layer];
}

static void a_comp_makes_a_layer_for_each_region(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, COMP("'regions':['mouth','brows']", "8", "2000m", "6000m"));
    assert_int_equal(t.layer_count, 3);
    assert_string_equal(t.layer[1].name, "mouth");
    assert_string_equal(t.layer[2].name, "brows");
    assert_true(weight_of(&t, 0, "mouth.corner.l", 4 * help_s) == 0.0);
    assert_true(weight_of(&t, 1, "mouth.corner.l", 4 * help_s) == 1.0);
    assert_true(weight_of(&t, 2, "brow.mid.l", 4 * help_s) == 1.0);
    assert_true(weight_of(&t, 0, "cheek.l", 4 * help_s) == 1.0);
    take_finish(&t);
}

static void a_comp_cross_fades_with_what_was_there(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, COMP("'regions':['mouth']", "8", "2000m", "6000m"));
    assert_true(fabs(weight_of(&t, 1, "lip.upper.mid", 2050 * help_ms) - 0.25) < 1e-15);
    assert_true(fabs(weight_of(&t, 0, "lip.upper.mid", 2050 * help_ms) - 0.75) < 1e-15);
    assert_true(weight_of(&t, 0, "lip.upper.mid", 2 * help_s) == 1.0);
    assert_true(weight_of(&t, 0, "lip.upper.mid", 6 * help_s) == 1.0);
    take_finish(&t);
}

static void a_comp_next_to_another_extends_its_layer(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, COMP("'regions':['mouth']", "8", "2000m", "5000m"));
    help_do(&t, COMP("'regions':['mouth']", "9", "5000m", "7000m"));
    assert_int_equal(t.layer_count, 2);
    assert_int_equal(t.layer[1].clip_count, 2);
    assert_string_equal(help_shown(&t.layer[1], 5100 * help_ms), "4@3.1*0.5 5@0.1*0.5");
    assert_true(weight_of(&t, 0, "mouth.corner.l", 5100 * help_ms) < 1e-15);
    take_finish(&t);
}

static void the_jaw_alone_is_replaced(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, COMP("'own':['jaw.*'],'name':'other jaw'", "8", "0", "10000m"));
    help_do(&t, COMP("'own':['jaw.*']", "9", "3000m", "4000m"));
    assert_int_equal(t.layer_count, 2);
    assert_string_equal(t.layer[1].name, "other jaw");
    assert_true(weight_of(&t, 1, "jaw.open", 5 * help_s) == 1.0);
    assert_true(weight_of(&t, 1, "mouth.corner.l", 5 * help_s) == 0.0);
    assert_int_equal(t.layer[1].clip_count, 3);
    take_finish(&t);
}

static void a_comp_is_not_hidden_by_a_later_layer(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, COMP("'regions':['mouth']", "8", "2000m", "6000m"));
    help_do(&t, "{'op':'layer.add','name':'overdub','own':['mouth.corner.l']}");
    help_do(&t, "{'op':'clip.add','layer':5,'performance':10}");
    help_do(&t, COMP("'regions':['mouth']", "9", "2000m", "6000m"));
    assert_int_equal(t.layer_count, 4);
    assert_true(weight_of(&t, 3, "mouth.corner.l", 4 * help_s) == 1.0);
    take_finish(&t);
}

static void a_comp_is_of_regions_or_of_names(void **state)
{
    (void)state;
    take t = help_take();
    help_refused(&t, COMP("'name':'x'", "8", "0", "1000m"), "expected either regions");
    help_refused(&t, COMP("'regions':['jaw'],'own':['jaw.*']", "8", "0", "1000m"), "either");
    for (int i = 0; i < EDIT_LAYERS_MAX - 2; ++i)
        help_do(&t, "{'op':'layer.add','name':'x'}");
    help_refused(&t, COMP("'regions':['jaw','nose']", "8", "0", "1000m"), "is reached");
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_punch_replaces_its_span_and_nothing_else),
        cmocka_unit_test(a_punch_without_fade_is_a_hard_cut),
        cmocka_unit_test(the_same_punch_again_replaces_the_first),
        cmocka_unit_test(a_punch_at_the_end_of_the_recording_meets_it_there),
        cmocka_unit_test(what_was_trimmed_off_serves_the_cross_fade),
        cmocka_unit_test(a_punch_into_nothing_fades_in_and_out),
        cmocka_unit_test(a_short_fade_gives_way_and_a_long_one_stays),
        cmocka_unit_test(fades_are_not_cut),
        cmocka_unit_test(a_punch_needs_room_and_material),
        cmocka_unit_test(a_punch_goes_by_the_time_that_is_shown),
        cmocka_unit_test(a_comp_makes_a_layer_for_each_region),
        cmocka_unit_test(a_comp_cross_fades_with_what_was_there),
        cmocka_unit_test(a_comp_next_to_another_extends_its_layer),
        cmocka_unit_test(the_jaw_alone_is_replaced),
        cmocka_unit_test(a_comp_is_not_hidden_by_a_later_layer),
        cmocka_unit_test(a_comp_is_of_regions_or_of_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
