/* csrbf/field.h - a solved displacement field and its evaluation:
 * d(x) = sum_i alpha_i phi(|x - c_i| / R) + W(x) p(x), W = 1 or 1 - prod_i (1 - phi_i(x)).
 * Centres are summed in canonical order. A component of d that is exactly zero leaves the bits of
 * its coordinate alone. Its gradient is exact at the vertices; its slope has a bound everywhere.
 * Inside the room. [frame] all but create/destroy. */
#ifndef MAROTTE_CSRBF_FIELD_H
#define MAROTTE_CSRBF_FIELD_H
#include "csrbf/hull.h"
#include "csrbf/settings.h"

enum { FIELD_LANES = 8 }; /* centres are asked so many at a time */

typedef struct field {
    csrbf_settings settings;
    uint32_t centre_count, term_count; /* terms of p: 1 and the coordinates along the hull */
    double *centre, *alpha;            /* centre_count by 3 */
    double *along[3]; /* the centres by axis; up to the next FIELD_LANES: beyond every reach */
    double beta[4][3];
    hull hull;
    /* For float: centres from `origin`, and the squared distance from which on phi is 0. It is a
     * few roundings less than R^2, so that nothing at or beyond R is ever touched. */
    float *local_centre, *local_alpha; /* centre_count by 3 */
    float origin[3], local_limit;
    const struct lanes *lanes;
    bool needs_double; /* alpha cancels so much that float evaluation would be noise */
} field;

bool field_create(field *out, uint32_t centre_capacity); /* false: no memory */
void field_destroy(field *f);

/* After centres, settings and hull are set. The field is zero until field_set_alpha. */
void field_begin(field *f);
/* Takes alpha (rows of `stride`, 3 of them used) over; beta is the caller's to set. largest_g: the
 * largest size of a displacement, which alpha is measured by. */
void field_set_alpha(field *f, const double *alpha, uint32_t stride, double largest_g);

/* local_limit, in double. */
double field_limit(const field *f);
void field_polynomial(const field *f, double out[3], const double x[3]);
/* The terms of p at x: 1, then (x - c0) along each axis of the hull, over R. */
void field_terms(const field *f, double out_term[4], const double x[3]);

void field_move_f64(const field *f, double *x, uint32_t count);
/* sum: 3 by POINTS_BLOCK := d at the vertices of one block. False when d is zero all over it; sum
 * may not be set then. */
bool field_in_block(const field *f, float sum[3][POINTS_BLOCK], const points *in, uint32_t block);
/* Returns how many blocks were touched. out may be in. */
uint32_t field_move(const field *f, points *out, const points *in);
/* Estimated time to find d in so many blocks that all centres reach, on one thread; and how many
 * blocks threads take at a time (base/pool.h). */
double field_cost_ns(const field *f, uint32_t block_count);
enum { FIELD_GRAIN = 16 };

/* ---- its derivative, and how hard it bends space ---- */

typedef struct gradient {
    float row[3][3][POINTS_BLOCK]; /* [a][b]: derivative of d_a by x_b */
} gradient;

/* grad p: [a][b] is the derivative of p_a by x_b. */
matrix3 field_polynomial_gradient(const field *f);

/* Smallest det(I + grad d) over the vertices; 1 without vertices. */
double field_min_determinant(const field *f, const points *at);
/* Largest spectral norm of grad d over the vertices. */
double field_max_slope(const field *f, const points *at);
/* Both in one pass; the same values. */
void field_measure(const field *f, const points *at, double *out_slope, double *out_determinant);
/* Upper bound of that norm over all of space: of all centres whose supports may meet at a point
 * the steepest slopes are added up. With a windowed polynomial: over the union of supports. */
double field_slope_bound(const field *f);

#endif
