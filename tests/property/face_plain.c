/* A mesh without a rig is csrbf/shape.h, bit for bit, whatever is done with it. Units as in
 * csrbf_scene.h. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/face.h"
#include "property/csrbf_scene.h"

#include <stdlib.h>

enum { SIDE = 25, LAYERS = 3, TIPS = SCENE_TIPS, VERTICES = SIDE * SIDE * LAYERS };

typedef struct pair {
    shape shape;
    face *face;
} pair;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static binding free_binding(void)
{
    binding b = {.vertex_count = VERTICES, .bone_count = 1};
    b.weight = malloc(VERTICES * sizeof *b.weight);
    b.mobility = malloc(VERTICES * sizeof *b.mobility);
    assert_true(b.weight && b.mobility);
    for (size_t i = 0; i < VERTICES; ++i)
        b.weight[i] = b.mobility[i] = 1.0f;
    return b;
}

static void make(pair *out)
{
    static float row[VERTICES][3];
    error err = {""};
    size_t at = 0;
    for (int k = 0; k < LAYERS; ++k)
        for (int j = 0; j < SIDE; ++j)
            for (int i = 0; i < SIDE; ++i, ++at) {
                row[at][0] = (float)(3.0 * i / (SIDE - 1) - 1.5);
                row[at][1] = (float)(3.0 * j / (SIDE - 1) - 1.5);
                row[at][2] = (float)(0.25 * k - 0.25);
            }
    const mesh m = {.vertex_count = VERTICES, .position = row[0]};
    binding b = free_binding();
    must(shape_create(&out->shape, row[0], VERTICES, TIPS, &err), &err);
    must(face_create_bound(&out->face, NULL, &m, &b, TIPS, &err), &err);
}

static void finish(pair *p)
{
    shape_destroy(&p->shape);
    face_destroy(p->face);
}

static void expect_same(const pair *p)
{
    const points *a = &p->shape.shown, *b = face_shown(p->face);
    size_t size = a->padded_count * sizeof(float);
    assert_memory_equal(a->x, b->x, size);
    assert_memory_equal(a->y, b->y, size);
    assert_memory_equal(a->z, b->z, size);
    assert_memory_equal(a->block, b->block, a->block_count * sizeof *a->block);
}

static void ends(double out[TIPS][3], const scene *s, double scale)
{
    for (uint32_t i = 0; i < s->tip_count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            out[i][axis] = s->tip[i][axis] + scale * s->g[i][axis];
}

static void engage_both(pair *p, const scene *s, double tip[TIPS][3])
{
    face_control control[TIPS];
    error err = {""};
    for (uint32_t i = 0; i < s->tip_count; ++i)
        control[i] = (face_control){{tip[i][0], tip[i][1], tip[i][2]}, 0};
    must(shape_engage(&p->shape, &s->settings, tip[0], s->tip_count, &err), &err);
    must(face_engage(p->face, &s->settings, control, s->tip_count, &err), &err);
}

static void pull_both(pair *p, const scene *s, double tip[TIPS][3], double end[TIPS][3])
{
    double way[TIPS][3];
    error err = {""};
    for (uint32_t i = 0; i < s->tip_count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            way[i][axis] = end[i][axis] - tip[i][axis];
    must(shape_pull(&p->shape, way[0], &err), &err);
    must(face_pull(p->face, end[0], NULL, &err), &err);
    expect_same(p);
    assert_true(face_metered(p->face)->slope_bound == shape_slope_bound(&p->shape, way[0]));
    assert_true(face_min_determinant(p->face) == shape_min_determinant(&p->shape, way[0]));
}

static void drag_both(pair *p, const scene *s, double from[TIPS][3], double to[TIPS][3])
{
    error err = {""};
    shape_step step[2];
    double reached[2][TIPS][3];
    must(shape_drag(&p->shape, &s->settings, from[0], to[0], s->tip_count, reached[0][0], &step[0],
                    &err),
         &err);
    must(face_drag(p->face, &s->settings, from[0], to[0], s->tip_count, NULL, reached[1][0],
                   &step[1], &err),
         &err);
    expect_same(p);
    assert_int_equal(step[0].substeps, step[1].substeps);
    assert_true(step[0].limited == step[1].limited);
    assert_true(step[0].min_determinant == step[1].min_determinant);
    assert_true(step[0].max_slope == step[1].max_slope);
    assert_memory_equal(reached[0], reached[1], (size_t)3 * s->tip_count * sizeof(double));
}

/* Pulls, a new engagement in the middle, a commit, drags, a leak, and pulls again. */
static void without_a_rig_a_face_is_a_shape(void **state)
{
    (void)state;
    for (uint32_t number = 0; number < 48; ++number) {
        scene s = scene_make(number, scene_kernels[number % 4], scene_polynomials[number / 4 % 4]);
        double tip[TIPS][3], end[TIPS][3], further[TIPS][3];
        pair p;
        s.settings.stretch_most = -1.0; /* as asked, also where that folds: a shape has no limit */
        make(&p);
        ends(tip, &s, 0.0);
        ends(end, &s, 1.0);
        ends(further, &s, 1.5);
        engage_both(&p, &s, tip);
        expect_same(&p);
        pull_both(&p, &s, tip, tip);
        pull_both(&p, &s, tip, end);
        engage_both(&p, &s, end);
        expect_same(&p);
        pull_both(&p, &s, end, tip);
        pull_both(&p, &s, end, further);
        shape_commit(&p.shape);
        face_commit(p.face);
        expect_same(&p);
        drag_both(&p, &s, tip, end);
        drag_both(&p, &s, end, further);
        drag_both(&p, &s, further, further);
        shape_leak(&p.shape, 5.0, 0.02);
        face_leak(p.face, 5.0, 0.02);
        expect_same(&p);
        engage_both(&p, &s, further);
        pull_both(&p, &s, further, end);
        drag_both(&p, &s, end, tip); /* ends the engagement */
        shape_commit(&p.shape);
        face_commit(p.face);
        expect_same(&p);
        shape_reset(&p.shape);
        face_reset(p.face);
        expect_same(&p);
        finish(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(without_a_rig_a_face_is_a_shape)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
