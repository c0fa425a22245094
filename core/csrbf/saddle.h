/* csrbf/saddle.h - the linear system of a field: [A P; P^T 0] [alpha; beta] = [g; 0], by Cholesky
 * of A and block elimination of the polynomial: Y = A^-1 P, S = P^T Y, beta = S^-1 Y^T g,
 * alpha = A^-1 (g - P beta). From the bottom: which controls are centres and in what order, the
 * factor of A, the system, and the unit responses that it gives. Inside the room. [frame] all but
 * create/destroy. */
#ifndef MAROTTE_CSRBF_SADDLE_H
#define MAROTTE_CSRBF_SADDLE_H
#include "csrbf/field.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- centres: controls in canonical order, joined where they coincide ---- */

/* Connected components of "not further apart than a distance". Of a component only the members of
 * its highest class count; it stands at their mean, and moves by the mean of their displacements.
 * The order: the skull, then the jaw, then the tips, so that what a factor says of pins does not
 * depend on tips; of each class few along a Morton curve, and many along their longest axis: for
 * centres all over a head the factorisation then has half as much to do as along the curve, and two
 * thirds of what it has after reverse Cuthill-McKee. */
typedef struct merge {
    uint32_t control_count, group_count;
    uint32_t *sorted; /* control_count: the controls in canonical order */
    uint32_t *group;  /* of each control; groups are in canonical order too */
    double *share;    /* of each control in its group's mean: 1 / members that count, or 0 */
} merge;

/* ---- the factor of a symmetric positive definite matrix ---- */

/* Stored by its envelope: each row from its first nonzero to the diagonal; the factor has no fill
 * outside. Rows are worked on in groups for speed; every entry is still its own sum over ascending
 * columns, so the bits do not depend on the grouping. */

/* Right-hand sides that are solved together: few for a pull, many for unit responses. */
enum { ENVELOPE_FEW = 4, ENVELOPE_MANY = 16 };
/* Rows are factored in groups, and some groups together; a group begins at a multiple of
 * ENVELOPE_ALIKE. */
enum { ENVELOPE_LANES = 32, ENVELOPE_GROUPS = 2, ENVELOPE_ALIKE = 4 };

typedef struct envelope {
    uint32_t row_capacity, row_count;
    uint32_t factored_count; /* rows whose values are those of the factor */
    uint32_t *first;         /* of each row: column of its first entry */
    size_t *start;           /* of each row: where it begins in value; row_capacity + 1 */
    double *value;           /* the matrix, then its factor */
    double *group;           /* scratch of each group: row_capacity by ENVELOPE_LANES */
    const struct lanes *lanes;
} envelope;

bool envelope_create(envelope *out, uint32_t row_capacity); /* false: no memory */
void envelope_destroy(envelope *e);

/* The first `row_count` rows stay, which have been factored; the others go. row_count: a multiple
 * of ENVELOPE_ALIKE. */
void envelope_keep(envelope *e, uint32_t row_count);
/* The next row, from column `first` to the diagonal, for the caller to fill. */
double *envelope_add_row(envelope *e, uint32_t first);

/* Of the rows that are not factored yet. False when a pivot is not above `smallest_pivot`; its row
 * is then in out_row. */
bool envelope_factor(envelope *e, double smallest_pivot, uint32_t *out_row);

/* Solves in place; rhs: row_count by ENVELOPE_FEW or by ENVELOPE_MANY. */
void envelope_solve_few(const envelope *e, double *rhs);
void envelope_solve_many(const envelope *e, double *rhs);

/* ---- the system ---- */

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

/* ---- unit responses ---- */

/* B_k: what one control's unit displacement does to each vertex, so that d(x) = sum_k B_k(x) g_k.
 */

enum { SADDLE_SCRATCH = 48 }; /* doubles for each centre */

/* out: a row of `stride` floats per control; zero in blocks that are not wanted (NULL: all are).
 * scratch: centre_count by SADDLE_SCRATCH. */
void saddle_responses(const saddle *s, double *scratch, float *out, size_t stride, const points *in,
                      const uint8_t *wanted);

#endif
