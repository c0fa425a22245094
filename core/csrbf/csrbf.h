/* csrbf/csrbf.h - the deformation engine: displacement fields of compactly supported radial basis
 * functions, d(x) = sum_i alpha_i phi(|x - c_i| / R) + p(x) with d(c_i) = g_i.
 * Formulas: research on the method, Wendland 1995 (kernels), Kojekine/Savchenko 2002 (the solve).
 * This is the solver. settings.h has its settings, shape.h uses fields over time.
 * Solves in float64, with centres in a canonical order (saddle.h): results do not depend on the
 * order of the controls, and have the same bits on every build. Pure except for the solver's own
 * memory; [frame] everything except create/destroy. */
#ifndef MAROTTE_CSRBF_CSRBF_H
#define MAROTTE_CSRBF_CSRBF_H
#include "csrbf/settings.h"

typedef struct csrbf_solver csrbf_solver;

/* Allocates a solver for `centre_capacity` centres: centre_capacity^2 * 8 bytes, touched only as
 * far as used. Only one thread at a time may use a solver, also for the const functions, except
 * csrbf_in_block. It holds the pool (base/pool.h) until it is destroyed: for many vertices its
 * functions share their work. */
csrbf_solver *csrbf_solver_create(uint32_t centre_capacity); /* NULL: no memory */
void csrbf_solver_destroy(csrbf_solver *solver);

/* Sorts, merges and factors the centres. centre: count by 3; class: count, or NULL: all tips. On
 * errors (not finite and within POINTS_REACH, radius <= 0, too many, not positive definite) the
 * last factorisation and its field are kept. On success the field is zero until csrbf_solve. count
 * 0 gives a field that is zero everywhere.
 * A linear or windowed polynomial is restricted to the affine hull of the centres: an extent below
 * 1/1000 of the largest counts as flat.
 * Unchanged pins are not factored again. The cost is that of the changed rows and those after them:
 * the order is skull, jaw, tips. The bits are those of a new solver. */
CHECKED mrt_result csrbf_factor(csrbf_solver *solver, const csrbf_settings *settings,
                                const double *centre, const csrbf_class *class, uint32_t count,
                                error *err);
/* Solves for displacements g (count by 3, in the caller's order, as given to csrbf_factor). The
 * solver then holds the field. Non-finite g is an error, and the last field is kept. */
CHECKED mrt_result csrbf_solve(csrbf_solver *solver, const double *g, error *err);
/* Returns an error if g is not finite and within POINTS_REACH, as csrbf_solve would. */
CHECKED mrt_result csrbf_check(const csrbf_solver *solver, const double *g, error *err);

/* Protects against almost flat sets of controls, which throw distant vertices far away. Drops the
 * flattest direction of the polynomial until the polynomial moves no corner of the box around the
 * vertices further than `limit` times the displacements. Constant is the last form that remains.
 * Call it between csrbf_factor and csrbf_solve: it clears the field. */
void csrbf_limit_gain(csrbf_solver *solver, const points *at, double limit);

/* Only tests use polynomial_terms, alpha_sum and polynomial_gain. */
typedef struct csrbf_diagnostics {
    uint32_t centre_count;     /* after merging */
    uint32_t polynomial_terms; /* 0, 1, ... 4 */
    uint32_t envelope_count;   /* entries stored for the factor */
    double alpha_sum;          /* sum of |alpha_i| */
    double slope_bound;     /* upper bound of the norm of grad d (theory: B2): < 1 means no fold */
    double polynomial_gain; /* after csrbf_limit_gain; 0 if it was not called */
    bool merged_apart;      /* merged centres had displacements that differ by more than 1e-3 R */
} csrbf_diagnostics;
/* Counts pairs of centres, so it is slow for thousands of centres: use it in every frame only for
 * about ten controls. */
csrbf_diagnostics csrbf_diagnose(const csrbf_solver *solver);

/* x (count by 3) += d(x), in float64, by direct evaluation. */
void csrbf_move_f64(const csrbf_solver *solver, double *x, uint32_t count);
/* out = in + d(in), in float32, by direct evaluation of blocks. Vertices outside of all supports
 * keep their bits. out may be in. Uses the bounds of `in`, updates those of `out`. Returns the
 * number of blocks within reach of the field: 0 if nothing moved. */
uint32_t csrbf_move(const csrbf_solver *solver, points *out, const points *in);
/* sum: 3 by POINTS_BLOCK := d at the vertices of one block, as csrbf_move adds it. Returns false if
 * d is zero in the whole block; then sum may be unset. */
bool csrbf_in_block(const csrbf_solver *solver, float sum[3][POINTS_BLOCK], const points *in,
                    uint32_t block);
/* Estimates the time of csrbf_in_block for all blocks, if every centre reached them
 * (base/pool.h). */
double csrbf_cost_ns(const csrbf_solver *solver, const points *in);

/* Computes unit responses (theory section 6): d(x) = sum_k B_k(x) g_k for the factored centres. Row
 * k of out_response (stride floats apart, >= in->padded_count) holds B_k at the vertices of `in`,
 * in the order of the controls given to csrbf_factor. Merged controls share the response of their
 * mean. Computed in float64, stored as float32. */
void csrbf_responses(const csrbf_solver *solver, float *out_response, size_t stride,
                     const points *in);
/* The same for the wanted blocks (block_count flags); the others are set to zero. */
void csrbf_responses_in(const csrbf_solver *solver, float *out_response, size_t stride,
                        const points *in, const uint8_t *wanted);

/* Returns the smallest determinant of I + grad d over the vertices; <= 0: the map folds there. In
 * float32. */
double csrbf_min_determinant(const csrbf_solver *solver, const points *at);
/* Returns the largest norm of grad d over the vertices. For tests; drags use csrbf_measure. */
double csrbf_max_slope(const csrbf_solver *solver, const points *at);
/* Computes both in one pass. */
void csrbf_measure(const csrbf_solver *solver, const points *at, double *out_slope,
                   double *out_determinant);

#endif
