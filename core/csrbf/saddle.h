/* csrbf/saddle.h - the linear system of a field: [A P; P^T 0] [alpha; beta] = [g; 0], by Cholesky
 * of A and block elimination of the polynomial: Y = A^-1 P, S = P^T Y, beta = S^-1 Y^T g,
 * alpha = A^-1 (g - P beta). Inside the room. [frame] all but create/destroy. */
#ifndef MAROTTE_CSRBF_SADDLE_H
#define MAROTTE_CSRBF_SADDLE_H
#include "csrbf/envelope.h"
#include "csrbf/field.h"
#include "csrbf/merge.h"

typedef struct saddle {
    merge merge;
    field field; /* settings, centres, hull; and the last solution */
    envelope matrix;
    double *basis;      /* P: centre_count by ENVELOPE_FEW, columns beyond term_count are 0 */
    double *resolved;   /* Y: likewise */
    double schur[4][4]; /* lower Cholesky factor of S */
    double gain;        /* of saddle_limit_gain; 0 when never asked */
    bool merged_apart;
    double *factored; /* centre_count by 3: of the rows that `matrix` has factored */
    csrbf_settings factored_for;
} saddle;

bool saddle_create(saddle *out, uint32_t centre_capacity); /* false: no memory */
void saddle_destroy(saddle *s);

/* Arguments checked by the caller. scratch: three times count items. Where the first centres in
 * canonical order are those that `s` or `other` has factored with the same kernel, radius and
 * ridge, their rows are not factored again: so pins cost nothing while only tips change. The result
 * has the same bits. On error `s` is useless until it is factored again. */
CHECKED mrt_result saddle_factor(saddle *s, const saddle *other, order_item *scratch,
                                 const csrbf_settings *settings, const double *centre,
                                 const csrbf_class *class, uint32_t count, error *err);

/* rhs: scratch of centre_count by ENVELOPE_FEW. On error the last solution stays. */
CHECKED mrt_result saddle_solve(saddle *s, double *rhs, const double *g, error *err);

/* alpha and beta of unit displacements of the centres first .. first + ENVELOPE_MANY - 1 (fewer at
 * the end; the columns beyond are 0). alpha: centre_count by ENVELOPE_MANY. */
void saddle_solve_units(const saddle *s, uint32_t first, double *alpha,
                        double beta[4][ENVELOPE_MANY]);

/* Drops the flattest direction of the polynomial until, at the corners of the box, it is at most
 * `limit` times the displacements: sum_k |d p / d g_k| <= limit. Clears the solution. */
void saddle_limit_gain(saddle *s, const points_bounds *box, double limit);

#endif
