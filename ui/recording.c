#include "recording.h"

#include <math.h>
#include <stdlib.h>

mrt_result recording_create(recording *out, const mesh *m, double fps, const char *clip_directory,
                            error *err)
{
    *out = (recording){.mesh = m, .min_determinant = 1.0};
    out->clip = clip_create(m, fps, clip_directory, err);
    if (!out->clip)
        return MRT_ERR_IO;
    out->rows = malloc((size_t)m->vertex_count * 3 * sizeof *out->rows);
    out->response = malloc((size_t)m->vertex_count * MRT_MAX_VECTORS * sizeof *out->response);
    if (out->rows && out->response)
        return MRT_OK;
    recording_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for the recording");
}

void recording_destroy(recording *self)
{
    if (!self)
        return;
    clip_destroy(self->clip);
    free(self->rows);
    free(self->response);
    free(self->work_ms);
    *self = (recording){0};
}

static mrt_result keep_work(recording *self, int64_t work_ns, error *err)
{
    if (self->frame_count == self->frame_capacity) {
        uint32_t capacity = self->frame_capacity ? 2 * self->frame_capacity : 1024;
        float *work_ms = realloc(self->work_ms, capacity * sizeof *work_ms);
        if (!work_ms)
            return error_set(err, MRT_ERR_MEMORY, "no memory for the recording");
        self->work_ms = work_ms;
        self->frame_capacity = capacity;
    }
    self->work_ms[self->frame_count++] = (float)((double)work_ns * 1e-6);
    return MRT_OK;
}

/* The engagement as a segment, in the file's order. */
static mrt_result begin_segment(recording *self, const shape *s, error *err)
{
    points_to_rows(self->rows, &s->base, &s->order);
    for (uint32_t k = 0; k < s->control_count; ++k)
        for (uint32_t v = 0; v < s->base.count; ++v)
            self->response[(size_t)k * s->base.count + s->order.file_of_slot[v]] =
                columns_row(&s->response, k)[v];
    return clip_begin_segment(self->clip, self->rows, self->response, s->start, s->control_count,
                              err);
}

static void meter_folds(recording *self, const performer *p)
{
    const shape *s = performer_shape(p);
    const double *displacement = performer_displacement(p);
    if (shape_slope_bound(s, displacement) < 1.0)
        return;
    double determinant = shape_min_determinant(s, displacement);
    if (!(determinant > 0.0))
        self->folded_frames += 1;
    self->min_determinant = fmin(self->min_determinant, determinant);
}

static mrt_result add_anchored(recording *self, const performer *p, error *err)
{
    mrt_result result = MRT_OK;
    uint32_t engagement = performer_engagement(p);
    if (!self->has_segment || engagement != self->engagement)
        result = begin_segment(self, performer_shape(p), err);
    if (result < 0)
        return result;
    self->has_segment = true;
    self->engagement = engagement;
    meter_folds(self, p);
    return clip_add_anchored(self->clip, performer_displacement(p), err);
}

static mrt_result add_free(recording *self, const performer *p, error *err)
{
    const shape *s = performer_shape(p);
    const mrt_pull *pull = performer_pull(p);
    double tip[MRT_MAX_VECTORS * 3];
    for (uint32_t i = 0; i < pull->count; ++i) {
        tip[3 * i] = (double)pull->vector[i].end.x;
        tip[3 * i + 1] = (double)pull->vector[i].end.y;
        tip[3 * i + 2] = (double)pull->vector[i].end.z;
    }
    points_to_rows(self->rows, &s->shown, &s->order);
    return clip_add_free(self->clip, self->rows, tip, pull->count, err);
}

static void measure_motion(recording *self, const shape *s)
{
    const points *a = &s->shown, *b = &s->rest;
    float furthest = 0.0f;
    for (uint32_t v = 0; v < a->count; ++v) {
        float x = a->x[v] - b->x[v], y = a->y[v] - b->y[v], z = a->z[v] - b->z[v];
        furthest = fmaxf(furthest, x * x + y * y + z * z);
    }
    self->furthest_mm = fmax(self->furthest_mm, sqrt((double)furthest));
}

mrt_result recording_add(recording *self, const performer *p, int64_t work_ns, error *err)
{
    mrt_result result = keep_work(self, work_ns, err);
    if (result < 0)
        return result;
    measure_motion(self, performer_shape(p));
    return performer_is_anchored(p) ? add_anchored(self, p, err) : add_free(self, p, err);
}

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

double recording_median_ms(recording *self)
{
    if (self->frame_count == 0)
        return 0.0;
    qsort(self->work_ms, self->frame_count, sizeof *self->work_ms, by_size);
    return (double)self->work_ms[self->frame_count / 2];
}

double recording_worst_ms(recording *self)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < self->frame_count; ++i)
        worst = fmax(worst, (double)self->work_ms[i]);
    return worst;
}
