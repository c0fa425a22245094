#include "io/write/component_frames.h"

#include <math.h>
#include <stdlib.h>

/* Squares of what lies farther are not safe in float32. */
static const float FARTHEST_M = 1e4f;

mrt_result component_frames_init(component_frames *out, const clip *c, const float *base_m,
                                 error *err)
{
    uint32_t clip_frames = clip_frame_count(c);
    *out =
        (component_frames){.clip = c, .base_m = base_m, .vertex_count = clip_mesh(c)->vertex_count};
    out->frame = malloc(((size_t)clip_frames + 1) * sizeof *out->frame);
    out->position = malloc((size_t)out->vertex_count * 3 * sizeof *out->position);
    if (!out->frame || !out->position)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the free frames");
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
            return error_set(
                err, MRT_ERR_UNSUPPORTED,
                "frame %u: vertex %zu is not finite or more than %.0f m from its place",
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
