/* csrbf/lanes_stream.h - writing what is too much for the caches around them, where the machine
 * can. Inline. Inside the room. Pure; any thread: stream_end before another thread may read. */
#ifndef MAROTTE_CSRBF_LANES_STREAM_H
#define MAROTTE_CSRBF_LANES_STREAM_H
#include "csrbf/points.h"

#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

/* out: aligned like a block of points. */
static inline void stream_block(float *out, const float *in)
{
#ifdef __SSE2__
    for (int i = 0; i < POINTS_BLOCK; i += 4)
        _mm_stream_ps(out + i, _mm_loadu_ps(in + i));
#else
    memcpy(out, in, POINTS_BLOCK * sizeof *out);
#endif
}

static inline void stream_end(void)
{
#ifdef __SSE2__
    _mm_sfence();
#endif
}

#endif
