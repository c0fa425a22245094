#include "draw/thumbnails.h"

#include <math.h>
#include <stdlib.h>

enum { TRIED_MAX = 32 }; /* frames of an eighth: more of them show nothing else to a person */

static double distance_from_rest_mm(const mesh *m, const float *position)
{
    double square = 0.0;
    size_t count = (size_t)m->vertex_count * 3;
    for (size_t i = 0; i < count; ++i) {
        double d = (double)position[i] - (double)m->position[i];
        square += d * d;
    }
    return m->vertex_count ? sqrt(square / m->vertex_count) : 0.0;
}

/* first <= frame < end; scratch: vertex_count by 3. */
static mrt_result find_furthest(thumbnail *out, const clip *c, uint32_t first, uint32_t end,
                                float *scratch, error *err)
{
    uint32_t tried = end - first < TRIED_MAX ? end - first : TRIED_MAX;
    *out = (thumbnail){.frame = first, .distance_mm = -1.0};
    for (uint32_t i = 0; i < tried; ++i) {
        uint32_t frame = first + (uint32_t)((uint64_t)(end - first) * i / tried);
        mrt_result result = clip_read(c, frame, scratch, err);
        if (result != MRT_OK)
            return result;
        double distance_mm = distance_from_rest_mm(clip_mesh(c), scratch);
        if (distance_mm > out->distance_mm)
            *out = (thumbnail){.frame = frame, .distance_mm = distance_mm};
    }
    return MRT_OK;
}

mrt_result thumbnails_choose(thumbnail out[THUMBNAILS_MAX], uint32_t *out_count, const clip *c,
                             error *err)
{
    *out_count = 0;
    float *scratch = malloc(((size_t)clip_mesh(c)->vertex_count * 3 + 1) * sizeof *scratch);
    if (!scratch)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a frame of the performance");
    uint64_t frame_count = clip_frame_count(c);
    mrt_result result = MRT_OK;
    for (uint64_t eighth = 0; eighth < THUMBNAILS_MAX && result == MRT_OK; ++eighth) {
        uint32_t first = (uint32_t)(frame_count * eighth / THUMBNAILS_MAX);
        uint32_t end = (uint32_t)(frame_count * (eighth + 1) / THUMBNAILS_MAX);
        if (first < end)
            result = find_furthest(&out[(*out_count)++], c, first, end, scratch, err);
    }
    free(scratch);
    return result;
}
