/* csrbf/saddle.h - the linear system of a field: [A P; P^T 0] [alpha; beta] = [g; 0]. It uses the
 * Cholesky factor of A and block elimination of the polynomial: Y = A^-1 P, S = P^T Y, beta = S^-1
 * Y^T g, alpha = A^-1 (g - P beta). In this order: centres and their order, the factor of A, the
 * system, unit responses. Internal to csrbf. [frame] all except create/destroy. */
#ifndef MAROTTE_CSRBF_SADDLE_H
#define MAROTTE_CSRBF_SADDLE_H
#include "csrbf/field.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- centres: controls in canonical order, merged where they coincide ---- */

/* Merges connected components of controls that are at most a distance apart. In a component, only
 * the members of its highest class count. The centre is at their mean, and moves by the mean of
 * their displacements.
 * The order is skull, jaw, tips, so that the factor of pins does not depend on tips. Within a
 * class, few centres are ordered along a Morton curve, and many along their longest axis. For
 * centres all over a head, the longest axis needs half of the operations of the curve, and two
 * thirds of those of reverse Cuthill-McKee. */
typedef struct merge {
    uint32_t control_count, group_count;
    uint32_t *sorted; /* control_count: the controls in canonical order */
    uint32_t *group;  /* group of each control; groups are in canonical order too */
    double *share;    /* share of each control in its group's mean: 1 / members that count, or 0 */
} merge;

/* ---- the factor of a symmetric positive definite matrix ---- */

/* Stores the envelope: each row from its first nonzero to the diagonal. The factor has no entries
 * outside of it. Rows are processed in groups for speed. Each entry is still a separate sum over
 * ascending columns, so the bits do not depend on the grouping. */

/* Numbers of right-hand sides that are solved together: few for a pull, many for unit responses. */
enum { ENVELOPE_FEW = 4, ENVELOPE_MANY = 16 };
/* Rows are factored in groups, and several groups together. A group begins at a multiple of
 * ENVELOPE_ALIKE. */
enum { ENVELOPE_LANES = 32, ENVELOPE_GROUPS = 2, ENVELOPE_ALIKE = 4 };

typedef struct envelope {
    uint32_t row_capacity, row_count;
    uint32_t factored_count; /* number of rows whose values are those of the factor */
    uint32_t *first;         /* for each row: column of its first entry */
    size_t *start;           /* for each row: its beginning in value; row_capacity + 1 */
    double *value;           /* the matrix, later its factor */
    double *group;           /* scratch for each group: row_capacity by ENVELOPE_LANES */
    const struct lanes *lanes;
} envelope;

bool envelope_create(envelope *out, uint32_t row_capacity); /* false: no memory */
void envelope_destroy(envelope *e);

/* Keeps the first `row_count` rows, which must be factored, and removes the others. row_count: a
 * multiple of ENVELOPE_ALIKE. */
void envelope_keep(envelope *e, uint32_t row_count);
/* Adds a row, from column `first` to the diagonal; the caller fills it. */
double *envelope_add_row(envelope *e, uint32_t first);

/* Factors the rows that are not factored yet. Returns false if a pivot is not above
 * `smallest_pivot`; out_row is its row. */
bool envelope_factor(envelope *e, double smallest_pivot, uint32_t *out_row);

/* Solves in place; rhs: row_count by ENVELOPE_FEW or by ENVELOPE_MANY. */
void envelope_solve_few(const envelope *e, double *rhs);
void envelope_solve_many(const envelope *e, double *rhs);

/* ---- the system ---- */

typedef struct saddle {
    merge merge;
    field field; /* settings, centres, hull; and the last solution */
    envelope matrix;
    double *basis;      /* P: centre_count by ENVELOPE_FEW; columns after term_count are 0 */
    double *resolved;   /* Y: likewise */
    double schur[4][4]; /* lower Cholesky factor of S */
    double gain;        /* from saddle_limit_gain; 0 if it was never called */
    bool merged_apart;
    double *factored; /* centre_count by 3: centres of the rows that `matrix` has factored */
    csrbf_settings factored_for;
} saddle;

bool saddle_create(saddle *out, uint32_t centre_capacity); /* false: no memory */
void saddle_destroy(saddle *s);

/* Factors the system. The caller checks the arguments. scratch: three times count items. Rows that
 * `s` or `other` has already factored are not factored again. They must be the first in canonical
 * order, with the same centres, kernel, radius and ridge. So pins cost nothing while only tips
 * change. The result has the same bits. On error `s` must be factored again before use. */
CHECKED mrt_result saddle_factor(saddle *s, const saddle *other, order_item *scratch,
                                 const csrbf_settings *settings, const double *centre,
                                 const csrbf_class *class, uint32_t count, error *err);

/* rhs: scratch of centre_count by ENVELOPE_FEW. On error the last solution is kept. */
CHECKED mrt_result saddle_solve(saddle *s, double *rhs, const double *g, error *err);

/* Computes alpha and beta of unit displacements of the centres first .. first + ENVELOPE_MANY - 1.
 * At the end there may be fewer; the other columns are 0. alpha: centre_count by ENVELOPE_MANY. */
void saddle_solve_units(const saddle *s, uint32_t first, double *alpha,
                        double beta[4][ENVELOPE_MANY]);

/* Drops the flattest direction of the polynomial until its gain at the corners of the box is at
 * most `limit`: sum_k |d p / d g_k| <= limit. Clears the solution. */
void saddle_limit_gain(saddle *s, const points_bounds *box, double limit);

/* ---- unit responses ---- */

/* B_k: displacement of each vertex for a unit displacement of one control, so that d(x) = sum_k
 * B_k(x) g_k. */

enum { SADDLE_SCRATCH = 48 }; /* number of doubles for each centre */

/* out: a row of `stride` floats per control, zero in blocks that are not wanted (NULL: all are).
 * scratch: centre_count by SADDLE_SCRATCH. */
void saddle_responses(const saddle *s, double *scratch, float *out, size_t stride, const points *in,
                      const uint8_t *wanted);

#endif
