/* csrbf/field.h - a solved displacement field and its evaluation: d(x) = sum_i alpha_i phi(|x -
 * c_i| / R) + W(x) p(x), W = 1 or 1 - prod_i (1 - phi_i(x)).
 * Centres are summed in canonical order. If a component of d is exactly zero, its coordinate keeps
 * its bits. The gradient is exact at the vertices; its norm has an upper bound everywhere. Internal
 * to csrbf. [frame] all except create/destroy. */
#ifndef MAROTTE_CSRBF_FIELD_H
#define MAROTTE_CSRBF_FIELD_H
#include "csrbf/hull.h"
#include "csrbf/settings.h"

enum { FIELD_LANES = 8 }; /* number of centres that are tested together */

typedef struct field {
    csrbf_settings settings;
    uint32_t centre_count, term_count; /* terms of p: 1 and the coordinates along the hull */
    double *centre, *alpha;            /* centre_count by 3 */
    double *along[3];                  /* centres by axis; padding lanes reach nothing */
    double beta[4][3];
    hull hull;
    /* For float evaluation: centres relative to `origin`, and the squared distance from which
     * phi is 0. It is a few roundings less than R^2, so that vertices at or beyond R are never
     * changed. */
    float *local_centre, *local_alpha; /* centre_count by 3 */
    float origin[3], local_limit;
    const struct lanes *lanes;
    bool needs_double; /* alpha cancels so much that float evaluation would only be noise */
} field;

bool field_create(field *out, uint32_t centre_capacity); /* false: no memory */
void field_destroy(field *f);

/* Call it after setting centres, settings and hull. The field is zero until field_set_alpha. */
void field_begin(field *f);
/* Copies alpha (rows of `stride`, 3 of them used); the caller sets beta. largest_g: length of the
 * largest displacement, to compare alpha with. */
void field_set_alpha(field *f, const double *alpha, uint32_t stride, double largest_g);

/* Returns local_limit in double. */
double field_limit(const field *f);
void field_polynomial(const field *f, double out[3], const double x[3]);
/* Computes the terms of p at x: 1, then (x - c0) along each axis of the hull, divided by R. */
void field_terms(const field *f, double out_term[4], const double x[3]);

void field_move_f64(const field *f, double *x, uint32_t count);
/* sum: 3 by POINTS_BLOCK := d at the vertices of one block. Returns false if d is zero in the whole
 * block; then sum may be unset. */
bool field_in_block(const field *f, float sum[3][POINTS_BLOCK], const points *in, uint32_t block);
/* Returns the number of changed blocks. out may be in. */
uint32_t field_move(const field *f, points *out, const points *in);
/* Estimates the time of evaluating d in this number of blocks on one thread, if all centres reach
 * them. FIELD_GRAIN: blocks per part of shared work (base/pool.h). */
double field_cost_ns(const field *f, uint32_t block_count);
enum { FIELD_GRAIN = 16 };

/* ---- the derivative, and the distortion of space ---- */

typedef struct gradient {
    float row[3][3][POINTS_BLOCK]; /* [a][b]: derivative of d_a with respect to x_b */
} gradient;

/* Returns grad p: [a][b] is the derivative of p_a with respect to x_b. */
matrix3 field_polynomial_gradient(const field *f);

/* Returns the smallest det(I + grad d) over the vertices; 1 without vertices. */
double field_min_determinant(const field *f, const points *at);
/* Returns the largest spectral norm of grad d over the vertices. */
double field_max_slope(const field *f, const points *at);
/* Computes both in one pass, with the same values. */
void field_measure(const field *f, const points *at, double *out_slope, double *out_determinant);
/* Returns an upper bound of that norm in all of space: the largest sum of the steepest slopes of
 * centres whose supports may meet. With a windowed polynomial: in the union of supports. */
double field_slope_bound(const field *f);

#endif
