#include "draw/moments.h"

#include <math.h>
#include <stdlib.h>

/* The squared distance of a segment's frames from rest as a polynomial of their vectors:
 * constant + 2 sum_k d_k . linear_k + sum_kl d_k . d_l square_kl. Sums over the vertices, mm. */
typedef struct segment_sums {
    int32_t segment; /* -1: none yet */
    double constant;
    double *linear; /* column_count by 3 */
    double *square; /* column_count by column_count */
} segment_sums;

typedef struct search {
    const clip *clip;
    const mesh *mesh;
    float *position; /* of one frame */
    segment_sums sums;
} search;

static void sums_finish(segment_sums *sums)
{
    free(sums->linear);
    free(sums->square);
    *sums = (segment_sums){.segment = -1};
}

static double product(const float *a, const float *b, uint32_t count)
{
    double sum = 0.0;
    for (uint32_t v = 0; v < count; ++v)
        sum += (double)a[v] * (double)b[v];
    return sum;
}

static void sum_linear(segment_sums *out, const clip_segment *s, const mesh *m)
{
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        for (size_t axis = 0; axis < 3; ++axis) {
            size_t i = (size_t)v * 3 + axis;
            double moved = (double)s->base[i] - (double)m->position[i];
            out->constant += moved * moved;
            for (size_t k = 0; k < s->column_count; ++k)
                out->linear[k * 3 + axis] += (double)s->column[k * m->vertex_count + v] * moved;
        }
}

/* False: no memory. */
static bool sums_init(segment_sums *out, const clip *c, int32_t segment)
{
    const clip_segment *s = clip_segment_at(c, (uint32_t)segment);
    const mesh *m = clip_mesh(c);
    size_t count = s->column_count;
    sums_finish(out);
    out->linear = calloc(count * 3 + 1, sizeof *out->linear);
    out->square = calloc(count * count + 1, sizeof *out->square);
    if (!out->linear || !out->square) {
        sums_finish(out);
        return false;
    }
    out->segment = segment;
    sum_linear(out, s, m);
    for (size_t k = 0; k < count; ++k)
        for (size_t l = 0; l <= k; ++l)
            out->square[k * count + l] = out->square[l * count + k] = product(
                s->column + k * m->vertex_count, s->column + l * m->vertex_count, m->vertex_count);
    return true;
}

static double sums_square(const segment_sums *sums, const double *displacement, size_t count)
{
    double total = sums->constant;
    for (size_t k = 0; k < count; ++k) {
        const double *d = displacement + k * 3, *linear = sums->linear + k * 3;
        total += 2.0 * (d[0] * linear[0] + d[1] * linear[1] + d[2] * linear[2]);
        for (size_t l = 0; l < count; ++l) {
            const double *e = displacement + l * 3;
            total += (d[0] * e[0] + d[1] * e[1] + d[2] * e[2]) * sums->square[k * count + l];
        }
    }
    return total > 0.0 ? total : 0.0; /* rounding at rest */
}

static double square_from_rest(const mesh *m, const float *position)
{
    double sum = 0.0;
    size_t count = (size_t)m->vertex_count * 3;
    for (size_t i = 0; i < count; ++i) {
        double d = (double)position[i] - (double)m->position[i];
        sum += d * d;
    }
    return sum;
}

/* An anchored frame without its vertices, where its segment has more frames than controls: then
 * the sums are the smaller work. */
static bool find_square_anchored(search *self, uint32_t frame, double *out)
{
    int32_t segment = clip_frame_segment(self->clip, frame);
    if (segment < 0)
        return false;
    const clip_segment *s = clip_segment_at(self->clip, (uint32_t)segment);
    if (s->frame_count <= s->column_count)
        return false;
    if (self->sums.segment != segment && !sums_init(&self->sums, self->clip, segment))
        return false;
    *out = sums_square(&self->sums, clip_vector(self->clip, frame), s->column_count);
    return true;
}

static mrt_result find_distance(search *self, uint32_t frame, double *out_mm, error *err)
{
    double square = 0.0;
    if (!find_square_anchored(self, frame, &square)) {
        mrt_result result = clip_read(self->clip, frame, self->position, err);
        if (result != MRT_OK)
            return result;
        square = square_from_rest(self->mesh, self->position);
    }
    *out_mm = self->mesh->vertex_count ? sqrt(square / self->mesh->vertex_count) : 0.0;
    return MRT_OK;
}

/* first <= frame < end */
static mrt_result find_furthest(search *self, uint32_t first, uint32_t end, moment *out, error *err)
{
    *out = (moment){.frame = first, .distance_mm = -1.0};
    for (uint32_t frame = first; frame < end; ++frame) {
        double distance_mm;
        mrt_result result = find_distance(self, frame, &distance_mm, err);
        if (result != MRT_OK)
            return result;
        if (distance_mm > out->distance_mm)
            *out = (moment){.frame = frame, .distance_mm = distance_mm};
    }
    return MRT_OK;
}

mrt_result moments_choose(moment out[MOMENTS_MAX], uint32_t *out_count, const clip *c, error *err)
{
    *out_count = 0;
    search self = {.clip = c, .mesh = clip_mesh(c), .sums = {.segment = -1}};
    self.position = malloc(((size_t)self.mesh->vertex_count * 3 + 1) * sizeof *self.position);
    if (!self.position)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a frame of the performance");
    uint64_t frame_count = clip_frame_count(c);
    mrt_result result = MRT_OK;
    for (uint64_t eighth = 0; eighth < MOMENTS_MAX && result == MRT_OK; ++eighth) {
        uint32_t first = (uint32_t)(frame_count * eighth / MOMENTS_MAX);
        uint32_t end = (uint32_t)(frame_count * (eighth + 1) / MOMENTS_MAX);
        if (first < end)
            result = find_furthest(&self, first, end, &out[(*out_count)++], err);
    }
    sums_finish(&self.sums);
    free(self.position);
    return result;
}
