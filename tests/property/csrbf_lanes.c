/* Every instruction set that the machine has gives the bits of the generic one: frames, drags, unit
 * responses, factors, meters; for all kernels and polynomials. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/isa.h"
#include "csrbf/shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VERTICES = 1500, CONTROLS = 13, MANY = 211 };

static float vertex[VERTICES][3];
static double start[CONTROLS][3], pull[CONTROLS][3], many[MANY][3];

static double next_part(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

static int fill(void **state)
{
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < VERTICES; ++i)
        for (int axis = 0; axis < 3; ++axis)
            vertex[i][axis] = (float)(100.0 * next_part(&seed) - 50.0);
    for (int k = 0; k < CONTROLS; ++k)
        for (int axis = 0; axis < 3; ++axis) {
            start[k][axis] = 100.0 * next_part(&seed) - 50.0;
            pull[k][axis] = 16.0 * next_part(&seed) - 8.0;
        }
    memset(pull[3], 0, sizeof pull[3]); /* one that weighs nothing */
    for (int k = 0; k < MANY; ++k)
        for (int axis = 0; axis < 3; ++axis)
            many[k][axis] = 100.0 * next_part(&seed) - 50.0;
    return 0;
}

/* Everything that comes of one setting, as bytes. */
typedef struct outcome {
    float pulled[VERTICES][3], dragged[VERTICES][3], moved[VERTICES][3];
    float response[CONTROLS][VERTICES];
    points_bounds bounds[VERTICES / POINTS_BLOCK + 1];
    double determinant, slope, slope_bound;
    shape_step step;
} outcome;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void use(isa which)
{
    setenv("MAROTTE_ISA", isa_name(which), 1);
}

static void perform(outcome *out, const csrbf_settings *settings)
{
    error err = {""};
    shape s;
    double to[CONTROLS][3];
    memset(out, 0, sizeof *out);
    must(shape_create(&s, vertex[0], VERTICES, CONTROLS, &err), &err);
    must(shape_engage(&s, settings, start[0], CONTROLS, &err), &err);
    for (uint32_t k = 0; k < CONTROLS; ++k)
        memcpy(out->response[k], columns_row(&s.response, k), sizeof out->response[k]);
    must(shape_pull(&s, pull[0], &err), &err);
    points_to_rows(out->pulled[0], &s.shown, &s.order);
    memcpy(out->bounds, s.shown.block, s.shown.block_count * sizeof *out->bounds);
    out->determinant = shape_min_determinant(&s, pull[0]);
    out->slope = csrbf_max_slope(s.solver, &s.base);
    out->slope_bound = shape_slope_bound(&s, pull[0]);
    (void)csrbf_move(s.solver, &s.shown, &s.rest);
    points_to_rows(out->moved[0], &s.shown, &s.order);
    shape_reset(&s);
    for (int k = 0; k < CONTROLS; ++k)
        for (int axis = 0; axis < 3; ++axis)
            to[k][axis] = start[k][axis] + pull[k][axis];
    must(shape_drag(&s, settings, start[0], to[0], CONTROLS, NULL, &out->step, &err), &err);
    points_to_rows(out->dragged[0], &s.shown, &s.order);
    shape_destroy(&s);
}

static void compare(const csrbf_settings *settings)
{
    static outcome expected, found;
    use(ISA_GENERIC);
    perform(&expected, settings);
    for (int i = 1; i < ISA_COUNT; ++i) {
        if (!isa_is_here((isa)i))
            continue;
        use((isa)i);
        perform(&found, settings);
        if (memcmp(&found, &expected, sizeof found) != 0)
            fail_msg("%s: other bits: kernel %d, polynomial %d, R %g", isa_name((isa)i),
                     (int)settings->kernel, (int)settings->polynomial, settings->radius);
    }
}

static void all_instruction_sets_give_the_same_bits(void **state)
{
    (void)state;
    static const double radius[] = {9.0, 35.0, 140.0};
    for (int kernel = 0; kernel <= CSRBF_WENDLAND_C6; ++kernel)
        for (int polynomial = 0; polynomial <= CSRBF_WINDOWED; ++polynomial)
            for (size_t i = 0; i < sizeof radius / sizeof *radius; ++i)
                compare(&(csrbf_settings){.kernel = (csrbf_kernel)kernel,
                                          .polynomial = (csrbf_polynomial)polynomial,
                                          .radius = radius[i]});
}

/* Many centres: the factorisation in whole groups and in parts of one. */
static void factors_of_many_centres_have_the_same_bits(void **state)
{
    (void)state;
    static double expected[VERTICES][3], found[VERTICES][3];
    const csrbf_settings settings = {.radius = 30.0};
    for (uint32_t count = 1; count <= MANY; count += count < 70 ? 1 : 47)
        for (int i = 0; i < ISA_COUNT; ++i) {
            error err = {""};
            if (!isa_is_here((isa)i))
                continue;
            use((isa)i);
            csrbf_solver *solver = csrbf_solver_create(count);
            assert_non_null(solver);
            must(csrbf_factor(solver, &settings, many[0], NULL, count, &err), &err);
            must(csrbf_solve(solver, many[0], &err), &err);
            for (int v = 0; v < VERTICES; ++v)
                for (int axis = 0; axis < 3; ++axis)
                    found[v][axis] = (double)vertex[v][axis];
            csrbf_move_f64(solver, found[0], VERTICES);
            if (i == ISA_GENERIC)
                memcpy(expected, found, sizeof found);
            assert_memory_equal(expected, found, sizeof found);
            csrbf_solver_destroy(solver);
        }
}

/* A single vertex, no controls, controls that reach nothing: nothing moves, or just what should. */
static void the_smallest_shapes_are_performed_on_every_instruction_set(void **state)
{
    (void)state;
    const csrbf_settings settings = {.radius = 5.0};
    const float alone[3] = {1.0f, 2.0f, 3.0f};
    const double at[3] = {1.0, 2.0, 3.0}, far[3] = {900.0, 0.0, 0.0}, way[3] = {0.5, 0.0, -1.0};
    for (int i = 0; i < ISA_COUNT; ++i) {
        error err = {""};
        shape s;
        if (!isa_is_here((isa)i))
            continue;
        use((isa)i);
        must(shape_create(&s, alone, 1, 2, &err), &err);
        must(shape_engage(&s, &settings, at, 0, &err), &err);
        must(shape_pull(&s, way, &err), &err);
        assert_memory_equal(s.shown.x, s.rest.x, s.rest.padded_count * sizeof(float));
        must(shape_engage(&s, &settings, far, 1, &err), &err);
        must(shape_pull(&s, way, &err), &err);
        assert_memory_equal(s.shown.x, s.rest.x, s.rest.padded_count * sizeof(float));
        assert_int_equal(csrbf_move(s.solver, &s.shown, &s.rest), 0);
        must(shape_engage(&s, &settings, at, 1, &err), &err);
        must(shape_pull(&s, way, &err), &err);
        assert_true(fabs((double)s.shown.x[0] - 1.5) < 1e-6);
        assert_true(fabs((double)s.shown.z[0] - 2.0) < 1e-6);
        shape_destroy(&s);
    }
}

static int restore(void **state)
{
    (void)state;
    unsetenv("MAROTTE_ISA");
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_instruction_sets_give_the_same_bits),
        cmocka_unit_test(factors_of_many_centres_have_the_same_bits),
        cmocka_unit_test(the_smallest_shapes_are_performed_on_every_instruction_set),
    };
    printf("best: %s\n", isa_name(isa_best()));
    return cmocka_run_group_tests(tests, fill, restore);
}
