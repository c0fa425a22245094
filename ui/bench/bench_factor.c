/* Factorisation and solve of many centres: what a rig with pins, or a reader of scans, asks for. */
#include "bench/bench.h"
#include "csrbf/csrbf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { CENTRES_MAX = 3000 };
static const uint32_t counts[] = {200, 500, 1000, CENTRES_MAX};
static const double radii_mm[] = {30.0, 40.0, 50.0};

typedef struct head { /* centres spread evenly over an ellipsoid of a skull's size */
    double centre[CENTRES_MAX * 3], g[CENTRES_MAX * 3];
    uint32_t count;
    csrbf_settings settings;
    csrbf_solver *solver;
    mrt_result failed;
} head;

static void spread(head *self, uint32_t count)
{
    static const double radius_mm[3] = {62.0, 85.0, 78.0};
    const double golden = 2.399963229728653;
    self->count = count;
    for (uint32_t i = 0; i < count; ++i) {
        double y = 1.0 - 2.0 * ((double)i + 0.5) / (double)count, r = sqrt(1.0 - y * y);
        double at[3] = {r * cos(golden * i), y, r * sin(golden * i)};
        for (int axis = 0; axis < 3; ++axis) {
            self->centre[3 * i + (uint32_t)axis] = at[axis] * radius_mm[axis];
            self->g[3 * i + (uint32_t)axis] = i % 100 == 0 ? 1.0 : 0.0;
        }
    }
}

static void run_factor(void *data)
{
    head *self = data;
    mrt_result result =
        csrbf_factor(self->solver, &self->settings, self->centre, NULL, self->count, NULL);
    if (result < 0)
        self->failed = result;
}

static void run_solve(void *data)
{
    head *self = data;
    mrt_result result = csrbf_solve(self->solver, self->g, NULL);
    if (result < 0)
        self->failed = result;
}

static void tell(bench *self, const head *h, const bench_work work[2])
{
    char label[32], line[160];
    csrbf_diagnostics said = csrbf_diagnose(h->solver);
    snprintf(label, sizeof label, "%u R=%g", h->count, h->settings.radius);
    snprintf(line, sizeof line,
             "factor %8.2f ms   three sides %7.2f ms   envelope %5.1f %% of the triangle",
             work[0].least_ns * 1e-6, work[1].least_ns * 1e-6,
             100.0 * (double)said.envelope_count /
                 (0.5 * (double)h->count * ((double)h->count + 1.0)));
    const facts_cell cells[] = {
        {"centres", NULL, h->count, 0},
        {"radius_mm", NULL, h->settings.radius, 1},
        {"factor_ms", NULL, work[0].least_ns * 1e-6, 4},
        {"solve_ms", NULL, work[1].least_ns * 1e-6, 4},
        {"envelope_entries", NULL, said.envelope_count, 0},
    };
    facts_row(self->told, "factor", label, line, cells, sizeof cells / sizeof cells[0]);
}

mrt_result bench_factor(bench *self, error *err)
{
    mrt_result result = MRT_OK;
    head *h = calloc(1, sizeof *h);
    if (h)
        h->solver = csrbf_solver_create(CENTRES_MAX);
    if (!h || !h->solver)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for %d centres", CENTRES_MAX);
    bench_title(self, "Factorisation: centres all over a head");
    for (size_t i = 0; i < sizeof counts / sizeof counts[0] && result >= 0; ++i)
        for (size_t k = 0; k < sizeof radii_mm / sizeof radii_mm[0]; ++k) {
            if (self->is_quick && counts[i] == CENTRES_MAX && k != 1)
                continue;
            spread(h, counts[i]);
            h->settings = (csrbf_settings){.radius = radii_mm[k]};
            bench_work work[] = {{.name = "factor", .run = run_factor, .data = h},
                                 {.name = "solve", .run = run_solve, .data = h}};
            bench_measure(work, 2, self->rounds, self->seconds);
            tell(self, h, work);
        }
    if (result >= 0 && h->failed < 0)
        result = error_set(err, h->failed, "the engine refused the centres of the bench");
    if (h)
        csrbf_solver_destroy(h->solver);
    free(h);
    return result;
}
