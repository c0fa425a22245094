/* face/frame/rows.h - vertices as rows of four floats, and vectors of four floats. One load gets a
 * vertex, which is fast for random access. Private to this folder. */
#ifndef MAROTTE_FACE_ROWS_H
#define MAROTTE_FACE_ROWS_H
#include <string.h>

typedef float rows_four __attribute__((vector_size(16)));

static inline rows_four rows_load(const float *from)
{
    rows_four out;
    memcpy(&out, from, sizeof out);
    return out;
}

static inline void rows_store(float *to, rows_four from)
{
    memcpy(to, &from, sizeof from);
}

/* Transposes four rows. */
static inline void rows_transpose(rows_four r[4])
{
    const rows_four low_01 = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
                    high_01 = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7),
                    low_23 = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5),
                    high_23 = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
    r[0] = __builtin_shufflevector(low_01, low_23, 0, 1, 4, 5);
    r[1] = __builtin_shufflevector(low_01, low_23, 2, 3, 6, 7);
    r[2] = __builtin_shufflevector(high_01, high_23, 0, 1, 4, 5);
    r[3] = __builtin_shufflevector(high_01, high_23, 2, 3, 6, 7);
}

/* Converts four vertices of three streams to rows; the fourth number is 0. */
static inline void rows_from(rows_four out[4], const float *x, const float *y, const float *z)
{
    out[0] = rows_load(x);
    out[1] = rows_load(y);
    out[2] = rows_load(z);
    out[3] = (rows_four){0.0f};
    rows_transpose(out);
}

/* Converts rows to streams. */
static inline void rows_into(float *x, float *y, float *z, const float (*row)[4])
{
    rows_four r[4] = {rows_load(row[0]), rows_load(row[1]), rows_load(row[2]), rows_load(row[3])};
    rows_transpose(r);
    rows_store(x, r[0]);
    rows_store(y, r[1]);
    rows_store(z, r[2]);
}

#endif
