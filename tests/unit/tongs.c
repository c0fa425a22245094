/* plugins/tongs, as loaded from the build: thumb and index finger grip, stretch and let go. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mapping_bench.h"

/* rad, in sensor order: the tips 0.35 palms apart, 0.73 and 1.13. */
static const float closed[MRT_ANGLES] = {1.44f, 0.15f, 0.2f,   0.34f, 0.61f,  0.53f, 0.26f,  0.67f,
                                         0.6f,  0.3f,  -0.04f, 0.72f, 0.64f,  0.32f, -0.05f, 0.7f,
                                         0.6f,  0.3f,  -0.04f, 0.12f, -0.08f, 0};
static const float opened[MRT_ANGLES] = {1.44f, 0.15f, 0.2f,   0.34f, 0.1f,   0.25f, 0.12f,  0.6f,
                                         0.55f, 0.28f, -0.04f, 0.69f, 0.64f,  0.32f, -0.05f, 0.7f,
                                         0.6f,  0.3f,  -0.04f, 0.12f, -0.08f, 0};
static const float wide[MRT_ANGLES] = {0.74f, 0.15f, 0.2f,  0.63f, -0.05f, 0.06f, 0.03f, 0.02f,
                                       0.13f, 0.06f, 0.26f, 0.05f, 0.18f,  0.09f, 0.21f, 0.03f,
                                       0.15f, 0.07f, 0.36f, 0.13f, 0.08f,  0};

/* How far the one place has moved against the other. */
static float stretched(const mrt_pull *pull)
{
    mrt_vec3 a = pull->vector[0].start, b = pull->vector[1].start;
    mrt_vec3 c = pull->vector[0].end, d = pull->vector[1].end;
    return bench_length(
        (mrt_vec3){d.x - c.x - b.x + a.x, d.y - c.y - b.y + a.y, d.z - c.z - b.z + a.z});
}

/* As bench_move, of what is held or springs back: probes are no moves of the face. */
static float held_move(bench *b, const float *from, const float *to, int steps)
{
    float most = 0, angle[MRT_ANGLES];
    for (int i = 1; i <= steps; ++i) {
        mrt_pull before = b->pull;
        for (int k = 0; k < MRT_ANGLES; ++k)
            angle[k] = from[k] + (to[k] - from[k]) * (float)i / (float)steps;
        bench_step(b, MRT_RIGHT, angle);
        if (before.mode == MRT_ANCHORED && b->pull.mode == MRT_ANCHORED)
            most = fmaxf(most, bench_jump(&before, &b->pull));
    }
    return most;
}

static float apart(const mrt_pull *pull)
{
    mrt_vec3 a = pull->vector[0].end, b = pull->vector[1].end;
    return bench_length((mrt_vec3){b.x - a.x, b.y - a.y, b.z - a.z});
}

static void closing_grips_where_the_tips_are_and_nothing_jumps(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "tongs", &bench_bare, "");
    bench_step(&b, MRT_RIGHT, wide);
    assert_int_equal(b.pull.mode, MRT_IDLE);
    mrt_vec3 probe = b.pull.vector[0].end;
    (void)bench_move(&b, wide, closed, 50);
    assert_int_equal(b.pull.mode, MRT_ANCHORED);
    assert_int_equal(b.pull.count, 2);
    assert_int_equal(b.pull.anchor, 1);
    assert_true(apart(&b.pull) >= 0.5f * b.pull.radius_mm - 0.01f);
    assert_true(isfinite(probe.x));
    bench_tear_down(&b);
}

static void opening_a_little_stretches_and_opening_wide_lets_go(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "tongs", &bench_bare, "release_time=0.2");
    bench_step(&b, MRT_RIGHT, closed);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    (void)bench_move(&b, closed, opened, 40);
    assert_int_equal(b.pull.anchor, 1);
    assert_true(stretched(&b.pull) > 10.0f);
    float most = held_move(&b, opened, wide, 40);
    most = fmaxf(most, held_move(&b, wide, wide, 60));
    assert_true(most < 3.0f); /* 20 mm back in 0.2 s, minimum jerk, 10 ms a frame: 1.9 mm */
    assert_true(bench_longest(&b.pull) <= 0.0f);
    assert_int_equal(b.pull.anchor, 1);
    (void)bench_move(&b, wide, closed, 40);
    assert_int_equal(b.pull.anchor, 2);
    bench_tear_down(&b);
}

/* Between the two gaps a hand that trembles neither grips nor lets go again and again. */
static void gaps_have_hysteresis(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "tongs", &bench_bare, "close=50,open=60");
    bench_step(&b, MRT_RIGHT, closed);
    for (int i = 0; i < 20; ++i) {
        float between[MRT_ANGLES];
        for (int k = 0; k < MRT_ANGLES; ++k)
            between[k] = closed[k] + (opened[k] - closed[k]) * (i % 2 ? 0.45f : 0.55f);
        bench_step(&b, MRT_RIGHT, between);
    }
    assert_int_equal(b.pull.anchor, 1);
    bench_tear_down(&b);
}

static void what_is_held_at_release_stays_and_is_gripped_anew(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "tongs", &bench_bare, "on_release=hold");
    bench_step(&b, MRT_RIGHT, closed);
    (void)bench_move(&b, closed, opened, 40);
    bench_trigger(&b, "Release");
    bench_step(&b, MRT_RIGHT, opened);
    mrt_pull held = b.pull;
    assert_true(bench_longest(&held) > 4.0f);
    (void)bench_move(&b, opened, wide, 20);
    assert_int_equal(b.pull.anchor, 1);
    assert_memory_equal(b.pull.vector, held.vector, 2 * sizeof(mrt_vector));
    bench_trigger(&b, "Engage");
    bench_step(&b, MRT_RIGHT, closed);
    assert_int_equal(b.pull.anchor, 2);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

static void commit_makes_a_new_base_and_grips_again(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "tongs", &bench_bare, "");
    bench_step(&b, MRT_RIGHT, closed);
    (void)bench_move(&b, closed, opened, 40);
    bench_trigger(&b, "Commit");
    bench_step(&b, MRT_RIGHT, opened);
    assert_int_equal(b.pull.commit, 1);
    assert_int_equal(b.pull.anchor, 2);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

static void a_hand_that_was_away_goes_on_without_a_jump(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "tongs", &bench_bare, "gain=0.2,stretch=0.2");
    bench_step(&b, MRT_RIGHT, closed);
    (void)bench_move(&b, closed, opened, 40);
    mrt_pull before = b.pull;
    b.frame.hand[MRT_RIGHT].present = false;
    assert_true(bench_frame(&b) >= 0);
    assert_memory_equal(b.pull.vector, before.vector, 2 * sizeof(mrt_vector));
    bench_step(&b, MRT_RIGHT, closed); /* back, and held otherwise */
    assert_true(bench_jump(&before, &b.pull) < 0.01f);
    assert_true(bench_move(&b, closed, opened, 40) < 2.0f);
    assert_true(bench_jump(&before, &b.pull) > 1.0f);
    bench_tear_down(&b);
}

static void walks_stay_within_reach(void **state)
{
    (void)state;
    static const char *const triggers[] = {"Engage", "Release", "Commit", NULL};
    bench b;
    bench_open(&b, "tongs", &bench_face, "release_pedal=1,engage_pedal=2");
    bench_walk(&b, triggers, 1.5f * 0.2f * 0.24f * 240.0f);
    bench_tear_down(&b);
}

static void shipped_faces_do_not_fold(void **state)
{
    (void)state;
    assert_true(bench_least_determinant("tongs", "moai", "", 600) > 0.0);
    assert_true(bench_least_determinant("tongs", "puppet", "", 600) > 0.0);
}

static void watch_grips(const bench *b, double time_s, void *data)
{
    float *most = data;
    (void)time_s;
    *most = fmaxf(*most, stretched(&b->pull));
}

/* It talks with its fingertips together, spreads, makes a fist and comes back. */
static void demo_grips_stretches_and_grips_again(void **state)
{
    (void)state;
    bench b;
    float most = 0;
    bench_open(&b, "tongs", &bench_bare, "");
    bench_demo(&b, watch_grips, &most);
    assert_in_range(b.pull.anchor, 2, 4);
    assert_true(most > 10.0f);
    bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closing_grips_where_the_tips_are_and_nothing_jumps),
        cmocka_unit_test(opening_a_little_stretches_and_opening_wide_lets_go),
        cmocka_unit_test(gaps_have_hysteresis),
        cmocka_unit_test(what_is_held_at_release_stays_and_is_gripped_anew),
        cmocka_unit_test(commit_makes_a_new_base_and_grips_again),
        cmocka_unit_test(a_hand_that_was_away_goes_on_without_a_jump),
        cmocka_unit_test(demo_grips_stretches_and_grips_again),
        cmocka_unit_test(walks_stay_within_reach),
        cmocka_unit_test(shipped_faces_do_not_fold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
