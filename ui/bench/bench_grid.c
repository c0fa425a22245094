/* The paper's Table 1: planar models, radii, anchored and unanchored; and larger models. */
#include "bench/bench.h"
#include "csrbf/shape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct model {
    uint32_t quads;
    bool has_centres, is_large;
    uint32_t paper_pairs[BENCH_RADII]; /* of Table 1; 0: not in the table */
} model;
/* For 16 641 vertices at 60 the paper prints 115812: a wrong digit, as its neighbours show. */
static const model models[] = {
    {32, false, false, {698, 2414, 7342, 10124, 10890}},
    {64, false, false, {2646, 9526, 28686, 39476, 42250}},
    {128, false, false, {10510, 37562, 113282, 155812, 166410}},
    {128, true, false, {20790, 74482, 225714, 309476, 330250}},
    {512, false, true, {0}},
    {1024, false, true, {0}},
};
enum { MODELS = sizeof models / sizeof models[0] };

/* Frames per second in the paper, display included, on a computer of 2004. */
typedef struct paper_rate {
    uint32_t vertex_count;
    double radius_mm, anchored, unanchored;
} paper_rate;
static const paper_rate paper_rates[] = {
    {33025, 10.0, 20.0, 15.9},
    {33025, 40.0, 14.4, 11.9},
    {33025, 80.0, 13.4, 10.9},
    {16641, 80.0, 28.0, 0.0},
};

static double paper_fps(uint32_t vertex_count, double radius_mm, bool is_anchored)
{
    for (size_t i = 0; i < sizeof paper_rates / sizeof paper_rates[0]; ++i)
        if (paper_rates[i].vertex_count == vertex_count &&
            fabs(paper_rates[i].radius_mm - radius_mm) < 0.5)
            return is_anchored ? paper_rates[i].anchored : paper_rates[i].unanchored;
    return 0.0;
}

typedef struct cell { /* one model at one radius */
    bench *of;
    const bench_plane *plane;
    shape shape;
    csrbf_solver *solver;
    bench_naive naive;
    csrbf_settings step; /* settings of the unanchored frame */
    double pull[BENCH_CONTROLS * 3], end[BENCH_CONTROLS * 3];
    mrt_result failed;
    uint32_t blocks;
    double narrow_ns; /* time of a direct frame at the smallest radius */
} cell;

static void run_anchored(void *data)
{
    cell *self = data;
    mrt_result result = shape_pull(&self->shape, self->pull, NULL);
    if (result < 0)
        self->failed = result;
}

static void run_direct(void *data)
{
    cell *self = data;
    self->blocks = csrbf_move(self->solver, &self->shape.shown, &self->shape.base);
}

/* Restores the shape before the step; this is not measured. */
static void set_back(void *data)
{
    cell *self = data;
    points_copy(&self->shape.shown, &self->shape.base);
}

/* Performs a whole sample: order, factor, solve, slope, update; in one step, as in the paper. */
static void run_step(void *data)
{
    cell *self = data;
    shape_step step;
    mrt_result result = shape_drag(&self->shape, &self->step, bench_control, self->end,
                                   BENCH_CONTROLS, NULL, &step, NULL);
    if (result < 0)
        self->failed = result;
}

static void flush(void *data)
{
    cell *self = data;
    bench_roof_flush(&self->of->roof);
}

static mrt_result prepare(cell *self, double radius_mm, error *err)
{
    const csrbf_settings settings = {.radius = radius_mm};
    memcpy(self->pull, bench_pull, sizeof self->pull);
    self->step = (csrbf_settings){.radius = radius_mm, .is_one_step = true};
    for (int i = 0; i < BENCH_CONTROLS * 3; ++i)
        self->end[i] = bench_control[i] + bench_pull[i];
    shape_reset(&self->shape); /* engaging makes the shown shape the base */
    bench_naive_init(&self->naive, self->plane, radius_mm);
    mrt_result result = shape_engage(&self->shape, &settings, bench_control, BENCH_CONTROLS, err);
    if (result >= 0)
        result = csrbf_factor(self->solver, &settings, bench_control, NULL, BENCH_CONTROLS, err);
    return result >= 0 ? csrbf_solve(self->solver, bench_pull, err) : result;
}

/* Returns the greatest distance between two results, divided by the largest displacement. */
static double difference(const cell *self)
{
    double furthest = 0.0, largest = 0.0;
    const points *shown = &self->shape.shown;
    for (size_t slot = 0; slot < shown->count; ++slot) {
        const float *naive = self->plane->moved + 3 * (size_t)self->shape.order.file_of_slot[slot];
        const float *rest = self->plane->xyz + 3 * (size_t)self->shape.order.file_of_slot[slot];
        double at[3];
        points_at(at, shown, slot);
        for (int axis = 0; axis < 3; ++axis) {
            double apart = fabs(at[axis] - (double)naive[axis]);
            double moved = fabs((double)naive[axis] - (double)rest[axis]);
            furthest = apart > furthest ? apart : furthest;
            largest = moved > largest ? moved : largest;
        }
    }
    return largest > 0.0 ? furthest / largest : 0.0;
}

typedef struct row {
    const char *mode; /* "anchored" */
    double radius_mm, took_ns, cold_ns, naive_ns, copy_ns, triad_ns;
    uint64_t bytes, pairs, paper_pairs;
    double off, paper_fps;
    bool is_direct; /* only the field, solved before */
    bool is_step;   /* unanchored: the whole step */
} row;

static void report(bench *self, const bench_plane *plane, const row *r)
{
    char line[256], label[32];
    double per_vertex = r->took_ns / (double)plane->vertex_count;
    double copied = r->copy_ns / r->took_ns, triad = r->triad_ns / r->took_ns;
    double roots = (double)r->pairs * self->root_ns / r->took_ns;
    snprintf(label, sizeof label, "%u R=%g", plane->vertex_count, r->radius_mm);
    int used = snprintf(
        line, sizeof line, "%-10s %8.3f ns/vertex %9.0f/s %6.1f x naive  %5.1f GB/s", r->mode,
        per_vertex, 1e9 / r->took_ns, r->naive_ns / r->took_ns, (double)r->bytes / r->took_ns);
    if (r->is_step)
        used += snprintf(line + used, sizeof line - (size_t)used, "  the whole step");
    else if (r->is_direct)
        used +=
            snprintf(line + used, sizeof line - (size_t)used, "  %3.0f %% of roots", 100.0 * roots);
    else
        used += snprintf(line + used, sizeof line - (size_t)used,
                         "  %3.0f %% of copy, %3.0f %% of triad", 100.0 * copied, 100.0 * triad);
    if (r->cold_ns > 0.0)
        used += snprintf(line + used, sizeof line - (size_t)used, "  cold %.3f",
                         r->cold_ns / (double)plane->vertex_count);
    if (r->paper_fps > 0.0)
        snprintf(line + used, sizeof line - (size_t)used, "  (paper %.1f/s)", r->paper_fps);
    const facts_cell cells[] = {
        {"mode", r->mode, 0.0, 0},
        {"vertices", NULL, plane->vertex_count, 0},
        {"radius_mm", NULL, r->radius_mm, 1},
        {"pairs", NULL, (double)r->pairs, 0},
        {"paper_pairs", NULL, (double)r->paper_pairs, 0},
        {"frame_ns", NULL, r->took_ns, 1},
        {"cold_frame_ns", NULL, r->cold_ns, 1},
        {"bytes", NULL, (double)r->bytes, 0},
        {"of_copy", NULL, copied, 4},
        {"of_triad", NULL, triad, 4},
        {"of_roots", NULL, roots, 4},
        {"over_naive", NULL, r->naive_ns / r->took_ns, 4},
        {"off_naive", NULL, r->off, 9},
        {"paper_fps", NULL, r->paper_fps, 1},
    };
    facts_row(self->told, "grid", label, line, cells, sizeof cells / sizeof cells[0]);
}

/* Goals are for the paper's largest model, and for memory outside the caches. */
static void promise(cell *self, const row *r)
{
    bench *of = self->of;
    bool is_wide = r->radius_mm > 79.0, is_narrow = r->radius_mm < 11.0;
    double over_naive = r->naive_ns / r->took_ns;
    double of_roots = (double)r->pairs * of->root_ns / r->took_ns;
    of->off_naive = fmax(of->off_naive, r->off);
    if (r->is_step)
        return;
    if (!r->is_direct && is_wide && self->plane->vertex_count > 1000000)
        bench_at_least(of, "anchored, 1.05 M: of triad", r->triad_ns / r->took_ns, 0.7);
    if (self->plane->vertex_count != 33025)
        return;
    if (!r->is_direct && is_wide) {
        bench_at_least(of, "anchored R=80: of copy", r->copy_ns / r->took_ns, 0.7);
        bench_at_least(of, "anchored R=80: over naive", over_naive, 25.0);
    }
    if (r->is_direct && is_narrow) {
        bench_at_least(of, "direct R=10: over naive", over_naive, 15.0);
        self->narrow_ns = r->took_ns;
    }
    if (r->is_direct && is_wide) {
        bench_at_least(of, "direct R=80: of roots", of_roots, 0.55);
        bench_at_least(of, "direct R=80: over naive", over_naive, 9.0);
        bench_at_least(of, "direct R=10: over R=80", r->took_ns / self->narrow_ns, 2.0);
    }
}

/* Bytes of a frame: the base is read, the result is written, and the columns are read. A direct
 * frame has no columns. */
static uint64_t bytes_of(cell *self, bool is_direct)
{
    columns_weigh(&self->shape.response, self->pull, is_direct ? 0 : BENCH_CONTROLS);
    return self->shape.response.weights.bytes;
}

static void set_back_and_step(void *data)
{
    set_back(data);
    run_step(data);
}

static mrt_result show_cell(cell *self, const row *r, const bench_work *work, error *err)
{
    bench *of = self->of;
    const bench_cell shown = {.is_anchored = !r->is_step,
                              .vertex_count = self->plane->vertex_count,
                              .triangle_count = self->plane->triangle_count,
                              .rest = self->plane->xyz,
                              .triangle = self->plane->triangle,
                              .radius_mm = r->radius_mm,
                              .frame_ns = r->took_ns,
                              .pairs = r->pairs,
                              .paper_pairs = r->paper_pairs,
                              .paper_fps = r->paper_fps,
                              .run = r->is_step ? set_back_and_step : work->run,
                              .data = work->data,
                              .shape = &self->shape};
    return of->on_cell ? of->on_cell(of->on_cell_data, &shown, err) : MRT_OK;
}

static mrt_result measure(cell *self, double radius_mm, const model *m, uint32_t which, error *err)
{
    bench *of = self->of;
    mrt_result result = prepare(self, radius_mm, err);
    if (result < 0)
        return result;
    uint64_t pairs = bench_plane_pairs(self->plane, radius_mm);
    for (int mode = 0; mode < 3; ++mode) {
        bool is_direct = mode == 2, is_step = mode == 1;
        uint64_t bytes = bytes_of(self, is_direct || is_step);
        of->roof.used = bytes < of->roof.bytes ? bytes : of->roof.bytes;
        bench_work work[] = {
            {.run = bench_naive_run, .data = &self->naive},
            {.run = is_direct ? run_direct
                    : is_step ? run_step
                              : run_anchored,
             .data = self,
             .before = is_step ? set_back : NULL},
            {.run = bench_roof_copy, .data = &of->roof},
            {.run = bench_roof_triad, .data = &of->roof},
            {.run = is_direct ? run_direct : run_anchored, .data = self, .before = flush},
        };
        bool has_cold = !is_step && !of->is_paper_alone &&
                        (!of->is_quick || (m->has_centres && which == BENCH_RADII - 1));
        bench_measure(work, has_cold ? 5 : 4, of->rounds, of->seconds);
        bench_naive_run(&self->naive);
        if (is_step)
            set_back(self);
        work[1].run(self);
        double share = (double)of->roof.used / (double)bytes;
        row r = {.mode = is_direct ? "field"
                         : is_step ? "unanchored"
                                   : "anchored",
                 .radius_mm = radius_mm,
                 .took_ns = work[1].least_ns,
                 .cold_ns = has_cold ? work[4].least_ns : 0.0,
                 .naive_ns = work[0].least_ns,
                 .copy_ns = work[2].least_ns / share,
                 .triad_ns = work[3].least_ns / share,
                 .bytes = bytes,
                 .pairs = pairs,
                 .paper_pairs = m->paper_pairs[which],
                 .off = difference(self),
                 .paper_fps =
                     is_direct ? 0.0 : paper_fps(self->plane->vertex_count, radius_mm, !is_step),
                 .is_direct = is_direct,
                 .is_step = is_step};
        report(of, self->plane, &r);
        promise(self, &r);
        result = is_direct ? MRT_OK : show_cell(self, &r, &work[1], err);
        if (result < 0)
            return result;
    }
    if (self->failed < 0)
        return error_set(err, self->failed, "the engine refused a frame of the bench");
    return prepare(self, radius_mm, err); /* a step releases the shape */
}

/* Measures from memory, on the paper's largest model: with columns and without, in one
 * comparison. */
static void measure_cold(cell *self)
{
    bench *of = self->of;
    char line[128];
    bench_work work[] = {
        {.run = run_anchored, .data = self, .before = flush},
        {.run = run_direct, .data = self, .before = flush},
    };
    bench_measure(work, sizeof work / sizeof work[0], 2 * of->rounds, 6.0 * of->seconds);
    double vertices = self->plane->vertex_count, columns_ns = work[0].least_ns;
    snprintf(line, sizeof line,
             "cold       columns %.3f, direct %.3f ns/vertex: columns %.2f x direct",
             columns_ns / vertices, work[1].least_ns / vertices, work[1].least_ns / columns_ns);
    const facts_cell cells[] = {
        {"vertices", NULL, vertices, 0},
        {"columns_cold_ns", NULL, columns_ns, 1},
        {"direct_cold_ns", NULL, work[1].least_ns, 1},
    };
    facts_row(of->told, "cold", "33025 R=80", line, cells, sizeof cells / sizeof cells[0]);
}

static mrt_result measure_model(bench *self, const model *m, error *err)
{
    bench_plane plane = {0};
    cell c = {.of = self, .plane = &plane};
    mrt_result result = bench_plane_create(&plane, m->quads, m->has_centres, err);
    if (result >= 0)
        result = shape_create(&c.shape, plane.xyz, plane.vertex_count, BENCH_CONTROLS, err);
    if (result >= 0 && !(c.solver = csrbf_solver_create(BENCH_CONTROLS)))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a solver");
    for (uint32_t i = 0; i < BENCH_RADII && result >= 0; ++i) {
        if (m->is_large && i != 0 && i != BENCH_RADII - 1)
            continue;
        result = measure(&c, bench_radius_mm[i], m, i, err);
        if (result >= 0 && m->has_centres && i == BENCH_RADII - 1 && !self->is_paper_alone)
            measure_cold(&c);
        progress_show(&self->shown, -1.0, "the paper's grid");
    }
    csrbf_solver_destroy(c.solver);
    shape_destroy(&c.shape);
    bench_plane_destroy(&plane);
    return result;
}

mrt_result bench_grid(bench *self, error *err)
{
    mrt_result result = MRT_OK;
    bench_title(self, "The paper's grid: ten controls on a plane, no polynomial");
    for (size_t i = 0; i < MODELS && result >= 0; ++i)
        if (!models[i].is_large || !self->is_paper_alone)
            result = measure_model(self, &models[i], err);
    bench_at_least(self, "grid: 1e-5 over off_naive", 1e-5 / fmax(self->off_naive, 1e-12), 1.0);
    return result;
}
