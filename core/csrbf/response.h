/* csrbf/response.h - unit responses B_k: what one control's unit displacement does to each vertex,
 * so that d(x) = sum_k B_k(x) g_k. Inside the room. [frame] */
#ifndef MAROTTE_CSRBF_RESPONSE_H
#define MAROTTE_CSRBF_RESPONSE_H
#include "csrbf/columns.h"
#include "csrbf/saddle.h"

enum { RESPONSE_SCRATCH = 48 }; /* doubles for each centre */

/* out: a row of `stride` floats per control; zero in blocks that are not wanted (NULL: all are).
 * scratch: centre_count by RESPONSE_SCRATCH. */
void response_fill(const saddle *s, double *scratch, float *out, size_t stride, const points *in,
                   const uint8_t *wanted);

/* Rows of out: the derivatives of B_k along `direction`, at each vertex its own. Not for C0, not
 * for a windowed polynomial. */
void response_derive(const saddle *s, double *scratch, columns *out, const points *in,
                     const points *direction);

#endif
