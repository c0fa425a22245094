/* However many threads take part, all that the engine computes has the same bits: moves, responses
 * and their derivatives, meters, frames, drags; on sizes that no part of the work divides. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/pool.h"
#include "csrbf/shape.h"
#include "property/csrbf_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VERTICES_MAX = 9000, CONTROLS = 37, LAYERS = 2 };
static const uint32_t sizes[] = {1, 64, 65, 1023, 1025, 2113, VERTICES_MAX};

static float vertex[VERTICES_MAX][3];
static double start[CONTROLS][3], pull[CONTROLS][3], end[CONTROLS][3];

static int fill(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int i = 0; i < VERTICES_MAX; ++i)
        for (int axis = 0; axis < 3; ++axis)
            vertex[i][axis] = (float)scene_number(&seed, 2.5);
    for (int k = 0; k < CONTROLS; ++k)
        for (int axis = 0; axis < 3; ++axis) {
            start[k][axis] = scene_number(&seed, 2.5);
            pull[k][axis] = scene_number(&seed, 0.2);
            end[k][axis] = start[k][axis] + pull[k][axis];
        }
    return setenv("MAROTTE_THREADS", "1", 1);
}

/* Everything that comes of one setting, as bytes. */
typedef struct outcome {
    float moved[VERTICES_MAX][3], pulled[VERTICES_MAX][3], dragged[VERTICES_MAX][3];
    float layered[VERTICES_MAX][3];
    float response[CONTROLS][VERTICES_MAX];
    uint32_t touched;
    double slope, determinant;
    shape_step step, layered_step;
} outcome;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void keep_rows(float out[CONTROLS][VERTICES_MAX], const columns *c, uint32_t count)
{
    for (uint32_t k = 0; k < CONTROLS; ++k)
        memcpy(out[k], columns_row(c, k), count * sizeof(float));
}

/* Two fields that each have half of the controls and a share of every vertex. */
static void drag_layers(outcome *out, shape *s, const csrbf_settings *settings)
{
    error err = {""};
    double kept[3][CONTROLS][3];
    uint32_t control[LAYERS][CONTROLS];
    drag_layer layer[LAYERS];
    float *weight = calloc(s->shown.padded_count, sizeof *weight);
    assert_non_null(weight);
    for (uint32_t slot = 0; slot < s->shown.padded_count; ++slot)
        weight[slot] = (float)(slot % 16) / 16.0f;
    for (uint32_t i = 0; i < LAYERS; ++i) {
        layer[i] = (drag_layer){
            .solver = csrbf_solver_create(CONTROLS), .weight = weight, .control = control[i]};
        assert_non_null(layer[i].solver);
        for (uint32_t k = i; k < CONTROLS; k += LAYERS)
            control[i][layer[i].control_count++] = k;
    }
    const drag d = {.moved = &s->shown,
                    .before = &s->before,
                    .layer = layer,
                    .layer_count = LAYERS,
                    .control_capacity = CONTROLS,
                    .tip = kept[0][0],
                    .step = kept[1][0],
                    .pull = kept[2][0]};
    const drag_way way = {.from = start[0], .to = end[0], .count = CONTROLS};
    must(drag_along(&d, settings, &way, NULL, &out->layered_step, &err), &err);
    points_to_rows(out->layered[0], &s->shown, &s->order);
    for (uint32_t i = 0; i < LAYERS; ++i)
        csrbf_solver_destroy(layer[i].solver);
    free(weight);
}

static void perform(outcome *out, uint32_t count, const csrbf_settings *settings)
{
    error err = {""};
    shape s;
    memset(out, 0, sizeof *out);
    must(shape_create(&s, vertex[0], count, CONTROLS, &err), &err);
    must(shape_engage(&s, settings, start[0], CONTROLS, &err), &err);
    keep_rows(out->response, &s.response, count);
    must(shape_pull(&s, pull[0], &err), &err);
    points_to_rows(out->pulled[0], &s.shown, &s.order);
    must(csrbf_solve(s.solver, pull[0], &err), &err);
    out->touched = csrbf_move(s.solver, &s.shown, &s.rest);
    points_to_rows(out->moved[0], &s.shown, &s.order);
    csrbf_measure(s.solver, &s.rest, &out->slope, &out->determinant);
    shape_reset(&s);
    must(shape_drag(&s, settings, start[0], end[0], CONTROLS, NULL, &out->step, &err), &err);
    points_to_rows(out->dragged[0], &s.shown, &s.order);
    shape_reset(&s);
    drag_layers(out, &s, settings);
    shape_destroy(&s);
}

static void compare(uint32_t count, const csrbf_settings *settings)
{
    static outcome expected, found;
    static const char *const threads[] = {"2", "3"};
    pool_share_from((double)INFINITY);
    perform(&expected, count, settings);
    pool_share_from(0.0);
    for (size_t i = 0; i < sizeof threads / sizeof *threads; ++i) {
        setenv("MAROTTE_THREADS", threads[i], 1);
        pool_hold();
        uint64_t before = pool_state_now().shared_count;
        perform(&found, count, settings);
        if (count > 1024)
            assert_true(pool_state_now().shared_count > before + 6);
        pool_release();
        if (memcmp(&found, &expected, sizeof found) != 0)
            fail_msg("%s threads, %u vertices: other bits: kernel %d, polynomial %d, R %g",
                     threads[i], count, (int)settings->kernel, (int)settings->polynomial,
                     settings->radius);
    }
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
        compare(sizes[i], &(csrbf_settings){.radius = 0.4});
        compare(sizes[i], &(csrbf_settings){.radius = 1.5});
    }
}

static void whatever_the_kernel_and_the_polynomial(void **state)
{
    (void)state;
    for (int kernel = 0; kernel <= CSRBF_WENDLAND_C6; ++kernel)
        for (int polynomial = 0; polynomial <= CSRBF_WINDOWED; ++polynomial)
            compare(1025, &(csrbf_settings){.kernel = (csrbf_kernel)kernel,
                                            .polynomial = (csrbf_polynomial)polynomial,
                                            .radius = 1.0});
}

/* A radius so large that float evaluation would be noise. */
static void and_in_double(void **state)
{
    (void)state;
    compare(2113, &(csrbf_settings){.radius = 200.0});
}

static int restore(void **state)
{
    (void)state;
    pool_share_from(POOL_WORTH_NS);
    return unsetenv("MAROTTE_THREADS");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(whatever_the_kernel_and_the_polynomial),
        cmocka_unit_test(and_in_double),
    };
    return cmocka_run_group_tests(tests, fill, restore);
}
