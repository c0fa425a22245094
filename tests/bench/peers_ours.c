/* The engine as a shared library for peers.py and peers_blender.py: the same sheet of 33 025
 * vertices and ten controls that the peers get, timed by the engine's own clock in their process.
 */
#include "base/clock.h"
#include "csrbf/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OURS __attribute__((visibility("default")))

enum { QUADS = 128, CONTROLS = 10 };
static const double side_mm = 66.12;
static const double control_xy[CONTROLS][2] = {
    {3.01, 19.56},  {-3.01, 19.56}, {8.19, 9.01},  {-8.19, 9.01},  {26.86, 9.52},
    {-26.86, 9.52}, {8.97, 0.71},   {-8.97, 0.71}, {26.94, 29.64}, {-26.94, 29.64}};

typedef struct ours {
    shape shape, unanchored; /* shape: engaged */
    double radius_mm;
    double start[CONTROLS * 3], pull[CONTROLS * 3];
    float *xyz;
} ours;

/* Bent, so that peers with a linear polynomial have a solution. */
static float height(double x, double y)
{
    return (float)(-(x * x + 0.7 * y * y) / 120.0);
}

static float *make_sheet(uint32_t *out_count)
{
    uint32_t row = QUADS + 1, count = row * row + QUADS * QUADS, at = 0;
    float *xyz = malloc((size_t)count * 3 * sizeof *xyz);
    for (uint32_t centre = 0; centre < 2 && xyz; ++centre)
        for (uint32_t j = 0; j + centre < row; ++j)
            for (uint32_t i = 0; i + centre < row; ++i) {
                double x = (((double)i + 0.5 * centre) / QUADS - 0.5) * side_mm;
                double y = (((double)j + 0.5 * centre) / QUADS - 0.5) * side_mm;
                xyz[at++] = (float)x;
                xyz[at++] = (float)y;
                xyz[at++] = height(x, y);
            }
    *out_count = count;
    return xyz;
}

OURS void ours_destroy(void *of);
OURS void ours_destroy(void *of)
{
    ours *self = of;
    if (!self)
        return;
    shape_destroy(&self->shape);
    shape_destroy(&self->unanchored);
    free(self->xyz);
    free(self);
}

OURS void *ours_create(double radius_mm);
OURS void *ours_create(double radius_mm)
{
    const csrbf_settings settings = {.radius = radius_mm};
    uint32_t count = 0;
    ours *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->xyz = make_sheet(&count);
    self->radius_mm = radius_mm;
    for (int i = 0; i < CONTROLS; ++i) {
        self->start[3 * i] = control_xy[i][0];
        self->start[3 * i + 1] = control_xy[i][1];
        self->start[3 * i + 2] = (double)height(control_xy[i][0], control_xy[i][1]);
        for (int axis = 0; axis < 3; ++axis)
            self->pull[3 * i + axis] = 0.3 * (double)((i * 7 + axis * 5) % 11 - 5);
    }
    if (self->xyz && shape_create(&self->shape, self->xyz, count, CONTROLS, NULL) >= 0 &&
        shape_create(&self->unanchored, self->xyz, count, CONTROLS, NULL) >= 0 &&
        shape_engage(&self->shape, &settings, self->start, CONTROLS, NULL) >= 0)
        return self;
    ours_destroy(self);
    return NULL;
}

OURS uint32_t ours_count(const void *of);
OURS uint32_t ours_count(const void *of)
{
    return ((const ours *)of)->shape.rest.count;
}

OURS void ours_rows(const void *of, float *xyz, double *start, double *pull, float *response);
/* response: count by 10, of the vertices in the file's order. */
OURS void ours_rows(const void *of, float *xyz, double *start, double *pull, float *response)
{
    const ours *self = of;
    memcpy(xyz, self->xyz, (size_t)ours_count(of) * 3 * sizeof *xyz);
    memcpy(start, self->start, sizeof self->start);
    memcpy(pull, self->pull, sizeof self->pull);
    for (size_t slot = 0; slot < self->shape.rest.count; ++slot)
        for (uint32_t k = 0; k < CONTROLS; ++k)
            response[(size_t)self->shape.order.file_of_slot[slot] * CONTROLS + k] =
                columns_row(&self->shape.response, k)[slot];
}

OURS double ours_anchored_ns(void *of, uint32_t rounds);
OURS double ours_anchored_ns(void *of, uint32_t rounds)
{
    ours *self = of;
    double least_ns = 1e30;
    for (uint32_t i = 0; i < rounds; ++i) {
        int64_t start_ns = clock_now_ns();
        if (shape_pull(&self->shape, self->pull, NULL) < 0)
            return 0.0;
        least_ns = fmin(least_ns, (double)(clock_now_ns() - start_ns));
    }
    return least_ns;
}

/* All that an unanchored sample costs, in one step as the paper has it: order, factor, solve,
 * slope, update. A peer sets its transform up from the same pairs and moves the same vertices. */
OURS double ours_unanchored_ns(void *of, uint32_t rounds);
OURS double ours_unanchored_ns(void *of, uint32_t rounds)
{
    ours *self = of;
    const csrbf_settings settings = {.radius = self->radius_mm, .is_one_step = true};
    double least_ns = 1e30, end[CONTROLS * 3];
    for (int i = 0; i < CONTROLS * 3; ++i)
        end[i] = self->start[i] + self->pull[i];
    for (uint32_t i = 0; i < rounds; ++i) {
        shape_step step;
        shape_reset(&self->unanchored);
        int64_t start_ns = clock_now_ns();
        if (shape_drag(&self->unanchored, &settings, self->start, end, CONTROLS, NULL, &step,
                       NULL) < 0)
            return 0.0;
        least_ns = fmin(least_ns, (double)(clock_now_ns() - start_ns));
    }
    return least_ns;
}

OURS void ours_shown(const void *of, float *xyz);
OURS void ours_shown(const void *of, float *xyz)
{
    const ours *self = of;
    points_to_rows(xyz, &self->shape.shown, &self->shape.order);
}
