/* csrbf/lanes.h - the inner loops of csrbf, compiled once for each instruction set (base/isa.h)
 * from the same sources: lanes_*.c. All variants give the same bits: every vertex and every entry
 * of a factor is a separate sum in a fixed order, without fused multiplications, and square roots
 * are rounded correctly everywhere. Objects with memory (columns, field, envelope) store the
 * current table at their creation. Internal to csrbf. Pure. [any] */
#ifndef MAROTTE_CSRBF_LANES_H
#define MAROTTE_CSRBF_LANES_H
#include "base/isa.h"
#include "csrbf/points.h"

struct columns;
struct envelope;
struct field;
struct gradient;

/* Unit responses that are evaluated together. alpha is centre_count by `stride`; `count` columns of
 * it are used. */
typedef struct lanes_responses {
    const double *alpha;
    size_t stride;
    uint32_t count;
    const double *beta; /* 4 by stride */
} lanes_responses;

enum { LANES_RESPONSES = 32 }; /* limit for columns that are evaluated together */

typedef struct lanes {
    /* See csrbf/columns.h for these three; move: columns_move_blocks. */
    void (*columns_sum)(const struct columns *c, float sum[3][POINTS_BLOCK], uint32_t first,
                        uint32_t block);
    void (*columns_add)(points *out, const points *base, float sum[3][POINTS_BLOCK],
                        uint32_t block);
    void (*columns_move)(const struct columns *c, points *out, const points *base, uint32_t first,
                         uint32_t end);
    bool (*is_zero)(const float value[POINTS_BLOCK]); /* whether the whole block is zero */
    /* total += weight times sum, for each vertex. */
    void (*add_weighted)(float total[3][POINTS_BLOCK], const float *weight,
                         float sum[3][POINTS_BLOCK]);

    /* In float; see field_in_block and field_gradient. */
    bool (*field_block)(const struct field *f, float sum[3][POINTS_BLOCK], const points *in,
                        uint32_t block);
    bool (*gradient_block)(const struct field *f, struct gradient *out, const points *at,
                           uint32_t block);
    /* Determinants of I + grad d at each vertex of a block. */
    void (*determinants)(double out[POINTS_BLOCK], const struct gradient *g);
    /* Sums of squares of grad d. */
    void (*squares)(double out[POINTS_BLOCK], const struct gradient *g);

    /* sum: count by POINTS_BLOCK, in double. */
    void (*responses_block)(const struct field *f, const lanes_responses *r,
                            double sum[][POINTS_BLOCK], const points *in, uint32_t block);

    /* The matrix of the centres. first_neighbour: the first centre in the support of `row`, or
     * `row`. kernel_row: phi of the distances from `row` to centres first .. row - 1. */
    uint32_t (*first_neighbour)(const struct field *f, uint32_t row);
    void (*kernel_row)(const struct field *f, double *out, uint32_t row, uint32_t first);
    /* See envelope_factor and the two solves. */
    bool (*factor)(struct envelope *e, double smallest_pivot, uint32_t *out_row);
    void (*solve_few)(const struct envelope *e, double *rhs);
    void (*solve_many)(const struct envelope *e, double *rhs);
} lanes;

const lanes *lanes_of(isa which); /* NULL: not compiled, or not supported by this machine */
const lanes *lanes_now(void);     /* of isa_now */

/* ---- used by lanes_*.c ---- */

/* LANES(name) is the name of the function for the instruction set of the file: the build defines
 * MAROTTE_VARIANT as generic, v2, v3 or v4. */
#define LANES_JOIN(name, variant) lanes_##name##_##variant
#define LANES_OF(name, variant)   LANES_JOIN(name, variant)
#define LANES(name)               LANES_OF(name, MAROTTE_VARIANT)

#define LANES_DECLARE(variant)                                                                     \
    void LANES_OF(columns_sum, variant)(const struct columns *c, float sum[3][POINTS_BLOCK],       \
                                        uint32_t first, uint32_t block);                           \
    void LANES_OF(columns_add, variant)(points * out, const points *base,                          \
                                        float sum[3][POINTS_BLOCK], uint32_t block);               \
    void LANES_OF(columns_move, variant)(const struct columns *c, points *out, const points *base, \
                                         uint32_t first, uint32_t end);                            \
    bool LANES_OF(is_zero, variant)(const float value[POINTS_BLOCK]);                              \
    void LANES_OF(add_weighted, variant)(float total[3][POINTS_BLOCK], const float *weight,        \
                                         float sum[3][POINTS_BLOCK]);                              \
    bool LANES_OF(field_block, variant)(const struct field *f, float sum[3][POINTS_BLOCK],         \
                                        const points *in, uint32_t block);                         \
    bool LANES_OF(gradient_block, variant)(const struct field *f, struct gradient *out,            \
                                           const points *at, uint32_t block);                      \
    void LANES_OF(determinants, variant)(double out[POINTS_BLOCK], const struct gradient *g);      \
    void LANES_OF(squares, variant)(double out[POINTS_BLOCK], const struct gradient *g);           \
    void LANES_OF(responses_block, variant)(const struct field *f, const lanes_responses *r,       \
                                            double sum[][POINTS_BLOCK], const points *in,          \
                                            uint32_t block);                                       \
    uint32_t LANES_OF(first_neighbour, variant)(const struct field *f, uint32_t row);              \
    void LANES_OF(kernel_row, variant)(const struct field *f, double *out, uint32_t row,           \
                                       uint32_t first);                                            \
    bool LANES_OF(factor, variant)(struct envelope * e, double smallest_pivot, uint32_t *out_row); \
    void LANES_OF(solve_few, variant)(const struct envelope *e, double *rhs);                      \
    void LANES_OF(solve_many, variant)(const struct envelope *e, double *rhs)

#ifdef MAROTTE_VARIANT
LANES_DECLARE(MAROTTE_VARIANT);
#endif

#endif
