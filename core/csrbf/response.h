/* csrbf/response.h - unit responses B_k: what one control's unit displacement does to each vertex,
 * so that d(x) = sum_k B_k(x) g_k. Inside the room. [frame] */
#ifndef MAROTTE_CSRBF_RESPONSE_H
#define MAROTTE_CSRBF_RESPONSE_H
#include "csrbf/saddle.h"

/* out: a row of `stride` floats per control; zero in blocks that are not wanted (NULL: all are).
 * alpha: scratch of centre_count by ENVELOPE_MANY. */
void response_fill(const saddle *s, double *alpha, float *out, size_t stride, const points *in,
                   const uint8_t *wanted);

#endif
