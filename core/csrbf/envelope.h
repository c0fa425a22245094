/* csrbf/envelope.h - Cholesky factor of a symmetric positive definite matrix stored by its
 * envelope: each row from its first nonzero to the diagonal, where the factor has no fill outside.
 * Rows are worked on in groups for speed; every entry is still its own sum over ascending columns,
 * so the bits do not depend on the grouping. Inside the room; the memory is its only state. */
#ifndef MAROTTE_CSRBF_ENVELOPE_H
#define MAROTTE_CSRBF_ENVELOPE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
/* The same of those of `from`, whose rows before `first` are these. */
void envelope_take(envelope *e, const envelope *from, uint32_t first, uint32_t row_count);
/* The next row, from column `first` to the diagonal, for the caller to fill. */
double *envelope_add_row(envelope *e, uint32_t first);

/* Of the rows that are not factored yet. False when a pivot is not above `smallest_pivot`; its row
 * is then in out_row. */
bool envelope_factor(envelope *e, double smallest_pivot, uint32_t *out_row);

/* Solves in place; rhs: row_count by ENVELOPE_FEW or by ENVELOPE_MANY. */
void envelope_solve_few(const envelope *e, double *rhs);
void envelope_solve_many(const envelope *e, double *rhs);

#endif
