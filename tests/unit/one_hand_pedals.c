/* plugins/one_hand in time: pedals, holds, layers, blinks, and the neutral pose that is stored. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "one_hand_bench.h"

enum { ANCHOR, HOLD, LAYER };
static const bends talking = {{{THUMB_MPJ, -20}, {RING_MPJ, -15}, {LITTLE_MPJ, -15}}};
static const bends frowning = {{{RING_MPJ, 15}, {LITTLE_MPJ, 15}, {INDEX_MPJ, 15}, {YAW, 10}}};

/* From one pose to another in `steps` frames; returns the greatest step of a contact, mm. */
static float sweep(bench *b, bends from, bends to, int steps)
{
    float most = 0, start[MRT_ANGLES], end[MRT_ANGLES], angle[MRT_ANGLES];
    bench_bent(start, &from, 1);
    bench_bent(end, &to, 1);
    for (int i = 1; i <= steps; ++i) {
        mrt_pull before = b->pull;
        for (int k = 0; k < MRT_ANGLES; ++k)
            angle[k] = start[k] + (end[k] - start[k]) * (float)i / (float)steps;
        bench_step(b, MRT_RIGHT, angle);
        most = fmaxf(most, bench_jump(&before, &b->pull));
    }
    return most;
}

static const bends nothing = {{{0, 0}}};

static void set_up_talking(bench *b, const char *params)
{
    bench_set_up(b, params);
    bench_talk_for(b, MRT_RIGHT, 3);
    (void)sweep(b, nothing, talking, 50);
    assert_true(bench_dof(b, "jaw.open") > 0.15f);
}

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
        set_up_talking(&b, "");
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
    set_up_talking(&b, "");
    mrt_pull before = b.pull;
    b.frame.pedal[ANCHOR] = 1;
    bench_bend(&b, MRT_RIGHT, talking, 3);
    b.frame.pedal[ANCHOR] = 0;
    bench_bend(&b, MRT_RIGHT, talking, 5);
    b.frame.pedal[ANCHOR] = 1;
    bench_bend(&b, MRT_RIGHT, talking, 1);
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
    set_up_talking(&b, "");
    mrt_pull before = b.pull;
    for (int tap = 0; tap < 2; ++tap) {
        b.frame.pedal[ANCHOR] = 1;
        bench_bend(&b, MRT_RIGHT, talking, 3);
        b.frame.pedal[ANCHOR] = 0;
        bench_bend(&b, MRT_RIGHT, talking, 40);
    }
    assert_as_before(&before, &b);
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_false(bench_is_rest(&b));
    bench_tear_down(&b);
}

static void anchors_do_not_ratchet_a_face_apart(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 3);
    for (int i = 0; i < 200; ++i) { /* smile, anchor, let go, anchor ... */
        bends smile = {{{RING_MPJ, i % 2 ? 0.0f : -25.0f}, {LITTLE_MPJ, i % 2 ? 0.0f : -25.0f}}};
        bench_bend(&b, MRT_RIGHT, smile, 60);
        if (i % 2 == 0)
            bench_trigger(&b, "Anchor");
        bench_bend(&b, MRT_RIGHT, smile, 1);
        assert_true(bench_length(bench_pulled(&b, "mouth.corner.l")) < 28.01f);
    }
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
    set_up_talking(&b, "re-attach_time=0.2");
    mrt_pull before = b.pull;
    b.frame.pedal[HOLD] = 1;
    for (int i = 0; i < 50; ++i) {
        (void)sweep(&b, talking, frowning, 2);
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
    set_up_talking(&b, "");
    mrt_pull before = b.pull;
    static const int taps[] = {1, 0, 1, 0};
    for (size_t i = 0; i < COUNT_OF(taps); ++i) {
        b.frame.pedal[HOLD] = (float)taps[i];
        bench_bend(&b, MRT_RIGHT, talking, 4);
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
    set_up_talking(&b, "hold_region=mouth");
    mrt_vec3 corner = bench_pulled(&b, "mouth.corner.l");
    float open = bench_dof(&b, "jaw.open");
    bench_set(&b, "hold=on"); /* the switch in the panel, as good as the pedal */
    (void)sweep(&b, talking, frowning, 50);
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
    set_up_talking(&b, "");
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
        set_up_talking(&b, "neutral_time=0.25");
        b.frame.pedal[first] = 1;
        bench_bend(&b, MRT_RIGHT, talking, 4);
        b.frame.pedal[ANCHOR + HOLD - first] = 1;
        mrt_pull before = b.pull;
        bench_bend(&b, MRT_RIGHT, talking, 1);
        assert_as_before(&before, &b);
        float open = bench_dof(&b, "jaw.open");
        for (int i = 0; i < 24; ++i) {
            bench_bend(&b, MRT_RIGHT, talking, 1);
            assert_true(bench_dof(&b, "jaw.open") < open && bench_dof(&b, "jaw.open") > 0.0f);
            open = bench_dof(&b, "jaw.open");
        }
        bench_bend(&b, MRT_RIGHT, talking, 2);
        assert_true(bench_is_rest(&b)); /* with both feet still down */
        b.frame.pedal[ANCHOR] = b.frame.pedal[HOLD] = 0;
        bench_bend(&b, MRT_RIGHT, talking, 40);
        assert_true(bench_is_rest(&b));
        bench_tear_down(&b);
    }
}

static void one_pedal_for_both_anchors_at_once_and_freezes_when_held(void **state)
{
    (void)state;
    bench b;
    set_up_talking(&b, "hold_pedal=1");
    mrt_pull before = b.pull;
    b.frame.pedal[ANCHOR] = 1;
    bench_bend(&b, MRT_RIGHT, talking, 33); /* more than 300 ms */
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
    set_up_talking(&b, "other_layer=head");
    float open = bench_dof(&b, "jaw.open");
    mrt_pull before = b.pull;
    b.frame.pedal[LAYER] = 1;
    assert_true(sweep(&b, talking, frowning, 40) <= 0.0f); /* no contact is the head's */
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
    (void)sweep(b, nothing, all, 40);
    int moved = fabsf(bench_pulled(b, "mouth.corner.l").y - corner) > 1.0f;
    moved |= (fabsf(bench_pulled(b, "brow.mid.l").y - brow) > 1.0f) << 1;
    moved |= (fabsf(bench_dof(b, "skull.turn") - turn) > 0.05f) << 2;
    (void)sweep(b, all, nothing, 40);
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
    (void)sweep(&b, nothing, talking, 50);
    mrt_vec3 corner = bench_pulled(&b, "mouth.corner.r");
    assert_true(corner.y > 2.0f);
    bench_trigger(&b, "Next layer");
    (void)sweep(&b, talking, frowning, 50);
    assert_true(bench_pulled(&b, "brow.mid.l").y < -1.0f);
    mrt_vec3 kept = bench_pulled(&b, "mouth.corner.r");
    assert_memory_equal(&corner, &kept, sizeof kept);
    bench_tear_down(&b);
}

static void a_change_of_mode_does_not_jump(void **state)
{
    (void)state;
    static const char *const modes[] = {"mode=mask", "mode=layered_waldo", "mode=muppet+"};
    bench b;
    set_up_talking(&b, "");
    for (size_t m = 0; m < COUNT_OF(modes); ++m) {
        mrt_pull before = b.pull;
        bench_set(&b, modes[m]);
        bench_bend(&b, MRT_RIGHT, talking, 1);
        assert_true(bench_jump(&before, &b.pull) < 1e-5f);
        for (int i = 0; i < 40; ++i) {
            before = b.pull;
            bench_bend(&b, MRT_RIGHT, talking, 1);
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
    set_up_talking(&b, "");
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

static void lids_do_not_jump_when_a_blink_meets_a_droop(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 5);
    (void)sweep(&b, nothing, (bends){{{MIDDLE_MPJ, 20}}}, 60);
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
    bench_bend(&b, MRT_RIGHT, talking, 1); /* engages with another pose */
    assert_true(bench_is_rest(&b));        /* at first */
    bench_bend(&b, MRT_RIGHT, talking, 40);
    float open = bench_dof(&b, "jaw.open");
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_true(bench_is_rest(&b));
    bench_tear_down(&b);
    set_up_talking(&b, ""); /* as if the talk pose had been neutral at engage */
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
        cmocka_unit_test(a_quick_bend_blinks_and_a_slow_one_does_not),
        cmocka_unit_test(a_blink_closes_in_80_ms_and_opens_in_150),
        cmocka_unit_test(a_slow_bend_droops_as_far_as_its_range),
        cmocka_unit_test(lids_do_not_jump_when_a_blink_meets_a_droop),
        cmocka_unit_test(stored_neutral_comes_back),
        cmocka_unit_test(bytes_that_are_no_stored_neutral_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
