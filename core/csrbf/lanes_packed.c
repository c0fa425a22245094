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

enum { TILE = 4 * POINTS_BLOCK }; /* vertices whose normals are made together, at most */

typedef struct tile {
    _Alignas(64) float x[TILE];
    float y[TILE], z[TILE];
} tile;

/* A tangent at rest in `count` blocks: of each of them three rows, and three of the other. */
static void unpack_rest(tile *restrict out, const int16_t *restrict row, uint32_t count)
{
    for (size_t block = 0; block < count; ++block, row += (size_t)6 * POINTS_BLOCK)
        for (size_t i = 0; i < POINTS_BLOCK; ++i) {
            size_t at = block * POINTS_BLOCK + i;
            out->x[at] = (float)row[i] * (1.0f / TANGENTS_UNIT);
            out->y[at] = (float)row[POINTS_BLOCK + i] * (1.0f / TANGENTS_UNIT);
            out->z[at] = (float)row[2 * POINTS_BLOCK + i] * (1.0f / TANGENTS_UNIT);
        }
}

/* out := rest and the columns, which are the same in all blocks from first to end - 1. */
static void move_tangents(tile *out, const tile *rest, const source *s, uint32_t first,
                          uint32_t end)
{
    chosen some;
    some.next = 0;
    if (!choose_more(&some, s->weights, marks_of(s->marked, first))) {
        memcpy(out, rest, sizeof *out);
    } else if (some.count <= FEW) {
        const span from = {.x = rest->x,
                           .y = rest->y,
                           .z = rest->z,
                           .count = (size_t)(end - first) * POINTS_BLOCK};
        group g;
        gather(&g, s, some.column, some.count, first);
        move_few[some.count - 1](out->x, out->y, out->z, &from, &g);
    } else {
        for (size_t k = 0; k < end - first; ++k) {
            _Alignas(64) float sum[3][POINTS_BLOCK];
            size_t at = k * POINTS_BLOCK;
            sum_block(s, sum, first + (uint32_t)k);
            add_row(out->x + at, rest->x + at, sum[0]);
            add_row(out->y + at, rest->y + at, sum[1]);
            add_row(out->z + at, rest->z + at, sum[2]);
        }
    }
}

static void cross(float *restrict nx, float *restrict ny, float *restrict nz,
                  const tile *restrict a, const tile *restrict b, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        float x = a->y[i] * b->z[i] - a->z[i] * b->y[i];
        float y = a->z[i] * b->x[i] - a->x[i] * b->z[i];
        float z = a->x[i] * b->y[i] - a->y[i] * b->x[i];
        float square = x * x + y * y + z * z;
        bool good = (square > 1e-20f) & (square <= FLT_MAX);
        float inverse = 1.0f / sqrtf(good ? square : 1.0f);
        nx[i] = good ? x * inverse : 0.0f;
        ny[i] = good ? y * inverse : 0.0f;
        nz[i] = good ? z * inverse : 1.0f;
    }
}

/* The end of what can be done together from `first` on: wanted, and with the same columns. */
static uint32_t end_of_tile(const source along[2], const uint8_t *wanted, uint32_t first,
                            uint32_t end)
{
    uint32_t limit = end - first < TILE / POINTS_BLOCK ? end : first + TILE / POINTS_BLOCK;
    for (uint32_t block = first; wanted && block < limit; ++block)
        if (!wanted[block])
            limit = block;
    return end_of_run(&along[1], first, end_of_run(&along[0], first, limit));
}

void LANES(normals)(const tangents *t, float *const n[3], const uint8_t *wanted, uint32_t first,
                    uint32_t end)
{
    const source along[2] = {source_of(&t->packed1, &t->along1),
                             source_of(&t->packed2, &t->along2)};
    for (uint32_t block = first, next; block < end; block = next) {
        tile rest, moved[2];
        size_t at = (size_t)block * POINTS_BLOCK;
        next = block + 1;
        if (wanted && !wanted[block])
            continue;
        next = end_of_tile(along, wanted, block, end);
        for (size_t k = 0; k < 2; ++k) {
            unpack_rest(&rest, t->rest + 6 * at + 3 * k * POINTS_BLOCK, next - block);
            move_tangents(&moved[k], &rest, &along[k], block, next);
        }
        cross(n[0] + at, n[1] + at, n[2] + at, &moved[0], &moved[1],
              (size_t)(next - block) * POINTS_BLOCK);
    }
}
