/* io/write/window_axes.h - candidates for the axes of a window: principal components of some of its
 * frames. Private to the search for components. One thread at a time. */
#ifndef MAROTTE_IO_WINDOW_AXES_H
#define MAROTTE_IO_WINDOW_AXES_H
#include "io/write/basis.h"
#include "io/write/component_frames.h"

typedef struct window_axes {
    uint32_t picked;
    uint32_t *pick;   /* picked: frames of the window, ascending */
    double *vector;   /* picked by picked: eigenvectors of their Gram matrix, one per row */
    double *strength; /* picked: eigenvalues, descending */
} window_axes;

/* Stores the candidates in the basis and uses those that are certainly needed. The basis must be
 * empty, with length and cap set. tolerance_square: square of the maximum vertex error, m^2. */
CHECKED mrt_result window_axes_find(window_axes *out, basis *b, window_frames *frames,
                                    float tolerance_square, error *err);
void window_axes_finish(window_axes *a);

/* Computes the squared residual of each picked frame after the tried candidates, m^2. out_left:
 * picked. */
void window_axes_left_out(double *out_left, const window_axes *a, const basis *b);

#endif
