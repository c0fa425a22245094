#include "io/write/component_frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Maximum offset: the squares of larger offsets are not safe in float32. */
static const float FARTHEST_M = 1e4f;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to read the free frames");
}

mrt_result component_frames_init(component_frames *out, const clip *c, const float *base_m,
                                 error *err)
{
    uint32_t clip_frames = clip_frame_count(c);
    *out =
        (component_frames){.clip = c, .base_m = base_m, .vertex_count = clip_mesh(c)->vertex_count};
    out->frame = malloc(((size_t)clip_frames + 1) * sizeof *out->frame);
    out->position = malloc((size_t)out->vertex_count * 3 * sizeof *out->position);
    if (!out->frame || !out->position)
        return no_memory(err);
    for (uint32_t i = 0; i < clip_frames; ++i)
        if (clip_frame_segment(c, i) < 0)
            out->frame[out->count++] = i;
    return MRT_OK;
}

void component_frames_finish(component_frames *f)
{
    free(f->frame);
    free(f->position);
    *f = (component_frames){0};
}

mrt_result component_frames_read(component_frames *f, uint32_t index, float *out, error *err)
{
    size_t length = (size_t)f->vertex_count * 3;
    mrt_result result = clip_read(f->clip, f->frame[index], f->position, err);
    if (result < 0)
        return result;
    for (size_t d = 0; d < length; ++d)
        out[d] = (float)((double)f->position[d] * 0.001 - (double)f->base_m[d]);
    for (size_t d = 0; d < length; ++d)
        if (!(fabsf(out[d]) <= FARTHEST_M))
            return error_set(err, MRT_ERR_UNSUPPORTED,
                             "frame %u: vertex %zu is not finite or moved more than %.0f m",
                             f->frame[index], d / 3, (double)FARTHEST_M);
    return MRT_OK;
}

uint32_t component_frames_spread(uint32_t i, uint32_t picked, uint32_t count)
{
    return picked < 2 ? 0 : (uint32_t)((uint64_t)i * (count - 1) / (picked - 1));
}

float component_frames_peak(const float *offset, size_t vertex_count)
{
    float greatest = 0.0f;
    for (const float *v = offset, *end = offset + vertex_count * 3; v < end; v += 3) {
        float square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        greatest = square > greatest ? square : greatest;
    }
    return greatest;
}

/* ---- the frames of one window ---- */

typedef struct survey {
    double *sum;
    float *low, *high, *before; /* 3 per vertex each */
} survey;

static void see_frame(survey *all, const float *offset, size_t length)
{
    for (size_t d = 0; d < length; ++d) {
        float at = offset[d], low = all->low[d], high = all->high[d];
        all->sum[d] += (double)at;
        all->low[d] = low < at ? low : at;
        all->high[d] = high > at ? high : at;
    }
}

/* Returns the largest movement of a vertex since the previous frame. */
static double step_from_before(const survey *all, const float *offset, size_t length)
{
    float greatest = 0.0f;
    for (size_t d = 0; d < length; d += 3) {
        float x = offset[d] - all->before[d], y = offset[d + 1] - all->before[d + 1],
              z = offset[d + 2] - all->before[d + 2];
        float square = x * x + y * y + z * z;
        greatest = square > greatest ? square : greatest;
    }
    return sqrt((double)greatest);
}

static mrt_result survey_frames(window_frames *w, survey *all, error *err)
{
    size_t length = (size_t)w->frames->vertex_count * 3;
    for (uint32_t i = 0; i < w->count; ++i) {
        mrt_result result = component_frames_read(w->frames, w->first + i, w->offset, err);
        if (result < 0)
            return result;
        if (i == 0) {
            memcpy(all->low, w->offset, length * sizeof *all->low);
            memcpy(all->high, w->offset, length * sizeof *all->high);
            memcpy(all->before, w->offset, length * sizeof *all->before);
        }
        see_frame(all, w->offset, length);
        w->step_m[i] = step_from_before(all, w->offset, length);
        memcpy(all->before, w->offset, length * sizeof *all->before);
    }
    return MRT_OK;
}

/* Computes the mean. A vertex that never moves keeps its exact position. */
static void find_base(window_frames *w, const survey *all, float still)
{
    for (size_t v = 0; v < w->frames->vertex_count; ++v) {
        float mean[3];
        for (size_t axis = 0; axis < 3; ++axis)
            mean[axis] = (float)(all->sum[v * 3 + axis] / (double)w->count);
        bool is_there = component_frames_peak(mean, 1) > still;
        for (size_t axis = 0; axis < 3 && is_there; ++axis)
            w->base[v * 3 + axis] = mean[axis];
        w->has_base = w->has_base || is_there;
    }
}

static void find_moved(window_frames *w, const survey *all, float still)
{
    for (uint32_t v = 0; v < w->frames->vertex_count; ++v) {
        float farthest[3];
        for (size_t axis = 0; axis < 3; ++axis) {
            size_t d = (size_t)v * 3 + axis;
            farthest[axis] = fmaxf(all->high[d] - w->base[d], w->base[d] - all->low[d]);
        }
        w->is_moved[v] = component_frames_peak(farthest, 1) > still;
        if (w->is_moved[v])
            w->moved[w->moved_count++] = v;
    }
}

static mrt_result find_base_and_moved(window_frames *w, window_base base, double tolerance_m,
                                      error *err)
{
    size_t length = (size_t)w->frames->vertex_count * 3;
    double threshold_m = tolerance_m * COMPONENT_STILL_SHARE;
    float still = (float)(threshold_m * threshold_m);
    survey all = {calloc(length, sizeof(double)), calloc(length, sizeof(float)),
                  calloc(length, sizeof(float)), calloc(length, sizeof(float))};
    mrt_result result =
        all.sum && all.low && all.high && all.before ? survey_frames(w, &all, err) : no_memory(err);
    if (result == MRT_OK && base == WINDOW_BASE_MEAN)
        find_base(w, &all, still);
    if (result == MRT_OK)
        find_moved(w, &all, still);
    free(all.sum);
    free(all.low);
    free(all.high);
    free(all.before);
    return result;
}

static void see_still(window_frames *w)
{
    for (size_t v = 0; v < w->frames->vertex_count; ++v) {
        if (w->is_moved[v])
            continue;
        float away[3];
        for (size_t axis = 0; axis < 3; ++axis)
            away[axis] = w->offset[v * 3 + axis] - w->base[v * 3 + axis];
        w->still_peak = fmaxf(w->still_peak, component_frames_peak(away, 1));
    }
}

mrt_result window_frames_init(window_frames *out, component_frames *frames, uint32_t first,
                              uint32_t count, window_base base, double tolerance_m, error *err)
{
    size_t vertex_count = frames->vertex_count;
    *out = (window_frames){.frames = frames, .first = first, .count = count};
    out->base = calloc(vertex_count * 3, sizeof *out->base);
    out->is_moved = calloc(vertex_count, sizeof *out->is_moved);
    out->moved = calloc(vertex_count, sizeof *out->moved);
    out->step_m = calloc(count, sizeof *out->step_m);
    out->offset = calloc(vertex_count * 3, sizeof *out->offset);
    if (!out->base || !out->is_moved || !out->moved || !out->step_m || !out->offset)
        return no_memory(err);
    return find_base_and_moved(out, base, tolerance_m, err);
}

void window_frames_finish(window_frames *w)
{
    free(w->base);
    free(w->is_moved);
    free(w->moved);
    free(w->step_m);
    free(w->offset);
    *w = (window_frames){0};
}

mrt_result window_frames_read(window_frames *w, uint32_t index, float *out, error *err)
{
    mrt_result result = component_frames_read(w->frames, w->first + index, w->offset, err);
    if (result < 0)
        return result;
    see_still(w);
    for (uint32_t i = 0; i < w->moved_count; ++i) {
        size_t from = (size_t)w->moved[i] * 3;
        for (size_t axis = 0; axis < 3; ++axis)
            out[(size_t)i * 3 + axis] = w->offset[from + axis] - w->base[from + axis];
    }
    return MRT_OK;
}
