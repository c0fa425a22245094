/* csrbf/csrbf.h - the deformation engine: displacement fields of compactly supported radial basis
 * functions, d(x) = sum_i alpha_i phi(|x - c_i| / R) + p(x) with d(c_i) = g_i.
 * Formulas: research on the method, Wendland 1995 (kernels), Kojekine/Savchenko 2002 (the solve).
 * The solver; what it is asked is in settings.h, what is done with a field over time in shape.h.
 * Solve in float64, centres in a canonical order (saddle.h): results do not depend on the order of
 * the controls, and have the same bits on every build. Pure but for the solver's own memory;
 * [frame] everything except create/destroy. */
#ifndef MAROTTE_CSRBF_CSRBF_H
#define MAROTTE_CSRBF_CSRBF_H
#include "csrbf/settings.h"

typedef struct csrbf_solver csrbf_solver;

/* Room for `centre_capacity` centres: centre_capacity^2 * 8 bytes, touched as far as used. One
 * thread at a time may use a solver, the functions that take it as const included, but for
 * csrbf_in_block. It holds the pool (base/pool.h) until it is destroyed: over many vertices its
 * functions share their work. */
csrbf_solver *csrbf_solver_create(uint32_t centre_capacity); /* NULL: no memory */
void csrbf_solver_destroy(csrbf_solver *solver);

/* Sorts, merges and factors the centres. centre: count by 3; class: count, or NULL: all tips.
 * Errors (not finite and within POINTS_REACH, radius <= 0, too many, not positive definite) leave
 * the last factorisation and its field; afterwards the field is zero until csrbf_solve.
 * count 0 is a field that is zero everywhere. A linear or windowed polynomial is restricted to the
 * affine hull of the centres: an extent below 1/1000 of the largest counts as flat.
 * Pins that stay where they were are not factored again: what changes behind them, tips behind the
 * jaw and the jaw behind the skull, costs what it is itself. The bits are those of a new solver. */
CHECKED mrt_result csrbf_factor(csrbf_solver *solver, const csrbf_settings *settings,
                                const double *centre, const csrbf_class *class, uint32_t count,
                                error *err);
/* Solves for displacements g (count by 3, in the caller's order, as given to csrbf_factor); the
 * solver then holds the field. Non-finite g is an error and leaves the last field. */
CHECKED mrt_result csrbf_solve(csrbf_solver *solver, const double *g, error *err);
/* Refuses what csrbf_solve refuses for being not finite and within POINTS_REACH; no more. */
CHECKED mrt_result csrbf_check(const csrbf_solver *solver, const double *g, error *err);

/* Guards against nearly flat sets of controls, which throw vertices far from them: drops the
 * flattest direction of the polynomial until the polynomial moves no corner of the box around the
 * vertices further than `limit` times the displacements (constant is the last that remains).
 * Between csrbf_factor and csrbf_solve: clears the field. */
void csrbf_limit_gain(csrbf_solver *solver, const points *at, double limit);

/* polynomial_terms, alpha_sum and polynomial_gain are asked for by tests alone. */
typedef struct csrbf_diagnostics {
    uint32_t centre_count;     /* after merging */
    uint32_t polynomial_terms; /* 0, 1, ... 4 */
    uint32_t envelope_count;   /* entries stored for the factor */
    double alpha_sum;          /* sum of |alpha_i| */
    double slope_bound;     /* upper bound of the norm of grad d (theory: B2): < 1 means no fold */
    double polynomial_gain; /* what csrbf_limit_gain left; 0 when it was not asked */
    bool merged_apart;      /* merged centres had displacements further apart than 1e-3 R */
} csrbf_diagnostics;
/* Counts pairs of centres: for ten controls in every frame, for thousands now and then. */
csrbf_diagnostics csrbf_diagnose(const csrbf_solver *solver);

/* x (count by 3) += d(x), in float64, by direct evaluation. */
void csrbf_move_f64(const csrbf_solver *solver, double *x, uint32_t count);
/* out = in + d(in), in float32, by direct evaluation over blocks; vertices out of every support
 * keep their bits. out may be in. Uses the bounds of `in`, keeps those of `out`. Returns how
 * many blocks of vertices lie within reach of the field: 0 when nothing moved. */
uint32_t csrbf_move(const csrbf_solver *solver, points *out, const points *in);
/* sum: 3 by POINTS_BLOCK := d at the vertices of one block, as csrbf_move adds it. False when d is
 * zero all over the block; sum may not be set then. */
bool csrbf_in_block(const csrbf_solver *solver, float sum[3][POINTS_BLOCK], const points *in,
                    uint32_t block);
/* Estimated time of csrbf_in_block in all blocks, if every centre reached them (base/pool.h). */
double csrbf_cost_ns(const csrbf_solver *solver, const points *in);

/* Unit responses (theory section 6): d(x) = sum_k B_k(x) g_k for the factored centres. Row k of
 * out_response (stride floats apart, >= in->padded_count) holds B_k at the vertices of `in`, in
 * the order of the controls given to csrbf_factor (merged controls share their mean's response).
 * Computed in float64, stored as float32. */
void csrbf_responses(const csrbf_solver *solver, float *out_response, size_t stride,
                     const points *in);
/* The same in the blocks that are wanted (block_count); zero is written in the others. */
void csrbf_responses_in(const csrbf_solver *solver, float *out_response, size_t stride,
                        const points *in, const uint8_t *wanted);

/* Smallest determinant of I + grad d over the vertices; <= 0: the map folds there. In float32. */
double csrbf_min_determinant(const csrbf_solver *solver, const points *at);
/* Largest norm of grad d over the vertices. For tests; drags ask for both in one pass. */
double csrbf_max_slope(const csrbf_solver *solver, const points *at);
/* Both in one pass. */
void csrbf_measure(const csrbf_solver *solver, const points *at, double *out_slope,
                   double *out_determinant);

#endif
