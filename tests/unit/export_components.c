#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/isa.h"
#include "export_scene.h"
#include "io/write/components.h"
#include "io/write/frame_block.h"
#include "io/write/symmetric.h"

/* Greatest distance in mm between what was found and a frame. */
static double frame_error_mm(const components *found, const component_window *window,
                             uint32_t frame, const float *shape, const float *base_m)
{
    size_t length = (size_t)found->vertex_count * 3;
    double greatest = 0.0, *at = malloc(length * sizeof *at);
    float *offset = malloc(length * sizeof *offset);
    for (size_t i = 0; i < length; ++i)
        at[i] = (double)base_m[i] + (window->base ? (double)window->base[i] : 0.0);
    for (uint32_t j = 0; j < window->count; ++j) {
        double weight = (double)window->weight[(size_t)frame * window->count + j];
        components_offset(offset, found, window, j);
        for (size_t i = 0; i < length; ++i)
            at[i] += weight * (double)offset[i];
    }
    for (size_t i = 0; i < length; i += 3) {
        double x = at[i] * 1000.0 - (double)shape[i], y = at[i + 1] * 1000.0 - (double)shape[i + 1],
               z = at[i + 2] * 1000.0 - (double)shape[i + 2];
        greatest = fmax(greatest, sqrt(x * x + y * y + z * z));
    }
    free(at);
    free(offset);
    return greatest;
}

/* Over all frames of the clip, each in the window that it belongs to. */
static double true_error_mm(const components *found, const clip *c, const float *base_m)
{
    error err;
    float *shape = malloc((size_t)found->vertex_count * 3 * sizeof *shape);
    double greatest = 0.0;
    uint32_t seen = 0;
    for (uint32_t w = 0; w < found->window_count; ++w) {
        const component_window *window = &found->window[w];
        assert_int_equal(window->first_frame, seen);
        for (uint32_t f = 0; f < window->frame_count; ++f, ++seen) {
            assert_int_equal(clip_read(c, found->frame[seen], shape, &err), MRT_OK);
            greatest = fmax(greatest, frame_error_mm(found, window, f, shape, base_m));
        }
    }
    assert_int_equal(seen, found->frame_count);
    free(shape);
    return greatest;
}

static float *metres(const mesh *m)
{
    float *out = malloc((size_t)m->vertex_count * 3 * sizeof *out);
    assert_non_null(out);
    for (size_t i = 0; i < (size_t)m->vertex_count * 3; ++i)
        out[i] = (float)((double)m->position[i] * 0.001);
    return out;
}

static void motion_of_rank_two_needs_two_components(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(13);
    size_t length = (size_t)m.vertex_count * 3;
    float *base_m = metres(&m), *shape = malloc(length * sizeof *shape);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    for (int frame = 0; frame < 500; ++frame) {
        for (size_t i = 0; i < length; ++i) {
            double a = scene_bump(m.position + i / 3 * 3, 20.0, 10.0, 60.0);
            double b = scene_bump(m.position + i / 3 * 3, -30.0, -40.0, 50.0);
            shape[i] = m.position[i] + (float)(9.0 * a * sin(0.1 * frame) +
                                               4.0 * b * (double)(i % 3) * cos(0.07 * frame));
        }
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
    }
    components found;
    components_request wanted = {.base_m = base_m, .tolerance_mm = 0.01};
    assert_int_equal(components_find(&found, c, &wanted, NULL, &err), MRT_OK);
    assert_int_equal(found.target_count, 3); /* and what they are counted from */
    assert_int_equal(found.window[0].count, 2);
    assert_int_equal(found.frame_count, 500);
    assert_true(true_error_mm(&found, c, base_m) <= 0.01);
    assert_int_equal(found.window_count, 1);
    for (size_t i = 0; i < (size_t)found.frame_count * 2; ++i)
        assert_true(found.window[0].weight[i] >= 0.0f && found.window[0].weight[i] <= 1.0f);
    components_finish(&found);
    clip_destroy(c);
    mesh_destroy(&m);
    free(base_m);
    free(shape);
}

/* Every frame its own noise: no component helps another frame, the worst case for the search. */
static void noise_holds_the_tolerance_or_says_that_it_does_not(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(8);
    size_t length = (size_t)m.vertex_count * 3;
    float *base_m = metres(&m), *shape = malloc(length * sizeof *shape);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    uint32_t noise = 7;
    for (int frame = 0; frame < 700; ++frame) {
        for (size_t i = 0; i < length; ++i) {
            noise = noise * 1664525u + 1013904223u;
            shape[i] = m.position[i] + (float)((double)(noise >> 8) / (1 << 24) * 10.0 - 5.0);
        }
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
    }
    components found;
    components_request wanted = {.base_m = base_m, .tolerance_mm = 0.05};
    assert_int_equal(components_find(&found, c, &wanted, NULL, &err), MRT_OK);
    assert_true(found.target_count <= length + 1);
    assert_true(found.max_error_mm <= 0.05);
    assert_true(fabs(true_error_mm(&found, c, base_m) - found.max_error_mm) < 1e-4);
    components_finish(&found);
    wanted.max_count = 40;
    assert_int_equal(components_find(&found, c, &wanted, NULL, &err), MRT_OK);
    assert_int_equal(found.target_count, 40);
    assert_true(found.max_error_mm > 1.0);
    assert_true(fabs(true_error_mm(&found, c, base_m) - found.max_error_mm) < 1e-4);
    components_finish(&found);
    clip_destroy(c);
    mesh_destroy(&m);
    free(base_m);
    free(shape);
}

static void a_clip_without_free_frames_has_no_components(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(4);
    float *base_m = metres(&m);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    scene_add_anchored(c, 3, 0.0);
    components found;
    components_request wanted = {.base_m = base_m, .tolerance_mm = 0.1};
    assert_int_equal(components_find(&found, c, &wanted, NULL, &err), MRT_OK);
    assert_int_equal(found.target_count, 0);
    assert_int_equal(found.frame_count, 0);
    components_finish(&found);
    components_finish(NULL);
    clip_destroy(c);
    mesh_destroy(&m);
    free(base_m);
}

static void eigenvectors_solve_their_matrix(void **state)
{
    (void)state;
    enum { N = 60, RANK = 25 }; /* the last 35 eigenvalues are 0 */
    static double given[N * N], vector[N * N], value[N], work[N * (N + 3)], factor[N * RANK];
    error err;
    for (size_t i = 0; i < N * RANK; ++i)
        factor[i] = sin(1.0 + 1.7 * (double)i + 0.003 * (double)(i * i)) / (double)(1 + i % RANK);
    for (size_t i = 0; i < N * N; ++i)
        for (size_t k = 0; k < RANK; ++k)
            given[i] += factor[i / N * RANK + k] * factor[i % N * RANK + k];
    memcpy(vector, given, sizeof vector);
    assert_int_equal(symmetric_eigen(vector, value, work, N, &err), MRT_OK);
    for (size_t i = 0; i < N; ++i) {
        assert_true(i == 0 || value[i] <= value[i - 1]);
        assert_true(i < RANK || fabs(value[i]) < 1e-12 * value[0]);
        for (size_t row = 0; row < N; ++row) {
            double product = 0.0, inner = 0.0;
            for (size_t k = 0; k < N; ++k) {
                product += given[row * N + k] * vector[i * N + k];
                inner += vector[row * N + k] * vector[i * N + k];
            }
            assert_true(fabs(product - value[i] * vector[i * N + row]) < 1e-12 * value[0]);
            assert_true(fabs(inner - (row == i)) < 1e-12);
        }
    }
}

/* Rows and elements that fill no panel and no tile. */
static void every_instruction_set_finds_the_same_bits(void **state)
{
    (void)state;
    enum { ROWS = 37, LENGTH = 1003 };
    static float row[ROWS * LENGTH], block[2][LENGTH * FRAME_BLOCK], weight[ROWS * FRAME_BLOCK];
    static double dot[2][ROWS * FRAME_BLOCK];
    for (int i = 0; i < ROWS * LENGTH; ++i)
        row[i] = (float)((i * 7919) % 2003) * 1e-3f - 1.0f;
    for (int i = 0; i < ROWS * FRAME_BLOCK; ++i)
        weight[i] = (float)((i * 104729) % 4001) * 3e-4f - 0.6f;
    for (int which = 0; which < ISA_COUNT; ++which) {
        int at = which > 0;
        if (!isa_is_here((isa)which))
            continue;
        for (int i = 0; i < LENGTH * FRAME_BLOCK; ++i)
            block[at][i] = (float)((i * 15485863LL) % 3001) * 1e-3f - 1.5f;
        assert_int_equal(setenv("MAROTTE_ISA", isa_name((isa)which), 1), 0);
        frame_block_dot(dot[at], row, ROWS, block[at], LENGTH);
        frame_block_subtract(block[at], row, ROWS, weight, LENGTH);
        assert_memory_equal(dot[at], dot[0], sizeof dot[0]);
        assert_memory_equal(block[at], block[0], sizeof block[0]);
    }
    assert_int_equal(unsetenv("MAROTTE_ISA"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(motion_of_rank_two_needs_two_components),
        cmocka_unit_test(noise_holds_the_tolerance_or_says_that_it_does_not),
        cmocka_unit_test(a_clip_without_free_frames_has_no_components),
        cmocka_unit_test(eigenvectors_solve_their_matrix),
        cmocka_unit_test(every_instruction_set_finds_the_same_bits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
