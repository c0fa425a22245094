/* Other takes of the slate under the chosen one: swiped over, and laid earlier or later first. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "take/edit_help.h"
#include "base/clock.h"
#include "timeline_stand.h"

#include <math.h>
#include <string.h>

static take one_layer(void)
{
    take t = help_take();
    t.fps = 25.0;
    help_do(&t, "{'op':'layer.add','name':'mouth','own':['mouth']}");
    return t;
}

static void near_s(int64_t found_ns, double expected_s, double within_s)
{
    if (fabs((double)found_ns * 1e-9 - expected_s) > within_s)
        fail_msg("%.4f s, expected %.4f s", (double)found_ns * 1e-9, expected_s);
}

static stand *open_with_other_take(void)
{
    static stand the_stand;
    stand *s = &the_stand;
    stand_open(s, 1200.0f, 300.0f, 1.0f);
    stand_choose(s, one_layer());
    s->comps = calloc(1, sizeof *s->comps);
    assert_non_null(s->comps);
    s->comps->of = s->take.id;
    s->comps->count = 1;
    s->comps->take[0] = help_take();
    s->comps->take[0].number = 3;
    s->comps->take[0].layer[0].clip[0].performance = 9;
    stand_click_word(s, "Takes");
    assert_true(s->panel->has_comps);
    stand_click_word(s, "B"); /* brows beside the mouth */
    return s;
}

/* It shows what the take shows from 2 s on, which was performed over it there. */
static void what_was_performed_over_a_take_lies_where_it_was_performed(void **state)
{
    (void)state;
    stand *s = open_with_other_take();
    const take_clip *of = &s->take.layer[0].clip[0];
    take_clip *raw = &s->comps->take[0].layer[0].clip[0];
    assert_int_equal(timeline_comp_later_ns(s->panel, 0), 0);
    raw->performance = of->performance;
    raw->start_ns = 0;
    raw->from_ns = of->from_ns + take_warp_to_source(of, of->start_ns) + 2 * NS_PER_S -
                   take_warp_to_source(raw, 0);
    raw->to_ns = raw->from_ns + NS_PER_S;
    near_s(timeline_comp_later_ns(s->panel, 0), 2.0 + 1e-9 * (double)of->start_ns, 1e-6);
    raw->from_ns = of->to_ns + 60 * NS_PER_S; /* the same live hands, a minute later */
    raw->to_ns = raw->from_ns + NS_PER_S;
    assert_int_equal(timeline_comp_later_ns(s->panel, 0), 0);
    stand_close(s);
}

static void a_swipe_over_another_take_is_one_step(void **state)
{
    (void)state;
    stand *s = open_with_other_take();
    stand_drag(s, stand_x(s, 2.0), stand_y(s, 2), stand_x(s, 3.0), stand_y(s, 2));
    assert_int_equal(s->step_count, 1);
    assert_int_equal(s->edit_count, 2);
    assert_string_equal(s->edited[0], "comp");
    const take_layer *top = &s->take.layer[s->take.layer_count - 1];
    assert_string_equal(top->name, "brows");
    assert_int_equal(top->clip[0].performance, 9);
    near_s(top->clip[0].start_ns, 2.0, 0.02);
    near_s(top->clip[0].end_ns, 3.0, 0.02);
    stand_close(s);
}

/* It has other words at that instant: it is laid where they meet, and what is swiped is from there.
 */
static void another_take_is_laid_later_and_comped_as_it_lies(void **state)
{
    (void)state;
    stand *s = open_with_other_take();
    stand_key(s, UI_KEY_CONTROL, true);
    stand_drag(s, stand_x(s, 2.0), stand_y(s, 2), stand_x(s, 2.5), stand_y(s, 2));
    stand_key(s, UI_KEY_CONTROL, false);
    assert_int_equal(s->step_count, 0); /* the take is as it was */
    near_s(timeline_comp_later_ns(s->panel, 0), 0.5, 0.02);
    stand_picture(s, "slid");
    stand_drag(s, stand_x(s, 3.0), stand_y(s, 2), stand_x(s, 4.0), stand_y(s, 2));
    assert_int_equal(s->step_count, 1);
    const take_layer *top = &s->take.layer[s->take.layer_count - 1];
    const take_clip *clip = &top->clip[0];
    near_s(clip->start_ns, 3.0, 0.03);
    const take *other = &s->comps->take[0];
    const int64_t shown_ns = take_warp_to_source(clip, clip->start_ns);
    const int64_t own_ns =
        take_warp_to_source(&other->layer[0].clip[0], clip->start_ns - other->layer[0].offset_ns);
    near_s(own_ns - shown_ns, 0.5, 0.03);
    stand_close(s);
}

static void laying_another_take_elsewhere_is_undone(void **state)
{
    (void)state;
    stand *s = open_with_other_take();
    stand_key(s, UI_KEY_CONTROL, true);
    stand_drag(s, stand_x(s, 2.0), stand_y(s, 2), stand_x(s, 2.5), stand_y(s, 2));
    stand_key(s, UI_KEY_CONTROL, false);
    const int64_t laid_ns = timeline_comp_later_ns(s->panel, 0);
    const undo_change dragged = s->did;
    assert_int_equal(s->did_count, 1);
    assert_non_null(strstr(dragged.words, "shift take 3 to +0.5"));
    stand_double_click(s, stand_x(s, 2.0), stand_y(s, 2)); /* lays it back */
    assert_int_equal(s->did_count, 2);
    assert_int_equal(timeline_comp_later_ns(s->panel, 0), 0);
    (void)s->did.set(s->did.owner, s->did.before);
    assert_int_equal(timeline_comp_later_ns(s->panel, 0), laid_ns);
    (void)dragged.set(dragged.owner, dragged.before);
    assert_int_equal(timeline_comp_later_ns(s->panel, 0), 0);
    (void)dragged.set(dragged.owner, dragged.after);
    assert_int_equal(timeline_comp_later_ns(s->panel, 0), laid_ns);
    stand_double_click(s, stand_x(s, 2.0), stand_y(s, 2));
    stand_double_click(s, stand_x(s, 2.0), stand_y(s, 2)); /* it lies there already */
    assert_int_equal(s->did_count, 3);
    stand_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_performed_over_a_take_lies_where_it_was_performed),
        cmocka_unit_test(a_swipe_over_another_take_is_one_step),
        cmocka_unit_test(another_take_is_laid_later_and_comped_as_it_lies),
        cmocka_unit_test(laying_another_take_elsewhere_is_undone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
