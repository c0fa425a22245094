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

/* Leaves the candidates in the basis, which is empty and has its length and cap, and in use those
 * that are certainly needed. tolerance_square: that of the greatest vertex error wanted, m^2. */
CHECKED mrt_result window_axes_find(window_axes *out, basis *b, window_frames *frames,
                                    float tolerance_square, error *err);
void window_axes_finish(window_axes *a);

/* out_left: picked: how much of each picked frame the candidates tried leave, m^2. */
void window_axes_left_out(double *out_left, const window_axes *a, const basis *b);

#endif
