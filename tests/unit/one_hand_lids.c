/* plugins/one_hand: blinks and drooping lids, and the neutral pose that is stored. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "one_hand_bench.h"

enum { HOLD = 1 }; /* pedal */

/* ---- lids ---- */

/* The upper left lid over a bend of the middle finger at a steady speed, per frame. */
static int lid_curve(bench *b, float deg_per_s, float far_deg, double dt_s, float *out,
                     int capacity)
{
    bench_set_up(b, "");
    b->dt_s = dt_s;
    bench_talk_for(b, MRT_RIGHT, 20);
    int count = 0;
    for (float deg = 0; count < capacity; ++count) {
        deg = fminf(deg + deg_per_s * (float)dt_s, far_deg);
        bench_bend(b, MRT_RIGHT, (bends){{{MIDDLE_MPJ, deg}}}, 1);
        out[count] = bench_dof(b, "lid_upper.l.close") / 0.8f;
    }
    bench_tear_down(b);
    return count;
}

static void a_quick_bend_blinks_and_a_slow_one_does_not(void **state)
{
    (void)state;
    static const struct bend_case {
        float deg_per_s, far_deg;
        bool blinks;
    } cases[] = {
        {300, 25, true}, {200, 25, true}, {120, 40, false}, {60, 40, false}, {400, 10, false}};
    for (size_t c = 0; c < COUNT_OF(cases); ++c) {
        float lid[100], most = 0;
        bench b;
        int count = lid_curve(&b, cases[c].deg_per_s, cases[c].far_deg, 0.01, lid, COUNT_OF(lid));
        for (int i = 0; i < count; ++i)
            most = fmaxf(most, lid[i]);
        if ((most > 0.95f) != cases[c].blinks)
            fail_msg("%g deg/s: lids close by %g", (double)cases[c].deg_per_s, (double)most);
    }
}

static void a_blink_closes_in_80_ms_and_opens_in_150(void **state)
{
    (void)state;
    static const double rates_s[] = {0.001, 0.01, 0.0166};
    for (size_t r = 0; r < COUNT_OF(rates_s); ++r) {
        bench b;
        bench_set_up(&b, "");
        b.dt_s = rates_s[r];
        bench_talk_for(&b, MRT_RIGHT, 5);
        bench_trigger(&b, "Blink");
        double time_s = 0, closed_s = 0, open_s = 0;
        float most = 0;
        while (time_s < 0.4) {
            bench_talk_for(&b, MRT_RIGHT, 1);
            time_s += rates_s[r];
            float lid = bench_dof(&b, "lid_upper.r.close") / 0.8f;
            double s = time_s < 0.08 ? time_s / 0.08 : (time_s - 0.08) / 0.15;
            double eased = s < 1 ? s * s * s * (10 - 15 * s + 6 * s * s) : 1;
            assert_true(fabs((double)lid - (time_s < 0.08 ? eased : 1 - eased)) < 1e-4);
            if (lid > most)
                most = lid, closed_s = time_s;
            if (lid > 0)
                open_s = time_s;
            assert_true(fabsf(bench_dof(&b, "lid_lower.r.close") / 0.3f - lid) < 1e-5f);
        }
        assert_true(fabs(closed_s - 0.08) <= rates_s[r] && most > 0.98f);
        assert_true(open_s < 0.2301 && open_s > 0.2299 - 2.5 * rates_s[r]);
        assert_true(bench_is_rest(&b));
        bench_tear_down(&b);
    }
}

static void a_slow_bend_droops_as_far_as_its_range(void **state)
{
    (void)state;
    float lid[300];
    bench b;
    int count = lid_curve(&b, 30, 90, 0.01, lid, COUNT_OF(lid));
    for (int i = 1; i < count; ++i)
        assert_true(lid[i] >= lid[i - 1] && lid[i] - lid[i - 1] < 0.02f);
    assert_true(lid[10] <= 0.0f); /* 3 deg: within the dead zone */
    assert_true(fabsf(lid[count - 1] - 0.6f) < 0.01f);
}

static void an_anchor_keeps_drooping_lids(void **state)
{
    (void)state;
    bench b;
    bends half = {{{INDEX_MPJ, 0}, {MIDDLE_MPJ, 20}}};
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 5);
    (void)bench_sweep(&b, bench_nothing, half, 60);
    float before = bench_dof(&b, "lid_upper.l.close");
    assert_true(before > 0.1f);
    bench_trigger(&b, "Anchor");
    for (int i = 0; i < 100; ++i) {
        bench_bend(&b, MRT_RIGHT, half, 1);
        assert_true(fabsf(bench_dof(&b, "lid_upper.l.close") - before) <= 0.0f);
    }
    bench_tear_down(&b);
}

static void lids_do_not_jump_when_a_blink_meets_a_droop(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 5);
    (void)bench_sweep(&b, bench_nothing, (bends){{{MIDDLE_MPJ, 20}}}, 60);
    float before = bench_dof(&b, "lid_upper.l.close");
    assert_true(before > 0.1f);
    for (int i = 0; i < 200; ++i) {
        if (i == 5 || i == 18 || i == 90)
            bench_trigger(&b, "Blink"); /* again while it opens */
        b.frame.pedal[HOLD] = i > 94 && i < 120;
        bench_bend(&b, MRT_RIGHT, (bends){{{MIDDLE_MPJ, 20}}}, 1);
        float lid = bench_dof(&b, "lid_upper.l.close");
        /* 1.875 times the mean speed of closing in 80 ms */
        assert_true(fabsf(lid - before) < 0.8f * 1.88f * 0.01f / 0.08f);
        assert_true(i < 96 || i > 118 || fabsf(lid - before) <= 0.0f); /* held in mid-blink */
        before = lid;
    }
    bench_tear_down(&b);
}

/* ---- the stored neutral pose ---- */

static void stored_neutral_comes_back(void **state)
{
    (void)state;
    unsigned char bytes[4096];
    bench b;
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 2);
    size_t size = b.state->save(b.plugin.self, NULL, 0);
    assert_in_range(size, 16, sizeof bytes);
    assert_int_equal(b.state->save(b.plugin.self, bytes, size), size);
    bench_tear_down(&b);

    bench_set_up(&b, "neutral=stored");
    assert_int_equal(b.state->load(b.plugin.self, bytes, size), MRT_OK);
    unsigned char again[4096];
    assert_int_equal(b.state->save(b.plugin.self, again, sizeof again), size);
    assert_memory_equal(bytes, again, size);
    bench_bend(&b, MRT_RIGHT, bench_talking, 1); /* engages with another pose */
    assert_true(bench_is_rest(&b));              /* at first */
    bench_bend(&b, MRT_RIGHT, bench_talking, 40);
    float open = bench_dof(&b, "jaw.open");
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_true(bench_is_rest(&b));
    bench_tear_down(&b);
    bench_set_up_talking(&b, ""); /* as if the talk pose had been neutral at engage */
    assert_true(fabsf(bench_dof(&b, "jaw.open") - open) < 1e-5f);
    bench_tear_down(&b);
}

static uint32_t next_random(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*state >> 33);
}

static void bytes_that_are_no_stored_neutral_are_refused(void **state)
{
    (void)state;
    unsigned char good[4096], bad[4096];
    uint64_t random = 1;
    bench b;
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 2);
    size_t size = b.state->save(b.plugin.self, good, sizeof good);
    for (int i = 0; i < 2000; ++i) { /* noise of any length */
        size_t length = next_random(&random) % sizeof bad;
        for (size_t k = 0; k < length; ++k)
            bad[k] = (unsigned char)next_random(&random);
        assert_int_equal(b.state->load(b.plugin.self, bad, length), MRT_ERR_FORMAT);
    }
    for (size_t k = 0; k < size; ++k) { /* one wrong bit, anywhere */
        memcpy(bad, good, size);
        bad[k] ^= (unsigned char)(1u << (k % 8));
        assert_int_equal(b.state->load(b.plugin.self, bad, size), MRT_ERR_FORMAT);
    }
    for (size_t length = 0; length < size; length += 7) /* cut off */
        assert_int_equal(b.state->load(b.plugin.self, good, length), MRT_ERR_FORMAT);
    assert_int_equal(b.state->load(b.plugin.self, NULL, 0), MRT_ERR_FORMAT);
    assert_int_equal(b.state->load(b.plugin.self, good, size), MRT_OK);
    bench_talk_for(&b, MRT_RIGHT, 60); /* what was refused changed nothing */
    assert_true(bench_is_rest(&b));
    bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_quick_bend_blinks_and_a_slow_one_does_not),
        cmocka_unit_test(a_blink_closes_in_80_ms_and_opens_in_150),
        cmocka_unit_test(a_slow_bend_droops_as_far_as_its_range),
        cmocka_unit_test(an_anchor_keeps_drooping_lids),
        cmocka_unit_test(lids_do_not_jump_when_a_blink_meets_a_droop),
        cmocka_unit_test(stored_neutral_comes_back),
        cmocka_unit_test(bytes_that_are_no_stored_neutral_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
