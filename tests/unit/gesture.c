/* plugins/gesture, as loaded from the build: what it recognises, and what the face does then. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mapping_bench.h"

/* Fingers as the shipped gestures have them, and one that nobody taught. */
static const bends pointing = {{{INDEX_MPJ, -35}, {INDEX_PIJ, -21}, {MIDDLE_MPJ, -5}}};
static const bends odd = {{{MIDDLE_MPJ, 35}, {MIDDLE_PIJ, 40}, {RING_MPJ, -30}, {THUMB_ABD, -15}}};
static const bends nearly_pointing = {{{INDEX_MPJ, -29}, {INDEX_PIJ, -17}}};

static float smile(const bench *b)
{
    return bench_pulled(b, "mouth.corner.l").y;
}

static float brow(const bench *b)
{
    return bench_pulled(b, "brow.mid.l").y;
}

static void hold(bench *b, bends by, int frames)
{
    bench_bend(b, MRT_RIGHT, by, frames);
}

static void face_rests_until_a_gesture_is_made(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "gesture", &bench_face, "");
    bench_talk_for(&b, MRT_RIGHT, 200);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    assert_int_equal(b.pull.mode, MRT_ANCHORED);
    hold(&b, odd, 200); /* rejected: it is like none of them */
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

static void shipped_gesture_plays_attack_hold_release(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "gesture", &bench_face, "dwell=0.1,attack=0.2,hold=0.3,release=0.4,sustain=off");
    bench_talk_for(&b, MRT_RIGHT, 10);
    hold(&b, pointing, 10);
    assert_true(bench_longest(&b.pull) <= 0.0f); /* it dwells */
    hold(&b, pointing, 25);
    float full = brow(&b);
    assert_true(full > 9.0f);
    assert_true(bench_pulled(&b, "mouth.corner.l").y <= 0.0f); /* the rest stays */
    hold(&b, pointing, 20);
    assert_true(fabsf(brow(&b) - full) < 1e-3f);
    hold(&b, pointing, 60); /* once; held on it does not start again */
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

static void sustain_stays_while_the_gesture_is_held(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "gesture", &bench_face, "hold=0.1,release=0.2,sustain=on");
    hold(&b, pointing, 300);
    assert_true(brow(&b) > 9.0f);
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

/* 2 deg more or less at the border do not set it off again and again. */
static void leaving_needs_more_than_coming(void **state)
{
    (void)state;
    bench b;
    int rises = 0;
    bench_open(&b, "gesture", &bench_face,
               "attack=0.05,hold=0.05,release=0.05,sustain=off,dwell=0.02");
    hold(&b, pointing, 30);
    for (int i = 0; i < 200; ++i) {
        float before = brow(&b);
        hold(&b, i / 5 % 2 ? pointing : nearly_pointing, 1);
        rises += brow(&b) > before;
    }
    assert_int_equal(rises, 0);
    bench_tear_down(&b);
}

static void taught_gesture_replaces_the_shipped_one(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "gesture", &bench_face, "gesture_2=smile,gesture_3=nothing");
    hold(&b, odd, 40);
    bench_trigger(&b, "Teach 2");
    hold(&b, odd, 100); /* it is being made: nothing yet */
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_talk_for(&b, MRT_RIGHT, 30);
    hold(&b, pointing, 100); /* no longer a gesture */
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_talk_for(&b, MRT_RIGHT, 30);
    hold(&b, odd, 100);
    assert_true(smile(&b) > 5.0f);
    bench_trigger(&b, "Forget");
    bench_talk_for(&b, MRT_RIGHT, 100);
    hold(&b, pointing, 100);
    assert_true(smile(&b) > 5.0f);
    bench_tear_down(&b);
}

static void teaching_takes_the_mean_of_a_trembling_hand(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "gesture", &bench_face, "gesture_1=smile,reject=2,leave=2");
    bends one = odd, other = odd;
    one.bend[4] = (bend){LITTLE_MPJ, -14};
    other.bend[4] = (bend){LITTLE_MPJ, 14};
    for (int i = 0; i < 60; ++i)
        hold(&b, i % 2 ? one : other, 1);
    bench_trigger(&b, "Teach 1");
    hold(&b, odd, 1);
    bench_talk_for(&b, MRT_RIGHT, 30);
    hold(&b, one, 100);
    assert_true(smile(&b) <= 0.0f); /* 3.5 deg away */
    hold(&b, odd, 100);
    assert_true(smile(&b) > 5.0f);
    bench_tear_down(&b);
}

static void teaching_without_a_hand_says_so(void **state)
{
    (void)state;
    bench b;
    log_record record = {0};
    bench_open(&b, "gesture", &bench_face, "");
    while (log_pop(b.log, &record)) {
    }
    bench_trigger(&b, "Teach 1");
    assert_int_equal(bench_frame(&b), MRT_OK);
    assert_true(log_pop(b.log, &record) && record.level == MRT_LOG_WARNING);
    bench_tear_down(&b);
}

static void state_keeps_what_was_taught_over_a_reset(void **state)
{
    (void)state;
    bench b, again;
    unsigned char bytes[4096];
    bench_open(&b, "gesture", &bench_face, "");
    hold(&b, odd, 40);
    bench_trigger(&b, "Teach 3");
    hold(&b, odd, 1);
    size_t size = b.state->save(b.plugin.self, bytes, sizeof bytes);
    assert_in_range(size, 1, sizeof bytes);
    bench_open(&again, "gesture", &bench_face, "");
    assert_int_equal(again.state->load(again.plugin.self, bytes, size), MRT_OK);
    again.functions->reset(again.plugin.self);
    hold(&again, odd, 100);
    assert_true(smile(&again) > 5.0f);
    bytes[size / 2] ^= 1;
    assert_int_equal(again.state->load(again.plugin.self, bytes, size), MRT_ERR_FORMAT);
    bench_tear_down(&b);
    bench_tear_down(&again);
}

static void an_action_goes_on_while_the_hand_is_away_and_nothing_jumps(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "gesture", &bench_face, "attack=0.2,hold=0.1,release=0.2");
    hold(&b, pointing, 20);
    float most = 0;
    b.frame.hand[MRT_RIGHT].present = false;
    for (int i = 0; i < 80; ++i) {
        mrt_pull before = b.pull;
        assert_int_equal(bench_frame(&b), MRT_OK);
        most = fmaxf(most, bench_jump(&before, &b.pull));
    }
    assert_true(most > 0.2f && most < 1.2f); /* 10 mm in 0.2 s: 0.94 mm at most */
    assert_true(bench_longest(&b.pull) <= 0.0f);
    bench_tear_down(&b);
}

static void face_without_names_is_refused_with_a_sentence(void **state)
{
    (void)state;
    assert_true(bench_refuses("gesture", &bench_bare));
}

static void walks_stay_bounded(void **state)
{
    (void)state;
    static const char *const triggers[] = {"Teach 1", "Teach 2", "Teach 3",
                                           "Teach 4", "Forget",  NULL};
    bench b;
    bench_open(&b, "gesture", &bench_face, "reject=20,leave=25,dwell=0");
    bench_walk(&b, triggers, 25.0f);
    bench_tear_down(&b);
}

static void shipped_faces_do_not_fold(void **state)
{
    (void)state;
    static const char params[] = "gesture_1=smile,gesture_2=brows_up,gesture_3=jaw_drop,"
                                 "gesture_4=frown,reject=40,leave=60,dwell=0,amount=120";
    assert_true(bench_least_determinant("gesture", "moai", params, 600) > 0.0);
    assert_true(bench_least_determinant("gesture", "puppet", params, 600) > 0.0);
}

/* When the demo does something: at full, and not before. */
static void watch_gestures(const bench *b, double time_s, void *data)
{
    double *at_s = data;
    if (at_s[0] < 0.0 && brow(b) > 9.0f)
        at_s[0] = time_s;
    if (at_s[1] < 0.0 && smile(b) > 7.0f)
        at_s[1] = time_s;
    if (at_s[2] < 0.0 && bench_dof(b, "jaw.open") > 0.35f)
        at_s[2] = time_s;
}

/* It lifts its index finger at 8.8 s, spreads at 11 s and makes a fist at 13 s. */
static void demo_makes_three_gestures_at_their_times(void **state)
{
    (void)state;
    bench b;
    double at_s[3] = {-1, -1, -1};
    bench_open(&b, "gesture", &bench_face, "");
    bench_demo(&b, watch_gestures, at_s);
    print_message("brows %.2f s, smile %.2f s, jaw %.2f s\n", at_s[0], at_s[1], at_s[2]);
    assert_true(at_s[0] > 8.6 && at_s[0] < 9.2);
    assert_true(at_s[1] > 10.7 && at_s[1] < 11.4);
    assert_true(at_s[2] > 12.9 && at_s[2] < 13.6);
    bench_tear_down(&b);
}

/* By its name; a pose that the face lacks leaves the action. */
static void a_gesture_plays_the_pose_of_the_rig_that_was_chosen(void **state)
{
    (void)state;
    bench b;
    bench_open(&b, "gesture", &bench_face, "pose_2=joy,pose_3=grin");
    bench_give_joy(&b);
    bench_talk_for(&b, MRT_RIGHT, 10);
    hold(&b, pointing, 60);
    assert_true(fabsf(smile(&b) - 7.0f) < 1e-3f);
    assert_true(fabsf(brow(&b)) <= 0.0f); /* not the action of the gesture */
    const uint32_t anchor = b.pull.anchor;
    hold(&b, pointing, 10);
    assert_int_equal(b.pull.anchor, anchor);
    bench_talk_for(&b, MRT_RIGHT, 100);
    assert_true(bench_longest(&b.pull) <= 1e-6f);
    bench_tear_down(&b);
    bench_open(&b, "gesture", &bench_face, "pose_2=grin");
    bench_give_joy(&b);
    bench_talk_for(&b, MRT_RIGHT, 10);
    hold(&b, pointing, 60);
    assert_true(brow(&b) > 9.0f);
    bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(face_rests_until_a_gesture_is_made),
        cmocka_unit_test(shipped_gesture_plays_attack_hold_release),
        cmocka_unit_test(sustain_stays_while_the_gesture_is_held),
        cmocka_unit_test(leaving_needs_more_than_coming),
        cmocka_unit_test(taught_gesture_replaces_the_shipped_one),
        cmocka_unit_test(teaching_takes_the_mean_of_a_trembling_hand),
        cmocka_unit_test(teaching_without_a_hand_says_so),
        cmocka_unit_test(state_keeps_what_was_taught_over_a_reset),
        cmocka_unit_test(an_action_goes_on_while_the_hand_is_away_and_nothing_jumps),
        cmocka_unit_test(demo_makes_three_gestures_at_their_times),
        cmocka_unit_test(face_without_names_is_refused_with_a_sentence),
        cmocka_unit_test(a_gesture_plays_the_pose_of_the_rig_that_was_chosen),
        cmocka_unit_test(walks_stay_bounded),
        cmocka_unit_test(shipped_faces_do_not_fold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
