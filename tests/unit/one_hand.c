/* plugins/one_hand: what each channel of each map moves, on which faces. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "one_hand_bench.h"

static const char *const modes[] = {"mode=muppet+", "mode=mask", "mode=layered_waldo"};

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

/* ---- hands ---- */

static void assert_mirrored(const bench *a, const bench *b)
{
    char other[64];
    for (size_t i = 0; i < BENCH_PERFORMED; ++i) {
        const char *name = bench_contacts[i].name;
        snprintf(other, sizeof other, "%s", name);
        char *end = other + strlen(other) - 1;
        if (end[-1] == '.')
            *end = *end == 'l' ? 'r' : 'l';
        mrt_vec3 p = bench_pulled(a, name), q = bench_pulled(b, other);
        mrt_vec3 d = {p.x + q.x, p.y - q.y, p.z - q.z};
        if (bench_length(d) > 1e-4f)
            fail_msg("%s and %s differ by %g mm", name, other, (double)bench_length(d));
    }
    static const struct pair {
        const char *a, *b;
        float sign;
    } pairs[] = {{"jaw.open", "jaw.open", 1},
                 {"jaw.lateral", "jaw.lateral", -1},
                 {"jaw.forward", "jaw.forward", 1},
                 {"skull.nod", "skull.nod", 1},
                 {"skull.turn", "skull.turn", -1},
                 {"eye.l.yaw", "eye.r.yaw", -1},
                 {"eye.l.pitch", "eye.r.pitch", 1},
                 {"lid_upper.l.close", "lid_upper.r.close", 1},
                 {"lid_lower.l.close", "lid_lower.r.close", 1}};
    for (size_t i = 0; i < COUNT_OF(pairs); ++i)
        assert_true(fabsf(bench_dof(a, pairs[i].a) - pairs[i].sign * bench_dof(b, pairs[i].b)) <
                    1e-5f);
}

/* One pose in which every sensor is somewhere. */
static const float some_deg[MRT_ANGLES] = {5,  -12, -6, 9, -14, -8, 3, -6, 11, 4, 7,
                                           -9, 6,   2,  5, -3,  -7, 3, 6,  12, 8, 9};

static void left_hand_mirrors_the_right(void **state)
{
    (void)state;
    static const char *const maps[] = {
        "mode=muppet+,eyes=50", "mode=mask", "mode=layered_waldo,layer=mouth",
        "mode=layered_waldo,layer=brows_and_lids", "mode=layered_waldo,layer=head"};
    for (size_t m = 0; m < COUNT_OF(maps); ++m) {
        bench b[2];
        for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
            float angle[MRT_ANGLES];
            bench_set_up(&b[side], maps[m]);
            bench_talk_for(&b[side], side, 3);
            for (int k = 1; k <= 40; ++k) {
                for (int i = 0; i < MRT_ANGLES; ++i)
                    angle[i] = bench_talk[i] + RAD(some_deg[i]) * (float)k / 40.0f;
                bench_step(&b[side], side, angle);
            }
        }
        float moved = bench_jump(&b[0].pull, &b[1].pull) + bench_dof_jump(&b[0].pull, &b[1].pull);
        assert_true(moved > 0.01f); /* they are not the same */
        assert_mirrored(&b[0], &b[1]);
        bench_tear_down(&b[0]);
        bench_tear_down(&b[1]);
    }
}

static void the_wanted_hand_performs(void **state)
{
    (void)state;
    static const struct wish {
        const char *params;
        bool left_moves, right_moves;
    } wishes[] = {
        {"hand=either", false, true}, {"hand=left", true, false}, {"hand=right", false, true}};
    for (size_t w = 0; w < COUNT_OF(wishes); ++w)
        for (uint32_t moving = MRT_LEFT; moving <= MRT_RIGHT; ++moving) {
            bench b;
            bench_set_up(&b, wishes[w].params);
            bench_pose(&b, MRT_LEFT, bench_talk);
            bench_talk_for(&b, MRT_RIGHT, 3);
            bench_bend(&b, moving, (bends){{{THUMB_MPJ, -20}}}, 3);
            bool moved = bench_dof(&b, "jaw.open") > 0.1f;
            assert_int_equal(moved,
                             moving == MRT_LEFT ? wishes[w].left_moves : wishes[w].right_moves);
            bench_tear_down(&b);
        }
}

/* ---- mask ---- */

static void mask_gives_each_fingertip_its_place(void **state)
{
    (void)state;
    static const struct finger {
        bends bends;
        const char *moved;
    } fingers[] = {
        {{{{INDEX_MPJ, -25}}}, "brow.inner.l brow.mid.l brow.outer.l"},
        {{{{MIDDLE_MPJ, -25}}}, "brow.inner.r brow.mid.r brow.outer.r"},
        {{{{RING_MPJ, -25}}},
         "mouth.corner.l nasolabial.l cheek.lower.l lip.upper.side.l lip.lower.side.l"},
        {{{{LITTLE_MPJ, -25}}},
         "mouth.corner.r nasolabial.r cheek.lower.r lip.upper.side.r lip.lower.side.r"},
    };
    for (size_t f = 0; f < COUNT_OF(fingers); ++f) {
        bench b;
        bench_set_up(&b, "mode=mask");
        bench_talk_for(&b, MRT_RIGHT, 3);
        bench_bend(&b, MRT_RIGHT, fingers[f].bends, 30);
        for (size_t i = 0; i < BENCH_PERFORMED; ++i) {
            const char *name = bench_contacts[i].name;
            mrt_vec3 pull = bench_pulled(&b, name);
            bool listed = false;
            char word[64];
            const char *words = fingers[f].moved;
            for (int used = 0; sscanf(words, "%63s%n", word, &used) == 1; words += used)
                listed = listed || strcmp(word, name) == 0;
            if (listed ? pull.y < 1.0f : bench_length(pull) > 0.0f) /* stretched: the tip rises */
                fail_msg("finger %zu: %s moves up by %g mm", f, name, (double)pull.y);
        }
        bench_tear_down(&b);
    }
}

static void mask_moves_with_the_fingers_not_with_the_wrist(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "mode=mask,mask.dead_zone=0.01");
    bench_talk_for(&b, MRT_RIGHT, 3);
    bench_bend(&b, MRT_RIGHT, (bends){{{PITCH, 15}, {YAW, -10}}}, 30);
    mrt_pull rest = b.pull;
    for (uint32_t i = 0; i < rest.count; ++i)
        rest.vector[i].end = rest.vector[i].start;
    assert_true(bench_jump(&rest, &b.pull) < 1e-3f);
    bench_tear_down(&b);
}

static void mask_hangs_the_jaw_on_the_thumb(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "mode=mask");
    bench_talk_for(&b, MRT_RIGHT, 3);
    bench_bend(&b, MRT_RIGHT, (bends){{{THUMB_ABD, 20}, {THUMB_MPJ, -15}}}, 30);
    assert_true(bench_dof(&b, "jaw.open") > 0.05f);
    assert_true(bench_length(bench_pulled(&b, "chin")) <= 0.0f); /* the bone does it */
    bench_bend(&b, MRT_RIGHT, (bends){{{THUMB_ABD, -15}, {THUMB_MPJ, 10}}}, 60);
    assert_true(bench_dof(&b, "jaw.open") <= 0.0f);
    assert_true(bench_pulled(&b, "chin").y > 0.5f);
    bench_tear_down(&b);
}

/* ---- faces ---- */

static void a_larger_face_moves_further(void **state)
{
    (void)state;
    mrt_contact large[BENCH_CONTACTS];
    memcpy(large, bench_contacts, sizeof large);
    for (size_t i = 0; i < BENCH_CONTACTS; ++i)
        large[i].rest = (mrt_vec3){2 * large[i].rest.x, 2 * large[i].rest.y, 2 * large[i].rest.z};
    mrt_face face = bench_face;
    face.contacts = large;
    mrt_dof dofs[BENCH_DOFS];
    memcpy(dofs, bench_dofs, sizeof dofs);
    for (size_t i = 0; i < BENCH_DOFS; ++i)
        if (strcmp(dofs[i].unit, "mm") == 0)
            dofs[i].min *= 2, dofs[i].max *= 2;
    face.dofs = dofs;
    mrt_vec3 corner[2];
    float lateral[2];
    for (int k = 0; k < 2; ++k) {
        bench b;
        bench_set_up_on(&b, k ? &face : &bench_face, "samples=1");
        bench_talk_for(&b, MRT_RIGHT, 3);
        bench_bend(&b, MRT_RIGHT, (bends){{{RING_MPJ, -15}, {LITTLE_MPJ, -15}, {THUMB_ABD, 12}}},
                   1);
        corner[k] = bench_pulled(&b, "mouth.corner.r");
        lateral[k] = bench_dof(&b, "jaw.lateral");
        bench_tear_down(&b);
    }
    assert_true(lateral[0] > 1.0f && fabsf(lateral[1] - 2 * lateral[0]) < 1e-4f);
    assert_true(corner[0].x < -1.0f && fabsf(corner[1].x - 2 * corner[0].x) < 1e-3f &&
                fabsf(corner[1].y - 2 * corner[0].y) < 1e-3f);
}

static void logged(bench *b, char *out, size_t capacity)
{
    log_record record;
    size_t used = 0;
    out[0] = '\0';
    while (log_pop(b->log, &record) && used < capacity)
        used += (size_t)snprintf(out + used, capacity - used, "%d %s\n", record.level, record.text);
}

static void a_face_without_anything_to_move_is_refused_with_a_reason(void **state)
{
    (void)state;
    mrt_face faces[] = {{.low = {-75, 0, -75}, .high = {75, 300, 75}}, bench_face};
    faces[1].contacts = &bench_contacts[BENCH_CONTACTS - 1]; /* an ear lobe, a tongue */
    faces[1].contact_count = 1;
    faces[1].dof_count = 1;
    for (size_t i = 0; i < COUNT_OF(faces); ++i) {
        bench b;
        error why = {""};
        bench_create(&b, "");
        b.plugin.failure = &why;
        assert_int_equal(b.functions->activate(b.plugin.self, &faces[i]), MRT_ERR_UNSUPPORTED);
        assert_non_null(strstr(why.text, "rigs/README.md"));
        bench_tear_down(&b);
    }
}

static void what_a_face_lacks_is_said_once_and_the_rest_performs(void **state)
{
    (void)state;
    mrt_face face = bench_face;
    char text[4096];
    bench b;
    face.contact_count = 7; /* chin, lips' middles, nose, forehead, corners */
    face.dof_count = 4;     /* head and jaw.open */
    bench_set_up_on(&b, &face, "samples=1");
    logged(&b, text, sizeof text);
    assert_non_null(strstr(text, "performs 7 of 27 contacts and 3 of 13 degrees of freedom"));
    for (size_t i = 7; i < BENCH_PERFORMED; ++i)
        if (!strstr(text, bench_contacts[i].name))
            fail_msg("%s is not said to be missing: %s", bench_contacts[i].name, text);
    for (size_t i = 4; i < BENCH_DOFS; ++i)
        assert_non_null(strstr(text, bench_dofs[i].name));
    assert_null(strstr(text, " chin"));
    for (const char *line = text; *line; line = strchr(line, '\n') + 1)
        assert_true(strchr(line, '\n') - line < LOG_TEXT - 1); /* none is cut */
    bench_talk_for(&b, MRT_RIGHT, 3);
    bench_bend(&b, MRT_RIGHT, (bends){{{RING_MPJ, -15}, {LITTLE_MPJ, -15}, {THUMB_ABD, 12}}}, 1);
    assert_int_equal(b.pull.count, 7);
    assert_true(bench_pulled(&b, "mouth.corner.l").y > 1.0f);
    assert_true(bench_pulled(&b, "chin").x > 1.0f); /* for want of jaw.lateral */
    assert_true(isnan(b.pull.dof[4]));
    bench_tear_down(&b);
}

static void without_a_jaw_bone_the_chin_is_pulled(void **state)
{
    (void)state;
    mrt_face face = bench_face;
    bench b;
    face.dof_count = 3; /* tongue, nod, turn */
    bench_set_up_on(&b, &face, "samples=1");
    bench_talk_for(&b, MRT_RIGHT, 3);
    bench_bend(&b, MRT_RIGHT, (bends){{{THUMB_MPJ, -60}}}, 1);
    float full_mm = 90.0f * RAD(30.0f);
    assert_true(fabsf(bench_pulled(&b, "chin").y + full_mm) < 0.01f);
    assert_true(bench_pulled(&b, "lip.lower.mid").y < -40.0f);
    assert_true(bench_length(bench_pulled(&b, "lip.upper.mid")) <= 0.0f);
    bench_tear_down(&b);
}

static void frames_alone_make_the_performance(void **state)
{
    (void)state;
    for (size_t m = 0; m < COUNT_OF(modes); ++m) {
        mrt_pull ends[2];
        bench b;
        bench_set_up(&b, modes[m]);
        for (int run = 0; run < 2; ++run) { /* again after a reset: the same bits */
            b.functions->reset(b.plugin.self);
            memset(&b.frame, 0, sizeof b.frame);
            memset(&b.pull, 0, sizeof b.pull);
            for (int i = 0; i < 300; ++i) {
                float angle[MRT_ANGLES];
                for (int k = 0; k < MRT_ANGLES; ++k)
                    angle[k] = bench_talk[k] + 0.01f * (float)((i * (k + 3)) % 40);
                b.frame.pedal[0] = (i / 30) % 3 == 1;
                b.frame.pedal[1] = (i / 20) % 4 == 1;
                b.frame.pedal[2] = (i / 10) % 5 == 1;
                bench_step(&b, MRT_RIGHT, angle);
            }
            ends[run] = b.pull;
        }
        assert_memory_equal(&ends[0], &ends[1], sizeof ends[0]);
        bench_tear_down(&b);
    }
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
        cmocka_unit_test(left_hand_mirrors_the_right),
        cmocka_unit_test(the_wanted_hand_performs),
        cmocka_unit_test(mask_gives_each_fingertip_its_place),
        cmocka_unit_test(mask_moves_with_the_fingers_not_with_the_wrist),
        cmocka_unit_test(mask_hangs_the_jaw_on_the_thumb),
        cmocka_unit_test(a_larger_face_moves_further),
        cmocka_unit_test(a_face_without_anything_to_move_is_refused_with_a_reason),
        cmocka_unit_test(what_a_face_lacks_is_said_once_and_the_rest_performs),
        cmocka_unit_test(without_a_jaw_bone_the_chin_is_pulled),
        cmocka_unit_test(frames_alone_make_the_performance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
