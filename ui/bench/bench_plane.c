/* The planar models, and the cost of bones and of several threads on them. */
#include "base/clock.h"
#include "base/pool.h"
#include "bench/bench.h"
#include "csrbf/shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double side_mm = 66.12;

const double bench_radius_mm[BENCH_RADII] = {10.0, 20.0, 40.0, 60.0, 80.0};

const double bench_control[BENCH_CONTROLS * 3] = {
    3.01,   19.56, 0.0, -3.01, 19.56, 0.0, 8.19,  9.01, 0.0, -8.19, 9.01,  0.0, 26.86,  9.52,  0.0,
    -26.86, 9.52,  0.0, 8.97,  0.71,  0.0, -8.97, 0.71, 0.0, 26.94, 29.64, 0.0, -26.94, 29.64, 0.0};

const double bench_pull[BENCH_CONTROLS * 3] = {
    0.4,  -0.3, 1.0, -0.4, -0.3, 1.0, 0.2, 0.5,  -1.2, -0.2, 0.5, -1.2, 0.6, 0.1, 1.4,
    -0.6, 0.1,  1.4, 0.0,  -0.6, 0.8, 0.0, -0.6, 0.8,  -0.3, 0.2, -1.0, 0.3, 0.2, -1.0};

static float coordinate(uint32_t half_steps, uint32_t quads)
{
    return (float)(((double)half_steps - (double)quads) * side_mm / (2.0 * (double)quads));
}

static void add_vertex(float *row, uint32_t half_column, uint32_t half_row, uint32_t quads)
{
    row[0] = coordinate(half_column, quads);
    row[1] = coordinate(half_row, quads);
    row[2] = 0.0f;
}

static void add_vertices(bench_plane *self, uint32_t quads, bool has_centres)
{
    float *row = self->xyz;
    for (uint32_t y = 0; y <= quads; ++y)
        for (uint32_t x = 0; x <= quads; ++x, row += 3)
            add_vertex(row, 2 * x, 2 * y, quads);
    for (uint32_t y = 0; has_centres && y < quads; ++y)
        for (uint32_t x = 0; x < quads; ++x, row += 3)
            add_vertex(row, 2 * x + 1, 2 * y + 1, quads);
}

static uint32_t *put_triangle(uint32_t *at, uint32_t a, uint32_t b, uint32_t c)
{
    at[0] = a;
    at[1] = b;
    at[2] = c;
    return at + 3;
}

static void add_triangles(bench_plane *self, uint32_t quads, bool has_centres)
{
    uint32_t *at = self->triangle, stride = quads + 1;
    for (uint32_t y = 0; y < quads; ++y)
        for (uint32_t x = 0; x < quads; ++x) {
            uint32_t a = y * stride + x, b = a + 1, c = b + stride, d = a + stride;
            uint32_t middle = stride * stride + y * quads + x;
            if (!has_centres) {
                at = put_triangle(at, a, b, c);
                at = put_triangle(at, a, c, d);
                continue;
            }
            at = put_triangle(at, a, b, middle);
            at = put_triangle(at, b, c, middle);
            at = put_triangle(at, c, d, middle);
            at = put_triangle(at, d, a, middle);
        }
}

mrt_result bench_plane_create(bench_plane *out, uint32_t quads, bool has_centres, error *err)
{
    uint32_t row = quads + 1, per_quad = has_centres ? 4 : 2;
    *out = (bench_plane){.vertex_count = row * row + (has_centres ? quads * quads : 0),
                         .triangle_count = quads * quads * per_quad};
    out->xyz = malloc((size_t)out->vertex_count * 3 * sizeof *out->xyz);
    out->moved = calloc((size_t)out->vertex_count * 3, sizeof *out->moved);
    out->triangle = malloc((size_t)out->triangle_count * 3 * sizeof *out->triangle);
    if (!out->xyz || !out->moved || !out->triangle) {
        bench_plane_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a plane of %u quads a side", quads);
    }
    add_vertices(out, quads, has_centres);
    add_triangles(out, quads, has_centres);
    return MRT_OK;
}

void bench_plane_destroy(bench_plane *self)
{
    free(self->xyz);
    free(self->moved);
    free(self->triangle);
    *self = (bench_plane){0};
}

uint64_t bench_plane_pairs(const bench_plane *self, double radius_mm)
{
    uint64_t pairs = 0;
    for (size_t v = 0; v < self->vertex_count; ++v)
        for (size_t k = 0; k < BENCH_CONTROLS; ++k) {
            double dx = (double)self->xyz[3 * v] - bench_control[3 * k];
            double dy = (double)self->xyz[3 * v + 1] - bench_control[3 * k + 1];
            pairs += dx * dx + dy * dy <= radius_mm * radius_mm;
        }
    return pairs;
}

/* ---- a frame with bones: a moving bone adds four columns. And a frame whose field is held by
 * pins; their number must not affect its time ---- */

enum { PINS_MAX = 1000, BONE_COLUMNS = 4, COLUMNS = BENCH_CONTROLS + BONE_COLUMNS };
static const double bones_radius_mm = 40.0;

typedef struct bone_scene {
    bench_plane plane;
    shape held; /* ten controls and pins */
    double start[(BENCH_CONTROLS + PINS_MAX) * 3], pull[(BENCH_CONTROLS + PINS_MAX) * 3];
    columns with_bone;
    double weight[COLUMNS * 3];
    mrt_result failed;
} bone_scene;

static void run_held(void *data)
{
    bone_scene *self = data;
    mrt_result result = shape_pull(&self->held, self->pull, NULL);
    if (result < 0)
        self->failed = result;
}

static void run_bone(void *data)
{
    bone_scene *self = data;
    columns_move(&self->with_bone, &self->held.shown, &self->held.base, self->weight);
}

/* Places pins around the controls, on the rim of the sheet and behind it, at least a millimetre
 * apart. */
static void lay_pins(bone_scene *self, uint32_t count)
{
    memcpy(self->start, bench_control, sizeof bench_control);
    memset(self->pull, 0, sizeof self->pull);
    memcpy(self->pull, bench_pull, sizeof bench_pull);
    uint32_t side = (uint32_t)ceil(sqrt((double)count));
    for (uint32_t i = 0; i < count; ++i) {
        double *at = self->start + (size_t)3 * (BENCH_CONTROLS + i);
        at[0] = 66.0 * ((double)(i % side) + 0.5) / (double)side - 33.0;
        at[1] = 66.0 * ((double)(i / side) + 0.5) / (double)side - 33.0;
        at[2] = -12.0;
    }
}

/* Makes the ten responses, and the four columns of a bone that moves half of the sheet: w x, w y, w
 * z, w. */
static mrt_result make_bone(bone_scene *self, error *err)
{
    mrt_result result = columns_create(&self->with_bone, &self->held.base, COLUMNS, err);
    if (result < 0)
        return result;
    const points *base = &self->held.base;
    const float *axis[3] = {base->x, base->y, base->z};
    for (uint32_t k = 0; k < BENCH_CONTROLS; ++k)
        memcpy(columns_row(&self->with_bone, k), columns_row(&self->held.response, k),
               base->padded_count * sizeof(float));
    for (size_t v = 0; v < base->padded_count; ++v) {
        float share = base->y[v] < 0.0f    ? 1.0f
                      : base->y[v] < 10.0f ? 1.0f - base->y[v] / 10.0f
                                           : 0.0f;
        for (uint32_t k = 0; k < 3; ++k)
            columns_row(&self->with_bone, BENCH_CONTROLS + k)[v] = share * axis[k][v];
        columns_row(&self->with_bone, BENCH_CONTROLS + 3)[v] = share;
    }
    columns_note(&self->with_bone, COLUMNS);
    memcpy(self->weight, bench_pull, sizeof bench_pull);
    for (int i = BENCH_CONTROLS * 3; i < COLUMNS * 3; ++i)
        self->weight[i] = 0.01 * (double)(i % 7 - 3);
    return MRT_OK;
}

static void report_bones(bench *self, const char *what, uint32_t pins, double took_ns,
                         double plain_ns)
{
    char label[32], line[128];
    snprintf(label, sizeof label, "%u pins", pins);
    snprintf(line, sizeof line, "%-26s %8.4f ms %6.3f x ten columns", what, took_ns * 1e-6,
             took_ns / plain_ns);
    const facts_cell cells[] = {
        {"what", what, 0.0, 0},
        {"pins", NULL, pins, 0},
        {"frame_ns", NULL, took_ns, 1},
        {"over_ten_columns", NULL, took_ns / plain_ns, 4},
    };
    facts_row(self->told, "bones", label, line, cells, sizeof cells / sizeof cells[0]);
}

/* Measures in turns with the same frame without pins. */
static mrt_result measure_pins(bench *self, bone_scene *plain, bone_scene *held, uint32_t pins,
                               error *err)
{
    const csrbf_settings settings = {.radius = bones_radius_mm};
    lay_pins(held, pins);
    mrt_result result = shape_create(&held->held, plain->plane.xyz, plain->plane.vertex_count,
                                     BENCH_CONTROLS + pins, err);
    if (result >= 0)
        result = shape_engage(&held->held, &settings, held->start, BENCH_CONTROLS + pins, err);
    if (result >= 0) {
        bench_work work[] = {{.run = run_held, .data = plain}, {.run = run_held, .data = held}};
        bench_measure(work, 2, 4 * self->rounds, self->seconds);
        report_bones(self, "field held by pins", pins, work[1].least_ns, work[0].least_ns);
        if (pins == PINS_MAX || self->is_quick)
            bench_at_most(self, "a field held by pins, over one without",
                          work[1].least_ns / work[0].least_ns, 1.25);
    }
    shape_destroy(&held->held);
    held->held = (shape){0};
    return result;
}

static mrt_result measure_bones(bench *self, bone_scene *plain, bone_scene *held, error *err)
{
    static const uint32_t pins[] = {200, 500, PINS_MAX};
    const csrbf_settings settings = {.radius = bones_radius_mm};
    lay_pins(plain, 0);
    mrt_result result = bench_plane_create(&plain->plane, 128, true, err);
    if (result >= 0)
        result = shape_create(&plain->held, plain->plane.xyz, plain->plane.vertex_count,
                              BENCH_CONTROLS, err);
    if (result >= 0)
        result = shape_engage(&plain->held, &settings, plain->start, BENCH_CONTROLS, err);
    if (result >= 0)
        result = make_bone(plain, err);
    if (result < 0)
        return result;
    bench_work work[] = {{.run = run_held, .data = plain}, {.run = run_bone, .data = plain}};
    bench_measure(work, 2, 4 * self->rounds, self->seconds);
    report_bones(self, "ten columns and a bone", 0, work[1].least_ns, work[0].least_ns);
    bench_at_most(self, "fourteen columns, over ten", work[1].least_ns / work[0].least_ns, 1.5);
    for (size_t i = 0; i < sizeof pins / sizeof pins[0] && result >= 0; ++i)
        if (!self->is_quick || pins[i] < PINS_MAX)
            result = measure_pins(self, plain, held, pins[i], err);
    if (result >= 0 && (plain->failed < 0 || held->failed < 0))
        return error_set(err, MRT_ERR_UNSUPPORTED, "the engine refused a frame of the bench");
    return result;
}

mrt_result bench_bones(bench *self, error *err)
{
    bone_scene *scenes = calloc(2, sizeof *scenes);
    if (!scenes)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    bench_title(self, "Bones: 33 025 vertices, R = 40 mm");
    mrt_result result = measure_bones(self, &scenes[0], &scenes[1], err);
    columns_destroy(&scenes[0].with_bone);
    shape_destroy(&scenes[0].held);
    bench_plane_destroy(&scenes[0].plane);
    free(scenes);
    return result;
}

/* ---- one thread beside all threads of the pool: the work of a frame without a break, and after 3
 * ms of sleep, as between frames, when the workers must wake up. Also prints what the pool chooses
 * itself: its limits (base/pool.h) are derived from these rows ---- */

static const double threads_radius_mm = 80.0; /* every control reaches every vertex */
static const struct {
    uint32_t quads;
    bool has_centres;
} thread_models[] = {{128, true}, {362, false}, {512, false}, {1024, false}};
enum { THREAD_MODELS = sizeof thread_models / sizeof thread_models[0], QUICK_MODELS = 2 };

typedef struct thread_scene {
    bench_plane plane;
    shape shape;
    csrbf_solver *solver;
} thread_scene;

static void move_direct(thread_scene *self)
{
    (void)csrbf_move(self->solver, &self->shape.shown, &self->shape.base);
}

static void move_anchored(thread_scene *self)
{
    columns_move(&self->shape.response, &self->shape.shown, &self->shape.base, bench_pull);
}

static void find_responses(thread_scene *self)
{
    csrbf_responses(self->solver, self->shape.response.value, self->shape.response.stride,
                    &self->shape.base);
}

static void measure_folds(thread_scene *self)
{
    double slope, determinant;
    csrbf_measure(self->solver, &self->shape.base, &slope, &determinant);
}

static const struct {
    const char *name;
    void (*run)(thread_scene *self);
} kinds[] = {{"direct", move_direct},
             {"anchored", move_anchored},
             {"responses", find_responses},
             {"folds", measure_folds}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

typedef struct thread_run {
    thread_scene *of;
    void (*run)(thread_scene *self);
    double share_from_ns;
} thread_run;

static void run_alternately(void *data)
{
    thread_run *self = data;
    pool_share_from(self->share_from_ns);
    self->run(self->of);
    pool_share_from((double)INFINITY);
}

static void rest_a_while(void *data)
{
    (void)data;
    clock_sleep_until_ns(clock_now_ns() + 3 * NS_PER_MS);
}

static bool is_shared(thread_run usual)
{
    uint64_t before = pool_state_now().shared_count;
    usual.share_from_ns = POOL_WORTH_NS;
    run_alternately(&usual);
    return pool_state_now().shared_count > before;
}

static void report_threads(bench *self, const thread_scene *s, const char *kind,
                           const bench_work work[4], bool shared)
{
    char label[48], line[160];
    double hot = work[0].least_ns / work[1].least_ns, paced = work[2].least_ns / work[3].least_ns;
    snprintf(label, sizeof label, "%u %s", s->plane.vertex_count, kind);
    snprintf(line, sizeof line,
             "alone %8.3f ms   shared %8.3f ms: %5.2f x   after a rest %8.3f, %8.3f: %5.2f x   "
             "%s",
             work[0].least_ns * 1e-6, work[1].least_ns * 1e-6, hot, work[2].least_ns * 1e-6,
             work[3].least_ns * 1e-6, paced, shared ? "is shared" : "is not");
    const facts_cell cells[] = {
        {"kind", kind, 0.0, 0},
        {"vertices", NULL, s->plane.vertex_count, 0},
        {"alone_ns", NULL, work[0].least_ns, 1},
        {"shared_ns", NULL, work[1].least_ns, 1},
        {"rested_alone_ns", NULL, work[2].least_ns, 1},
        {"rested_shared_ns", NULL, work[3].least_ns, 1},
        {"is_shared", NULL, shared ? 1.0 : 0.0, 0},
    };
    facts_row(self->told, "threads", label, line, cells, sizeof cells / sizeof cells[0]);
}

static void measure_kinds(bench *self, thread_scene *s)
{
    for (size_t i = 0; i < KINDS; ++i) {
        thread_run alone = {.of = s, .run = kinds[i].run, .share_from_ns = (double)INFINITY};
        thread_run shared = {.of = s, .run = kinds[i].run, .share_from_ns = 0.0};
        bench_work work[] = {
            {.run = run_alternately, .data = &alone},
            {.run = run_alternately, .data = &shared},
            {.run = run_alternately, .data = &alone, .before = rest_a_while},
            {.run = run_alternately, .data = &shared, .before = rest_a_while},
        };
        bench_measure(work, sizeof work / sizeof work[0], self->rounds, self->seconds);
        report_threads(self, s, kinds[i].name, work, is_shared(alone));
        progress_show(&self->shown, -1.0, "threads");
    }
}

static mrt_result measure_thread_model(bench *self, size_t which, error *err)
{
    thread_scene s = {.solver = NULL};
    const csrbf_settings settings = {.radius = threads_radius_mm};
    mrt_result result = bench_plane_create(&s.plane, thread_models[which].quads,
                                           thread_models[which].has_centres, err);
    if (result >= 0)
        result = shape_create(&s.shape, s.plane.xyz, s.plane.vertex_count, BENCH_CONTROLS, err);
    if (result >= 0 && !(s.solver = csrbf_solver_create(BENCH_CONTROLS)))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a solver");
    if (result >= 0)
        result = shape_engage(&s.shape, &settings, bench_control, BENCH_CONTROLS, err);
    if (result >= 0)
        result = csrbf_factor(s.solver, &settings, bench_control, NULL, BENCH_CONTROLS, err);
    if (result >= 0)
        result = csrbf_solve(s.solver, bench_pull, err);
    if (result >= 0)
        measure_kinds(self, &s);
    csrbf_solver_destroy(s.solver);
    shape_destroy(&s.shape);
    bench_plane_destroy(&s.plane);
    return result;
}

mrt_result bench_threads(bench *self, error *err)
{
    char title[96];
    mrt_result result = MRT_OK;
    snprintf(title, sizeof title, "Threads: one, and %u of MAROTTE_THREADS", pool_threads());
    bench_title(self, title);
    facts_number(self->told, "threads", "threads", pool_threads(), 0, "");
    for (size_t i = 0; i < (self->is_quick ? QUICK_MODELS : THREAD_MODELS) && result >= 0; ++i)
        result = measure_thread_model(self, i, err);
    return result;
}
