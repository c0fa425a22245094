/* Normals by tangents: against the exact ones of the deformed surface, and those of its triangles.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/isa.h"
#include "csrbf/shape.h"
#include "csrbf/tangents.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SIDE = 41,
    VERTICES = SIDE * SIDE,
    CONTROLS = 9,
    CROWD = 25,
    PADDED = VERTICES + POINTS_BLOCK
};
static const double degree = 57.29577951308232;

static float vertex[VERTICES][3];
static double start[CROWD][3], pull[CROWD][3]; /* CONTROLS of them, but for a crowd */

/* A bowl of 100 mm: z = (x^2 + y^2) / 200, and its normal. */
static double height(double x, double y)
{
    return (x * x + y * y) / 200.0;
}

static void normal_at_rest(double out[3], double x, double y)
{
    double size = sqrt(1.0 + (x * x + y * y) / 10000.0);
    out[0] = -x / 100.0 / size;
    out[1] = -y / 100.0 / size;
    out[2] = 1.0 / size;
}

static int fill(void **state)
{
    (void)state;
    for (int i = 0; i < VERTICES; ++i) {
        double x = 2.5 * (i % SIDE) - 50.0, y = 2.5 * (int)(i / SIDE) - 50.0;
        vertex[i][0] = (float)x;
        vertex[i][1] = (float)y;
        vertex[i][2] = (float)height(x, y);
    }
    for (int k = 0; k < CONTROLS; ++k) {
        start[k][0] = 35.0 * (k % 3 - 1) + 1.3;
        start[k][1] = 35.0 * (int)(k / 3 - 1) - 0.7;
        start[k][2] = height(start[k][0], start[k][1]);
        pull[k][0] = 3.0 - k;
        pull[k][1] = 0.7 * k - 2.0;
        pull[k][2] = k % 2 ? 7.0 : -5.0;
    }
    for (int k = CONTROLS; k < CROWD; ++k) {
        start[k][0] = 22.0 * ((k - CONTROLS) % 4) - 31.0;
        start[k][1] = 22.0 * (int)((k - CONTROLS) / 4) - 34.0;
        start[k][2] = height(start[k][0], start[k][1]);
        pull[k][2] = 0.1 * (k % 5);
    }
    return 0;
}

typedef struct stand {
    shape shape;
    tangents tangents;
    float rest[3][PADDED], n[3][PADDED];
} stand;

static bool raise_crowd(stand *s, const csrbf_settings *settings, uint32_t count)
{
    error err = {""};
    if (shape_create(&s->shape, vertex[0], VERTICES, count, &err) < 0 ||
        tangents_create(&s->tangents, &s->shape.rest, count, &err) < 0 ||
        shape_engage(&s->shape, settings, start[0], count, &err) < 0 ||
        shape_pull(&s->shape, pull[0], &err) < 0 ||
        csrbf_solve(s->shape.solver, pull[0], &err) < 0) /* for exact_normal */
        fail_msg("%s", err.text);
    for (uint32_t slot = 0; slot < s->shape.rest.padded_count; ++slot) {
        double n[3];
        normal_at_rest(n, (double)s->shape.rest.x[slot], (double)s->shape.rest.y[slot]);
        for (int axis = 0; axis < 3; ++axis)
            s->rest[axis][slot] = (float)n[axis];
    }
    const float *const rest[3] = {s->rest[0], s->rest[1], s->rest[2]};
    float *const n[3] = {s->n[0], s->n[1], s->n[2]};
    if (!tangents_engage(&s->tangents, s->shape.solver, &s->shape.base, rest, count))
        return false;
    tangents_normals(&s->tangents, n, pull[0]);
    return true;
}

static bool raise_stand(stand *s, const csrbf_settings *settings)
{
    return raise_crowd(s, settings, CONTROLS);
}

static void strike_stand(stand *s)
{
    tangents_destroy(&s->tangents);
    shape_destroy(&s->shape);
}

static void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double angle_deg(const double a[3], const double b[3])
{
    double c[3];
    cross(c, a, b);
    double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    return atan2(sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]), dot) * degree;
}

/* Of the bowl after the field, by differences in double. */
static void exact_normal(double out[3], const csrbf_solver *solver, double x, double y)
{
    const double h = 1e-4;
    double at[4][3] = {{x - h, y, height(x - h, y)},
                       {x + h, y, height(x + h, y)},
                       {x, y - h, height(x, y - h)},
                       {x, y + h, height(x, y + h)}};
    double along_x[3], along_y[3];
    csrbf_move_f64(solver, at[0], 4);
    for (int axis = 0; axis < 3; ++axis) {
        along_x[axis] = at[1][axis] - at[0][axis];
        along_y[axis] = at[3][axis] - at[2][axis];
    }
    cross(out, along_x, along_y);
}

static void they_are_those_of_the_deformed_surface(void **state)
{
    (void)state;
    static stand s;
    static const csrbf_kernel kernels[] = {CSRBF_WENDLAND_C2, CSRBF_WENDLAND_C4, CSRBF_WENDLAND_C6};
    for (int k = 0; k < 3; ++k)
        for (int polynomial = CSRBF_NONE; polynomial <= CSRBF_LINEAR; ++polynomial) {
            const csrbf_settings settings = {
                .kernel = kernels[k], .polynomial = (csrbf_polynomial)polynomial, .radius = 45.0};
            double worst = 0.0, turned = 0.0;
            assert_true(raise_stand(&s, &settings));
            for (uint32_t i = 0; i < VERTICES; ++i) {
                double expected[3], found[3], rest[3];
                exact_normal(expected, s.shape.solver, (double)s.shape.rest.x[i],
                             (double)s.shape.rest.y[i]);
                for (int axis = 0; axis < 3; ++axis) {
                    found[axis] = (double)s.n[axis][i];
                    rest[axis] = (double)s.rest[axis][i];
                }
                worst = fmax(worst, angle_deg(expected, found));
                turned = fmax(turned, angle_deg(rest, found));
            }
            assert_true(worst < 0.02); /* degrees */
            assert_true(turned > 10.0);
            strike_stand(&s);
        }
}

static void many_controls_are_summed_like_few(void **state)
{
    (void)state;
    static stand s;
    double worst = 0.0;
    assert_true(raise_crowd(&s, &(csrbf_settings){.radius = 200.0}, CROWD)); /* all reach all */
    for (uint32_t i = 0; i < VERTICES; ++i) {
        double expected[3], found[3];
        exact_normal(expected, s.shape.solver, (double)s.shape.rest.x[i],
                     (double)s.shape.rest.y[i]);
        for (int axis = 0; axis < 3; ++axis)
            found[axis] = (double)s.n[axis][i];
        worst = fmax(worst, angle_deg(expected, found));
    }
    assert_true(worst < 0.1); /* degrees: 25 columns, each rounded */
    strike_stand(&s);
}

static void parts_of_a_frame_are_those_of_the_whole(void **state)
{
    (void)state;
    static stand s;
    static float part[3][PADDED];
    float *const n[3] = {part[0], part[1], part[2]};
    uint8_t wanted[PADDED / POINTS_BLOCK];
    static const double radius[] = {12.0, 45.0, 200.0};
    for (int r = 0; r < 3; ++r) {
        assert_true(raise_stand(&s, &(csrbf_settings){.radius = radius[r]}));
        uint32_t blocks = s.shape.rest.block_count;
        memset(part, 0x7f, sizeof part);
        for (uint32_t block = 0; block < blocks; ++block)
            wanted[block] = block % 7 != 2 && block % 5 != 1;
        tangents_weigh(&s.tangents, pull[0]);
        tangents_normals_blocks(&s.tangents, n, wanted, 0, blocks / 2);
        tangents_normals_blocks(&s.tangents, n, wanted, blocks / 2, blocks);
        for (uint32_t i = 0; i < s.shape.rest.padded_count; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                static const uint8_t untouched[4] = {0x7f, 0x7f, 0x7f, 0x7f};
                const void *expected = &s.n[axis][i];
                assert_memory_equal(&part[axis][i], wanted[i / POINTS_BLOCK] ? expected : untouched,
                                    4);
            }
        strike_stand(&s);
    }
}

static void at_rest_they_are_the_normals_at_rest(void **state)
{
    (void)state;
    static stand s;
    static const double still[CONTROLS][3];
    float *const n[3] = {s.n[0], s.n[1], s.n[2]};
    assert_true(raise_stand(&s, &(csrbf_settings){.radius = 45.0}));
    tangents_normals(&s.tangents, n, still[0]);
    for (uint32_t i = 0; i < VERTICES; ++i)
        for (int axis = 0; axis < 3; ++axis)
            assert_true(fabs((double)s.n[axis][i] - (double)s.rest[axis][i]) < 1e-4);
    strike_stand(&s);
}

static void kernels_without_a_derivative_are_refused(void **state)
{
    (void)state;
    static stand s;
    assert_false(raise_stand(&s, &(csrbf_settings){.kernel = CSRBF_WENDLAND_C0, .radius = 45.0}));
    strike_stand(&s);
    assert_false(raise_stand(&s, &(csrbf_settings){.polynomial = CSRBF_WINDOWED, .radius = 45.0}));
    strike_stand(&s);
}

static void every_instruction_set_gives_the_same_bits(void **state)
{
    (void)state;
    static stand s;
    static float expected[3][PADDED];
    for (int i = 0; i < ISA_COUNT; ++i) {
        if (!isa_is_here((isa)i))
            continue;
        setenv("MAROTTE_ISA", isa_name((isa)i), 1);
        assert_true(raise_stand(&s, &(csrbf_settings){.radius = 45.0}));
        if (i == ISA_GENERIC)
            memcpy(expected, s.n, sizeof expected);
        assert_memory_equal(expected, s.n, sizeof expected);
        strike_stand(&s);
    }
    unsetenv("MAROTTE_ISA");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_those_of_the_deformed_surface),
        cmocka_unit_test(many_controls_are_summed_like_few),
        cmocka_unit_test(parts_of_a_frame_are_those_of_the_whole),
        cmocka_unit_test(at_rest_they_are_the_normals_at_rest),
        cmocka_unit_test(kernels_without_a_derivative_are_refused),
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, fill, NULL);
}
