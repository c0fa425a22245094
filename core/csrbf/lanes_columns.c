/* Anchored frames: out = base + sum of columns by weights. Columns are summed in ascending order,
 * vertex by vertex. */
#include "csrbf/block_range.h"
#include "csrbf/columns.h"
#include "csrbf/lanes.h"

#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

/* ---- writing around the caches, where the machine can; call stream_end before another thread
 * reads ---- */

/* out: aligned like a block of points. */
static inline void stream_block(float *out, const float *in)
{
#ifdef __SSE2__
    for (int i = 0; i < POINTS_BLOCK; i += 4)
        _mm_stream_ps(out + i, _mm_loadu_ps(in + i));
#else
    memcpy(out, in, POINTS_BLOCK * sizeof *out);
#endif
}

static inline void stream_end(void)
{
#ifdef __SSE2__
    _mm_sfence();
#endif
}

/* ---- the columns that count in a block: those that are not zero there and have a weight ---- */

typedef struct chosen {
    uint16_t column[2 * COLUMNS_WORD];
    uint32_t count;
    uint32_t next; /* index of the next word of weights */
} chosen;

static inline const uint64_t *marks_of(const columns *c, uint32_t block)
{
    return c->mark + (size_t)block * c->mark_words;
}

static inline void choose_word(chosen *to, uint64_t bits, uint32_t word)
{
    for (; bits != 0; bits &= bits - 1)
        to->column[to->count++] = (uint16_t)(word * COLUMNS_WORD + (uint32_t)__builtin_ctzll(bits));
}

/* Collects the next columns that count, as many as fit. Returns false if none are left. Start with
 * next = 0, and leave the rest unset, because it is large. */
static inline bool choose_more(chosen *to, const columns_weights *w, const uint64_t *mark)
{
    to->count = 0;
    while (to->next < w->word_count && to->count <= COLUMNS_WORD) {
        uint32_t word = w->word[to->next++];
        choose_word(to, mark[word] & w->live[word], word);
    }
    return to->count > 0;
}

/* Returns whether two blocks with these marks have the same columns that count. */
static inline bool choose_the_same(const columns_weights *w, const uint64_t *a, const uint64_t *b)
{
    uint64_t other = 0;
    for (uint32_t i = 0; i < w->word_count; ++i)
        other |= (a[w->word[i]] ^ b[w->word[i]]) & w->live[w->word[i]];
    return other == 0;
}

/* ---- sums ---- */

static inline bool is_far(const columns *c)
{
    return c->weights.bytes > c->far_from_bytes;
}

/* Up to FEW columns, at a vertex. */
enum { FEW = 16 };
typedef struct group {
    const float *row[FEW];
    float x[FEW], y[FEW], z[FEW];
} group;

/* Consecutive vertices before they are moved. */
typedef struct span {
    const float *x, *y, *z;
    size_t count;
} span;

static inline void gather(group *g, const columns *c, const uint16_t *column, uint32_t count,
                          uint32_t block)
{
    for (size_t k = 0; k < count; ++k) {
        const float *weight = c->weights.value + (size_t)3 * column[k];
        g->row[k] = c->value + column[k] * c->stride + (size_t)block * POINTS_BLOCK;
        g->x[k] = weight[0];
        g->y[k] = weight[1];
        g->z[k] = weight[2];
    }
}

/* ---- few columns: one pass, no sum in memory ---- */

#define MOVE_COLUMNS(COUNT)                                                                        \
    static void move_##COUNT(float *restrict x, float *restrict y, float *restrict z,              \
                             const span *restrict from, const group *restrict g)                   \
    {                                                                                              \
        const float *restrict from_x = from->x, *restrict from_y = from->y;                        \
        const float *restrict from_z = from->z;                                                    \
        for (size_t i = 0; i < from->count; ++i) {                                                 \
            float sx = 0.0f, sy = 0.0f, sz = 0.0f;                                                 \
            for (size_t k = 0; k < COUNT; ++k) {                                                   \
                float value = g->row[k][i];                                                        \
                sx += value * g->x[k];                                                             \
                sy += value * g->y[k];                                                             \
                sz += value * g->z[k];                                                             \
            }                                                                                      \
            float moved_x = from_x[i] + sx, moved_y = from_y[i] + sy, moved_z = from_z[i] + sz;    \
            x[i] = sx == 0.0f ? from_x[i] : moved_x;                                               \
            y[i] = sy == 0.0f ? from_y[i] : moved_y;                                               \
            z[i] = sz == 0.0f ? from_z[i] : moved_z;                                               \
        }                                                                                          \
    }
MOVE_COLUMNS(1)
MOVE_COLUMNS(2)
MOVE_COLUMNS(3)
MOVE_COLUMNS(4)
MOVE_COLUMNS(5)
MOVE_COLUMNS(6)
MOVE_COLUMNS(7)
MOVE_COLUMNS(8)
MOVE_COLUMNS(9)
MOVE_COLUMNS(10)
MOVE_COLUMNS(11)
MOVE_COLUMNS(12)
MOVE_COLUMNS(13)
MOVE_COLUMNS(14)
MOVE_COLUMNS(15)
MOVE_COLUMNS(16)

typedef void move_function(float *restrict x, float *restrict y, float *restrict z,
                           const span *restrict from, const group *restrict g);
static move_function *const move_few[FEW] = {move_1,  move_2,  move_3,  move_4,  move_5,  move_6,
                                             move_7,  move_8,  move_9,  move_10, move_11, move_12,
                                             move_13, move_14, move_15, move_16};

/* ---- any number of columns ---- */

/* sum += COUNT columns, in their order. */
#define ADD_COLUMNS(COUNT)                                                                         \
    static void add_##COUNT(float *restrict x, float *restrict y, float *restrict z,               \
                            const group *restrict g)                                               \
    {                                                                                              \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float sx = x[i], sy = y[i], sz = z[i];                                                 \
            for (size_t k = 0; k < COUNT; ++k) {                                                   \
                float value = g->row[k][i];                                                        \
                sx += value * g->x[k];                                                             \
                sy += value * g->y[k];                                                             \
                sz += value * g->z[k];                                                             \
            }                                                                                      \
            x[i] = sx;                                                                             \
            y[i] = sy;                                                                             \
            z[i] = sz;                                                                             \
        }                                                                                          \
    }
ADD_COLUMNS(1)
ADD_COLUMNS(2)
ADD_COLUMNS(4)
ADD_COLUMNS(8)
typedef void add_function(float *restrict x, float *restrict y, float *restrict z,
                          const group *restrict g);

/* Adds the chosen columns from `first` on. */
static inline void add_chosen(float sum[3][POINTS_BLOCK], const columns *c, const chosen *some,
                              uint32_t first, uint32_t block)
{
    static add_function *const add[4] = {add_8, add_4, add_2, add_1};
    uint32_t done = 0;
    while (done < some->count && some->column[done] < first)
        ++done;
    for (int step = 0; step < 4; ++step) {
        uint32_t count = 8u >> step;
        for (; some->count - done >= count; done += count) {
            group g;
            gather(&g, c, some->column + done, count, block);
            add[step](sum[0], sum[1], sum[2], &g);
        }
    }
}

static inline void sum_block(const columns *c, float sum[3][POINTS_BLOCK], uint32_t first,
                             uint32_t block)
{
    chosen some;
    some.next = 0;
    while (choose_more(&some, &c->weights, marks_of(c, block)))
        add_chosen(sum, c, &some, first, block);
}

static inline void range_block(points *p, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    points_bounds *b = &p->block[block];
    block_range(b->low, b->high, p->x + first, p->y + first, p->z + first);
}

/* out may be base, or sum. */
static inline void add_row(float *out, const float *base, const float *sum)
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float moved = base[i] + sum[i];
        out[i] = sum[i] == 0.0f ? base[i] : moved;
    }
}

static inline void add_block(points *out, const points *base, float sum[3][POINTS_BLOCK],
                             uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    add_row(out->x + first, base->x + first, sum[0]);
    add_row(out->y + first, base->y + first, sum[1]);
    add_row(out->z + first, base->z + first, sum[2]);
    range_block(out, block);
}

/* ---- runs: consecutive blocks with the same columns that count ---- */

enum { RUN = 8 }; /* maximum: its output is still in the first-level cache */

static inline uint32_t end_of_run(const columns *c, uint32_t first, uint32_t end)
{
    const uint64_t *mark = marks_of(c, first);
    uint32_t block = first + 1;
    while (block < end && block - first < RUN &&
           choose_the_same(&c->weights, mark, marks_of(c, block)))
        ++block;
    return block;
}

static inline void move_run_near(points *out, const points *base, const group *g, uint32_t count,
                                 uint32_t first, uint32_t end)
{
    size_t at = (size_t)first * POINTS_BLOCK;
    const span from = {.x = base->x + at,
                       .y = base->y + at,
                       .z = base->z + at,
                       .count = (size_t)(end - first) * POINTS_BLOCK};
    move_few[count - 1](out->x + at, out->y + at, out->z + at, &from, g);
    for (uint32_t block = first; block < end; ++block)
        range_block(out, block);
}

/* The same, writing around the caches. */
static inline void move_run_far(points *out, const points *base, group *g, uint32_t count,
                                uint32_t first, uint32_t end)
{
    float *const to[3] = {out->x, out->y, out->z};
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) float tile[3][POINTS_BLOCK];
        size_t at = (size_t)block * POINTS_BLOCK;
        const span from = {
            .x = base->x + at, .y = base->y + at, .z = base->z + at, .count = POINTS_BLOCK};
        points_bounds *bounds = &out->block[block];
        move_few[count - 1](tile[0], tile[1], tile[2], &from, g);
        for (int axis = 0; axis < 3; ++axis) {
            range_of(&bounds->low[axis], &bounds->high[axis], tile[axis]);
            stream_block(to[axis] + at, tile[axis]);
        }
        for (uint32_t k = 0; k < count; ++k)
            g->row[k] += POINTS_BLOCK;
    }
}

static inline void move_run(const columns *c, points *out, const points *base, const chosen *some,
                            uint32_t first, uint32_t end)
{
    group g;
    if (some->count > FEW) {
        for (uint32_t block = first; block < end; ++block) {
            _Alignas(64) float sum[3][POINTS_BLOCK];
            memset(sum, 0, sizeof sum);
            sum_block(c, sum, 0, block);
            add_block(out, base, sum, block);
        }
        return;
    }
    gather(&g, c, some->column, some->count, first);
    if (is_far(c))
        move_run_far(out, base, &g, some->count, first, end);
    else
        move_run_near(out, base, &g, some->count, first, end);
}

/* ---- the frame ---- */

static inline void restore_block(points *out, const points *base, uint32_t block, bool far)
{
    size_t first = (size_t)block * POINTS_BLOCK, size = POINTS_BLOCK * sizeof(float);
    float *const to[3] = {out->x, out->y, out->z};
    const float *const from[3] = {base->x, base->y, base->z};
    for (int axis = 0; axis < 3; ++axis)
        if (far)
            stream_block(to[axis] + first, from[axis] + first);
        else
            memcpy(to[axis] + first, from[axis] + first, size);
    out->block[block] = base->block[block];
}

/* Does the work of columns_move_blocks. */
static inline void move_blocks(const columns *c, points *out, const points *base, uint32_t first,
                               uint32_t end)
{
    for (uint32_t block = first, next; block < end; block = next) {
        chosen some;
        some.next = 0;
        next = block + 1;
        if (choose_more(&some, &c->weights, marks_of(c, block))) {
            next = end_of_run(c, block, end);
            move_run(c, out, base, &some, block, next);
        } else {
            restore_block(out, base, block, is_far(c));
        }
    }
    if (is_far(c))
        stream_end();
}

/* ---- functions of the table ---- */

void LANES(columns_sum)(const columns *c, float sum[3][POINTS_BLOCK], uint32_t first,
                        uint32_t block)
{
    sum_block(c, sum, first, block);
}

void LANES(columns_add)(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block)
{
    add_block(out, base, sum, block);
}

void LANES(columns_move)(const columns *c, points *out, const points *base, uint32_t first,
                         uint32_t end)
{
    move_blocks(c, out, base, first, end);
}

bool LANES(is_zero)(const float value[POINTS_BLOCK])
{
    int other = 0; /* counted without branches, so that it runs on whole vectors */
    for (int i = 0; i < POINTS_BLOCK; ++i)
        other += value[i] != 0.0f;
    return other == 0;
}

void LANES(add_weighted)(float total[3][POINTS_BLOCK], const float *weight,
                         float sum[3][POINTS_BLOCK])
{
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < POINTS_BLOCK; ++i)
            total[axis][i] += weight[i] * sum[axis][i];
}
