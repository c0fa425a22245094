/* face/fit/fit_solve.h - the pose and the pulls that come closest to one target of a fit_gram. The
 * pulls are linear for a given pose. The few degrees of freedom are found around them, by
 * Levenberg-Marquardt with the linear part eliminated (Golub and Pereyra 1973).
 * Private to this folder. [main] */
#ifndef MAROTTE_FACE_FIT_SOLVE_H
#define MAROTTE_FACE_FIT_SOLVE_H
#include "base/arrays.h"
#include "face/fit/fit_gram.h"

typedef struct fit_solver {
    arrays arrays; /* owner of the arrays below */
    const bones *bones;
    const fit_gram *gram;
    double ridge;     /* on the pulls, as a share of the mean diagonal of their matrix; > 0 */
    uint32_t unknown; /* 3 * control_count */
    double *weight;   /* column_count by 3 */
    double *slope;    /* MRT_MAX_DOFS by column_count by 3: derivative of the weights by a dof */
    double *matrix;   /* unknown by unknown, then its Cholesky factor */
    double *vector;   /* unknown */
    double *cross;    /* MRT_MAX_DOFS by unknown */
    double *product;  /* column_count by 3 */
    uint32_t *control_column,
        *control_start; /* columns of each control; control_start has control_count + 1 entries */
} fit_solver;

CHECKED mrt_result fit_solver_create(fit_solver *out, const bones *b, const fit_gram *gram,
                                     double ridge, error *err);
void fit_solver_destroy(fit_solver *s); /* accepts zeroed */

/* Finds the pulls with the least squared error for the bones posed by dof (dof_count). pull:
 * control_count by 3: g of the design's formula, in the bones' rest frame. Returns the squared
 * error. */
double fit_solve_pulls(fit_solver *s, double *pull, const float *dof, uint32_t target);
/* Also searches dof within its limits, starting from the given values. Returns the squared
 * error. */
double fit_solve_pose(fit_solver *s, double *pull, float *dof, uint32_t target);

#endif
