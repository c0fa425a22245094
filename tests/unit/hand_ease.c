/* hand/ease.h: what changes in one step is shown going there smoothly. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/ease.h"

#include <math.h>

static const double RADIANS_PER_DEGREE = 0.017453292519943295;
static const int64_t PERIOD_NS = 6666667; /* 150 Hz */

static void share_goes_from_0_to_1_and_no_further(void **state)
{
    (void)state;
    assert_true(ease_share(-5) == 0.0 && ease_share(0) == 0.0);
    assert_float_equal(ease_share(62500000), 0.15625, 1e-12);
    assert_float_equal(ease_share(125000000), 0.5, 1e-12);
    assert_float_equal(ease_share(187500000), 0.84375, 1e-12);
    assert_true(ease_share(250000000) == 1.0 && ease_share(INT64_MAX) == 1.0);
}

/* A hand at 0 rad for a second, a silence of two, then at 60 degrees. The steepest part of the
 * smoothstep is 1.5 / 0.25 s: 60 degrees * 6 / s / 150 Hz = 2.4 degrees a sample. */
static void angles_after_a_gap_never_jump(void **state)
{
    (void)state;
    ease_angles ease = {0};
    float before = 0;
    double greatest_deg = 0;
    for (int i = 0; i < 300; ++i) {
        int64_t time_ns = i * PERIOD_NS + (i >= 150 ? 2000000000 : 0);
        float angle[MRT_ANGLES] = {0};
        angle[4] = i >= 150 ? (float)(60.0 * RADIANS_PER_DEGREE) : 0.0f;
        ease_angles_apply(&ease, angle, time_ns);
        greatest_deg = fmax(greatest_deg, fabs((double)(angle[4] - before)) / RADIANS_PER_DEGREE);
        before = angle[4];
        if (i == 150)
            assert_true(angle[4] == 0.0f);
        if (i >= 150 + 38) /* 38 * 6.67 ms > 250 ms */
            assert_float_equal(angle[4], 1.0471976f, 1e-6f);
        assert_true(angle[5] == 0.0f);
    }
    assert_true(greatest_deg <= 2.4001);
    assert_true(greatest_deg > 2.3); /* and it does not dawdle either */
}

static void angles_without_a_gap_pass_untouched(void **state)
{
    (void)state;
    ease_angles ease = {0};
    for (int i = 0; i < 20; ++i) {
        float angle[MRT_ANGLES];
        for (int k = 0; k < MRT_ANGLES; ++k)
            angle[k] = (float)((i * 7 + k) % 5) * 0.3f;
        ease_angles_apply(&ease, angle, i * 250000000LL); /* 0.25 s is no gap yet */
        for (int k = 0; k < MRT_ANGLES; ++k)
            assert_true(angle[k] == (float)((i * 7 + k) % 5) * 0.3f);
    }
}

/* Lost again in the middle of the way back: it goes on from where it was. */
static void a_gap_within_an_ease_starts_from_what_was_shown(void **state)
{
    (void)state;
    ease_angles ease = {0};
    float angle[MRT_ANGLES] = {0};
    ease_angles_apply(&ease, angle, 0);
    angle[0] = 1.0f;
    ease_angles_apply(&ease, angle, 1000000000);
    angle[0] = 1.0f;
    ease_angles_apply(&ease, angle, 1125000000);
    assert_float_equal(angle[0], 0.5f, 1e-6f);
    angle[0] = -1.0f;
    ease_angles_apply(&ease, angle, 3000000000);
    assert_float_equal(angle[0], 0.5f, 1e-6f);
    angle[0] = -1.0f;
    ease_angles_apply(&ease, angle, 3125000000);
    assert_float_equal(angle[0], -0.25f, 1e-6f);
}

static void a_step_backwards_in_time_is_eased_too(void **state)
{
    (void)state;
    ease_angles ease = {0};
    float angle[MRT_ANGLES] = {0};
    ease_angles_apply(&ease, angle, INT64_MAX);
    angle[0] = 1.0f;
    ease_angles_apply(&ease, angle, INT64_MIN);
    assert_true(angle[0] == 0.0f);
}

/* From no turn to a quarter turn about z, given as -q: the short way is 45 degrees halfway. */
static void wrist_turns_the_short_way(void **state)
{
    (void)state;
    ease_wrist ease = {0};
    float at[EASE_WRIST] = {10, 0, 0, 0, 0, 0, 2}; /* any length */
    ease_wrist_apply(&ease, at, 0);
    assert_float_equal(at[6], 1.0f, 1e-6f);
    const float there[EASE_WRIST] = {30, 0, -40, 0, 0, -0.70710678f, -0.70710678f};
    for (int i = 0; i < EASE_WRIST; ++i)
        at[i] = there[i];
    ease_wrist_apply(&ease, at, 5000000000);
    assert_float_equal(at[0], 10.0f, 1e-6f);
    assert_float_equal(at[6], 1.0f, 1e-6f);
    for (int i = 0; i < EASE_WRIST; ++i)
        at[i] = there[i];
    ease_wrist_apply(&ease, at, 5125000000);
    assert_float_equal(at[0], 20.0f, 1e-5f);
    assert_float_equal(at[2], -20.0f, 1e-5f);
    assert_float_equal(at[5], 0.38268343f, 1e-6f);
    assert_float_equal(at[6], 0.92387953f, 1e-6f);
}

static void wrist_without_an_orientation_keeps_the_last(void **state)
{
    (void)state;
    ease_wrist ease = {0};
    float at[EASE_WRIST] = {1, 2, 3, 0, 0, 0, 0};
    ease_wrist_apply(&ease, at, 0);
    assert_true(at[3] == 0.0f && at[6] == 1.0f);
    float turned[EASE_WRIST] = {1, 2, 3, 1, 0, 0, 0};
    ease_wrist_apply(&ease, turned, 10000000);
    float none[EASE_WRIST] = {1, 2, 3, 0, 0, 0, 0};
    ease_wrist_apply(&ease, none, 20000000);
    assert_true(none[3] == 1.0f && none[6] == 0.0f);
}

/* Half a turn away the blend has no length on the way: it stays a rotation. */
static void wrist_half_a_turn_away_stays_a_rotation(void **state)
{
    (void)state;
    ease_wrist ease = {0};
    float at[EASE_WRIST] = {0, 0, 0, 0, 0, 0, 1};
    ease_wrist_apply(&ease, at, 0);
    for (int64_t time_ns = 1000000000; time_ns < 1300000000; time_ns += 5000000) {
        float there[EASE_WRIST] = {0, 0, 0, 1, 0, 0, 0};
        ease_wrist_apply(&ease, there, time_ns);
        double length = 0;
        for (int i = 3; i < EASE_WRIST; ++i)
            length += (double)there[i] * (double)there[i];
        assert_float_equal(length, 1.0, 1e-5);
    }
}

static void offset_is_reached_an_ease_later_and_replaced_from_where_it_is(void **state)
{
    (void)state;
    ease_offset offset = {0};
    float to[MRT_ANGLES] = {0}, angle[MRT_ANGLES] = {0};
    to[2] = 0.4f;
    ease_offset_set(&offset, to, 1000000000);
    ease_offset_add(&offset, angle, 1000000000);
    assert_true(angle[2] == 0.0f);
    angle[2] = 1.0f;
    ease_offset_add(&offset, angle, 1125000000);
    assert_float_equal(angle[2], 1.2f, 1e-6f);
    to[2] = 0.0f;
    ease_offset_set(&offset, to, 1125000000);
    angle[2] = 0.0f;
    ease_offset_add(&offset, angle, 1125000000);
    assert_float_equal(angle[2], 0.2f, 1e-6f);
    angle[2] = 0.0f;
    ease_offset_add(&offset, angle, 1375000000);
    assert_float_equal(angle[2], 0.0f, 1e-7f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(share_goes_from_0_to_1_and_no_further),
        cmocka_unit_test(angles_after_a_gap_never_jump),
        cmocka_unit_test(angles_without_a_gap_pass_untouched),
        cmocka_unit_test(a_gap_within_an_ease_starts_from_what_was_shown),
        cmocka_unit_test(a_step_backwards_in_time_is_eased_too),
        cmocka_unit_test(wrist_turns_the_short_way),
        cmocka_unit_test(wrist_without_an_orientation_keeps_the_last),
        cmocka_unit_test(wrist_half_a_turn_away_stays_a_rotation),
        cmocka_unit_test(offset_is_reached_an_ease_later_and_replaced_from_where_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
