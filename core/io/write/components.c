#include "io/write/components.h"

#include "io/write/basis.h"
#include "io/write/component_frames.h"
#include "io/write/frame_block.h"
#include "io/write/window_axes.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to find the components of the free frames");
}

/* ---- splitting a long motion into windows: an estimate from some frames and vertices, the same on
 * every run ---- */

typedef struct component_plan {
    uint32_t count;
    uint32_t *first; /* count + 1: the first frame of each window, and the end */
    uint32_t *need;  /* count: estimated number of targets of each, at least 1 */
} component_plan;

/* Maximum numbers of frames and vertices in the estimate. */
enum { MAX_FRAMES = 1536, MAX_VERTICES = 384, MAX_FRAME_BYTES = 512 << 20 };
/* Numbers of axes at which a window may end. One window for the whole motion is considered as well.
 */
static const uint32_t LIMIT[] = {32, 48, 64, 96, 128, 192, 256, 384};
enum { LIMIT_COUNT = sizeof LIMIT / sizeof *LIMIT };
/* Minimum number of targets per window when the number of targets is limited. Fewer would show too
 * little. */
enum { FEWEST_PER_WINDOW = 32 };
/* Exchange rate between work and file size: multiplications per byte, about 5 MB per second. */
static const double PRODUCTS_PER_BYTE = 1000.0;
/* Windows need more targets in total. They are used only if their cost is at most this share of the
 * cost of one window. */
static const double CLEARLY_CHEAPER = 0.85;

typedef struct planner {
    component_frames *frames;
    uint32_t picked, vertex_count, cap;
    uint32_t *vertex; /* vertex_count */
    float *shape;     /* picked by vertex_count by 3, metres */
    float *residual;  /* vertex_count by 3: scratch */
    uint8_t *is_moved;
    float tolerance_square;
    basis *basis; /* of the current window, on the picked vertices */
} planner;

typedef struct estimate {
    component_plan plan; /* capacity: one window per picked frame */
    uint32_t target_count;
    double cost; /* bytes */
} estimate;

static uint32_t picked_frame(const planner *p, uint32_t i)
{
    return component_frames_spread(i, p->picked, p->frames->count);
}

/* Finds the vertices that leave their position in the first frame. is_moved: one entry per vertex.
 */
static mrt_result find_moved(planner *p, uint8_t *is_moved, uint32_t *out_count, double threshold_m,
                             error *err)
{
    uint32_t vertex_count = p->frames->vertex_count;
    size_t length = (size_t)vertex_count * 3;
    float *first = malloc(length * sizeof *first), *offset = malloc(length * sizeof *offset);
    float threshold = (float)(threshold_m * threshold_m);
    mrt_result result = first && offset ? MRT_OK : no_memory(err);
    for (uint32_t i = 0; i < p->picked && result == MRT_OK; ++i) {
        result = component_frames_read(p->frames, picked_frame(p, i), i ? offset : first, err);
        for (uint32_t v = 0; v < vertex_count && i > 0 && result == MRT_OK; ++v) {
            const float *a = first + (size_t)v * 3, *b = offset + (size_t)v * 3;
            float x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
            is_moved[v] |= x * x + y * y + z * z > threshold;
        }
    }
    *out_count = 0;
    for (uint32_t v = 0; v < vertex_count; ++v)
        *out_count += is_moved[v];
    free(first);
    free(offset);
    return result;
}

/* Picks vertices evenly among those that move. */
static void pick_vertices(planner *p, const uint8_t *is_moved, uint32_t moved_count)
{
    p->vertex_count = moved_count < MAX_VERTICES ? moved_count : MAX_VERTICES;
    uint32_t moved = 0, taken = 0;
    for (uint32_t v = 0; taken < p->vertex_count; ++v)
        if (is_moved[v] && moved++ == component_frames_spread(taken, p->vertex_count, moved_count))
            p->vertex[taken++] = v;
}

static mrt_result read_shapes(planner *p, error *err)
{
    size_t width = (size_t)p->vertex_count * 3;
    float *offset = malloc((size_t)p->frames->vertex_count * 3 * sizeof *offset);
    mrt_result result = offset ? MRT_OK : no_memory(err);
    for (uint32_t i = 0; i < p->picked && result == MRT_OK; ++i) {
        result = component_frames_read(p->frames, picked_frame(p, i), offset, err);
        for (uint32_t k = 0; k < p->vertex_count && result == MRT_OK; ++k)
            memcpy(p->shape + i * width + (size_t)k * 3, offset + (size_t)p->vertex[k] * 3,
                   3 * sizeof *offset);
    }
    free(offset);
    return result;
}

static mrt_result read_input(planner *p, double tolerance_m, error *err)
{
    uint32_t moved_count;
    uint8_t *is_moved = calloc(p->frames->vertex_count, 1);
    p->vertex = malloc(MAX_VERTICES * sizeof *p->vertex);
    mrt_result result = is_moved && p->vertex ? MRT_OK : no_memory(err);
    if (result == MRT_OK)
        result = find_moved(p, is_moved, &moved_count, tolerance_m * COMPONENT_STILL_SHARE, err);
    if (result == MRT_OK) {
        pick_vertices(p, is_moved, moved_count);
        size_t width = (size_t)p->vertex_count * 3;
        p->shape = calloc(p->picked * width + 1, sizeof *p->shape);
        p->residual = malloc((width + 1) * sizeof *p->residual);
        p->is_moved = malloc((size_t)p->vertex_count + 1);
        *p->basis = (basis){.length = width, .cap = p->picked};
        result = p->shape && p->residual && p->is_moved ? read_shapes(p, err) : no_memory(err);
    }
    free(is_moved);
    return result;
}

/* Computes the residual of a frame relative to `origin` (NULL: rest) outside the basis. Returns its
 * greatest squared length of a vertex. */
static float leave_residual(const planner *p, const float *shape, const float *origin)
{
    size_t width = p->basis->length;
    for (size_t d = 0; d < width; ++d)
        p->residual[d] = origin ? shape[d] - origin[d] : shape[d];
    for (uint32_t v = 0; v < p->vertex_count; ++v)
        p->is_moved[v] |=
            component_frames_peak(p->residual + (size_t)v * 3, 1) >
            p->tolerance_square * (float)(COMPONENT_STILL_SHARE * COMPONENT_STILL_SHARE);
    for (size_t j = 0; j < p->basis->count; ++j) {
        const float *axis = p->basis->axis + j * width;
        basis_subtract(p->residual, (float)basis_dot(p->residual, axis, width), axis, width);
    }
    return component_frames_peak(p->residual, p->vertex_count);
}

static void close_window(const planner *p, estimate *e, uint32_t end)
{
    component_plan *plan = &e->plan;
    uint32_t rank = p->basis->count ? (uint32_t)p->basis->count : 1, moved = 0;
    for (uint32_t v = 0; v < p->vertex_count; ++v)
        moved += p->is_moved[v];
    double share = p->vertex_count ? (double)moved / p->vertex_count : 0.0;
    double frames = (double)(end - plan->first[plan->count]);
    double numbers = share * 3.0 * (double)p->frames->vertex_count;
    double bytes = 2.0 * sizeof(float) * numbers; /* of one target: positions and normals */
    e->cost += rank * (bytes + sizeof(float) * (double)p->frames->count);
    e->cost += 2.0 * frames * rank * numbers / PRODUCTS_PER_BYTE;
    plan->need[plan->count++] = rank;
    plan->first[plan->count] = end;
    e->target_count += rank;
    p->basis->count = 0;
    memset(p->is_moved, 0, p->vertex_count);
}

/* Adds the cost of the base of each window, if there are several. */
static void add_bases(const planner *p, estimate *e)
{
    if (e->plan.count < 2)
        return;
    double bytes = 2.0 * sizeof(float) * 3.0 * (double)p->frames->vertex_count +
                   sizeof(float) * (double)p->frames->count;
    e->cost += e->plan.count * bytes;
    e->target_count += e->plan.count;
    for (uint32_t w = 0; w < e->plan.count; ++w)
        e->plan.need[w] += 1;
}

/* Estimates windows that end when they would need more than `limit` directions (0: one window).
 * Stops when the cost exceeds `enough`. */
static void estimate_windows(const planner *p, estimate *e, uint32_t limit, double enough)
{
    size_t width = p->basis->length;
    const float *origin = limit ? p->shape : NULL;
    e->plan.count = e->plan.first[0] = e->target_count = 0;
    e->cost = 0.0;
    p->basis->count = 0;
    memset(p->is_moved, 0, p->vertex_count);
    for (uint32_t i = 0; i < p->picked && e->cost < enough; ++i) {
        const float *shape = p->shape + i * width;
        if (leave_residual(p, shape, origin) <= p->tolerance_square)
            continue;
        if (!limit || p->basis->count < limit) {
            (void)basis_add(p->basis, p->residual);
            continue;
        }
        close_window(p, e, picked_frame(p, i));
        origin = shape;
    }
    close_window(p, e, p->frames->count);
    add_bases(p, e);
}

static bool is_allowed(const planner *p, const estimate *e)
{
    return e->plan.count == 1 || e->target_count <= p->cap ||
           p->cap / FEWEST_PER_WINDOW >= e->plan.count;
}

/* Refuses a plan with more targets than numbers in a frame, which are never needed. */
static bool is_worth_it(const planner *p, const estimate *e)
{
    return is_allowed(p, e) && e->target_count < 3 * (uint64_t)p->frames->vertex_count;
}

static void swap_estimates(estimate *a, estimate *b)
{
    estimate kept = *a;
    *a = *b;
    *b = kept;
}

/* Finds the cheapest plan in *best; *other is scratch. */
static void choose(const planner *p, estimate *best, estimate *other)
{
    estimate_windows(p, best, 0, (double)INFINITY);
    double enough = CLEARLY_CHEAPER * best->cost;
    for (int i = 0; i < LIMIT_COUNT; ++i) {
        estimate_windows(p, other, LIMIT[i], enough);
        if (other->plan.count == 1)
            return; /* every higher limit also gives one window */
        if (other->cost < enough && is_worth_it(p, other)) {
            swap_estimates(best, other);
            enough = best->cost;
        }
    }
}

static mrt_result estimate_init(estimate *e, uint32_t window_count, error *err)
{
    e->plan.first = malloc(((size_t)window_count + 2) * sizeof *e->plan.first);
    e->plan.need = malloc(((size_t)window_count + 1) * sizeof *e->plan.need);
    return e->plan.first && e->plan.need ? MRT_OK : no_memory(err);
}

static uint32_t picked_count(const component_frames *frames)
{
    size_t by_size = (size_t)MAX_FRAME_BYTES / ((size_t)frames->vertex_count * 3 * sizeof(float));
    size_t count = by_size < 32 ? 32 : by_size > MAX_FRAMES ? MAX_FRAMES : by_size;
    return count < frames->count ? (uint32_t)count : frames->count;
}

static void component_plan_finish(component_plan *p)
{
    free(p->first);
    free(p->need);
    *p = (component_plan){0};
}

/* Chooses windows with a small total of bytes and work. cap: total number of targets. */
static mrt_result component_plan_make(component_plan *out, component_frames *frames,
                                      double tolerance_m, uint32_t cap, error *err)
{
    basis so_far = {0};
    planner p = {.frames = frames, .basis = &so_far, .cap = cap, .picked = picked_count(frames)};
    estimate best = {0}, other = {0};
    p.tolerance_square = (float)(tolerance_m * tolerance_m);
    mrt_result result = read_input(&p, tolerance_m, err);
    if (result == MRT_OK)
        result = estimate_init(&best, p.picked, err);
    if (result == MRT_OK)
        result = estimate_init(&other, p.picked, err);
    if (result == MRT_OK)
        choose(&p, &best, &other);
    *out = best.plan;
    component_plan_finish(&other.plan);
    basis_finish(&so_far);
    free(p.vertex);
    free(p.shape);
    free(p.residual);
    free(p.is_moved);
    if (result < 0)
        component_plan_finish(out);
    return result;
}

/* ---- one window of frames ---- */

typedef struct window_request {
    uint32_t first_frame, frame_count; /* of the free frames, at least 1 */
    window_base base;
    double tolerance_m;
    uint32_t cap; /* maximum number of targets, including the base; 1 counts as 2 */
    const export_progress *progress;
    double done_before, done_share; /* shares of the whole export, for the progress */
} window_request;

/* Number of candidates that are tried for a single frame. */
enum { CANDIDATES_PER_FRAME = 6 };

typedef struct search {
    const window_request *wanted;
    window_frames frames;
    float tolerance_square; /* m^2 */
    size_t length;          /* 3 per moved vertex */
    basis basis;
    float *residual, *missing; /* length: scratch */
    float *block;              /* length by FRAME_BLOCK: scratch */
    double *dot;               /* dot_capacity by FRAME_BLOCK: scratch */
    float *weight;             /* dot_capacity by FRAME_BLOCK: scratch */
    size_t dot_capacity;       /* rows */
    uint32_t block_count;      /* of FRAME_BLOCK frames in time order */
    float **block_weight;      /* block_count: block_axes by FRAME_BLOCK */
    size_t *block_axes;        /* block_count: axes that the weights were found with */
    float *block_peak;         /* block_count: greatest square of a vertex error, m^2 */
    uint32_t shown;            /* number of blocks that were reported to the progress callback */
} search;

static uint32_t lanes_in_block(const search *s, uint32_t block)
{
    uint32_t left = s->frames.count - block * FRAME_BLOCK;
    return left < FRAME_BLOCK ? left : FRAME_BLOCK;
}

static mrt_result read_block(search *s, const uint32_t *index, uint32_t lanes, error *err)
{
    if (lanes < FRAME_BLOCK)
        memset(s->block, 0, s->length * FRAME_BLOCK * sizeof *s->block);
    for (uint32_t lane = 0; lane < lanes; ++lane) {
        mrt_result result = window_frames_read(&s->frames, index[lane], s->residual, err);
        if (result < 0)
            return result;
        frame_block_set(s->block, lane, s->residual, s->length);
    }
    return MRT_OK;
}

/* ---- the axes ---- */

/* Removes the axes after the first `used` from s->residual. Returns whether the residual is within
 * the tolerance. */
static bool is_within_tolerance(search *s, size_t used)
{
    basis *b = &s->basis;
    for (; used < b->count; ++used) {
        const float *axis = b->axis + used * s->length;
        basis_subtract(s->residual, (float)basis_dot(s->residual, axis, s->length), axis,
                       s->length);
    }
    return component_frames_peak(s->residual, s->length / 3) <= s->tolerance_square;
}

/* Adds axes until the frame in `lane` is within the tolerance. The lane has its residual after
 * `used` axes. Tries a few candidates first. If they do not suffice, adds the direction of the
 * residual. */
static void grow_for_lane(search *s, uint32_t lane, size_t used)
{
    basis *b = &s->basis;
    frame_block_get(s->residual, s->block, lane, s->length);
    if (is_within_tolerance(s, used))
        return;
    size_t count = b->count, next = b->next;
    memcpy(s->missing, s->residual, s->length * sizeof *s->missing);
    for (int i = 0; i < CANDIDATES_PER_FRAME && basis_add_candidate(b); ++i)
        if (is_within_tolerance(s, b->count - 1))
            return;
    b->count = count;
    b->next = next;
    (void)basis_add(b, s->missing);
}

static bool reserve_weights(search *s)
{
    if (s->dot && s->basis.count <= s->dot_capacity)
        return true;
    size_t wanted = s->basis.count + 64;
    double *dot = realloc(s->dot, wanted * FRAME_BLOCK * sizeof *dot);
    if (dot)
        s->dot = dot;
    float *weight = realloc(s->weight, wanted * FRAME_BLOCK * sizeof *weight);
    if (weight)
        s->weight = weight;
    if (!dot || !weight)
        return false;
    s->dot_capacity = wanted;
    return true;
}

/* Computes the weights (in s->weight) and the greatest squared error of some frames with the
 * current axes. Adds axes when a frame needs them. */
static mrt_result fit(search *s, const uint32_t *index, uint32_t lanes, float *out_peak, error *err)
{
    basis *b = &s->basis;
    size_t used = b->count;
    mrt_result result = reserve_weights(s) ? read_block(s, index, lanes, err) : no_memory(err);
    if (result < 0)
        return result;
    frame_block_dot(s->dot, b->axis, used, s->block, s->length);
    for (size_t i = 0; i < used * FRAME_BLOCK; ++i)
        s->weight[i] = (float)s->dot[i];
    frame_block_subtract(s->block, b->axis, used, s->weight, s->length);
    float lane_peak[FRAME_BLOCK];
    frame_block_peak(lane_peak, s->block, s->length);
    *out_peak = 0.0f;
    for (uint32_t lane = 0; lane < lanes; ++lane) {
        *out_peak = fmaxf(*out_peak, lane_peak[lane]);
        if (lane_peak[lane] > s->tolerance_square && b->count < b->cap)
            grow_for_lane(s, lane, used);
    }
    return MRT_OK;
}

/* Returns the picked frames with the greatest values. */
static uint32_t find_worst(const window_axes *a, double *left, uint32_t index[FRAME_BLOCK])
{
    uint32_t lanes = a->picked < FRAME_BLOCK ? a->picked : FRAME_BLOCK;
    for (uint32_t lane = 0; lane < lanes; ++lane) {
        uint32_t worst = 0;
        for (uint32_t i = 1; i < a->picked; ++i)
            if (left[i] > left[worst])
                worst = i;
        left[worst] = -1.0; /* already chosen */
        index[lane] = a->pick[worst];
    }
    return lanes;
}

/* Handles the worst frames first. Their axes help all frames, so few blocks are fitted twice. */
static mrt_result grow_for_worst(search *s, const window_axes *a, error *err)
{
    basis *b = &s->basis;
    double *left = malloc(a->picked * sizeof *left);
    mrt_result result = left ? MRT_OK : no_memory(err);
    for (size_t before = SIZE_MAX; result == MRT_OK && b->count != before;) {
        uint32_t index[FRAME_BLOCK];
        float peak;
        before = b->count;
        window_axes_left_out(left, a, b);
        uint32_t lanes = find_worst(a, left, index);
        result = fit(s, index, lanes, &peak, err);
    }
    free(left);
    return result;
}

static mrt_result find_axes(search *s, error *err)
{
    window_axes axes;
    mrt_result result = window_axes_find(&axes, &s->basis, &s->frames, s->tolerance_square, err);
    if (result == MRT_OK)
        result = grow_for_worst(s, &axes, err);
    window_axes_finish(&axes);
    return result;
}

/* ---- fitting every frame ---- */

static mrt_result fit_block(search *s, uint32_t block, error *err)
{
    uint32_t index[FRAME_BLOCK], lanes = lanes_in_block(s, block);
    size_t used = s->basis.count;
    for (uint32_t lane = 0; lane < lanes; ++lane)
        index[lane] = block * FRAME_BLOCK + lane;
    mrt_result result = fit(s, index, lanes, &s->block_peak[block], err);
    if (result < 0)
        return result;
    size_t size = used * FRAME_BLOCK * sizeof(float);
    float *weight = realloc(s->block_weight[block], size + 1);
    if (!weight)
        return no_memory(err);
    if (size)
        memcpy(weight, s->weight, size);
    s->block_weight[block] = weight;
    s->block_axes[block] = used;
    return MRT_OK;
}

static bool has_all_axes(const search *s, uint32_t block)
{
    return s->block_weight[block] && s->block_axes[block] == s->basis.count;
}

static void show_progress(search *s, uint32_t fitted)
{
    const window_request *wanted = s->wanted;
    if (fitted <= s->shown || !wanted->progress || !wanted->progress->step)
        return;
    s->shown = fitted;
    wanted->progress->step(wanted->progress->data,
                           wanted->done_before + wanted->done_share * fitted / s->block_count);
}

static mrt_result fit_all(search *s, error *err)
{
    for (bool is_done = false; !is_done;) {
        is_done = true;
        for (uint32_t block = 0; block < s->block_count; ++block) {
            if (has_all_axes(s, block))
                continue;
            mrt_result result = fit_block(s, block, err);
            if (result < 0)
                return result;
            show_progress(s, block + 1);
        }
        for (uint32_t block = 0; block < s->block_count; ++block)
            is_done = is_done && has_all_axes(s, block);
    }
    return MRT_OK;
}

/* ---- the result ---- */

static float least_weight(const component_window *out, size_t component)
{
    float least = 0.0f;
    for (size_t i = 0; i < out->frame_count; ++i)
        least = fminf(least, out->weight[i * out->count + component]);
    return least;
}

/* Moves the base to where all components have their least weight, so that no weight is negative.
 * Programs that play a file limit weights to the range of a slider, 0 to 1. */
static mrt_result shift_to_least(component_window *out, uint32_t vertex_count, error *err)
{
    for (size_t j = 0; j < out->count; ++j) {
        const float *axis = out->axis + j * out->moved_count * 3;
        float least = least_weight(out, j);
        if (!(least < 0.0f))
            continue;
        if (!out->base && !(out->base = calloc((size_t)vertex_count * 3, sizeof *out->base)))
            return no_memory(err);
        for (size_t i = 0; i < out->moved_count; ++i)
            for (size_t k = 0; k < 3; ++k)
                out->base[(size_t)out->moved[i] * 3 + k] += least * axis[i * 3 + k];
        for (size_t i = 0; i < out->frame_count; ++i)
            out->weight[i * out->count + j] -= least;
    }
    return MRT_OK;
}

/* Scales each axis by the power of two that brings its weights, which are not negative, to at
 * most 1. This is exact in float32. */
static void scale_axes(component_window *out)
{
    size_t length = (size_t)out->moved_count * 3;
    for (size_t j = 0; j < out->count; ++j) {
        float greatest = 0.0f;
        for (size_t i = 0; i < out->frame_count; ++i)
            greatest = fmaxf(greatest, out->weight[i * out->count + j]);
        int exponent = 0;
        (void)frexpf(greatest, &exponent);
        for (size_t i = 0; i < out->frame_count; ++i)
            out->weight[i * out->count + j] = ldexpf(out->weight[i * out->count + j], -exponent);
        for (size_t d = 0; d < length; ++d)
            out->axis[j * length + d] = ldexpf(out->axis[j * length + d], exponent);
    }
}

static float hand_out_weights(const search *s, component_window *out)
{
    float greatest = s->frames.still_peak;
    for (uint32_t block = 0; block < s->block_count; ++block) {
        greatest = fmaxf(greatest, s->block_peak[block]);
        for (uint32_t lane = 0; lane < lanes_in_block(s, block); ++lane)
            for (size_t j = 0; j < out->count; ++j)
                out->weight[((size_t)block * FRAME_BLOCK + lane) * out->count + j] =
                    s->block_weight[block][j * FRAME_BLOCK + lane];
    }
    return greatest;
}

static mrt_result hand_out(search *s, component_window *out, double *out_error_m, error *err)
{
    out->count = (uint32_t)s->basis.count;
    out->weight = calloc((size_t)out->frame_count * out->count + 1, sizeof *out->weight);
    if (!out->weight)
        return no_memory(err);
    *out_error_m = sqrt((double)hand_out_weights(s, out));
    out->axis = s->basis.axis;
    s->basis.axis = NULL;
    out->moved = s->frames.moved;
    out->moved_count = s->frames.moved_count;
    s->frames.moved = NULL;
    if (s->frames.has_base) {
        out->base = s->frames.base;
        s->frames.base = NULL;
    }
    mrt_result result = shift_to_least(out, s->frames.frames->vertex_count, err);
    if (result >= 0)
        scale_axes(out);
    return result;
}

/* Allocates the search. Call after the moving vertices are known. */
static mrt_result search_init(search *s, uint32_t cap, error *err)
{
    s->length = (size_t)s->frames.moved_count * 3;
    s->block_count = (s->frames.count - 1) / FRAME_BLOCK + 1;
    s->basis = (basis){.cap = cap, .length = s->length};
    s->residual = malloc((s->length + 1) * sizeof *s->residual);
    s->missing = malloc((s->length + 1) * sizeof *s->missing);
    s->block = malloc((s->length + 1) * FRAME_BLOCK * sizeof *s->block);
    s->block_weight = calloc(s->block_count, sizeof *s->block_weight);
    s->block_axes = calloc(s->block_count, sizeof *s->block_axes);
    s->block_peak = calloc(s->block_count, sizeof *s->block_peak);
    bool is_complete =
        s->residual && s->missing && s->block && s->block_weight && s->block_axes && s->block_peak;
    return is_complete ? MRT_OK : no_memory(err);
}

static void search_finish(search *s)
{
    for (uint32_t block = 0; s->block_weight && block < s->block_count; ++block)
        free(s->block_weight[block]);
    free(s->residual);
    free(s->missing);
    free(s->block);
    free(s->dot);
    free(s->weight);
    free(s->block_weight);
    free(s->block_axes);
    free(s->block_peak);
    basis_finish(&s->basis);
    window_frames_finish(&s->frames);
}

static uint32_t window_target_count(const component_window *w)
{
    return w->count + (w->base != NULL);
}

static void window_finish(component_window *w)
{
    free(w->base);
    free(w->moved);
    free(w->axis);
    free(w->weight);
    *w = (component_window){0};
}

/* Finds the components of one window. out_error_m: greatest error of a vertex, in metres. */
static mrt_result window_find(component_window *out, double *out_error_m, component_frames *frames,
                              const window_request *wanted, error *err)
{
    *out =
        (component_window){.first_frame = wanted->first_frame, .frame_count = wanted->frame_count};
    search s = {.wanted = wanted,
                .tolerance_square = (float)(wanted->tolerance_m * wanted->tolerance_m)};
    mrt_result result =
        window_frames_init(&s.frames, frames, wanted->first_frame, wanted->frame_count,
                           wanted->base, wanted->tolerance_m, err);
    if (result == MRT_OK)
        result = search_init(&s, wanted->cap > 1 ? wanted->cap - 1 : wanted->cap, err);
    if (result == MRT_OK)
        result = find_axes(&s, err);
    if (result == MRT_OK)
        result = fit_all(&s, err);
    if (result == MRT_OK)
        result = hand_out(&s, out, out_error_m, err);
    search_finish(&s);
    if (result < 0)
        window_finish(out);
    return result;
}

/* ---- all windows ---- */

/* Share of the tolerance that is used. The rest covers rounding errors of float32 sums. */
static const double TOLERANCE_SHARE = 0.999;

static uint32_t cap_of(const components_request *wanted, uint32_t vertex_count)
{
    size_t cap = (size_t)COMPONENTS_MAX_BYTES / ((size_t)vertex_count * 3 * sizeof(float));
    cap = cap < 16 ? 16 : cap > COMPONENTS_MAX ? COMPONENTS_MAX : cap;
    return wanted->max_count && wanted->max_count < cap ? wanted->max_count : (uint32_t)cap;
}

/* Returns the share of the remaining cap for this window, by the needs of all remaining windows. */
static uint32_t cap_of_window(const component_plan *plan, uint32_t window, uint32_t left)
{
    uint64_t need = 0;
    for (uint32_t w = window; w < plan->count; ++w)
        need += plan->need[w];
    assert(need > 0);
    uint32_t share = (uint32_t)((uint64_t)left * plan->need[window] / need);
    return share ? share : left > 0;
}

static mrt_result find_window(components *out, component_frames *frames, const component_plan *plan,
                              const window_request *common, uint32_t left, error *err)
{
    uint32_t index = out->window_count;
    window_request wanted = *common;
    wanted.first_frame = plan->first[index];
    wanted.frame_count = plan->first[index + 1] - plan->first[index];
    wanted.cap = cap_of_window(plan, index, left);
    wanted.base = plan->count > 1 && wanted.cap > 0 ? WINDOW_BASE_MEAN : WINDOW_BASE_NONE;
    wanted.done_before = 0.1 + 0.7 * (double)wanted.first_frame / (double)frames->count;
    wanted.done_share = 0.7 * (double)wanted.frame_count / (double)frames->count;
    double error_m = 0.0;
    component_window *window = &out->window[index];
    mrt_result result = window_find(window, &error_m, frames, &wanted, err);
    if (result < 0)
        return result;
    out->window_count++;
    out->target_count += window_target_count(window);
    out->max_error_mm = fmax(out->max_error_mm, error_m * 1000.0);
    return MRT_OK;
}

static mrt_result find_windows(components *out, component_frames *frames,
                               const component_plan *plan, const components_request *wanted,
                               const export_progress *progress, error *err)
{
    window_request common = {.tolerance_m = wanted->tolerance_mm * 0.001 * TOLERANCE_SHARE,
                             .progress = progress};
    uint32_t cap = cap_of(wanted, out->vertex_count);
    out->window = calloc(plan->count, sizeof *out->window);
    if (!out->window)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u windows of free frames",
                         plan->count);
    for (uint32_t w = 0; w < plan->count; ++w) {
        mrt_result result = find_window(out, frames, plan, &common, cap - out->target_count, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

void components_finish(components *c)
{
    if (!c)
        return;
    for (uint32_t w = 0; w < c->window_count; ++w)
        window_finish(&c->window[w]);
    free(c->window);
    free(c->frame);
    *c = (components){0};
}

void components_offset(float *out, const components *c, const component_window *window,
                       uint32_t component)
{
    const float *axis = window->axis + (size_t)component * window->moved_count * 3;
    memset(out, 0, (size_t)c->vertex_count * 3 * sizeof *out);
    for (uint32_t i = 0; i < window->moved_count; ++i)
        memcpy(out + (size_t)window->moved[i] * 3, axis + (size_t)i * 3, 3 * sizeof *out);
}

mrt_result components_find(components *out, const clip *c, const components_request *wanted,
                           const export_progress *progress, error *err)
{
    *out = (components){.vertex_count = clip_mesh(c)->vertex_count};
    component_frames frames;
    component_plan plan = {0};
    mrt_result result = component_frames_init(&frames, c, wanted->base_m, err);
    if (result == MRT_OK && frames.count > 0) {
        result = component_plan_make(&plan, &frames, wanted->tolerance_mm * 0.001,
                                     cap_of(wanted, out->vertex_count), err);
        if (result == MRT_OK)
            result = find_windows(out, &frames, &plan, wanted, progress, err);
    }
    out->frame_count = frames.count;
    out->frame = frames.frame;
    frames.frame = NULL;
    component_plan_finish(&plan);
    component_frames_finish(&frames);
    if (result < 0)
        components_finish(out);
    return result;
}
