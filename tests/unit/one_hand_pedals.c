/* plugins/one_hand in time: anchors, holds, layers, modes, and hands that come and go. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "one_hand_bench.h"

enum { ANCHOR, HOLD, LAYER };
static const bends frowning = {{{RING_MPJ, 15}, {LITTLE_MPJ, 15}, {INDEX_MPJ, 15}, {YAW, 10}}};

static void assert_as_before(const mrt_pull *before, const bench *b)
{
    assert_true(bench_jump(before, &b->pull) <= 0.0f);
    assert_true(bench_dof_jump(before, &b->pull) <= 0.0f);
}

/* ---- anchor ---- */

static void anchor_takes_a_new_neutral_in_the_same_frame_without_a_jump(void **state)
{
    (void)state;
    for (int by_button = 0; by_button < 2; ++by_button) {
        bench b;
        bench_set_up_talking(&b, "");
        mrt_pull before = b.pull;
        if (by_button)
            bench_trigger(&b, "Anchor");
        else
            b.frame.pedal[ANCHOR] = 1;
        bench_bend(&b, MRT_RIGHT, frowning, 1); /* the hand is elsewhere in that very frame */
        assert_as_before(&before, &b);
        bench_bend(&b, MRT_RIGHT, frowning, 50); /* and the face stays as long as it stays */
        assert_as_before(&before, &b);
        assert_int_equal(b.pull.anchor, before.anchor); /* the starts are the contacts' */
        bends more = frowning;
        more.bend[2].deg -= 10; /* from the new neutral, the index finger lifts the brows */
        bench_bend(&b, MRT_RIGHT, more, 1);
        assert_true(bench_pulled(&b, "brow.mid.l").y > 3.0f);
        bench_tear_down(&b);
    }
}

static void a_second_tap_reverts_the_first(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "");
    mrt_pull before = b.pull;
    b.frame.pedal[ANCHOR] = 1;
    bench_bend(&b, MRT_RIGHT, bench_talking, 3);
    b.frame.pedal[ANCHOR] = 0;
    bench_bend(&b, MRT_RIGHT, bench_talking, 5);
    b.frame.pedal[ANCHOR] = 1;
    bench_bend(&b, MRT_RIGHT, bench_talking, 1);
    b.frame.pedal[ANCHOR] = 0;
    assert_as_before(&before, &b);
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_true(bench_is_rest(&b)); /* the old neutral is in force again */
    bench_tear_down(&b);
}

static void two_slow_taps_are_two_anchors(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "");
    mrt_pull before = b.pull;
    for (int tap = 0; tap < 2; ++tap) {
        b.frame.pedal[ANCHOR] = 1;
        bench_bend(&b, MRT_RIGHT, bench_talking, 3);
        b.frame.pedal[ANCHOR] = 0;
        bench_bend(&b, MRT_RIGHT, bench_talking, 40);
    }
    assert_as_before(&before, &b);
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_false(bench_is_rest(&b));
    bench_tear_down(&b);
}

static void anchors_do_not_ratchet_a_face_apart(void **state)
{
    (void)state;
    static const bends smile = {{{RING_MPJ, -25}, {LITTLE_MPJ, -25}}};
    bench b;
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 3);
    for (int i = 0; i < 100; ++i) { /* a smile gives more than letting go of it takes */
        bench_bend(&b, MRT_RIGHT, smile, 20);
        bench_trigger(&b, "Anchor");
        bench_bend(&b, MRT_RIGHT, smile, 1);
        bench_talk_for(&b, MRT_RIGHT, 20);
        bench_trigger(&b, "Anchor");
        bench_talk_for(&b, MRT_RIGHT, 1);
    }
    mrt_vec3 kept = bench_pulled(&b, "mouth.corner.l");
    assert_true(bench_length(kept) > 11.5f && bench_length(kept) < 13.01f); /* at its reach */
    bench_bend(&b, MRT_RIGHT, smile, 30);
    assert_true(bench_pulled(&b, "mouth.corner.l").y > kept.y + 1.0f); /* and still obeys */
    bench_trigger(&b, "Ease to neutral");
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_true(bench_is_rest(&b));
    bench_tear_down(&b);
}

/* ---- hold ---- */

static void hold_freezes_and_lets_the_face_come_back_in_its_time(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "re-attach_time=0.2");
    mrt_pull before = b.pull;
    b.frame.pedal[HOLD] = 1;
    for (int i = 0; i < 50; ++i) {
        (void)bench_sweep(&b, bench_talking, frowning, 2);
        assert_as_before(&before, &b);
    }
    b.frame.pedal[HOLD] = 0;
    bench_bend(&b, MRT_RIGHT, frowning, 1);
    assert_as_before(&before, &b); /* the frame of the release */
    float all = 0, most = 0;
    for (int i = 0; i < 20; ++i) {
        mrt_pull last = b.pull;
        bench_bend(&b, MRT_RIGHT, frowning, 1);
        most = fmaxf(most, bench_jump(&last, &b.pull));
        all = fmaxf(all, bench_jump(&before, &b.pull));
    }
    assert_true(all > 10.0f);
    assert_true(most < 1.0f / 20.0f * 1.88f * all); /* minimum jerk: 1.875 times the mean speed */
    mrt_pull back = b.pull;
    bench_bend(&b, MRT_RIGHT, frowning, 20);
    assert_as_before(&back, &b); /* 200 ms and no longer */
    assert_true(bench_pulled(&b, "mouth.corner.l").y < -3.0f);
    bench_tear_down(&b);
}

static void double_tap_latches_the_hold_until_the_next_press(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "");
    mrt_pull before = b.pull;
    static const int taps[] = {1, 0, 1, 0};
    for (size_t i = 0; i < COUNT_OF(taps); ++i) {
        b.frame.pedal[HOLD] = (float)taps[i];
        bench_bend(&b, MRT_RIGHT, bench_talking, 4);
    }
    bench_bend(&b, MRT_RIGHT, frowning, 200);
    assert_as_before(&before, &b);
    b.frame.pedal[HOLD] = 1;
    bench_bend(&b, MRT_RIGHT, frowning, 40);
    assert_as_before(&before, &b);
    b.frame.pedal[HOLD] = 0;
    bench_bend(&b, MRT_RIGHT, frowning, 40);
    assert_true(bench_pulled(&b, "mouth.corner.l").y < -3.0f);
    bench_tear_down(&b);
}

static void hold_region_freezes_only_its_part(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "hold_region=mouth");
    mrt_vec3 corner = bench_pulled(&b, "mouth.corner.l");
    float open = bench_dof(&b, "jaw.open");
    bench_set(&b, "hold=on"); /* the switch in the panel, as good as the pedal */
    (void)bench_sweep(&b, bench_talking, frowning, 50);
    mrt_vec3 kept = bench_pulled(&b, "mouth.corner.l");
    assert_memory_equal(&corner, &kept, sizeof kept);
    assert_true(fabsf(bench_dof(&b, "jaw.open") - open) <= 0.0f);
    assert_true(bench_pulled(&b, "brow.mid.l").y < -1.0f);
    assert_true(bench_dof(&b, "skull.turn") > 0.05f);
    bench_tear_down(&b);
}

static void re_anchor_while_held_keeps_the_frozen_face(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "");
    mrt_pull before = b.pull;
    b.frame.pedal[HOLD] = 1;
    bench_bend(&b, MRT_RIGHT, frowning, 60); /* long after: no chord */
    b.frame.pedal[ANCHOR] = 1;
    bench_bend(&b, MRT_RIGHT, frowning, 5);
    b.frame.pedal[ANCHOR] = b.frame.pedal[HOLD] = 0;
    bench_bend(&b, MRT_RIGHT, frowning, 60);
    assert_as_before(&before, &b); /* the hand has a comfortable place for the same face */
    bench_tear_down(&b);
}

static void chord_eases_to_neutral(void **state)
{
    (void)state;
    for (int first = ANCHOR; first <= HOLD; ++first) { /* in either order */
        bench b;
        bench_set_up_talking(&b, "neutral_time=0.25");
        b.frame.pedal[first] = 1;
        bench_bend(&b, MRT_RIGHT, bench_talking, 4);
        b.frame.pedal[ANCHOR + HOLD - first] = 1;
        mrt_pull before = b.pull;
        bench_bend(&b, MRT_RIGHT, bench_talking, 1);
        assert_as_before(&before, &b);
        float open = bench_dof(&b, "jaw.open");
        for (int i = 0; i < 24; ++i) {
            bench_bend(&b, MRT_RIGHT, bench_talking, 1);
            assert_true(bench_dof(&b, "jaw.open") < open && bench_dof(&b, "jaw.open") > 0.0f);
            open = bench_dof(&b, "jaw.open");
        }
        bench_bend(&b, MRT_RIGHT, bench_talking, 2);
        assert_true(bench_is_rest(&b)); /* with both feet still down */
        b.frame.pedal[ANCHOR] = b.frame.pedal[HOLD] = 0;
        bench_bend(&b, MRT_RIGHT, bench_talking, 40);
        assert_true(bench_is_rest(&b));
        bench_tear_down(&b);
    }
}

static void one_pedal_for_both_anchors_at_once_and_freezes_when_held(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "hold_pedal=1");
    mrt_pull before = b.pull;
    b.frame.pedal[ANCHOR] = 1;
    bench_bend(&b, MRT_RIGHT, bench_talking, 33); /* more than 300 ms */
    assert_as_before(&before, &b);
    bench_bend(&b, MRT_RIGHT, frowning, 30);
    assert_as_before(&before, &b);
    b.frame.pedal[ANCHOR] = 0;
    bench_bend(&b, MRT_RIGHT, frowning, 40);
    assert_true(bench_jump(&before, &b.pull) > 3.0f);
    bench_tear_down(&b);
}

/* ---- layers ---- */

static void layer_pedal_gives_the_hand_another_layer_while_it_is_down(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "other_layer=head");
    float open = bench_dof(&b, "jaw.open");
    mrt_pull before = b.pull;
    b.frame.pedal[LAYER] = 1;
    assert_true(bench_sweep(&b, bench_talking, frowning, 40) <=
                0.0f); /* no contact is the head's */
    assert_true(fabsf(bench_dof(&b, "jaw.open") - open) <= 0.0f);
    assert_true(bench_dof(&b, "skull.turn") > 0.05f);
    b.frame.pedal[LAYER] = 0;
    bench_bend(&b, MRT_RIGHT, frowning, 1);
    assert_true(bench_jump(&before, &b.pull) <= 0.0f);
    bench_bend(&b, MRT_RIGHT, frowning, 40);
    assert_true(bench_pulled(&b, "mouth.corner.l").y < -3.0f);
    bench_tear_down(&b);
}

/* Which layers a movement of everything moves: bits of mouth, brows, head. */
static int moved_layers(bench *b)
{
    static const bends all = {{{THUMB_MPJ, -20},
                               {INDEX_MPJ, -20},
                               {RING_MPJ, -20},
                               {LITTLE_MPJ, -20},
                               {PITCH, 10},
                               {YAW, 10}}};
    float brow = bench_pulled(b, "brow.mid.l").y, corner = bench_pulled(b, "mouth.corner.l").y;
    float turn = bench_dof(b, "skull.turn");
    (void)bench_sweep(b, bench_nothing, all, 40);
    int moved = fabsf(bench_pulled(b, "mouth.corner.l").y - corner) > 1.0f;
    moved |= (fabsf(bench_pulled(b, "brow.mid.l").y - brow) > 1.0f) << 1;
    moved |= (fabsf(bench_dof(b, "skull.turn") - turn) > 0.05f) << 2;
    (void)bench_sweep(b, all, bench_nothing, 40);
    return moved;
}

static void waldo_moves_one_layer_and_holds_the_others(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "mode=layered_waldo,layer=mouth");
    bench_talk_for(&b, MRT_RIGHT, 30);
    assert_int_equal(moved_layers(&b), 1);
    b.frame.pedal[LAYER] = 1; /* the next one, for a moment */
    bench_talk_for(&b, MRT_RIGHT, 30);
    assert_int_equal(moved_layers(&b), 2);
    b.frame.pedal[LAYER] = 0;
    bench_talk_for(&b, MRT_RIGHT, 30);
    assert_int_equal(moved_layers(&b), 1);
    static const int expected[] = {2, 4, 1};
    for (int i = 0; i < 3; ++i) {
        bench_trigger(&b, "Next layer");
        bench_talk_for(&b, MRT_RIGHT, 30);
        assert_int_equal(moved_layers(&b), expected[i]);
    }
    static const int taps[] = {1, 0, 1, 0};
    for (size_t i = 0; i < COUNT_OF(taps); ++i) { /* a double tap stays */
        b.frame.pedal[LAYER] = (float)taps[i];
        bench_talk_for(&b, MRT_RIGHT, 4);
    }
    bench_talk_for(&b, MRT_RIGHT, 30);
    assert_int_equal(moved_layers(&b), 2);
    bench_tear_down(&b);
}

static void a_layer_left_behind_keeps_its_face(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "mode=layered_waldo");
    bench_talk_for(&b, MRT_RIGHT, 3);
    (void)bench_sweep(&b, bench_nothing, bench_talking, 50);
    mrt_vec3 corner = bench_pulled(&b, "mouth.corner.r");
    assert_true(corner.y > 2.0f);
    bench_trigger(&b, "Next layer");
    (void)bench_sweep(&b, bench_talking, frowning, 50);
    assert_true(bench_pulled(&b, "brow.mid.l").y < -1.0f);
    mrt_vec3 kept = bench_pulled(&b, "mouth.corner.r");
    assert_memory_equal(&corner, &kept, sizeof kept);
    bench_tear_down(&b);
}

static void a_change_of_mode_does_not_jump(void **state)
{
    (void)state;
    static const char *const modes[] = {"mode=mask", "mode=layered_waldo", "mode=classic"};
    bench b;
    bench_set_up_talking(&b, "");
    for (size_t m = 0; m < COUNT_OF(modes); ++m) {
        mrt_pull before = b.pull;
        bench_set(&b, modes[m]);
        bench_bend(&b, MRT_RIGHT, bench_talking, 1);
        assert_true(bench_jump(&before, &b.pull) < 1e-5f);
        for (int i = 0; i < 40; ++i) {
            before = b.pull;
            bench_bend(&b, MRT_RIGHT, bench_talking, 1);
            assert_true(bench_jump(&before, &b.pull) < 2.5f);
        }
    }
    bench_tear_down(&b);
}

/* ---- hands that come and go ---- */

static void a_hand_that_is_lost_leaves_its_face_and_comes_back_without_a_jump(void **state)
{
    (void)state;
    bench b;
    bench_set_up_talking(&b, "");
    mrt_pull before = b.pull;
    b.frame.hand[MRT_RIGHT].present = false;
    for (int i = 0; i < 20; ++i)
        assert_int_equal(bench_frame(&b), MRT_OK);
    assert_as_before(&before, &b);
    bench_bend(&b, MRT_RIGHT, frowning, 1);
    assert_as_before(&before, &b);
    bench_bend(&b, MRT_RIGHT, frowning, 40);
    assert_true(bench_pulled(&b, "mouth.corner.l").y < -3.0f);
    bench_tear_down(&b);
}

static void no_hand_yet_says_nothing(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "");
    b.frame.pedal[ANCHOR] = 1;
    assert_int_equal(bench_frame(&b), MRT_HOLD);
    bench_pose(&b, MRT_RIGHT, bench_talk);
    b.frame.hand[MRT_RIGHT].angle[3] = NAN; /* a hand that makes no sense is none */
    assert_int_equal(bench_frame(&b), MRT_HOLD);
    bench_talk_for(&b, MRT_RIGHT, 1);
    assert_true(bench_is_rest(&b));
    bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anchor_takes_a_new_neutral_in_the_same_frame_without_a_jump),
        cmocka_unit_test(a_second_tap_reverts_the_first),
        cmocka_unit_test(two_slow_taps_are_two_anchors),
        cmocka_unit_test(anchors_do_not_ratchet_a_face_apart),
        cmocka_unit_test(hold_freezes_and_lets_the_face_come_back_in_its_time),
        cmocka_unit_test(double_tap_latches_the_hold_until_the_next_press),
        cmocka_unit_test(hold_region_freezes_only_its_part),
        cmocka_unit_test(re_anchor_while_held_keeps_the_frozen_face),
        cmocka_unit_test(chord_eases_to_neutral),
        cmocka_unit_test(one_pedal_for_both_anchors_at_once_and_freezes_when_held),
        cmocka_unit_test(layer_pedal_gives_the_hand_another_layer_while_it_is_down),
        cmocka_unit_test(waldo_moves_one_layer_and_holds_the_others),
        cmocka_unit_test(a_layer_left_behind_keeps_its_face),
        cmocka_unit_test(a_change_of_mode_does_not_jump),
        cmocka_unit_test(a_hand_that_is_lost_leaves_its_face_and_comes_back_without_a_jump),
        cmocka_unit_test(no_hand_yet_says_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
