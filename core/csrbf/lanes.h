/* csrbf/lanes.h - the inner loops of the room, compiled once for each instruction set (base/isa.h)
 * from the same sources: lanes_*.c. All of them give the same bits: every vertex and every entry of
 * a factor is its own sum in a fixed order, without fused multiplications, and square roots are
 * rounded correctly everywhere. Who holds memory of the room (columns, field, envelope) takes the
 * table of its day when it is created. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_LANES_H
#define MAROTTE_CSRBF_LANES_H
#include "base/isa.h"
#include "csrbf/columns_packed.h"
#include "csrbf/envelope.h"
#include "csrbf/field.h"
#include "csrbf/gradient.h"
#include "csrbf/tangents.h"

/* Unit responses that are evaluated together: alpha is centre_count by `stride`, `count` columns of
 * it are used. */
typedef struct lanes_responses {
    const double *alpha;
    size_t stride;
    uint32_t count;
    const double *beta; /* 4 by stride */
} lanes_responses;

enum { LANES_RESPONSES = 32 }; /* at most so many columns together */

typedef struct lanes {
    /* csrbf/columns.h says what these three do; move: columns_move_blocks. */
    void (*columns_sum)(const columns *c, float sum[3][POINTS_BLOCK], uint32_t block);
    void (*columns_add)(points *out, const points *base, float sum[3][POINTS_BLOCK],
                        uint32_t block);
    uint32_t (*columns_move)(const columns *c, points *out, const points *base, uint8_t *moved,
                             uint32_t first, uint32_t end);
    /* Blocks first .. end - 1 of csrbf/columns_packed.h, with p->weights. */
    void (*packed_move)(const columns_packed *p, const columns *c, points *out, const points *base,
                        uint32_t first, uint32_t end);
    bool (*is_zero)(const float value[POINTS_BLOCK]); /* all over the block */
    /* total += weight times sum, by vertices. */
    void (*add_weighted)(float total[3][POINTS_BLOCK], const float *weight,
                         float sum[3][POINTS_BLOCK]);

    /* In float; as field_in_block and gradient_of. */
    bool (*field_block)(const field *f, float sum[3][POINTS_BLOCK], const points *in,
                        uint32_t block);
    bool (*gradient_block)(const field *f, gradient *out, const points *at, uint32_t block);
    /* Of the map I + grad d at each vertex of a block. */
    void (*determinants)(double out[POINTS_BLOCK], const gradient *g);
    /* Sum of squares of grad d. */
    void (*squares)(double out[POINTS_BLOCK], const gradient *g);

    /* sum: count by POINTS_BLOCK, in double. */
    void (*responses_block)(const field *f, const lanes_responses *r, double sum[][POINTS_BLOCK],
                            const points *in, uint32_t block);

    /* The same of their derivatives along `direction`. */
    void (*derivatives_block)(const field *f, const lanes_responses *r, double sum[][POINTS_BLOCK],
                              const points *in, const points *direction, uint32_t block);
    /* As tangents_normals_blocks. */
    void (*normals)(const tangents *t, float *const n[3], const uint8_t *wanted, uint32_t first,
                    uint32_t end);

    /* The matrix of the centres: the first that `row` has in its support, or `row`; and phi of the
     * distances from `row` to those from `first` to row - 1. */
    uint32_t (*first_neighbour)(const field *f, uint32_t row);
    void (*kernel_row)(const field *f, double *out, uint32_t row, uint32_t first);
    /* As envelope_factor and the two solves. */
    bool (*factor)(envelope *e, double smallest_pivot, uint32_t *out_row);
    void (*solve_few)(const envelope *e, double *rhs);
    void (*solve_many)(const envelope *e, double *rhs);
} lanes;

const lanes *lanes_of(isa which); /* NULL: not compiled in, or not of this machine */
const lanes *lanes_now(void);     /* of isa_now */

#endif
