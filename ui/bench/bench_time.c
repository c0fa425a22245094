#include "base/clock.h"
#include "bench/bench.h"

#include <stdlib.h>

static double time_one(bench_work *work)
{
    if (work->before)
        work->before(work->data);
    else
        work->run(work->data); /* its data comes into the caches, the others' leave */
    int64_t start_ns = clock_now_ns();
    work->run(work->data);
    return (double)(clock_now_ns() - start_ns);
}

uint32_t bench_measure(bench_work *work, uint32_t count, uint32_t rounds, double seconds)
{
    uint32_t round = 0;
    for (uint32_t i = 0; i < count; ++i) {
        (void)time_one(&work[i]);
        work[i].least_ns = 0.0;
    }
    int64_t end_ns = clock_now_ns() + (int64_t)(seconds * 1e9);
    while (round < rounds && (round < 3 || clock_now_ns() < end_ns)) {
        for (uint32_t i = 0; i < count; ++i) {
            double took_ns = time_one(&work[i]);
            if (round == 0 || took_ns < work[i].least_ns)
                work[i].least_ns = took_ns;
            if (work[i].took_ns)
                work[i].took_ns[round] = took_ns;
        }
        ++round;
    }
    return round;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_quantile(double *value, uint32_t count, double share)
{
    if (count == 0)
        return 0.0;
    qsort(value, count, sizeof *value, by_size);
    uint32_t index = (uint32_t)((double)count * share);
    return value[index < count ? index : count - 1];
}
