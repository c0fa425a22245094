#include "bench/bench.h"
#include "base/large.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { ALIGNMENT = 64, STAGGER = 80 * sizeof(float) };

mrt_result bench_roof_create(bench_roof *out, size_t bytes, error *err)
{
    bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    *out = (bench_roof){.bytes = bytes, .used = bytes};
    out->from = large_alloc(bytes);
    out->to = large_alloc(bytes + STAGGER);
    out->other = large_alloc(bytes + 2 * STAGGER);
    if (!out->from || !out->to || !out->other) {
        bench_roof_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory to measure the machine with");
    }
    for (size_t i = 0; i < bytes / sizeof(float); ++i)
        out->from[i] = 1.0f + (float)(i % 1000) * 0.01f;
    memset(out->to, 0, bytes);
    memset(out->other, 0, bytes);
    return MRT_OK;
}

void bench_roof_destroy(bench_roof *self)
{
    free(self->from);
    free(self->to);
    free(self->other);
    *self = (bench_roof){0};
}

void bench_roof_copy(void *roof)
{
    const bench_roof *self = roof;
    memcpy(self->to, self->from, self->used / 2);
}

void bench_roof_triad(void *roof)
{
    const bench_roof *self = roof;
    size_t count = self->used / 3 / ALIGNMENT * (ALIGNMENT / sizeof(float));
    const float *a = self->from, *b = self->other;
    float *out = self->to;
#ifdef __SSE2__
    const __m128 scale = _mm_set1_ps(0.5f);
    for (size_t i = 0; i < count; i += 4)
        _mm_stream_ps(out + i,
                      _mm_add_ps(_mm_load_ps(a + i), _mm_mul_ps(scale, _mm_load_ps(b + i))));
    _mm_sfence();
#else
    for (size_t i = 0; i < count; ++i)
        out[i] = a[i] + 0.5f * b[i];
#endif
}

void bench_roof_roots(void *roof)
{
    const bench_roof *self = roof;
    const float *restrict from = self->from;
    float *restrict to = self->to;
    for (int i = 0; i < BENCH_ROOTS; ++i)
        to[i] = sqrtf(from[i]);
}

void bench_roof_flush(void *roof)
{
    const bench_roof *self = roof;
    volatile float sink = 0.0f;
    float sum = 0.0f;
    for (size_t i = 0; i < self->bytes / sizeof(float); i += ALIGNMENT / sizeof(float))
        sum += self->other[i]; /* read only: what is written would be written back later */
    sink = sum;
    (void)sink;
}
