/* One thread beside as many as the pool has: a frame's work in a row, and after 3 ms of sleep as
 * between frames, when workers have to be woken. What the pool does of its own accord is told too:
 * its limits (base/pool.h) come of these rows. */
#include "base/clock.h"
#include "base/pool.h"
#include "bench/bench.h"
#include "bench/bench_plane.h"
#include "csrbf/shape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double radius_mm = 80.0; /* every control reaches every vertex */
static const struct {
    uint32_t quads;
    bool has_centres;
} models[] = {{128, true}, {362, false}, {512, false}, {1024, false}};
enum { MODELS = sizeof models / sizeof models[0], QUICK_MODELS = 2 };

typedef struct scene {
    bench_plane plane;
    shape shape;
    csrbf_solver *solver;
} scene;

static void move_direct(scene *self)
{
    (void)csrbf_move(self->solver, &self->shape.shown, &self->shape.base);
}

static void move_anchored(scene *self)
{
    columns_move(&self->shape.response, &self->shape.shown, &self->shape.base, bench_pull);
}

static void find_responses(scene *self)
{
    csrbf_responses(self->solver, self->shape.response.value, self->shape.response.stride,
                    &self->shape.base);
}

static void measure_folds(scene *self)
{
    double slope, determinant;
    csrbf_measure(self->solver, &self->shape.base, &slope, &determinant);
}

static const struct {
    const char *name;
    void (*run)(scene *self);
} kinds[] = {{"direct", move_direct},
             {"anchored", move_anchored},
             {"responses", find_responses},
             {"folds", measure_folds}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

typedef struct thread_run {
    scene *of;
    void (*run)(scene *self);
    double share_from_ns;
} thread_run;

static void run_turn(void *data)
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
    run_turn(&usual);
    return pool_state_now().shared_count > before;
}

static void tell(bench *self, const scene *s, const char *kind, const bench_work work[4],
                 bool shared)
{
    char label[48], line[160];
    double hot = work[0].least_ns / work[1].least_ns, paced = work[2].least_ns / work[3].least_ns;
    snprintf(label, sizeof label, "%u %s", s->plane.vertex_count, kind);
    snprintf(line, sizeof line,
             "alone %8.3f ms   shared %8.3f ms: %5.2f x   after a rest %8.3f, %8.3f: %5.2f x   %s",
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

static void measure_kinds(bench *self, scene *s)
{
    for (size_t i = 0; i < KINDS; ++i) {
        thread_run alone = {.of = s, .run = kinds[i].run, .share_from_ns = (double)INFINITY};
        thread_run shared = {.of = s, .run = kinds[i].run, .share_from_ns = 0.0};
        bench_work work[] = {
            {.name = "alone", .run = run_turn, .data = &alone},
            {.name = "shared", .run = run_turn, .data = &shared},
            {.name = "alone", .run = run_turn, .data = &alone, .before = rest_a_while},
            {.name = "shared", .run = run_turn, .data = &shared, .before = rest_a_while},
        };
        bench_measure(work, sizeof work / sizeof work[0], self->rounds, self->seconds);
        tell(self, s, kinds[i].name, work, is_shared(alone));
        progress_show(&self->shown, -1.0, "threads");
    }
}

static mrt_result measure_model(bench *self, size_t which, error *err)
{
    scene s = {.solver = NULL};
    const csrbf_settings settings = {.radius = radius_mm};
    mrt_result result =
        bench_plane_create(&s.plane, models[which].quads, models[which].has_centres, err);
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
    for (size_t i = 0; i < (self->is_quick ? QUICK_MODELS : MODELS) && result >= 0; ++i)
        result = measure_model(self, i, err);
    return result;
}
