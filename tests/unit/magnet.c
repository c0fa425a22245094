/* plugins/magnet, as loaded from the build: one field that bending fingers charge. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mapping_bench.h"

static const bends fist = {{{INDEX_MPJ, 50},
                            {INDEX_PIJ, 50},
                            {MIDDLE_MPJ, 50},
                            {MIDDLE_PIJ, 50},
                            {RING_MPJ, 50},
                            {RING_PIJ, 50}}};
static const bends flat = {{{INDEX_MPJ, -40},
                            {INDEX_PIJ, -40},
                            {MIDDLE_MPJ, -40},
                            {MIDDLE_PIJ, -40},
                            {RING_MPJ, -40},
                            {RING_PIJ, -40}}};

static void hold(bench *b, bends by, int frames)
{
    bench_bend(b, MRT_RIGHT, by, frames);
}

static void pose_at_engage_is_neutral(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "magnet", &bench_face, "");
    hold(&b, fist, 20);
    assert_int_equal(b.pull.mode, MRT_ANCHORED);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

static void fist_draws_out_and_flat_hand_drives_in_or_the_other_way(void **state)
{
    (void)state;
    static const char *const params[] = {"fist=draws_out,inward=100,gather=0",
                                         "fist=drives_in,inward=100,gather=0"};
    for (int other = 0; other < 2; ++other) {
        float sign = other ? -1.0f : 1.0f;
        bench b;
        bench_open(&b, "magnet", &bench_face, params[other]);
        bench_talk_for(&b, MRT_RIGHT, 2);
        hold(&b, fist, 100);
        assert_true(sign * bench_pulled(&b, "nose.tip").z > 10.0f);
        hold(&b, flat, 100);
        assert_true(sign * bench_pulled(&b, "nose.tip").z < -10.0f);
        bench_tear_down(&b);
    }
}

static void strength_is_largest_in_the_middle_and_bounded(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "magnet", &bench_face, "strength=10,across=50,up=50");
    bench_talk_for(&b, MRT_RIGHT, 2);
    hold(&b, fist, 200);
    mrt_vec3 nose = bench_pulled(&b, "nose.tip"), chin = bench_pulled(&b, "chin");
    assert_true(nose.z > 2.0f * chin.z && chin.z > 0.0f);
    assert_true(nose.z < 0.1f * 225.0f);
    assert_true(bench_pulled(&b, "cheek.l").x < 0.0f); /* gathered to the axis */
    bench_tear_down(&b);
}

static void wrist_moves_it(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "magnet", &bench_face, "gather=0");
    bench_talk_for(&b, MRT_RIGHT, 2);
    bends up = fist;
    up.bend[5] = (bend){PITCH, -25};
    hold(&b, fist, 200);
    float nose = bench_pulled(&b, "nose.tip").z, brow = bench_pulled(&b, "forehead.mid").z;
    hold(&b, up, 200);
    assert_true(bench_pulled(&b, "nose.tip").z < nose - 1.0f);
    assert_true(bench_pulled(&b, "forehead.mid").z > brow + 1.0f);
    bench_tear_down(&b);
}

static void release_and_engage_and_commit_do_not_jump(void **state)
{
    (void)state;
    static const char *const triggers[] = {"Release", "Engage", NULL};
    bench b;
    bench_open(&b, "magnet", &bench_face, "release_time=0.5,ease=0.1");
    bench_talk_for(&b, MRT_RIGHT, 2);
    hold(&b, fist, 100);
    for (int i = 0; triggers[i]; ++i) {
        mrt_pull before = b.pull;
        bench_trigger(&b, triggers[i]);
        hold(&b, fist, 1);
        assert_true(bench_jump(&before, &b.pull) < 2.5f);
        hold(&b, fist, 100);
        assert_true(bench_longest(&b.pull) < 0.1f); /* sprung back; this fist is neutral */
    }
    hold(&b, flat, 100);
    uint32_t anchor = b.pull.anchor;
    bench_trigger(&b, "Commit");
    hold(&b, flat, 1);
    assert_int_equal(b.pull.commit, 1);
    assert_int_equal(b.pull.anchor, anchor + 1);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

static void face_without_contacts_has_a_field_too(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "magnet", &bench_bare, "");
    bench_talk_for(&b, MRT_RIGHT, 2);
    assert_int_equal(b.pull.count, 36);
    assert_int_equal(b.pull.vector[0].contact, 0);
    hold(&b, fist, 100);
    assert_true(bench_longest(&b.pull) > 15.0f);
    bench_tear_down(&b);
}

static void hand_that_comes_back_otherwise_is_followed_gently(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "magnet", &bench_face, "ease=0.1");
    bench_talk_for(&b, MRT_RIGHT, 2);
    hold(&b, fist, 100);
    mrt_pull before = b.pull;
    b.frame.hand[MRT_RIGHT].present = false;
    for (int i = 0; i < 30; ++i)
        assert_true(bench_frame(&b) >= 0);
    assert_true(bench_jump(&before, &b.pull) < 0.01f);
    hold(&b, flat, 1);
    assert_true(bench_jump(&before, &b.pull) < 4.0f);
    bench_tear_down(&b);
}

static void walks_stay_within_strength(void **state)
{
    (void)state;
    static const char *const triggers[] = {"Engage", "Release", "Commit", NULL};
    bench b;
    bench_open(&b, "magnet", &bench_face, "release_pedal=1,engage_pedal=2");
    bench_walk(&b, triggers, 40.0f);
    bench_tear_down(&b);
}

static void shipped_faces_do_not_fold(void **state)
{
    (void)state;
    assert_true(bench_least_determinant("magnet", "moai", "", 600) > 0.0);
    assert_true(bench_least_determinant("magnet", "puppet", "", 600) > 0.0);
}

static void watch_nose(const bench *b, double time_s, void *data)
{
    float *nose = data; /* spread, then a fist */
    float z = bench_pulled(b, "nose.tip").z;
    if (time_s > 10.9 && time_s < 11.6)
        nose[0] = fminf(nose[0], z);
    if (time_s > 12.9 && time_s < 13.8)
        nose[1] = fmaxf(nose[1], z);
}

static void demo_drives_in_spread_and_draws_out_with_its_fist(void **state)
{
    (void)state;
    bench b;
    float nose[2] = {0};
    bench_open(&b, "magnet", &bench_face, "");
    bench_demo(&b, watch_nose, nose);
    print_message("nose %.1f mm, %.1f mm\n", (double)nose[0], (double)nose[1]);
    assert_true(nose[0] < -2.0f && nose[1] > 8.0f);
    bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pose_at_engage_is_neutral),
        cmocka_unit_test(fist_draws_out_and_flat_hand_drives_in_or_the_other_way),
        cmocka_unit_test(strength_is_largest_in_the_middle_and_bounded),
        cmocka_unit_test(wrist_moves_it),
        cmocka_unit_test(release_and_engage_and_commit_do_not_jump),
        cmocka_unit_test(face_without_contacts_has_a_field_too),
        cmocka_unit_test(hand_that_comes_back_otherwise_is_followed_gently),
        cmocka_unit_test(demo_drives_in_spread_and_draws_out_with_its_fist),
        cmocka_unit_test(walks_stay_within_strength),
        cmocka_unit_test(shipped_faces_do_not_fold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
