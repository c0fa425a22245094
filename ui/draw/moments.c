#include "draw/moments.h"

#include <math.h>
#include <stdlib.h>

static double distance_from_rest(const mesh *m, const float *position)
{
    double sum = 0.0;
    size_t count = (size_t)m->vertex_count * 3;
    for (size_t i = 0; i < count; ++i) {
        double d = (double)position[i] - (double)m->position[i];
        sum += d * d;
    }
    return m->vertex_count ? sqrt(sum / m->vertex_count) : 0.0;
}

/* first <= frame < end */
static mrt_result furthest(moment *out, const clip *c, uint32_t first, uint32_t end,
                           float *position, error *err)
{
    *out = (moment){.frame = first, .distance_mm = -1.0};
    for (uint32_t frame = first; frame < end; ++frame) {
        mrt_result result = clip_read(c, frame, position, err);
        if (result != MRT_OK)
            return result;
        double distance_mm = distance_from_rest(clip_mesh(c), position);
        if (distance_mm > out->distance_mm)
            *out = (moment){.frame = frame, .distance_mm = distance_mm};
    }
    return MRT_OK;
}

mrt_result moments_choose(moment out[MOMENTS_MAX], uint32_t *out_count, const clip *c, error *err)
{
    *out_count = 0;
    float *position = malloc(((size_t)clip_mesh(c)->vertex_count * 3 + 1) * sizeof *position);
    if (!position)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a frame of the performance");
    uint64_t frame_count = clip_frame_count(c);
    mrt_result result = MRT_OK;
    for (uint64_t eighth = 0; eighth < MOMENTS_MAX && result == MRT_OK; ++eighth) {
        uint32_t first = (uint32_t)(frame_count * eighth / MOMENTS_MAX);
        uint32_t end = (uint32_t)(frame_count * (eighth + 1) / MOMENTS_MAX);
        if (first < end)
            result = furthest(&out[(*out_count)++], c, first, end, position, err);
    }
    free(position);
    return result;
}
