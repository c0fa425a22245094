/* A frame with bones: four columns more for one that moves; and one whose field is held by pins,
 * whose number must not matter to a frame. */
#include "bench/bench.h"
#include "bench/bench_plane.h"
#include "csrbf/shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PINS_MAX = 1000, BONE_COLUMNS = 4, COLUMNS = BENCH_CONTROLS + BONE_COLUMNS };
static const double radius_mm = 40.0;

typedef struct scene {
    bench_plane plane;
    shape held; /* ten controls and pins */
    double start[(BENCH_CONTROLS + PINS_MAX) * 3], pull[(BENCH_CONTROLS + PINS_MAX) * 3];
    columns with_bone;
    double weight[COLUMNS * 3];
    mrt_result failed;
} scene;

static void run_held(void *data)
{
    scene *self = data;
    mrt_result result = shape_pull(&self->held, self->pull, NULL);
    if (result < 0)
        self->failed = result;
}

static void run_bone(void *data)
{
    scene *self = data;
    columns_move(&self->with_bone, &self->held.shown, &self->held.base, self->weight);
}

/* Pins around the controls, on the sheet's rim and behind it: none within a millimetre of another.
 */
static void lay_pins(scene *self, uint32_t count)
{
    memcpy(self->start, bench_control, sizeof bench_control);
    memset(self->pull, 0, sizeof self->pull);
    memcpy(self->pull, bench_pull, sizeof bench_pull);
    uint32_t side = (uint32_t)ceil(sqrt((double)count));
    for (uint32_t i = 0; i < count; ++i) {
        double *at = self->start + (size_t)3 * (BENCH_CONTROLS + i);
        at[0] = 66.0 * ((double)(i % side) + 0.5) / (double)side - 33.0;
        at[1] = 66.0 * ((double)(i / side) + 0.5) / (double)side - 33.0;
        at[2] = -12.0;
    }
}

/* The ten responses as they are, and a bone that moves half of the sheet: w x, w y, w z, w. */
static mrt_result make_bone(scene *self, error *err)
{
    mrt_result result = columns_create(&self->with_bone, &self->held.base, COLUMNS, err);
    if (result < 0)
        return result;
    const points *base = &self->held.base;
    const float *axis[3] = {base->x, base->y, base->z};
    for (uint32_t k = 0; k < BENCH_CONTROLS; ++k)
        memcpy(columns_row(&self->with_bone, k), columns_row(&self->held.response, k),
               base->padded_count * sizeof(float));
    for (size_t v = 0; v < base->padded_count; ++v) {
        float share = base->y[v] < 0.0f    ? 1.0f
                      : base->y[v] < 10.0f ? 1.0f - base->y[v] / 10.0f
                                           : 0.0f;
        for (uint32_t k = 0; k < 3; ++k)
            columns_row(&self->with_bone, BENCH_CONTROLS + k)[v] = share * axis[k][v];
        columns_row(&self->with_bone, BENCH_CONTROLS + 3)[v] = share;
    }
    columns_note(&self->with_bone, COLUMNS);
    memcpy(self->weight, bench_pull, sizeof bench_pull);
    for (int i = BENCH_CONTROLS * 3; i < COLUMNS * 3; ++i)
        self->weight[i] = 0.01 * (double)(i % 7 - 3);
    return MRT_OK;
}

static void tell(bench *self, const char *what, uint32_t pins, double took_ns, double plain_ns)
{
    char label[32], line[128];
    snprintf(label, sizeof label, "%u pins", pins);
    snprintf(line, sizeof line, "%-26s %8.4f ms %6.3f x ten columns", what, took_ns * 1e-6,
             took_ns / plain_ns);
    const facts_cell cells[] = {
        {"what", what, 0.0, 0},
        {"pins", NULL, pins, 0},
        {"frame_ns", NULL, took_ns, 1},
        {"over_ten_columns", NULL, took_ns / plain_ns, 4},
    };
    facts_row(self->told, "bones", label, line, cells, sizeof cells / sizeof cells[0]);
}

/* Beside the same frame without pins, in turns. */
static mrt_result measure_pins(bench *self, scene *plain, scene *held, uint32_t pins, error *err)
{
    const csrbf_settings settings = {.radius = radius_mm};
    lay_pins(held, pins);
    mrt_result result = shape_create(&held->held, plain->plane.xyz, plain->plane.vertex_count,
                                     BENCH_CONTROLS + pins, err);
    if (result >= 0)
        result = shape_engage(&held->held, &settings, held->start, BENCH_CONTROLS + pins, err);
    if (result >= 0) {
        bench_work work[] = {{.name = "plain", .run = run_held, .data = plain},
                             {.name = "held", .run = run_held, .data = held}};
        bench_measure(work, 2, 4 * self->rounds, self->seconds);
        tell(self, "field held by pins", pins, work[1].least_ns, work[0].least_ns);
        if (pins == PINS_MAX || self->is_quick)
            bench_at_most(self, "a field held by pins, over one without",
                          work[1].least_ns / work[0].least_ns, 1.05);
    }
    shape_destroy(&held->held);
    held->held = (shape){0};
    return result;
}

static mrt_result measure(bench *self, scene *plain, scene *held, error *err)
{
    static const uint32_t pins[] = {200, 500, PINS_MAX};
    const csrbf_settings settings = {.radius = radius_mm};
    lay_pins(plain, 0);
    mrt_result result = bench_plane_create(&plain->plane, 128, true, err);
    if (result >= 0)
        result = shape_create(&plain->held, plain->plane.xyz, plain->plane.vertex_count,
                              BENCH_CONTROLS, err);
    if (result >= 0)
        result = shape_engage(&plain->held, &settings, plain->start, BENCH_CONTROLS, err);
    if (result >= 0)
        result = make_bone(plain, err);
    if (result < 0)
        return result;
    bench_work work[] = {{.name = "ten", .run = run_held, .data = plain},
                         {.name = "fourteen", .run = run_bone, .data = plain}};
    bench_measure(work, 2, 4 * self->rounds, self->seconds);
    tell(self, "ten columns and a bone", 0, work[1].least_ns, work[0].least_ns);
    bench_at_most(self, "fourteen columns, over ten", work[1].least_ns / work[0].least_ns, 1.5);
    for (size_t i = 0; i < sizeof pins / sizeof pins[0] && result >= 0; ++i)
        if (!self->is_quick || pins[i] < PINS_MAX)
            result = measure_pins(self, plain, held, pins[i], err);
    if (result >= 0 && (plain->failed < 0 || held->failed < 0))
        return error_set(err, MRT_ERR_UNSUPPORTED, "the engine refused a frame of the bench");
    return result;
}

mrt_result bench_bones(bench *self, error *err)
{
    scene *scenes = calloc(2, sizeof *scenes);
    if (!scenes)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    bench_title(self, "Bones: 33 025 vertices, R = 40 mm");
    mrt_result result = measure(self, &scenes[0], &scenes[1], err);
    columns_destroy(&scenes[0].with_bone);
    shape_destroy(&scenes[0].held);
    bench_plane_destroy(&scenes[0].plane);
    free(scenes);
    return result;
}
