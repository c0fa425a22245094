/* plugins/sculpt, as loaded from the build: palm and fingertips as tools for clay. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mapping_bench.h"

/* Bending moves the fingertips of a hand before the face into it, stretching out of it. */
static const bends bent = {{{INDEX_MPJ, 15}, {MIDDLE_MPJ, 15}, {RING_MPJ, 15}}};

static float index_way(const bench *b)
{
    const mrt_vector *v = &b->pull.vector[1];
    return v->end.z - v->start.z;
}

/* Of the index finger's tip, mm, out of the face: while it bends, and while it stretches. */
static void bend_and_stretch(bench *b, float *out_bending, float *out_stretching)
{
    float angle[MRT_ANGLES];
    *out_bending = *out_stretching = 0;
    for (int i = 1; i <= 20; ++i) {
        bench_bent(angle, &bent, (float)(i <= 10 ? i : 20 - i) / 10.0f);
        bench_step(b, MRT_RIGHT, angle);
        *(i <= 10 ? out_bending : out_stretching) += index_way(b);
    }
}

static void push_only_pushes_and_pull_only_pulls(void **state)
{
    (void)state;
    bench b;
    float bending, stretching;
    bench_open(&b, "sculpt", &bench_bare, "tool=push,strength=100");
    bench_talk_for(&b, MRT_RIGHT, 2);
    bend_and_stretch(&b, &bending, &stretching);
    assert_true(bending < -3.0f);
    assert_true(fabsf(stretching) < 1e-3f);
    bench_tear_down(&b);
    bench_open(&b, "sculpt", &bench_bare, "tool=pull,strength=100");
    bench_talk_for(&b, MRT_RIGHT, 2);
    bend_and_stretch(&b, &bending, &stretching);
    assert_true(fabsf(bending) < 1e-3f);
    assert_true(fabsf(stretching) < 0.5f); /* it only comes back to where it touched */
    bench_bend(&b, MRT_RIGHT, (bends){{{INDEX_MPJ, -15}}}, 1);
    assert_true(index_way(&b) > 1.0f);
    bench_tear_down(&b);
}

/* A hand that trembles must not dig a hole. */
static void pushing_again_goes_no_deeper(void **state)
{
    (void)state;
    bench b;
    float bending, stretching;
    bench_open(&b, "sculpt", &bench_bare, "tool=push,strength=100");
    bench_talk_for(&b, MRT_RIGHT, 2);
    bend_and_stretch(&b, &bending, &stretching);
    float first = bending;
    for (int i = 0; i < 10; ++i) {
        bend_and_stretch(&b, &bending, &stretching);
        assert_true(fabsf(bending) < 0.02f * fabsf(first));
    }
    bench_tear_down(&b);
}

static void grab_takes_all_motion_times_strength(void **state)
{
    (void)state;
    bench b;
    float whole, half, back;
    bench_open(&b, "sculpt", &bench_bare, "tool=grab,strength=100");
    bench_talk_for(&b, MRT_RIGHT, 2);
    bend_and_stretch(&b, &whole, &back);
    assert_true(fabsf(whole + back) < 0.01f && whole < -3.0f);
    bench_set(&b, "strength=50");
    bend_and_stretch(&b, &half, &back);
    assert_true(fabsf(half - 0.5f * whole) < 0.02f);
    bench_tear_down(&b);
}

static void smooth_eases_back_while_the_hand_moves_near(void **state)
{
    (void)state;
    bench b;
    float angle[MRT_ANGLES];
    bench_open(&b, "sculpt", &bench_bare, "tool=smooth");
    bench_talk_for(&b, MRT_RIGHT, 3);
    assert_true(b.pull.leak_per_s <= 0.0f); /* it does not move */
    bench_bent(angle, &bent, 1);
    bench_step(&b, MRT_RIGHT, angle);
    assert_true(b.pull.leak_per_s > 1.0f && b.pull.leak_per_s < 8.0f);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    b.frame.near = false;
    bench_talk_for(&b, MRT_RIGHT, 1);
    assert_true(b.pull.leak_per_s <= 0.0f);
    bench_tear_down(&b);
}

static void touching_anew_moves_nothing(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "sculpt", &bench_bare, "tool=grab,strength=100");
    bench_talk_for(&b, MRT_RIGHT, 3);
    b.frame.hand[MRT_RIGHT].present = false;
    assert_int_equal(bench_frame(&b), MRT_OK);
    assert_int_equal(b.pull.count, 0);
    bench_bend(&b, MRT_RIGHT, bent, 1); /* back, elsewhere */
    assert_int_equal(b.pull.count, 13);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_trigger(&b, "Release");
    bench_bend(&b, MRT_RIGHT, bent, 1);
    assert_int_equal(b.pull.count, 0);
    bench_trigger(&b, "Engage");
    bench_talk_for(&b, MRT_RIGHT, 1);
    assert_true(b.pull.count == 13 && bench_longest(&b.pull) <= 0.0f);
    bench_bend(&b, MRT_RIGHT, bent, 1);
    assert_true(bench_longest(&b.pull) > 3.0f);
    bench_tear_down(&b);
}

static void pedal_takes_the_next_tool_and_a_new_choice_ends_that(void **state)
{
    (void)state;
    bench b;
    float bending, stretching;
    bench_open(&b, "sculpt", &bench_bare, "tool=grab,tool_pedal=2,strength=100");
    bench_talk_for(&b, MRT_RIGHT, 2);
    b.frame.pedal[1] = 1.0f; /* grab, then push again */
    bench_talk_for(&b, MRT_RIGHT, 1);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bend_and_stretch(&b, &bending, &stretching);
    assert_true(bending < -3.0f && fabsf(stretching) < 1e-3f);
    bench_set(&b, "tool=smooth");
    bend_and_stretch(&b, &bending, &stretching);
    assert_true(fabsf(bending) <= 0.0f && b.pull.leak_per_s > 0.0f);
    bench_tear_down(&b);
}

static void walks_stay_bounded(void **state)
{
    (void)state;
    static const char *const triggers[] = {"Engage", "Release", "Commit", NULL};
    bench b;
    bench_open(&b, "sculpt", &bench_face, "tool_pedal=1,engage_pedal=2");
    bench_walk(&b, triggers, 120.0f); /* in a frame; the test's hand jumps on its waves */
    bench_tear_down(&b);
}

static void shipped_faces_do_not_fold(void **state)
{
    (void)state;
    assert_true(bench_least_determinant("sculpt", "moai", "", 200) > 0.0);
    assert_true(bench_least_determinant("sculpt", "puppet", "", 200) > 0.0);
}

/* How far the index finger's tip has pushed in all, mm. */
static void watch_push(const bench *b, double time_s, void *data)
{
    double *pushed = data;
    const mrt_vector *v = &b->pull.vector[1];
    double x = (double)v->end.x - (double)v->start.x, y = (double)v->end.y - (double)v->start.y;
    double z = (double)v->end.z - (double)v->start.z;
    (void)time_s;
    *pushed += sqrt(x * x + y * y + z * z);
}

/* Twenty syllables and a fist: as deep as the fist, not twenty times as deep. */
static void demo_pushes_once_as_deep_as_it_goes(void **state)
{
    (void)state;
    bench b;
    double pushed = 0;
    bench_open(&b, "sculpt", &bench_bare, "");
    bench_demo(&b, watch_push, &pushed);
    print_message("pushed by %.1f mm\n", pushed);
    assert_true(pushed > 5.0 && pushed < 100.0);
    bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(push_only_pushes_and_pull_only_pulls),
        cmocka_unit_test(pushing_again_goes_no_deeper),
        cmocka_unit_test(grab_takes_all_motion_times_strength),
        cmocka_unit_test(smooth_eases_back_while_the_hand_moves_near),
        cmocka_unit_test(touching_anew_moves_nothing),
        cmocka_unit_test(pedal_takes_the_next_tool_and_a_new_choice_ends_that),
        cmocka_unit_test(demo_pushes_once_as_deep_as_it_goes),
        cmocka_unit_test(walks_stay_bounded),
        cmocka_unit_test(shipped_faces_do_not_fold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
