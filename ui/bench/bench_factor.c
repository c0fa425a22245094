/* Factorisation and solution with many centres, as for a rig with pins or for reading a scan. Also
 * taking hold again with unchanged pins, where only the tips are factored. */
#include "bench/bench.h"
#include "csrbf/saddle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { CENTRES_MAX = 3000, TIPS = 10, ROOM = CENTRES_MAX + TIPS, ROUNDS = 3 };
static const uint32_t counts[] = {200, 500, 1000, CENTRES_MAX};
static const double radii_mm[] = {30.0, 40.0, 50.0};

typedef struct head { /* centres spread evenly over an ellipsoid of a skull's size */
    double centre[ROOM * 3], g[ROOM * 3];
    csrbf_class class[ROOM];
    uint32_t count;
    csrbf_settings settings;
    csrbf_solver *solver;
    saddle many; /* for many right-hand sides together */
    double *side;
    order_item *scratch;
    uint32_t round;
    mrt_result failed;
} head;

void bench_skull_centre(double out[3], uint32_t i, uint32_t count, double scale)
{
    static const double radius_mm[3] = {62.0, 85.0, 78.0}, golden_rad = 2.399963229728653;
    double y = 1.0 - 2.0 * ((double)i + 0.5) / (double)count, r = sqrt(1.0 - y * y);
    double at[3] = {r * cos(golden_rad * i), y, r * sin(golden_rad * i)};
    for (int axis = 0; axis < 3; ++axis)
        out[axis] = at[axis] * radius_mm[axis] * scale;
}

static void spread(head *self, uint32_t count)
{
    self->count = count;
    for (uint32_t i = 0; i < count; ++i) {
        bench_skull_centre(self->centre + (size_t)3 * i, i, count, 1.0);
        self->class[i] = CSRBF_SKULL;
        for (uint32_t axis = 0; axis < 3; ++axis)
            self->g[3 * i + axis] = i % 100 == 0 ? 1.0 : 0.0;
    }
}

/* Adds tips in the skin in front of the skull, which pull. */
static void add_tips(head *self)
{
    for (uint32_t i = 0; i < self->count * 3; ++i)
        self->g[i] = 0.0;
    for (uint32_t i = 0; i < TIPS; ++i, ++self->count) {
        bench_skull_centre(self->centre + (size_t)3 * self->count, i, TIPS, 1.2);
        self->class[self->count] = CSRBF_TIP;
        for (uint32_t axis = 0; axis < 3; ++axis)
            self->g[3 * self->count + axis] = (double)(i % 3) - 1.0;
    }
}

static void note(head *self, mrt_result result)
{
    if (result < 0)
        self->failed = result;
}

static void factor(head *self, const csrbf_settings *settings)
{
    note(self, csrbf_factor(self->solver, settings, self->centre, self->class, self->count, NULL));
}

/* Runs the whole factorisation. Consecutive rounds have different matrices. */
static void run_factor(void *data)
{
    head *self = data;
    csrbf_settings settings = self->settings;
    settings.ridge = 1e-13 * (1.0 + (double)(self->round++ % ROUNDS));
    factor(self, &settings);
}

static void run_solve(void *data)
{
    head *self = data;
    note(self, csrbf_solve(self->solver, self->g, NULL));
}

static void run_solve_many(void *data)
{
    head *self = data;
    double beta[4][ENVELOPE_MANY];
    saddle_solve_units(&self->many, 0, self->side, beta);
}

static void run_hold_afresh(void *data)
{
    run_factor(data);
    run_solve(data);
}

static void run_hold_again(void *data)
{
    head *self = data;
    double way_mm = 0.5 * (double)(self->round++ % ROUNDS);
    for (uint32_t i = self->count - TIPS; i < self->count; ++i)
        self->centre[(size_t)3 * i + 2] = self->centre[(size_t)3 * i] * 0.5 + way_mm;
    factor(self, &self->settings);
    run_solve(self);
}

/* Simulates earlier tips, so that all stored data of the pins is in place. */
static void hold_some_times(void *data)
{
    run_hold_again(data);
    run_hold_again(data);
}

static void report(bench *self, const head *h, const bench_work work[3])
{
    char label[32], line[160];
    csrbf_diagnostics diagnosed = csrbf_diagnose(h->solver);
    snprintf(label, sizeof label, "%u R=%g", h->count, h->settings.radius);
    snprintf(line, sizeof line,
             "factor %8.2f ms   three sides %7.2f ms   sixteen %7.2f ms   envelope %5.1f %% of "
             "the triangle",
             work[0].least_ns * 1e-6, work[1].least_ns * 1e-6, work[2].least_ns * 1e-6,
             100.0 * (double)diagnosed.envelope_count /
                 (0.5 * (double)h->count * ((double)h->count + 1.0)));
    const facts_cell cells[] = {
        {"centres", NULL, h->count, 0},
        {"radius_mm", NULL, h->settings.radius, 1},
        {"factor_ms", NULL, work[0].least_ns * 1e-6, 4},
        {"solve_ms", NULL, work[1].least_ns * 1e-6, 4},
        {"solve_many_ms", NULL, work[2].least_ns * 1e-6, 4},
        {"envelope_entries", NULL, diagnosed.envelope_count, 0},
    };
    facts_row(self->told, "factor", label, line, cells, sizeof cells / sizeof cells[0]);
}

static void measure(bench *self, head *h)
{
    note(h, saddle_factor(&h->many, &h->many, h->scratch, &h->settings, h->centre, h->class,
                          h->count, NULL));
    bench_work work[] = {{.run = run_factor, .data = h},
                         {.run = run_solve, .data = h},
                         {.run = run_solve_many, .data = h}};
    bench_measure(work, 3, self->rounds, self->seconds);
    report(self, h, work);
    if (h->count == CENTRES_MAX && h->settings.radius <= radii_mm[1] &&
        h->settings.radius >= radii_mm[1])
        bench_at_most_ms(self, "3 000 centres factored", work[0].least_ns * 1e-6, 60.0);
}

static void measure_again(bench *self, head *h)
{
    char label[48], line[128];
    bench_work work[] = {{.run = run_hold_afresh, .data = h},
                         {.run = run_hold_again, .data = h, .before = hold_some_times}};
    bench_measure(work, 2, self->rounds, self->seconds);
    double ratio = work[0].least_ns / work[1].least_ns;
    snprintf(label, sizeof label, "%d tips, %u pins", TIPS, h->count - TIPS);
    snprintf(line, sizeof line, "factor and solve %8.2f ms   tips alone %8.2f ms: %5.1f x",
             work[0].least_ns * 1e-6, work[1].least_ns * 1e-6, ratio);
    const facts_cell cells[] = {
        {"pins", NULL, h->count - TIPS, 0},
        {"afresh_ms", NULL, work[0].least_ns * 1e-6, 4},
        {"again_ms", NULL, work[1].least_ns * 1e-6, 4},
        {"ratio", NULL, ratio, 3},
    };
    facts_row(self->told, "hold_again", label, line, cells, sizeof cells / sizeof cells[0]);
}

static void measure_all(bench *self, head *h)
{
    bench_title(self, "Factorisation: centres all over a head");
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i)
        for (size_t k = 0; k < sizeof radii_mm / sizeof radii_mm[0]; ++k) {
            if (self->is_quick && counts[i] == CENTRES_MAX && k != 1)
                continue;
            spread(h, counts[i]);
            h->settings = (csrbf_settings){.radius = radii_mm[k]};
            measure(self, h);
        }
    bench_title(self, "Taking hold again: pins stay, R = 40 mm");
    for (size_t i = 1; i < sizeof counts / sizeof counts[0]; ++i) {
        spread(h, counts[i]);
        add_tips(h);
        h->settings = (csrbf_settings){.radius = radii_mm[1]};
        measure_again(self, h);
    }
}

static mrt_result create(head **out, error *err)
{
    head *h = *out = calloc(1, sizeof *h);
    if (h && (h->solver = csrbf_solver_create(ROOM)) && saddle_create(&h->many, ROOM) &&
        (h->side = calloc((size_t)ROOM * ENVELOPE_MANY, sizeof *h->side)) &&
        (h->scratch = calloc((size_t)3 * ROOM, sizeof *h->scratch)))
        return MRT_OK;
    return error_set(err, MRT_ERR_MEMORY, "no memory for %d centres", ROOM);
}

static void destroy(head *h)
{
    if (!h)
        return;
    csrbf_solver_destroy(h->solver);
    saddle_destroy(&h->many);
    free(h->side);
    free(h->scratch);
    free(h);
}

mrt_result bench_factor(bench *self, error *err)
{
    head *h;
    mrt_result result = create(&h, err);
    if (result >= 0)
        measure_all(self, h);
    if (result >= 0 && h->failed < 0)
        result = error_set(err, h->failed, "the engine refused the centres of the bench");
    destroy(h);
    return result;
}
