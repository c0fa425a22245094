/* Anchored frames of packed columns, and the normals that such columns of derivatives give. */
#include "csrbf/lanes_variant.h"

typedef int16_t column_value;
#include "csrbf/lanes_move.h"

#include <float.h>
#include <math.h>

static source source_of(const columns_packed *p, const columns *c)
{
    return (source){.value = p->value, .stride = p->stride, .weights = &p->weights, .marked = c};
}

void LANES(packed_move)(const columns_packed *p, const columns *c, points *out, const points *base,
                        uint32_t first, uint32_t end)
{
    const source s = source_of(p, c);
    (void)move_blocks(&s, out, base, NULL, first, end);
}

/* ---- normals ---- */

/* A tangent at rest in one block: three rows. */
static void unpack_rest(float out[3][POINTS_BLOCK], const int16_t *restrict row)
{
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < POINTS_BLOCK; ++i)
            out[axis][i] = (float)row[axis * POINTS_BLOCK + i] * (1.0f / TANGENTS_UNIT);
}

/* out := rest and the columns. */
static void move_tangent(float out[3][POINTS_BLOCK], float rest[3][POINTS_BLOCK], const source *s,
                         uint32_t block)
{
    chosen some;
    some.next = 0;
    if (!choose_more(&some, s->weights, marks_of(s->marked, block))) {
        memcpy(out, rest, 3 * sizeof *out);
    } else if (some.count > FEW) {
        sum_block(s, out, block);
        for (int axis = 0; axis < 3; ++axis)
            add_row(out[axis], rest[axis], out[axis]);
    } else {
        const span from = {.x = rest[0], .y = rest[1], .z = rest[2], .count = POINTS_BLOCK};
        group g;
        gather(&g, s, some.column, some.count, block);
        move_few[some.count - 1](out[0], out[1], out[2], &from, &g);
    }
}

static void cross_block(float *restrict nx, float *restrict ny, float *restrict nz,
                        float a[3][POINTS_BLOCK], float b[3][POINTS_BLOCK])
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float x = a[1][i] * b[2][i] - a[2][i] * b[1][i];
        float y = a[2][i] * b[0][i] - a[0][i] * b[2][i];
        float z = a[0][i] * b[1][i] - a[1][i] * b[0][i];
        float square = x * x + y * y + z * z;
        bool good = (square > 1e-20f) & (square <= FLT_MAX);
        float inverse = 1.0f / sqrtf(good ? square : 1.0f);
        nx[i] = good ? x * inverse : 0.0f;
        ny[i] = good ? y * inverse : 0.0f;
        nz[i] = good ? z * inverse : 1.0f;
    }
}

void LANES(normals)(const tangents *t, float *const n[3], const uint8_t *wanted, uint32_t first,
                    uint32_t end)
{
    const source along[2] = {source_of(&t->packed1, &t->along1),
                             source_of(&t->packed2, &t->along2)};
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) float rest[3][POINTS_BLOCK];
        _Alignas(64) float moved[2][3][POINTS_BLOCK];
        size_t at = (size_t)block * POINTS_BLOCK;
        if (wanted && !wanted[block])
            continue;
        for (size_t k = 0; k < 2; ++k) {
            unpack_rest(rest, t->rest + 6 * at + 3 * k * POINTS_BLOCK);
            move_tangent(moved[k], rest, &along[k], block);
        }
        cross_block(n[0] + at, n[1] + at, n[2] + at, moved[0], moved[1]);
    }
}
