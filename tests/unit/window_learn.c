/* ui/window/panels/mapping.h: which finger somebody moves, and which parameter links it. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/panels/mapping.h"

#include <math.h>

typedef struct hands_at {
    learn learn;
    mrt_hand hand[2];
    double time_s;
} hands_at;

static void set_up(hands_at *h)
{
    *h = (hands_at){.time_s = 0.0};
    h->hand[MRT_LEFT].present = h->hand[MRT_RIGHT].present = true;
    learn_begin(&h->learn);
}

/* A finger of a hand swings by `rad` at the knuckle, its neighbours go along by a share. */
static void swing(hands_at *h, uint32_t side, int finger, float rad, float share, double seconds,
                  double dt_s)
{
    static const int knuckle[5] = {1, 4, 7, 11, 15};
    for (double t = 0.0; t < seconds; t += dt_s, h->time_s += dt_s) {
        for (int i = 0; i < 5; ++i) {
            int apart = i > finger ? i - finger : finger - i;
            float part = apart == 0 ? 1.0f : apart == 1 ? share : 0.0f;
            h->hand[side].angle[knuckle[i]] =
                0.3f + part * rad * 0.5f * (float)(1.0 - cos(6.0 * t));
        }
        learn_update(&h->learn, h->hand, dt_s);
    }
}

static void the_finger_that_moves_most_is_meant(void **state)
{
    (void)state;
    static const double dt_s[] = {1.0 / 60.0, 1.0 / 5.0, 1.0 / 240.0};
    for (int k = 0; k < 3; ++k)
        for (int finger = 0; finger < 5; ++finger) {
            hands_at h;
            set_up(&h);
            swing(&h, MRT_RIGHT, finger, 0.9f, 0.4f, 1.2, dt_s[k]);
            assert_int_equal(h.learn.finger, finger);
            set_up(&h);
            swing(&h, MRT_LEFT, finger, 0.9f, 0.4f, 1.2, dt_s[k]);
            assert_int_equal(h.learn.finger, 5 + finger);
        }
}

static void a_hand_at_rest_means_nothing(void **state)
{
    (void)state;
    hands_at h;
    set_up(&h);
    swing(&h, MRT_RIGHT, 1, 0.1f, 0.3f, 3.0, 1.0 / 60.0);
    assert_int_equal(h.learn.finger, LEARN_NONE);
}

static void a_fist_means_no_single_finger(void **state)
{
    (void)state;
    hands_at h;
    set_up(&h);
    swing(&h, MRT_RIGHT, 2, 1.0f, 0.95f, 1.2, 1.0 / 60.0);
    assert_int_equal(h.learn.finger, LEARN_NONE);
}

static void the_last_finger_stays_meant_while_the_hand_rests(void **state)
{
    (void)state;
    hands_at h;
    set_up(&h);
    swing(&h, MRT_RIGHT, 1, 0.9f, 0.2f, 1.2, 1.0 / 60.0);
    swing(&h, MRT_RIGHT, 1, 0.0f, 0.0f, 3.0, 1.0 / 60.0);
    assert_int_equal(h.learn.finger, 1);
    assert_true(h.learn.travel_rad[1] < 0.01f);
    swing(&h, MRT_RIGHT, 4, 0.9f, 0.2f, 1.2, 1.0 / 60.0);
    assert_int_equal(h.learn.finger, 4);
}

static void what_is_no_number_is_no_movement(void **state)
{
    (void)state;
    hands_at h;
    set_up(&h);
    h.hand[MRT_RIGHT].angle[7] = NAN;
    for (int i = 0; i < 100; ++i)
        learn_update(&h.learn, h.hand, i == 50 ? (double)NAN : 1.0 / 60.0);
    assert_int_equal(h.learn.finger, LEARN_NONE);
}

static void a_hand_that_comes_is_no_movement(void **state)
{
    (void)state;
    hands_at h;
    set_up(&h);
    h.hand[MRT_RIGHT].present = false;
    for (int i = 0; i < 60; ++i)
        learn_update(&h.learn, h.hand, 1.0 / 60.0);
    h.hand[MRT_RIGHT].present = true;
    h.hand[MRT_RIGHT].angle[4] = 1.2f; /* while it was away it was at 0 */
    for (int i = 0; i < 60; ++i)
        learn_update(&h.learn, h.hand, 1.0 / 60.0);
    assert_int_equal(h.learn.finger, LEARN_NONE);
}

/* ---- parameters ---- */

#define LINK(name)                                                                                 \
    {                                                                                              \
        1, MRT_PARAM_STEPPED, name, "Contacts", "", "", 0, 64, 0, NULL                             \
    }

static void links_are_found_by_group_and_name(void **state)
{
    (void)state;
    static const mrt_param param[] = {
        LINK("Right thumb"),
        LINK("left little"),
        LINK("Right toe"),
        {1, 0, "Right index", "Contacts", "", "", 0, 64, 0, NULL},
        {1, MRT_PARAM_STEPPED, "Right index", "Hand", "", "", 0, 64, 0, NULL}};
    assert_int_equal(learn_finger_of(&param[0]), 0);
    assert_int_equal(learn_finger_of(&param[1]), 9);
    for (int i = 2; i < 5; ++i)
        assert_int_equal(learn_finger_of(&param[i]), LEARN_NONE);
    const mrt_plugin_type type = {.param_count = 5, .params = param};
    assert_true(learn_can(&type));
    assert_int_equal(learn_param_of(&type, 9), 1);
    assert_int_equal(learn_param_of(&type, 3), 5);
    const mrt_plugin_type none = {.param_count = 3, .params = param + 2};
    assert_false(learn_can(&none));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_finger_that_moves_most_is_meant),
        cmocka_unit_test(a_hand_at_rest_means_nothing),
        cmocka_unit_test(a_fist_means_no_single_finger),
        cmocka_unit_test(the_last_finger_stays_meant_while_the_hand_rests),
        cmocka_unit_test(what_is_no_number_is_no_movement),
        cmocka_unit_test(a_hand_that_comes_is_no_movement),
        cmocka_unit_test(links_are_found_by_group_and_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
