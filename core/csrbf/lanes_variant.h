/* csrbf/lanes_variant.h - for the sources that are compiled once for each instruction set:
 * LANES(name) is the function's name in this one of them. The build defines MAROTTE_VARIANT as
 * generic, v2, v3 or v4. Inside lanes_*.c. */
#ifndef MAROTTE_CSRBF_LANES_VARIANT_H
#define MAROTTE_CSRBF_LANES_VARIANT_H
#include "csrbf/lanes.h"

#define LANES_JOIN(name, variant) lanes_##name##_##variant
#define LANES_OF(name, variant)   LANES_JOIN(name, variant)
#define LANES(name)               LANES_OF(name, MAROTTE_VARIANT)

#define LANES_DECLARE(variant)                                                                     \
    void LANES_OF(columns_sum, variant)(const columns *c, float sum[3][POINTS_BLOCK],              \
                                        uint32_t block);                                           \
    void LANES_OF(columns_add, variant)(points * out, const points *base,                          \
                                        float sum[3][POINTS_BLOCK], uint32_t block);               \
    uint32_t LANES_OF(columns_move, variant)(const columns *c, points *out, const points *base,    \
                                             uint8_t *moved, uint32_t first, uint32_t end);        \
    void LANES_OF(packed_move, variant)(const columns_packed *p, const columns *c, points *out,    \
                                        const points *base, uint32_t first, uint32_t end);         \
    bool LANES_OF(is_zero, variant)(const float value[POINTS_BLOCK]);                              \
    void LANES_OF(add_weighted, variant)(float total[3][POINTS_BLOCK], const float *weight,        \
                                         float sum[3][POINTS_BLOCK]);                              \
    bool LANES_OF(field_block, variant)(const field *f, float sum[3][POINTS_BLOCK],                \
                                        const points *in, uint32_t block);                         \
    bool LANES_OF(gradient_block, variant)(const field *f, gradient *out, const points *at,        \
                                           uint32_t block);                                        \
    void LANES_OF(determinants, variant)(double out[POINTS_BLOCK], const gradient *g);             \
    void LANES_OF(squares, variant)(double out[POINTS_BLOCK], const gradient *g);                  \
    void LANES_OF(responses_block, variant)(const field *f, const lanes_responses *r,              \
                                            double sum[][POINTS_BLOCK], const points *in,          \
                                            uint32_t block);                                       \
    void LANES_OF(derivatives_block, variant)(const field *f, const lanes_responses *r,            \
                                              double sum[][POINTS_BLOCK], const points *in,        \
                                              const points *direction, uint32_t block);            \
    void LANES_OF(normals, variant)(const tangents *t, float *const n[3], const uint8_t *wanted,   \
                                    uint32_t first, uint32_t end);                                 \
    uint32_t LANES_OF(first_neighbour, variant)(const field *f, uint32_t row);                     \
    void LANES_OF(kernel_row, variant)(const field *f, double *out, uint32_t row, uint32_t first); \
    bool LANES_OF(factor, variant)(envelope * e, double smallest_pivot, uint32_t *out_row);        \
    void LANES_OF(solve_few, variant)(const envelope *e, double *rhs);                             \
    void LANES_OF(solve_many, variant)(const envelope *e, double *rhs)

#ifdef MAROTTE_VARIANT
LANES_DECLARE(MAROTTE_VARIANT);
#endif

#endif
