/* tests/unit/export_scene.h - the scenes that the tests of the exporters write: a domed sheet of
 * two parts, unit responses with compact support, and motions that are the same on every run. */
#ifndef MAROTTE_TESTS_EXPORT_SCENE_H
#define MAROTTE_TESTS_EXPORT_SCENE_H
#include "io/clip.h"
#include "io/export.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A folder of this test's own, emptied by the caller. */
static inline void scene_folder(char *out, size_t size)
{
    const char *root = getenv("TMPDIR");
    (void)snprintf(out, size, "%s/marotte_export_XXXXXX", root && *root ? root : "/tmp");
    assert_non_null(mkdtemp(out));
}

static inline void scene_path(char *out, size_t size, const char *folder, const char *name)
{
    (void)snprintf(out, size, "%s/%s", folder, name);
}

static inline void scene_name(char **out, const char *name)
{
    free(*out);
    *out = strdup(name);
    assert_non_null(*out);
}

/* side by side vertices, 200 mm high; the upper half is the part "brow", the lower "mouth". */
static inline mesh scene_sheet(uint32_t side)
{
    mesh m;
    error err;
    uint32_t cells = side - 1;
    assert_int_equal(mesh_create(&m, side * side, cells * cells * 2, &err), MRT_OK);
    for (uint32_t v = 0; v < side * side; ++v) {
        double a = (double)(v % side) / cells * 2.0 - 1.0, b = (double)(v / side) / cells * 2.0 - 1;
        m.position[(size_t)v * 3] = (float)(80.0 * a);
        m.position[(size_t)v * 3 + 1] = (float)(-100.0 * b);
        m.position[(size_t)v * 3 + 2] = (float)(60.0 * (1.0 - a * a) * (1.0 - b * b * 0.5));
    }
    for (uint32_t i = 0; i < cells * cells; ++i) {
        uint32_t v = i / cells * side + i % cells;
        uint32_t corner[6] = {v, v + side, v + 1, v + 1, v + side, v + side + 1};
        memcpy(m.triangle + (size_t)i * 6, corner, sizeof corner);
    }
    m.part = realloc(m.part, 2 * sizeof *m.part);
    assert_non_null(m.part);
    m.part_count = 2;
    uint32_t half = cells / 2 * cells * 2;
    m.part[1] = (mesh_part){.first_triangle = half,
                            .triangle_count = m.triangle_count - half,
                            .first_vertex = cells / 2 * side,
                            .vertex_count = m.vertex_count - cells / 2 * side};
    m.part[0].triangle_count = half;
    m.part[0].vertex_count = (cells / 2 + 1) * side;
    scene_name(&m.part[0].name, "brow");
    scene_name(&m.part[1].name, "mouth");
    scene_name(&m.material[0].name, "skin");
    return m;
}

/* Wendland's C2 function of the distance from (x, y) in the sheet's plane, in mm. */
static inline double scene_bump(const float *position, double x, double y, double radius_mm)
{
    double dx = (double)position[0] - x, dy = (double)position[1] - y;
    double r = sqrt(dx * dx + dy * dy) / radius_mm, left = 1.0 - r;
    return left > 0.0 ? left * left * left * left * (4.0 * r + 1.0) : 0.0;
}

enum { SCENE_CONTROLS = 3 };

/* An engagement of three controls on the shape `base` (V by 3). */
static inline void scene_begin_segment(clip *c, const float *base, error *err)
{
    const mesh *m = clip_mesh(c);
    static const double place[SCENE_CONTROLS][2] = {{-40.0, 30.0}, {10.0, -20.0}, {50.0, 60.0}};
    float *response = malloc((size_t)SCENE_CONTROLS * m->vertex_count * sizeof *response);
    assert_non_null(response);
    for (size_t k = 0; k < SCENE_CONTROLS; ++k) {
        for (size_t v = 0; v < m->vertex_count; ++v)
            response[k * m->vertex_count + v] =
                (float)scene_bump(m->position + v * 3, place[k][0], place[k][1], 45.0);
    }
    assert_int_equal(clip_begin_segment(c, base, response, NULL, SCENE_CONTROLS, err), MRT_OK);
    free(response);
}

static inline void scene_add_anchored(clip *c, uint32_t count, double phase)
{
    error err;
    for (uint32_t frame = 0; frame < count; ++frame) {
        double displacement[SCENE_CONTROLS * 3];
        for (size_t i = 0; i < SCENE_CONTROLS * 3; ++i)
            displacement[i] = 12.0 * sin(phase + 0.13 * frame * (double)(i + 1));
        assert_int_equal(clip_add_anchored(c, displacement, &err), MRT_OK);
        double control[SCENE_CONTROLS * 6] = {0};
        for (size_t i = 0; i < SCENE_CONTROLS * 3; ++i)
            control[i / 3 * 6 + 3 + i % 3] = displacement[i];
        assert_int_equal(clip_add_controls(c, control, SCENE_CONTROLS, &err), MRT_OK);
    }
}

/* Free frames: bumps that wander over the sheet while they pull, on top of `shape`. */
static inline void scene_free_shape(float *out, const mesh *m, double time, uint32_t bump_count)
{
    memcpy(out, m->position, (size_t)m->vertex_count * 3 * sizeof *out);
    for (uint32_t b = 0; b < bump_count; ++b) {
        double x = 45.0 * sin(0.7 * b) + 6.0 * sin(time * (0.9 + 0.13 * b));
        double y = 60.0 * cos(1.1 * b) + 6.0 * cos(time * (0.7 + 0.11 * b));
        double pull[3] = {6.0 * sin(time * (1.3 + 0.21 * b)), 8.0 * sin(time * 2.1 + b),
                          9.0 * cos(time * (1.7 - 0.1 * b))};
        for (size_t v = 0; v < m->vertex_count; ++v) {
            double w = scene_bump(m->position + v * 3, x, y, 50.0);
            for (size_t axis = 0; axis < 3; ++axis)
                out[v * 3 + axis] += (float)(w * pull[axis]);
        }
    }
}

static inline void scene_add_free(clip *c, uint32_t count, double first_time, uint32_t bump_count)
{
    error err;
    const mesh *m = clip_mesh(c);
    float *shape = malloc((size_t)m->vertex_count * 3 * sizeof *shape);
    assert_non_null(shape);
    for (uint32_t frame = 0; frame < count; ++frame) {
        double time = first_time + frame / 60.0;
        double control[12] = {time, 1.0, 2.0, -time, 0.25, 1e-3};
        scene_free_shape(shape, m, time, bump_count);
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
        assert_int_equal(clip_add_controls(c, control, 2, &err), MRT_OK);
    }
    free(shape);
}

/* Clay: every frame changes the shape that the last one left (V by 3), the first `left` frames on
 * the left side of the sheet, the others on its right side. */
static inline void scene_knead(clip *c, float *shape, uint32_t count, uint32_t left)
{
    error err;
    const mesh *m = clip_mesh(c);
    for (uint32_t frame = 0; frame < count; ++frame) {
        double time = frame / 30.0, side = frame < left ? -50.0 : 50.0;
        double x = side + 20.0 * sin(2.3 * time), y = 80.0 * cos(1.1 * time);
        double pull[3] = {0.4 * sin(3.1 * time), 0.5 * cos(1.9 * time), 0.9 * sin(2.7 * time)};
        for (size_t v = 0; v < m->vertex_count; ++v) {
            double w = scene_bump(m->position + v * 3, x, y, 28.0);
            for (size_t axis = 0; axis < 3; ++axis)
                shape[v * 3 + axis] += (float)(w * pull[axis]);
        }
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
    }
}

static inline clip *scene_clay(const mesh *m, uint32_t count, uint32_t left)
{
    error err;
    float *shape = malloc((size_t)m->vertex_count * 3 * sizeof *shape);
    assert_non_null(shape);
    memcpy(shape, m->position, (size_t)m->vertex_count * 3 * sizeof *shape);
    clip *c = clip_create(m, 30.0, NULL, &err);
    assert_non_null(c);
    scene_knead(c, shape, count, left);
    free(shape);
    return c;
}

#endif
