/* What the engine is promised to reach, beside what this run measured. */
#include "bench/bench.h"

#include <stdio.h>

/* Other work on the machine takes from a ratio too: a gate asks for half of it. */
static const double gate_share = 0.5;

static void note(bench *self, const bench_promise *promise)
{
    if (self->promise_count < BENCH_PROMISES)
        self->promise[self->promise_count++] = *promise;
}

void bench_at_least(bench *self, const char *what, double measured, double promised)
{
    note(self, &(bench_promise){what, "", measured, promised, false, true});
}

void bench_at_most(bench *self, const char *what, double measured, double promised)
{
    note(self, &(bench_promise){what, "", measured, promised, true, true});
}

void bench_at_most_ms(bench *self, const char *what, double measured_ms, double promised_ms)
{
    note(self, &(bench_promise){what, " ms", measured_ms, promised_ms, true, false});
}

static bool is_kept(const bench_promise *p, double share)
{
    return p->is_most ? p->measured * share <= p->promised : p->measured >= p->promised * share;
}

uint32_t bench_promises(bench *self)
{
    uint32_t broken = 0;
    if (self->promise_count > 0)
        bench_title(self, "What is promised");
    for (uint32_t i = 0; i < self->promise_count; ++i) {
        const bench_promise *p = &self->promise[i];
        char line[160];
        bool is_broken = p->is_gated && !is_kept(p, gate_share);
        broken += is_broken;
        const char *verdict = is_kept(p, 1.0) ? "kept" : is_broken ? "far missed" : "missed";
        snprintf(line, sizeof line, "%-40s %9.3f%s, promised at %s %g%s", p->what, p->measured,
                 p->unit, p->is_most ? "most" : "least", p->promised, p->unit);
        const facts_cell cells[] = {
            {"what", p->what, 0.0, 0},
            {"measured", NULL, p->measured, 6},
            {p->is_most ? "at_most" : "at_least", NULL, p->promised, 6},
            {"is_kept", NULL, is_kept(p, 1.0), -1},
            {"is_half_kept", NULL, is_kept(p, gate_share), -1},
            {"is_gated", NULL, p->is_gated, -1},
        };
        facts_row(self->told, "promises", verdict, line, cells, sizeof cells / sizeof cells[0]);
    }
    return broken;
}
