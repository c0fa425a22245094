/* plugins/one_hand: the neutral pose, and what each channel of the muppet+ map moves. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "one_hand_bench.h"

static const char *const modes[] = {"mode=classic", "mode=mask", "mode=layered_waldo"};

static void neutral_hand_gives_exactly_the_rest_face(void **state)
{
    (void)state;
    for (size_t m = 0; m < COUNT_OF(modes); ++m)
        for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
            bench b;
            bench_set_up_on(&b, &bench_face, modes[m]); /* the neutral pose: of 20 samples */
            for (int i = 0; i < 60; ++i) {
                bench_talk_for(&b, side, 1);
                assert_true(bench_is_rest(&b));
                assert_int_equal(b.pull.anchor, 1);
            }
            bench_tear_down(&b);
        }
}

static void neutral_pose_is_the_mean_of_the_samples_asked_for(void **state)
{
    (void)state;
    bench b;
    bench_set_up_on(&b, &bench_face,
                    "samples=10,brows.dead_zone=0,brow_tilt.dead_zone=0,"
                    "lids.droop_dead_zone=0");
    for (int i = 0; i < 10; ++i) { /* trembles by 2 deg about the talk pose */
        float deg = i % 2 ? 2.0f : -2.0f;
        bench_bend(&b, MRT_RIGHT, (bends){{{INDEX_MPJ, deg}, {MIDDLE_MPJ, deg}}}, 1);
        assert_true(i == 9 || bench_is_rest(&b));
    }
    bench_talk_for(&b, MRT_RIGHT, 60);
    assert_true(fabsf(bench_pulled(&b, "brow.mid.l").y) < 1e-4f);
    bench_tear_down(&b);
}

static void vectors_start_at_the_contacts_and_name_them(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "");
    bench_bend(&b, MRT_RIGHT, (bends){{{RING_MPJ, -20}}}, 3);
    assert_int_equal(b.pull.count, BENCH_PERFORMED);
    bool seen[BENCH_CONTACTS] = {false};
    for (uint32_t i = 0; i < b.pull.count; ++i) {
        uint32_t contact = b.pull.vector[i].contact - 1;
        assert_false(seen[contact]);
        seen[contact] = true;
        assert_memory_equal(&b.pull.vector[i].start, &bench_contacts[contact].rest,
                            sizeof(mrt_vec3));
    }
    assert_true(isnan(bench_dof(&b, "tongue.curl")));
    bench_tear_down(&b);
}

/* ---- muppet+ ---- */

typedef struct channel {
    const char *name;
    bends bends;        /* of one channel's sensors, well beyond its dead zone */
    float dead_deg;     /* of bends.bend[0], all others in proportion */
    const char *moved;  /* contacts and degrees of freedom; a pair without its side */
    const char *leader; /* whose pull is checked for its direction */
    mrt_vec3 direction; /* unit; of the left one */
} channel;

static const channel channels[] = {
    {"jaw", {{{THUMB_MPJ, -15}, {THUMB_IJ, -15}}}, 0.75f, "jaw.open", NULL, {0, 0, 0}},
    {"jaw by talking", {{{THUMB_MPJ, -12}, {THUMB_ABD, 12}}}, 1.5f, "jaw.open", NULL, {0, 0, 0}},
    {"jaw aside", {{{THUMB_ABD, 15}}}, 3.0f, "jaw.lateral", NULL, {0, 0, 0}},
    {"brows up",
     {{{INDEX_MPJ, -15}, {MIDDLE_MPJ, -15}}},
     2.0f,
     "brow.inner brow.mid brow.outer forehead.mid",
     "brow.mid",
     {0, 1, 0}},
    {"tilt",
     {{{INDEX_MPJ, -1.9f}, {MIDDLE_MPJ, 3.9f}}},
     1.9f * 3.0f / 5.8f,
     "brow.inner brow.outer",
     "brow.inner",
     {0, 1, 0}},
    {"brows down and droop",
     {{{INDEX_MPJ, 20}, {MIDDLE_MPJ, 20}}},
     2.0f,
     "brow.inner brow.mid brow.outer forehead.mid lid",
     "brow.mid",
     {0, -1, 0}},
    {"smile",
     {{{RING_MPJ, -16}, {LITTLE_MPJ, -16}}},
     2.0f,
     "mouth.corner cheek cheek.lower nasolabial lip.upper.side lip.lower.side",
     "mouth.corner",
     {0.550f, 0.749f, -0.370f}},
    {"frown",
     {{{RING_MPJ, 12}, {LITTLE_MPJ, 12}}},
     2.0f,
     "mouth.corner cheek cheek.lower nasolabial lip.upper.side lip.lower.side",
     "mouth.corner",
     {0.120f, -0.981f, -0.150f}},
    {"smirk",
     {{{RING_MPJ, -10}, {LITTLE_MPJ, 10}}},
     4.0f,
     "mouth.corner cheek.lower nasolabial lip.upper.side lip.lower.side",
     NULL,
     {0, 0, 0}},
    {"wide",
     {{{MIDDLE_ABD, 15}, {RING_ABD, 15}, {LITTLE_ABD, 15}}},
     3.0f,
     "mouth.corner cheek.lower nasolabial lip.upper.side lip.lower.side",
     "mouth.corner",
     {0.944f, 0, -0.330f}},
    {"pucker",
     {{{MIDDLE_ABD, -8}, {RING_ABD, -8}, {LITTLE_ABD, -8}}},
     3.0f,
     "mouth.corner cheek.lower nasolabial lip.upper.side lip.lower.side lip.upper.mid "
     "lip.lower.mid",
     "mouth.corner",
     {-0.912f, 0, 0.410f}},
    {"sneer",
     {{{ARCH, 15}}},
     5.0f,
     "nose.wing nasolabial lip.upper.side cheek lip.upper.mid",
     "nasolabial",
     {0.123f, 0.985f, 0.123f}},
    {"upper lip",
     {{{INDEX_PIJ, -15}, {MIDDLE_PIJ, -15}, {RING_PIJ, -15}, {LITTLE_PIJ, -15}}},
     4.0f,
     "lip.upper.mid lip.upper.side skull.nod",
     "lip.upper.mid",
     {0, 0.995f, 0.0995f}},
    {"nod", {{{PITCH, 12}}}, 2.0f, "skull.nod", NULL, {0, 0, 0}},
    {"turn", {{{YAW, 12}}}, 2.0f, "skull.turn", NULL, {0, 0, 0}},
};

/* A name, less its side, is one of the words. */
static bool is_listed(const char *words, const char *name)
{
    char stem[64], word[64];
    snprintf(stem, sizeof stem, "%s", name);
    size_t length = strlen(stem);
    if (strncmp(stem, "lid_", 4) == 0)
        snprintf(stem, sizeof stem, "lid");
    else if (length > 2 && stem[length - 2] == '.')
        stem[length - 2] = '\0';
    for (int used = 0; sscanf(words, "%63s%n", word, &used) == 1; words += used)
        if (strcmp(word, stem) == 0)
            return true;
    return false;
}

static void each_channel_moves_its_own_and_nothing_else(void **state)
{
    (void)state;
    for (size_t c = 0; c < COUNT_OF(channels); ++c) {
        const channel *ch = &channels[c];
        bench b;
        bench_set_up(&b, "");
        bench_talk_for(&b, MRT_RIGHT, 2);
        bench_bend(&b, MRT_RIGHT, ch->bends, 200);
        int moved = 0;
        for (size_t i = 0; i < BENCH_PERFORMED; ++i) {
            float way = bench_length(bench_pulled(&b, bench_contacts[i].name));
            bool listed = is_listed(ch->moved, bench_contacts[i].name);
            if (listed ? way < 0.05f : way > 0.0f)
                fail_msg("%s: %s moves by %g mm", ch->name, bench_contacts[i].name, (double)way);
            moved += listed;
        }
        for (size_t i = 1; i < BENCH_DOFS; ++i) {
            float value = fabsf(bench_dof(&b, bench_dofs[i].name));
            bool listed = is_listed(ch->moved, bench_dofs[i].name);
            if (listed ? value < 0.01f : value > 0.0f)
                fail_msg("%s: %s is %g", ch->name, bench_dofs[i].name, (double)value);
            moved += listed;
        }
        assert_true(moved > 0);
        bench_tear_down(&b);
    }
}

static void assert_along(const char *what, mrt_vec3 pull, mrt_vec3 direction, float side)
{
    float length = bench_length(pull);
    mrt_vec3 d = {pull.x / length - side * direction.x, pull.y / length - direction.y,
                  pull.z / length - direction.z};
    if (bench_length(d) > 0.002f)
        fail_msg("%s: pulls along %g %g %g", what, (double)(pull.x / length),
                 (double)(pull.y / length), (double)(pull.z / length));
}

static void each_channel_pulls_in_its_direction(void **state)
{
    (void)state;
    for (size_t c = 0; c < COUNT_OF(channels); ++c) {
        const channel *ch = &channels[c];
        if (!ch->leader)
            continue;
        bench b;
        char name[64];
        bench_set_up(&b, "");
        bench_talk_for(&b, MRT_RIGHT, 2);
        bench_bend(&b, MRT_RIGHT, ch->bends, 50);
        bool is_pair = strncmp(ch->leader, "lip.upper.mid", 13) != 0;
        for (int side = 0; side < 2; ++side) {
            snprintf(name, sizeof name, "%s%s", ch->leader, !is_pair ? "" : side ? ".r" : ".l");
            assert_along(ch->name, bench_pulled(&b, name), ch->direction, side ? -1.0f : 1.0f);
        }
        bench_tear_down(&b);
    }
}

static void dead_zones_are_exactly_still_inside_and_continuous_at_the_edge(void **state)
{
    (void)state;
    for (size_t c = 0; c < COUNT_OF(channels); ++c) {
        const channel *ch = &channels[c];
        float edge = ch->dead_deg / fabsf(ch->bends.bend[0].deg), fine = 0.001f;
        float angle[MRT_ANGLES];
        bench b;
        bench_set_up(&b, "re-attach_time=0.02");
        bench_talk_for(&b, MRT_RIGHT, 10);
        for (int i = 0; i < 100; ++i) {
            bench_bent(angle, &ch->bends, 0.999f * edge * (float)i / 100.0f);
            bench_step(&b, MRT_RIGHT, angle);
            if (!bench_is_rest(&b))
                fail_msg("%s: moves at %g of its dead zone", ch->name, (double)i / 100);
        }
        mrt_pull before = b.pull;
        float first = 0, most = 0;
        for (int i = 0; i < 2000 && edge + fine * (float)i < 1.0f; ++i) {
            bench_bent(angle, &ch->bends, edge + fine * (float)i);
            bench_step(&b, MRT_RIGHT, angle);
            float jump = bench_jump(&before, &b.pull) + bench_dof_jump(&before, &b.pull);
            if (i < 3)
                first = fmaxf(first, jump);
            most = fmaxf(most, jump);
            before = b.pull;
        }
        /* C1: it sets out slowly; everywhere a thousandth of the way is a small step */
        if (most > 0.03f || first > 0.15f * most || most <= 0.0f)
            fail_msg("%s: steps of %g, at the edge %g", ch->name, (double)most, (double)first);
        bench_tear_down(&b);
    }
}

static void jaw_opens_by_its_gain_with_a_knee(void **state)
{
    (void)state;
    static const struct point {
        float drop_deg, open_deg, tolerance_deg;
    } points[] = {
        {0.0f, 0.0f, 0.0f},
        {1.49f, 0.0f, 0.0f},
        {2.25f + 0.2f * 30.0f / 0.65f, 9.0f, 0.001f}, /* 20 % of the travel, 30 % of the gape */
        {2.25f + 30.0f / 0.65f, 30.0f, 0.001f},       /* 0.65 over the whole travel */
        {90.0f, 30.0f, 0.001f},
        {-30.0f, 0.0f, 0.0f},
    };
    bench b;
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 3);
    for (size_t i = 0; i < COUNT_OF(points); ++i) {
        bench_bend(&b, MRT_RIGHT, (bends){{{THUMB_MPJ, -points[i].drop_deg}}}, 1);
        float open_deg = bench_dof(&b, "jaw.open") / RAD(1.0f);
        if (!(fabsf(open_deg - points[i].open_deg) <= points[i].tolerance_deg))
            fail_msg("a drop of %g opens by %g deg", (double)points[i].drop_deg, (double)open_deg);
    }
    float before = 0;
    for (int i = 0; i < 500; ++i) { /* monotone */
        bench_bend(&b, MRT_RIGHT, (bends){{{THUMB_IJ, -2.0f - 0.1f * (float)i}}}, 1);
        float open = bench_dof(&b, "jaw.open");
        assert_true(open >= before && open - before < RAD(0.2f));
        before = open;
    }
    bench_tear_down(&b);
}

static void ranges_stop_softly_where_they_say(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "reach=100");
    bench_talk_for(&b, MRT_RIGHT, 3);
    bench_bend(&b, MRT_RIGHT, (bends){{{RING_MPJ, -90}, {LITTLE_MPJ, -90}}}, 1);
    assert_true(fabsf(bench_length(bench_pulled(&b, "mouth.corner.l")) - 12.0f) < 0.05f);
    bench_bend(&b, MRT_RIGHT, (bends){{{INDEX_MPJ, -90}, {MIDDLE_MPJ, -90}}}, 1);
    assert_true(fabsf(bench_pulled(&b, "brow.mid.r").y - 10.0f) < 1e-4f);
    bench_bend(&b, MRT_RIGHT, (bends){{{PITCH, 90}, {YAW, -90}}}, 1);
    assert_true(fabsf(bench_dof(&b, "skull.nod") - RAD(20.0f)) < 1e-5f);
    assert_true(fabsf(bench_dof(&b, "skull.turn") + RAD(30.0f)) < 1e-5f);
    bench_set(&b, "reach=5");
    bench_bend(&b, MRT_RIGHT, (bends){{{RING_MPJ, -90}, {LITTLE_MPJ, -90}}}, 1);
    assert_true(fabsf(bench_length(bench_pulled(&b, "mouth.corner.l")) - 5.0f) < 1e-4f);
    bench_tear_down(&b);
}

static void smirk_lifts_the_ring_fingers_side(void **state)
{
    (void)state;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        bench b;
        bench_set_up(&b, "");
        bench_talk_for(&b, side, 3);
        bench_bend(&b, side, (bends){{{RING_MPJ, -10}, {LITTLE_MPJ, 10}}}, 1);
        float left = bench_pulled(&b, "mouth.corner.l").y;
        float right = bench_pulled(&b, "mouth.corner.r").y;
        assert_true(side == MRT_RIGHT ? left > 0.5f : right > 0.5f);
        assert_true(fabsf(left + right) < 1e-5f);
        bench_tear_down(&b);
    }
}

static void intensity_scales_expression_but_not_speech(void **state)
{
    (void)state;
    bench b;
    bends all = {{{THUMB_MPJ, -15}, {INDEX_MPJ, -10}, {MIDDLE_MPJ, -10}}};
    bench_set_up(&b, "");
    bench_talk_for(&b, MRT_RIGHT, 3);
    bench_bend(&b, MRT_RIGHT, all, 1);
    float brow = bench_pulled(&b, "brow.mid.l").y, jaw = bench_dof(&b, "jaw.open");
    bench_set(&b, "intensity=50");
    bench_bend(&b, MRT_RIGHT, all, 1);
    assert_true(fabsf(bench_pulled(&b, "brow.mid.l").y - 0.5f * brow) < 1e-4f);
    assert_true(fabsf(bench_dof(&b, "jaw.open") - jaw) < 1e-6f);
    bench_set(&b, "intensity=100,intensity_pedal=4");
    b.frame.pedal[3] = 1.0f;
    bench_bend(&b, MRT_RIGHT, all, 200);
    assert_true(fabsf(bench_pulled(&b, "brow.mid.l").y - 1.5f * brow) < 1e-3f);
    b.frame.pedal[3] = 0.0f;
    bench_bend(&b, MRT_RIGHT, all, 400);
    assert_true(fabsf(bench_pulled(&b, "brow.mid.l").y) < 1e-3f);
    bench_tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neutral_hand_gives_exactly_the_rest_face),
        cmocka_unit_test(neutral_pose_is_the_mean_of_the_samples_asked_for),
        cmocka_unit_test(vectors_start_at_the_contacts_and_name_them),
        cmocka_unit_test(each_channel_moves_its_own_and_nothing_else),
        cmocka_unit_test(each_channel_pulls_in_its_direction),
        cmocka_unit_test(dead_zones_are_exactly_still_inside_and_continuous_at_the_edge),
        cmocka_unit_test(jaw_opens_by_its_gain_with_a_knee),
        cmocka_unit_test(ranges_stop_softly_where_they_say),
        cmocka_unit_test(smirk_lifts_the_ring_fingers_side),
        cmocka_unit_test(intensity_scales_expression_but_not_speech),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
