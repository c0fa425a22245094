#include "io/write/component_plan.h"

#include "io/write/basis.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* At most so many frames and vertices are looked at. */
enum { MAX_FRAMES = 1536, MAX_VERTICES = 384, MAX_FRAME_BYTES = 512 << 20 };
/* Ranks at which a window may end; the whole motion as one window is looked at as well. */
static const uint32_t LIMIT[] = {32, 48, 64, 96, 128, 192, 256, 384};
enum { LIMIT_COUNT = sizeof LIMIT / sizeof *LIMIT };
/* Windows with fewer targets than this show too little when the number of targets is capped. */
enum { FEWEST_PER_WINDOW = 32 };
/* A byte of the file is worth so many multiplications: about 5 MB to a second. */
static const double PRODUCTS_PER_BYTE = 1000.0;
/* Windows need more targets in all: they are made where they cost at most this share. */
static const double CLEARLY_CHEAPER = 0.85;

typedef struct planner {
    component_frames *frames;
    uint32_t picked, vertex_count, cap;
    uint32_t *vertex; /* vertex_count */
    float *shape;     /* picked by vertex_count by 3, metres */
    float *residual;  /* vertex_count by 3: scratch */
    uint8_t *is_moved;
    float tolerance_square;
    basis *basis; /* of the window so far, on the vertices looked at */
} planner;

typedef struct estimate {
    component_plan plan; /* room for one window per frame looked at */
    uint32_t target_count;
    double cost; /* bytes */
} estimate;

static mrt_result no_memory(error *err)
{
    (void)error_set(err, MRT_ERR_MEMORY, "no memory to split the free frames into windows");
    return MRT_ERR_MEMORY;
}

/* ---- what is looked at ---- */

static uint32_t picked_frame(const planner *p, uint32_t i)
{
    return component_frames_spread(i, p->picked, p->frames->count);
}

/* is_moved: of all vertices, which leave the place they have in the first frame. */
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

/* Evenly among those that move. */
static void pick_vertices(planner *p, const uint8_t *is_moved, uint32_t moved_count)
{
    p->vertex_count = moved_count < MAX_VERTICES ? moved_count : MAX_VERTICES;
    uint32_t seen = 0, taken = 0;
    for (uint32_t v = 0; taken < p->vertex_count; ++v)
        if (is_moved[v] && seen++ == component_frames_spread(taken, p->vertex_count, moved_count))
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

static mrt_result look(planner *p, double tolerance_m, error *err)
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

/* ---- estimates ---- */

/* What the basis leaves of a frame seen from another (NULL: from rest). */
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
    double bytes = 2.0 * sizeof(float) * numbers; /* of places and normals */
    e->cost += rank * (bytes + sizeof(float) * (double)p->frames->count);
    e->cost += 2.0 * frames * rank * numbers / PRODUCTS_PER_BYTE;
    plan->need[plan->count++] = rank;
    plan->first[plan->count] = end;
    e->target_count += rank;
    p->basis->count = 0;
    memset(p->is_moved, 0, p->vertex_count);
}

/* The bases of several windows. */
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

/* Windows that end where more than `limit` directions would be needed (0: one window). Gives up
 * when it costs more than `enough`. */
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

/* More targets than numbers in a frame are never needed. */
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

/* Leaves the cheapest in *best; *other is room to work in. */
static void choose(const planner *p, estimate *best, estimate *other)
{
    estimate_windows(p, best, 0, (double)INFINITY);
    double enough = CLEARLY_CHEAPER * best->cost;
    for (int i = 0; i < LIMIT_COUNT; ++i) {
        estimate_windows(p, other, LIMIT[i], enough);
        if (other->plan.count == 1)
            return; /* and so it is with every limit above */
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

void component_plan_finish(component_plan *p)
{
    free(p->first);
    free(p->need);
    *p = (component_plan){0};
}

mrt_result component_plan_make(component_plan *out, component_frames *frames, double tolerance_m,
                               uint32_t cap, error *err)
{
    basis so_far = {0};
    planner p = {.frames = frames, .basis = &so_far, .cap = cap, .picked = picked_count(frames)};
    estimate best = {0}, other = {0};
    p.tolerance_square = (float)(tolerance_m * tolerance_m);
    mrt_result result = look(&p, tolerance_m, err);
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
