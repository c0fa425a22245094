/* unit/draw_help.h - what the tests of ui/draw share: nearness and small meshes. */
#ifndef MAROTTE_TESTS_UNIT_DRAW_HELP_H
#define MAROTTE_TESTS_UNIT_DRAW_HELP_H
#include "mesh/mesh.h"

#include <math.h>
#include <stdlib.h>

/* cmocka's assert_float_equal casts the first operand of an expression only. Fails on NaN. */
#define assert_near(a, b, tolerance)                                                               \
    assert_true(fabs((double)(a) - (double)(b)) <= (double)(tolerance))

typedef struct ball {
    float centre[3], radius_mm;
} ball;

enum { BALL_SIDES = 48, BALL_RINGS = 25, BALL_VERTICES = BALL_SIDES * BALL_RINGS };

/* Balls of BALL_VERTICES each, in order; aborts the test when there is no memory. */
static inline mesh shapes_balls(const ball *balls, uint32_t ball_count)
{
    mesh m;
    error err;
    const uint32_t triangles = BALL_SIDES * (BALL_RINGS - 1) * 2;
    if (mesh_create(&m, BALL_VERTICES * ball_count, triangles * ball_count, &err) != MRT_OK)
        abort();
    float *p = m.position;
    uint32_t *t = m.triangle;
    for (uint32_t b = 0; b < ball_count; ++b)
        for (uint32_t side = 0; side < BALL_SIDES; ++side)
            for (uint32_t ring = 0; ring < BALL_RINGS; ++ring) {
                double around = 6.283185307179586 * side / BALL_SIDES;
                double up = 3.141592653589793 * ring / (BALL_RINGS - 1);
                double r = (double)balls[b].radius_mm;
                *p++ = balls[b].centre[0] + (float)(r * sin(up) * sin(around));
                *p++ = balls[b].centre[1] - (float)(r * cos(up));
                *p++ = balls[b].centre[2] + (float)(r * sin(up) * cos(around));
                if (ring + 1 == BALL_RINGS)
                    continue;
                uint32_t first = b * BALL_VERTICES;
                uint32_t here = first + side * BALL_RINGS + ring;
                uint32_t next = first + (side + 1) % BALL_SIDES * BALL_RINGS + ring;
                const uint32_t corners[6] = {here, next, here + 1, next, next + 1, here + 1};
                for (int i = 0; i < 6; ++i)
                    *t++ = corners[i];
            }
    return m;
}

/* A square wall facing +z, side 2 * half_mm. */
static inline mesh shapes_wall(float half_mm, float z_mm)
{
    mesh m;
    error err;
    if (mesh_create(&m, 4, 2, &err) != MRT_OK)
        abort();
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    static const float place[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int i = 0; i < 4; ++i) {
        m.position[i * 3 + 0] = half_mm * place[i][0];
        m.position[i * 3 + 1] = half_mm * place[i][1];
        m.position[i * 3 + 2] = z_mm;
    }
    for (int i = 0; i < 6; ++i)
        m.triangle[i] = corners[i];
    return m;
}

#endif
