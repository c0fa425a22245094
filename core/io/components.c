#include "io/components.h"

#include "io/basis.h"
#include "io/frame_block.h"
#include "io/symmetric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* At most so many frames, and so many bytes of them, are looked at to find candidate axes. */
enum { MAX_PICKED = 384, MAX_PICKED_BYTES = 96 << 20 };
/* Share of the tolerance that is used: the rest covers what float32 sums lose. */
static const double TOLERANCE_SHARE = 0.999;
/* Squares of what lies farther are not safe in float32. */
static const float FARTHEST_M = 1e4f;
/* Axes weaker than this share of the strongest are rounding of the Gram matrix. */
static const double NOISE = 1e-12;

typedef struct search {
    const clip *clip;
    const float *base_m;
    size_t length; /* 3 per vertex */
    uint32_t frame_count, block_count;
    uint32_t *order;        /* frame_count: frames of the clip, those looked at first */
    float *position;        /* length: scratch */
    float *residual;        /* length: scratch */
    float *block;           /* length by FRAME_BLOCK: scratch */
    double *dot;            /* dot_capacity by FRAME_BLOCK: scratch */
    size_t dot_capacity;    /* rows */
    float **block_weight;   /* block_count: block_axes by FRAME_BLOCK */
    size_t *block_axes;     /* block_count: axes that the weights were found with */
    float *block_peak;      /* block_count: greatest square of a vertex error, m^2 */
    float tolerance_square; /* m^2 */
    basis basis;
} search;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to find the components of the free frames");
}

static float peak(const float *offset, size_t length)
{
    float greatest = 0.0f;
    for (size_t d = 0; d + 3 <= length; d += 3) {
        float square =
            offset[d] * offset[d] + offset[d + 1] * offset[d + 1] + offset[d + 2] * offset[d + 2];
        greatest = square > greatest ? square : greatest;
    }
    return greatest;
}

/* ---- frames as offsets from the base, in metres ---- */

static mrt_result read_offset(search *s, uint32_t frame, float *out, error *err)
{
    mrt_result result = clip_read(s->clip, frame, s->position, err);
    if (result < 0)
        return result;
    for (size_t d = 0; d < s->length; ++d)
        out[d] = (float)((double)s->position[d] * 0.001 - (double)s->base_m[d]);
    for (size_t d = 0; d < s->length; ++d)
        if (!(fabsf(out[d]) <= FARTHEST_M))
            return error_set(
                err, MRT_ERR_UNSUPPORTED,
                "frame %u: vertex %zu is not finite or more than %.0f m from its place", frame,
                d / 3, (double)FARTHEST_M);
    return MRT_OK;
}

static void block_put(float *block, uint32_t lane, const float *frame, size_t length)
{
    for (size_t d = 0; d < length; ++d)
        block[d * FRAME_BLOCK + lane] = frame[d];
}

static void block_get(float *out, const float *block, uint32_t lane, size_t length)
{
    for (size_t d = 0; d < length; ++d)
        out[d] = block[d * FRAME_BLOCK + lane];
}

static uint32_t lanes_in_block(uint32_t block, uint32_t frame_count)
{
    uint32_t left = frame_count - block * FRAME_BLOCK;
    return left < FRAME_BLOCK ? left : FRAME_BLOCK;
}

static mrt_result read_block(search *s, uint32_t block, error *err)
{
    uint32_t lanes = lanes_in_block(block, s->frame_count);
    if (lanes < FRAME_BLOCK)
        memset(s->block, 0, s->length * FRAME_BLOCK * sizeof *s->block);
    for (uint32_t lane = 0; lane < lanes; ++lane) {
        mrt_result result = read_offset(s, s->order[block * FRAME_BLOCK + lane], s->residual, err);
        if (result < 0)
            return result;
        block_put(s->block, lane, s->residual, s->length);
    }
    return MRT_OK;
}

/* ---- candidates: principal components of frames picked evenly ---- */

static uint32_t picked_count(const search *s)
{
    size_t by_memory = (size_t)MAX_PICKED_BYTES / (s->length * sizeof(float));
    size_t count = by_memory < 32 ? 32 : by_memory > MAX_PICKED ? MAX_PICKED : by_memory;
    return count < s->frame_count ? (uint32_t)count : s->frame_count;
}

/* The frames picked come first in s->order, the others follow. */
static mrt_result order_frames(search *s, uint32_t picked, error *err)
{
    uint8_t *is_picked = calloc(s->frame_count, 1);
    uint32_t *frame = malloc(s->frame_count * sizeof *frame);
    if (!is_picked || !frame) {
        free(is_picked);
        free(frame);
        return no_memory(err);
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < clip_frame_count(s->clip); ++i)
        if (clip_frame_segment(s->clip, i) < 0)
            frame[count++] = i;
    count = 0;
    for (uint32_t i = 0; i < picked; ++i) {
        uint64_t at = picked < 2 ? 0 : (uint64_t)i * (s->frame_count - 1) / (picked - 1);
        is_picked[at] = 1;
        s->order[count++] = frame[at];
    }
    for (uint32_t i = 0; i < s->frame_count; ++i)
        if (!is_picked[i])
            s->order[count++] = frame[i];
    free(is_picked);
    free(frame);
    return MRT_OK;
}

static mrt_result read_picked(search *s, float *out_row, uint32_t picked, error *err)
{
    for (uint32_t i = 0; i < picked; ++i) {
        mrt_result result = read_offset(s, s->order[i], out_row + i * s->length, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static void gram(search *s, double *out, const float *row, uint32_t count)
{
    for (uint32_t first = 0; first < count; first += FRAME_BLOCK) {
        uint32_t lanes = lanes_in_block(first / FRAME_BLOCK, count);
        memset(s->block, 0, s->length * FRAME_BLOCK * sizeof *s->block);
        for (uint32_t lane = 0; lane < lanes; ++lane)
            block_put(s->block, lane, row + (first + lane) * s->length, s->length);
        frame_block_dot(s->dot, row, first + lanes, s->block, s->length);
        for (uint32_t i = 0; i < first + lanes; ++i)
            for (uint32_t lane = 0; lane < lanes; ++lane) {
                double value = s->dot[i * FRAME_BLOCK + lane];
                out[(size_t)i * count + first + lane] = value;
                out[(size_t)(first + lane) * count + i] = value;
            }
    }
}

/* The least count whose left-out strength is at most `limit`. */
static uint32_t count_for_tail(const double *strength, uint32_t count, double limit)
{
    double tail = 0.0;
    while (count > 0 && tail + fmax(strength[count - 1], 0.0) <= limit)
        tail += fmax(strength[--count], 0.0);
    return count;
}

/* Rows 0..count-1 of the basis's axis: sum over the picked frames of vector * frame. */
static void combine_candidates(search *s, const float *row, uint32_t picked, const double *vector,
                               uint32_t count, float *weight)
{
    for (uint32_t first = 0; first < count; first += FRAME_BLOCK) {
        uint32_t lanes = lanes_in_block(first / FRAME_BLOCK, count);
        memset(weight, 0, (size_t)picked * FRAME_BLOCK * sizeof *weight);
        for (uint32_t lane = 0; lane < lanes; ++lane)
            for (uint32_t i = 0; i < picked; ++i)
                weight[i * FRAME_BLOCK + lane] =
                    (float)-vector[(size_t)(first + lane) * picked + i];
        memset(s->block, 0, s->length * FRAME_BLOCK * sizeof *s->block);
        frame_block_subtract(s->block, row, picked, weight, s->length);
        for (uint32_t lane = 0; lane < lanes; ++lane)
            block_get(s->basis.axis + (first + lane) * s->length, s->block, lane, s->length);
    }
}

/* Leaves the candidates in the basis, and in use as many as are certainly needed: with fewer, even
 * the mean square of the vertex errors of the picked frames is above the tolerance. */
static mrt_result find_candidates(search *s, uint32_t picked, error *err)
{
    basis *b = &s->basis;
    mrt_result result = MRT_OK;
    double *matrix = malloc((size_t)picked * picked * sizeof *matrix);
    double *work = malloc((size_t)picked * (picked + 3) * sizeof *work);
    double *strength = malloc(picked * sizeof *strength);
    float *weight = malloc((size_t)picked * FRAME_BLOCK * sizeof *weight);
    float *row = malloc(picked * s->length * sizeof *row);
    if (!matrix || !work || !strength || !weight || !row) {
        result = no_memory(err);
        goto done;
    }
    result = read_picked(s, row, picked, err);
    if (result < 0)
        goto done;
    gram(s, matrix, row, picked);
    result = symmetric_eigen(matrix, strength, work, picked, err);
    if (result < 0)
        goto done;
    double limit = (double)s->tolerance_square;
    uint32_t useful = count_for_tail(strength, picked, limit);
    while (useful > 0 && strength[useful - 1] <= NOISE * strength[0])
        --useful;
    if (useful > b->cap)
        useful = (uint32_t)b->cap;
    uint32_t needed =
        count_for_tail(strength, useful, limit * (double)picked * (double)(s->length / 3));
    if (!basis_reserve(b, useful)) {
        result = no_memory(err);
        goto done;
    }
    combine_candidates(s, row, picked, matrix, useful, weight);
    b->candidate_end = useful;
    while (b->count < needed && basis_add(b, NULL))
        continue;
done:
    free(matrix);
    free(work);
    free(strength);
    free(weight);
    free(row);
    return result;
}

/* ---- every frame against the basis ---- */

/* Adds axes until the frame whose residual after `used` axes is in `lane` holds the tolerance. */
static void grow_for_lane(search *s, uint32_t lane, size_t used)
{
    basis *b = &s->basis;
    block_get(s->residual, s->block, lane, s->length);
    for (;;) {
        for (; used < b->count; ++used) {
            const float *axis = b->axis + used * s->length;
            basis_subtract(s->residual, (float)basis_dot(s->residual, axis, s->length), axis,
                           s->length);
        }
        if (peak(s->residual, s->length) <= s->tolerance_square || !basis_add(b, s->residual))
            return;
    }
}

/* Weights and error of one block with the axes in use; more axes come into use when it needs them
 * (the block is then to be fitted again). */
static mrt_result fit_block(search *s, uint32_t block, error *err)
{
    basis *b = &s->basis;
    size_t used = b->count;
    mrt_result result = read_block(s, block, err);
    if (result < 0)
        return result;
    if (used > s->dot_capacity) {
        double *grown = realloc(s->dot, (used + 64) * FRAME_BLOCK * sizeof *grown);
        if (!grown)
            return no_memory(err);
        s->dot = grown;
        s->dot_capacity = used + 64;
    }
    float *weight = realloc(s->block_weight[block], (used + 1) * FRAME_BLOCK * sizeof *weight);
    if (!weight)
        return no_memory(err);
    s->block_weight[block] = weight;
    frame_block_dot(s->dot, b->axis, used, s->block, s->length);
    for (size_t i = 0; i < used * FRAME_BLOCK; ++i)
        weight[i] = (float)s->dot[i];
    frame_block_subtract(s->block, b->axis, used, weight, s->length);
    float lane_peak[FRAME_BLOCK];
    frame_block_peak(lane_peak, s->block, s->length);
    s->block_peak[block] = 0.0f;
    for (uint32_t lane = 0; lane < lanes_in_block(block, s->frame_count); ++lane) {
        if (lane_peak[lane] > s->block_peak[block])
            s->block_peak[block] = lane_peak[lane];
        if (lane_peak[lane] > s->tolerance_square && b->count < b->cap)
            grow_for_lane(s, lane, used);
    }
    s->block_axes[block] = used;
    return MRT_OK;
}

static mrt_result fit_all(search *s, const export_progress *progress, error *err)
{
    bool all_fitted = false, first_round = true;
    while (!all_fitted) {
        all_fitted = true;
        for (uint32_t block = 0; block < s->block_count; ++block) {
            if (!first_round && s->block_axes[block] == s->basis.count)
                continue;
            mrt_result result = fit_block(s, block, err);
            if (result < 0)
                return result;
            if (first_round && progress && progress->step)
                progress->step(progress->data,
                               0.1 + 0.7 * (double)(block + 1) / (double)s->block_count);
        }
        for (uint32_t block = 0; block < s->block_count; ++block)
            if (s->block_axes[block] != s->basis.count)
                all_fitted = false;
        first_round = false;
    }
    return MRT_OK;
}

/* ---- the result ---- */

/* Scales every axis by the power of two that brings its weights into -1..1: exact in float32, so
 * that the errors measured are those of the values handed out. */
static void scale_axes(components *out)
{
    size_t length = (size_t)out->vertex_count * 3;
    for (size_t j = 0; j < out->count; ++j) {
        float greatest = 0.0f;
        for (size_t i = 0; i < out->frame_count; ++i)
            greatest = fmaxf(greatest, fabsf(out->weight[i * out->count + j]));
        int exponent = 0;
        (void)frexpf(greatest, &exponent);
        for (size_t i = 0; i < out->frame_count; ++i)
            out->weight[i * out->count + j] = ldexpf(out->weight[i * out->count + j], -exponent);
        for (size_t d = 0; d < length; ++d)
            out->axis[j * length + d] = ldexpf(out->axis[j * length + d], exponent);
    }
}

static mrt_result hand_out(search *s, components *out, error *err)
{
    size_t count = s->basis.count;
    uint32_t clip_frames = clip_frame_count(s->clip);
    uint32_t *index_of = malloc(clip_frames * sizeof *index_of);
    out->frame = malloc(s->frame_count * sizeof *out->frame);
    out->weight = malloc((s->frame_count * count + 1) * sizeof *out->weight);
    if (!index_of || !out->frame || !out->weight) {
        free(index_of);
        return no_memory(err);
    }
    out->count = (uint32_t)count;
    out->vertex_count = (uint32_t)(s->length / 3);
    for (uint32_t i = 0; i < clip_frames; ++i)
        if (clip_frame_segment(s->clip, i) < 0) {
            index_of[i] = out->frame_count;
            out->frame[out->frame_count++] = i;
        }
    float greatest = 0.0f;
    for (uint32_t block = 0; block < s->block_count; ++block) {
        greatest = fmaxf(greatest, s->block_peak[block]);
        for (uint32_t lane = 0; lane < lanes_in_block(block, s->frame_count); ++lane) {
            float *weight = out->weight + index_of[s->order[block * FRAME_BLOCK + lane]] * count;
            for (size_t j = 0; j < count; ++j)
                weight[j] = s->block_weight[block][j * FRAME_BLOCK + lane];
        }
    }
    free(index_of);
    out->max_error_mm = sqrt((double)greatest) * 1000.0;
    out->axis = s->basis.axis;
    s->basis.axis = NULL;
    scale_axes(out);
    return MRT_OK;
}

static mrt_result search_init(search *s, const clip *c, const components_request *wanted,
                              error *err)
{
    s->clip = c;
    s->base_m = wanted->base_m;
    s->length = (size_t)clip_mesh(c)->vertex_count * 3;
    for (uint32_t i = 0; i < clip_frame_count(c); ++i)
        s->frame_count += clip_frame_segment(c, i) < 0;
    if (s->frame_count == 0)
        return MRT_OK;
    double tolerance_m = wanted->tolerance_mm * 0.001 * TOLERANCE_SHARE;
    s->tolerance_square = (float)(tolerance_m * tolerance_m);
    s->block_count = (s->frame_count - 1) / FRAME_BLOCK + 1;
    size_t cap = (size_t)COMPONENTS_MAX_BYTES / (s->length * sizeof(float));
    cap = cap < 16 ? 16 : cap > COMPONENTS_MAX ? COMPONENTS_MAX : cap;
    if (wanted->max_count && wanted->max_count < cap)
        cap = wanted->max_count;
    s->basis = (basis){.cap = cap, .length = s->length};
    s->dot_capacity = MAX_PICKED;
    s->order = malloc(s->frame_count * sizeof *s->order);
    s->position = malloc(s->length * sizeof *s->position);
    s->residual = malloc(s->length * sizeof *s->residual);
    s->block = malloc(s->length * FRAME_BLOCK * sizeof *s->block);
    s->dot = malloc(s->dot_capacity * FRAME_BLOCK * sizeof *s->dot);
    s->block_weight = calloc(s->block_count, sizeof *s->block_weight);
    s->block_axes = calloc(s->block_count, sizeof *s->block_axes);
    s->block_peak = calloc(s->block_count, sizeof *s->block_peak);
    bool complete = s->order && s->position && s->residual && s->block && s->dot &&
                    s->block_weight && s->block_axes && s->block_peak;
    return complete ? MRT_OK : no_memory(err);
}

static void search_finish(search *s)
{
    for (uint32_t block = 0; s->block_weight && block < s->block_count; ++block)
        free(s->block_weight[block]);
    free(s->order);
    free(s->position);
    free(s->residual);
    free(s->block);
    free(s->dot);
    free(s->block_weight);
    free(s->block_axes);
    free(s->block_peak);
    basis_finish(&s->basis);
}

void components_finish(components *c)
{
    if (!c)
        return;
    free(c->frame);
    free(c->axis);
    free(c->weight);
    *c = (components){0};
}

mrt_result components_find(components *out, const clip *c, const components_request *wanted,
                           const export_progress *progress, error *err)
{
    *out = (components){.vertex_count = clip_mesh(c)->vertex_count};
    search s = {0};
    mrt_result result = search_init(&s, c, wanted, err);
    if (result == MRT_OK && s.frame_count > 0) {
        uint32_t picked = picked_count(&s);
        result = order_frames(&s, picked, err);
        if (result == MRT_OK)
            result = find_candidates(&s, picked, err);
        if (result == MRT_OK)
            result = fit_all(&s, progress, err);
        if (result == MRT_OK)
            result = hand_out(&s, out, err);
    }
    search_finish(&s);
    if (result < 0)
        components_finish(out);
    return result;
}
