/* property/csrbf_slab.h - a slab of vertices, and one at each tip of a random scene: the shape that
 * the tests of shape.h pull and drag. After <cmocka.h>. */
#ifndef MAROTTE_TESTS_CSRBF_SLAB_H
#define MAROTTE_TESTS_CSRBF_SLAB_H
#include "csrbf/shape.h"
#include "property/csrbf_scene.h"

enum { SIDE = 25, LAYERS = 3, TIPS = SCENE_TIPS };
enum { VERTICES = SIDE * SIDE * LAYERS + TIPS };

/* A slab of layers, and a vertex at each tip. */
static inline void make_shape(shape *out, const scene *s)
{
    static float row[VERTICES][3];
    error err = {""};
    size_t at = 0;
    for (int k = 0; k < LAYERS; ++k)
        for (int j = 0; j < SIDE; ++j)
            for (int i = 0; i < SIDE; ++i, ++at) {
                row[at][0] = (float)(3.0 * i / (SIDE - 1) - 1.5);
                row[at][1] = (float)(3.0 * j / (SIDE - 1) - 1.5);
                row[at][2] = k == 1 ? -0.0f : (float)(0.25 * k - 0.25); /* its sign must stay */
            }
    for (uint32_t i = 0; i < TIPS; ++i, ++at)
        for (int axis = 0; axis < 3; ++axis)
            row[at][axis] = (float)s->tip[i][axis];
    if (shape_create(out, row[0], VERTICES, TIPS, &err) < 0)
        fail_msg("%s", err.text);
}

static inline scene make_scene(uint32_t number, csrbf_polynomial polynomial)
{
    return scene_make(number, scene_kernels[number % 4], polynomial);
}

static inline void ends(double out[TIPS][3], const scene *s, double scale)
{
    for (uint32_t i = 0; i < s->tip_count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            out[i][axis] = s->tip[i][axis] + scale * s->g[i][axis];
}

static inline void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static inline void expect_same_bits(const points *a, const points *b)
{
    size_t size = a->padded_count * sizeof(float);
    assert_memory_equal(a->x, b->x, size);
    assert_memory_equal(a->y, b->y, size);
    assert_memory_equal(a->z, b->z, size);
    assert_memory_equal(a->block, b->block, a->block_count * sizeof *a->block);
}

static inline double largest_difference(const points *a, const points *b)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < a->count; ++i) {
        double d[3] = {fabs((double)(a->x[i] - b->x[i])), fabs((double)(a->y[i] - b->y[i])),
                       fabs((double)(a->z[i] - b->z[i]))};
        for (int axis = 0; axis < 3; ++axis) {
            assert_true(isfinite(d[axis]));
            largest = d[axis] > largest ? d[axis] : largest;
        }
    }
    return largest;
}

static inline void keep(shape *s, points *out)
{
    points_copy(out, &s->shown);
}

#endif
