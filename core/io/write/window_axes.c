#include "io/write/window_axes.h"

#include "io/write/frame_block.h"
#include "io/write/symmetric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Maximum number of frames for the Gram matrix, and of their bytes. */
enum { MAX_PICKED = 320, MAX_PICKED_BYTES = 96 << 20 };
/* Weight of time in the choice of frames, in units of the mean step. */
static const double TIME_SHARE = 0.25;
/* Axes weaker than this share of the strongest are rounding of the Gram matrix. */
static const double NOISE = 1e-12;
/* Target for the initial number of axes: root mean square of the errors as a share of the
 * tolerance. The greatest error is several times that. */
static const double START_SHARE = 1.0 / 3.0;

typedef struct workshop {
    window_axes *axes;
    window_frames *frames;
    size_t length; /* 3 per moved vertex */
    float *row;    /* picked by length: the picked frames */
    float *block;  /* length by FRAME_BLOCK */
    double *dot;   /* picked by FRAME_BLOCK */
    float *weight; /* picked by FRAME_BLOCK */
} workshop;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the principal components");
}

/* ---- the frames ---- */

static uint32_t picked_count(const window_frames *frames)
{
    size_t size = (size_t)frames->moved_count * 3 * sizeof(float) + 1;
    size_t count = (size_t)MAX_PICKED_BYTES / size;
    count = count < 32 ? 32 : count > MAX_PICKED ? MAX_PICKED : count;
    return count < frames->count ? (uint32_t)count : frames->count;
}

/* Picks frames at even distances along the path of the shape, where time adds to the distance. Fast
 * motion gets more frames because each of them has a different shape. */
static void pick_frames(window_axes *a, const window_frames *frames, uint32_t wanted)
{
    double way_m = 0.0, at_m = 0.0;
    for (uint32_t i = 0; i < frames->count; ++i)
        way_m += frames->step_m[i];
    double pace_m = TIME_SHARE * way_m / (double)frames->count;
    way_m += pace_m * (double)frames->count;
    for (uint32_t i = 0; i < frames->count && a->picked < wanted; ++i) {
        at_m += frames->step_m[i] + pace_m;
        bool is_due = at_m * (double)wanted > way_m * (double)a->picked;
        bool is_last_chance = frames->count - i <= wanted - a->picked;
        if (is_due || is_last_chance)
            a->pick[a->picked++] = i;
    }
}

static mrt_result read_picked(workshop *w, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < w->axes->picked && result == MRT_OK; ++i)
        result = window_frames_read(w->frames, w->axes->pick[i], w->row + i * w->length, err);
    return result;
}

/* ---- principal components of the picked frames ---- */

static uint32_t lanes_from(uint32_t first, uint32_t count)
{
    return count - first < FRAME_BLOCK ? count - first : FRAME_BLOCK;
}

static void gram(workshop *w, double *out)
{
    uint32_t count = w->axes->picked;
    for (uint32_t first = 0; first < count; first += FRAME_BLOCK) {
        uint32_t lanes = lanes_from(first, count);
        memset(w->block, 0, w->length * FRAME_BLOCK * sizeof *w->block);
        for (uint32_t lane = 0; lane < lanes; ++lane)
            frame_block_set(w->block, lane, w->row + (first + lane) * w->length, w->length);
        frame_block_dot(w->dot, w->row, first + lanes, w->block, w->length);
        for (uint32_t i = 0; i < first + lanes; ++i)
            for (uint32_t lane = 0; lane < lanes; ++lane) {
                double value = w->dot[i * FRAME_BLOCK + lane];
                out[(size_t)i * count + first + lane] = value;
                out[(size_t)(first + lane) * count + i] = value;
            }
    }
}

static mrt_result decompose(workshop *w, error *err)
{
    uint32_t picked = w->axes->picked;
    double *work = malloc((size_t)picked * (picked + 3) * sizeof *work);
    if (!work)
        return no_memory(err);
    gram(w, w->axes->vector);
    mrt_result result = symmetric_eigen(w->axes->vector, w->axes->strength, work, picked, err);
    free(work);
    return result;
}

/* Computes candidates 0..count-1: sum over the picked frames of vector * frame. */
static void combine(workshop *w, float *candidate, uint32_t count)
{
    uint32_t picked = w->axes->picked;
    for (uint32_t first = 0; first < count; first += FRAME_BLOCK) {
        uint32_t lanes = lanes_from(first, count);
        memset(w->weight, 0, (size_t)picked * FRAME_BLOCK * sizeof *w->weight);
        for (uint32_t lane = 0; lane < lanes; ++lane)
            for (uint32_t i = 0; i < picked; ++i)
                w->weight[i * FRAME_BLOCK + lane] =
                    (float)-w->axes->vector[(size_t)(first + lane) * picked + i];
        memset(w->block, 0, w->length * FRAME_BLOCK * sizeof *w->block);
        frame_block_subtract(w->block, w->row, picked, w->weight, w->length);
        for (uint32_t lane = 0; lane < lanes; ++lane)
            frame_block_get(candidate + (first + lane) * w->length, w->block, lane, w->length);
    }
}

/* Returns the smallest count of axes whose omitted strength is at most `limit`. */
static uint32_t count_for_tail(const double *strength, uint32_t count, double limit)
{
    double tail = 0.0;
    while (count > 0 && tail + fmax(strength[count - 1], 0.0) <= limit)
        tail += fmax(strength[--count], 0.0);
    return count;
}

/* Returns the number of candidates with which every picked frame is within the tolerance. */
static uint32_t useful_count(const window_axes *a, double tolerance_square, size_t cap)
{
    uint32_t useful = count_for_tail(a->strength, a->picked, tolerance_square);
    while (useful > 0 && a->strength[useful - 1] <= NOISE * a->strength[0])
        --useful;
    return useful > cap ? (uint32_t)cap : useful;
}

static mrt_result use_candidates(workshop *w, basis *b, double tolerance_square, error *err)
{
    const window_axes *a = w->axes;
    uint32_t useful = useful_count(a, tolerance_square, b->cap);
    double start_square = START_SHARE * START_SHARE * tolerance_square;
    uint32_t start =
        count_for_tail(a->strength, useful, start_square * a->picked * w->frames->moved_count);
    b->candidate = malloc((useful * w->length + 1) * sizeof *b->candidate);
    if (!b->candidate)
        return no_memory(err);
    combine(w, b->candidate, useful);
    b->candidate_count = useful;
    while (b->count < start && basis_add_candidate(b))
        continue;
    return MRT_OK;
}

static mrt_result make_axes(workshop *w, basis *b, float tolerance_square, error *err)
{
    mrt_result result = read_picked(w, err);
    if (result == MRT_OK)
        result = decompose(w, err);
    if (result == MRT_OK)
        result = use_candidates(w, b, (double)tolerance_square, err);
    return result;
}

mrt_result window_axes_find(window_axes *out, basis *b, window_frames *frames,
                            float tolerance_square, error *err)
{
    *out = (window_axes){0};
    size_t wanted = picked_count(frames), length = (size_t)frames->moved_count * 3;
    workshop w = {.axes = out, .frames = frames, .length = length};
    out->pick = calloc(wanted, sizeof *out->pick);
    out->vector = malloc(wanted * wanted * sizeof *out->vector);
    out->strength = malloc(wanted * sizeof *out->strength);
    w.row = malloc((wanted * length + 1) * sizeof *w.row);
    w.block = malloc((length + 1) * FRAME_BLOCK * sizeof *w.block);
    w.dot = malloc(wanted * FRAME_BLOCK * sizeof *w.dot);
    w.weight = malloc(wanted * FRAME_BLOCK * sizeof *w.weight);
    bool is_complete =
        out->pick && out->vector && out->strength && w.row && w.block && w.dot && w.weight;
    if (is_complete)
        pick_frames(out, frames, (uint32_t)wanted);
    mrt_result result = is_complete ? make_axes(&w, b, tolerance_square, err) : no_memory(err);
    free(w.row);
    free(w.block);
    free(w.dot);
    free(w.weight);
    return result;
}

void window_axes_finish(window_axes *a)
{
    free(a->pick);
    free(a->vector);
    free(a->strength);
    *a = (window_axes){0};
}

void window_axes_left_out(double *out_left, const window_axes *a, const basis *b)
{
    memset(out_left, 0, a->picked * sizeof *out_left);
    for (size_t j = b->next; j < a->picked; ++j)
        for (uint32_t i = 0; i < a->picked; ++i) {
            double part = a->vector[j * a->picked + i];
            out_left[i] += a->strength[j] * part * part;
        }
}
