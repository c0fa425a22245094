/* What holds for any controls in any pose: they land on their ends, nothing jumps when others take
 * over, the bones' own parts stay rigid, all stays finite. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/face_scene.h"

enum { ROUNDS = 60, CONTROLS_MAX = 12 };

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* SplitMix64 (Steele, Lea, Flood 2014); 0..1. */
static double number(uint64_t *seed)
{
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void random_pose(const face_scene *s, uint64_t *seed, float dof[MRT_MAX_DOFS])
{
    const bones *b = face_bones(s->face);
    memset(dof, 0, MRT_MAX_DOFS * sizeof *dof);
    for (uint32_t i = 0; i < b->dof_count; ++i)
        dof[i] = b->dof[i].min + (float)number(seed) * (b->dof[i].max - b->dof[i].min);
}

typedef struct grip_scene {
    uint32_t count;
    uint32_t vertex[CONTROLS_MAX]; /* of the sheet, at least 8 mm apart, free to move */
    face_control control[CONTROLS_MAX];
    double end[CONTROLS_MAX][3];
} grip_scene;

static bool is_apart(const face_scene *s, const grip_scene *g, uint32_t vertex)
{
    for (uint32_t i = 0; i < g->count; ++i)
        if (scene_distance(scene_rest(s, vertex), scene_rest(s, g->vertex[i])) < 8.0)
            return false;
    return true;
}

/* Controls hold random vertices of the sheet where they are shown. */
static void random_grips(const face_scene *s, uint64_t *seed, grip_scene *g)
{
    uint32_t wanted = 1 + (uint32_t)(number(seed) * CONTROLS_MAX);
    *g = (grip_scene){0};
    for (int tries = 0; tries < 500 && g->count < wanted && g->count < CONTROLS_MAX; ++tries) {
        int column = (int)(number(seed) * 37.0) - 18, row = (int)(number(seed) * 37.0) - 18;
        uint32_t vertex = number(seed) < 0.5 ? scene_at(column, row) : scene_below(column, row);
        if (!is_apart(s, g, vertex))
            continue;
        vec3 at = scene_shown(s, vertex);
        g->vertex[g->count] = vertex;
        g->control[g->count] = (face_control){at, 0};
        g->end[g->count][0] = at.x;
        g->end[g->count][1] = at.y;
        g->end[g->count][2] = at.z;
        g->count += 1;
    }
}

static void wander(grip_scene *g, uint64_t *seed, double size)
{
    for (uint32_t i = 0; i < g->count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            g->end[i][axis] += size * (2.0 * number(seed) - 1.0);
}

static double furthest_from_end(const face_scene *s, const grip_scene *g)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < g->count; ++i) {
        vec3 end = {g->end[i][0], g->end[i][1], g->end[i][2]};
        worst = fmax(worst, scene_distance(scene_shown(s, g->vertex[i]), end));
    }
    return worst;
}

static void expect_rigid_parts(const face_scene *s, const float *dof)
{
    rigid pose[SCENE_BONES];
    bones_pose(pose, face_bones(s->face), dof);
    for (uint32_t v = SCENE_UPPER_TEETH; v < SCENE_VERTICES; ++v) {
        uint32_t bone = v < SCENE_LOWER_TEETH ? SKULL : (v < SCENE_EYE ? JAW : EYE);
        double off = scene_distance(scene_shown(s, v), rigid_apply(&pose[bone], scene_rest(s, v)));
        assert_true(bone == SKULL ? off == 0.0 : off < 2e-5);
    }
}

/* A free point in the slit might take hold of the other lip: those are what contacts are for. */
static bool holds_a_lip(const grip_scene *g)
{
    for (uint32_t i = 0; i < g->count; ++i)
        if (g->vertex[i] >= SCENE_LOWER || g->vertex[i] / SCENE_SIDE == SCENE_HALF)
            return true;
    return false;
}

static void controls_land_and_nothing_jumps(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    double worst_miss = 0.0, worst_jump = 0.0;
    points kept;
    scene_init(&s);
    must(scene_finish(&s, &err), &err);
    must(points_create(&kept, face_order(s.face), s.mesh.position, &err), &err);
    for (uint64_t round = 0; round < ROUNDS; ++round) {
        uint64_t seed = 100 + round;
        csrbf_settings settings = {.kernel = (csrbf_kernel)(round % 4),
                                   .polynomial = round % 5 ? CSRBF_NONE : CSRBF_WINDOWED,
                                   .radius = 15.0 + 30.0 * number(&seed),
                                   .stretch_most = -1.0};
        float dof[MRT_MAX_DOFS];
        face_reset(s.face);
        random_pose(&s, &seed, dof);
        must(face_pull(s.face, NULL, dof, &err), &err);
        for (int take = 0; take < 3; ++take) {
            grip_scene g;
            random_grips(&s, &seed, &g);
            must(face_engage(s.face, &settings, g.control, g.count, &err), &err);
            points_copy(&kept, face_shown(s.face));
            must(face_pull(s.face, g.end[0], dof, &err), &err);
            worst_jump = fmax(worst_jump, scene_greatest_difference(&kept, face_shown(s.face)));
            wander(&g, &seed, 3.0);
            random_pose(&s, &seed, dof);
            must(face_pull(s.face, g.end[0], dof, &err), &err);
            assert_true(points_are_usable(face_shown(s.face)));
            expect_rigid_parts(&s, dof);
            if (!holds_a_lip(&g))
                worst_miss = fmax(worst_miss, furthest_from_end(&s, &g));
        }
    }
    print_message("furthest from its end %.2g mm, largest jump %.2g mm\n", worst_miss, worst_jump);
    assert_true(worst_miss < 2e-3);
    assert_true(worst_jump < 1e-4);
    points_destroy(&kept);
    face_destroy(s.face);
}

static void the_same_takes_give_the_same_bits(void **state)
{
    (void)state;
    static face_scene s[2];
    error err = {""};
    for (int copy = 0; copy < 2; ++copy) {
        scene_init(&s[copy]);
        must(scene_finish(&s[copy], &err), &err);
    }
    for (int copy = 0; copy < 2; ++copy)
        for (uint64_t round = 0; round < 8; ++round) {
            uint64_t seed = 40 + round;
            const csrbf_settings settings = {.radius = 25.0};
            float dof[MRT_MAX_DOFS];
            double reached[CONTROLS_MAX][3], from[CONTROLS_MAX][3];
            shape_step step;
            grip_scene g;
            random_grips(&s[copy], &seed, &g);
            random_pose(&s[copy], &seed, dof);
            must(face_engage(s[copy].face, &settings, g.control, g.count, &err), &err);
            wander(&g, &seed, 2.0);
            for (int other = 0; other < copy * 3; ++other) /* more frames drawn in between */
                must(face_pull(s[copy].face, g.end[0], NULL, &err), &err);
            must(face_pull(s[copy].face, g.end[0], dof, &err), &err);
            memcpy(from, g.end, sizeof from);
            wander(&g, &seed, 1.0);
            must(face_drag(s[copy].face, &settings, from[0], g.end[0], g.count, dof, reached[0],
                           &step, &err),
                 &err);
        }
    assert_true(scene_same_bits(face_shown(s[0].face), face_shown(s[1].face)));
    for (int copy = 0; copy < 2; ++copy)
        face_destroy(s[copy].face);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(controls_land_and_nothing_jumps),
        cmocka_unit_test(the_same_takes_give_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
