/* face/fit/fit_gram.h - a face and its targets reduced to the sums that least squares needs. The
 * face is linear in its columns (face.h), x' - x = sum_j column_j weight_j. So the squared distance
 * to a target is a quadratic form in the weights, for any pose and any pulls:
 *   energy - 2 sum_j right_j . weight_j + sum_jk gram_jk weight_j . weight_k.
 * Private to this folder. [main] */
#ifndef MAROTTE_FACE_FIT_GRAM_H
#define MAROTTE_FACE_FIT_GRAM_H
#include "face/bones.h"

enum { FIT_AFFINE = 4 };

typedef struct fit_column {
    uint32_t bone;
    uint32_t control; /* RIG_NONE for a column of the bone's own motion */
    uint32_t axis;    /* 0..2: w_b x, w_b y, w_b z; 3: w_b; 0 for a control */
} fit_column;

typedef struct fit_gram {
    fit_column *
        column; /* columns of the moving bones first, FIT_AFFINE each; then those of the controls */
    uint32_t column_count, column_capacity, control_count, target_count;
    double *gram;   /* column_count by column_count */
    double *right;  /* target_count by column_count by 3 */
    double *energy; /* target_count: sum of squares of the target */
    uint32_t *used; /* scratch: column_count */
} fit_gram;

/* Creates the columns of the moving bones' own motion, with sums of zero. Add columns of controls
 * with fit_gram_add_column, then call fit_gram_begin before the first vertex. */
CHECKED mrt_result fit_gram_create(fit_gram *out, const bones *b, uint32_t control_count,
                                   uint32_t control_column_capacity, uint32_t target_count,
                                   error *err);
void fit_gram_add_column(fit_gram *g, uint32_t bone, uint32_t control);
CHECKED mrt_result fit_gram_begin(fit_gram *g, error *err);
void fit_gram_destroy(fit_gram *g); /* accepts zeroed */

/* Adds one vertex: the values of its columns (column_count), and its offsets in the targets
 * (target_count by 3, mm). */
void fit_gram_add_vertex(fit_gram *g, const double *value, const double *offset);
/* Completes the symmetric matrix, of which only one half was summed. Call after the last vertex. */
void fit_gram_finish(fit_gram *g);

/* Combines columns so that fields interpolate over some of the controls, instead of one kernel
 * each. out's column of bone b and the i-th choice is  sum_j full_column(b, choice[j])
 * share[b][j][i]. share: bone_count by choice_count by choice_count (row j, column i), 0 if a
 * choice is not in the bone's field. Creates `out`; its controls are the choices. */
CHECKED mrt_result fit_gram_reduce(fit_gram *out, const fit_gram *full, const uint32_t *choice,
                                   uint32_t choice_count, const double *share, error *err);

#endif
