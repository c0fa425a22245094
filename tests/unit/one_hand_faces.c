/* plugins/one_hand: either hand, the mask, and faces that lack something. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "one_hand_bench.h"

static const char *const modes[] = {"mode=classic", "mode=mask", "mode=layered_waldo"};

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
        "mode=classic,eyes=50", "mode=mask", "mode=layered_waldo,layer=mouth",
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

static void mask_gives_the_palm_both_cheeks(void **state)
{
    (void)state;
    bench b;
    bench_set_up(&b, "mode=mask,mask.dead_zone=0.5,mask.little=0,mask.ring=0");
    bench_talk_for(&b, MRT_RIGHT, 3);
    bench_bend(&b, MRT_RIGHT, (bends){{{ARCH, 25}}}, 30);
    mrt_vec3 left = bench_pulled(&b, "cheek.l"), right = bench_pulled(&b, "cheek.r");
    assert_true(bench_length(left) > 1.0f && fabsf(left.x) > 0.2f);
    assert_true(fabsf(left.x + right.x) < 1e-4f && fabsf(left.y - right.y) < 1e-4f &&
                fabsf(left.z - right.z) < 1e-4f);
    assert_true(bench_length(bench_pulled(&b, "brow.mid.l")) <= 0.0f);
    bench_tear_down(&b);
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

static void a_wide_mouth_alone_makes_no_large_face(void **state)
{
    (void)state;
    mrt_contact wide[BENCH_CONTACTS];
    memcpy(wide, bench_contacts, sizeof wide);
    for (size_t i = 0; i < BENCH_CONTACTS; ++i)
        if (strncmp(wide[i].name, "mouth.corner", 12) == 0)
            wide[i].rest.x *= 2.2f;
    mrt_face face = bench_face;
    face.contacts = wide;
    float lift[2];
    for (int k = 0; k < 2; ++k) {
        bench b;
        bench_set_up_on(&b, k ? &face : &bench_face, "samples=1");
        bench_talk_for(&b, MRT_RIGHT, 3);
        bench_bend(&b, MRT_RIGHT, (bends){{{INDEX_MPJ, -15}, {MIDDLE_MPJ, -15}}}, 1);
        lift[k] = bench_pulled(&b, "brow.mid.l").y;
        bench_tear_down(&b);
    }
    assert_true(lift[0] > 3.0f && fabsf(lift[1] - lift[0]) < 1e-4f);
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
        instance_listen(&b.plugin, &why, NULL);
        assert_int_equal(b.functions->activate(b.plugin.self, &faces[i]), MRT_ERR_UNSUPPORTED);
        instance_listen_end(&b.plugin);
        assert_non_null(strstr(why.text, "open a face with a rig"));
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
    assert_non_null(strstr(text, "moves 7 of 27 contacts and 3 of 15 degrees of freedom"));
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
        cmocka_unit_test(left_hand_mirrors_the_right),
        cmocka_unit_test(the_wanted_hand_performs),
        cmocka_unit_test(mask_gives_each_fingertip_its_place),
        cmocka_unit_test(mask_gives_the_palm_both_cheeks),
        cmocka_unit_test(mask_moves_with_the_fingers_not_with_the_wrist),
        cmocka_unit_test(mask_hangs_the_jaw_on_the_thumb),
        cmocka_unit_test(a_larger_face_moves_further),
        cmocka_unit_test(a_wide_mouth_alone_makes_no_large_face),
        cmocka_unit_test(a_face_without_anything_to_move_is_refused_with_a_reason),
        cmocka_unit_test(what_a_face_lacks_is_said_once_and_the_rest_performs),
        cmocka_unit_test(without_a_jaw_bone_the_chin_is_pulled),
        cmocka_unit_test(frames_alone_make_the_performance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
