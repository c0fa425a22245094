#include "csrbf/columns.h"

#include "base/large.h"
#include "base/pool.h"
#include "csrbf/lanes.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STAGGER = 16 };             /* floats between two rows: not a power of two */
enum { FAR_BYTES_MAX = 16 << 20 }; /* of a last-level cache; other programs use it too */
enum { SHARED_FROM_BLOCKS = 131072 / POINTS_BLOCK, GRAIN = 64 }; /* see base/pool.h */

static uint32_t words_of(uint32_t count)
{
    return (count + COLUMNS_WORD - 1) / COLUMNS_WORD;
}

/* ---- weights ---- */

static void weights_destroy(columns_weights *w)
{
    free(w->value);
    free(w->live);
    free(w->word);
    *w = (columns_weights){0};
}

static bool weights_create(columns_weights *out, uint32_t capacity)
{
    size_t words = words_of(capacity);
    *out = (columns_weights){.value = calloc((size_t)3 * capacity + 1, sizeof *out->value),
                             .live = calloc(words + 1, sizeof *out->live),
                             .word = calloc(words + 1, sizeof *out->word)};
    if (out->value && out->live && out->word)
        return true;
    weights_destroy(out);
    return false;
}

/* Returns which of `count` columns of one word have a weight other than 0. Tests the bits of the
 * three numbers together, without the signs: there may be a thousand columns, of which ten have a
 * weight. */
static uint64_t live_in_word(const float *value, uint32_t count)
{
    uint64_t live = 0;
    for (uint32_t i = 0; i < count; ++i, value += 3) {
        uint32_t bits[3];
        memcpy(bits, value, sizeof bits);
        uint64_t counts = ((bits[0] | bits[1] | bits[2]) & UINT32_C(0x7fffffff)) != 0;
        live |= counts << i;
    }
    return live;
}

static void note_weights(columns_weights *w, const columns *c, uint32_t count)
{
    size_t rows = (size_t)6 * c->block_count * sizeof(float); /* rows of base and out */
    memset(w->live, 0, words_of(c->capacity) * sizeof *w->live);
    w->word_count = 0;
    for (uint32_t first = 0; first < count; first += COLUMNS_WORD) {
        uint32_t left = count - first, word = first / COLUMNS_WORD;
        const float *value = w->value + (size_t)3 * first;
        w->live[word] = live_in_word(value, left < COLUMNS_WORD ? left : COLUMNS_WORD);
        if (w->live[word] == 0)
            continue;
        w->word[w->word_count++] = (uint16_t)word;
        for (uint32_t bit = 0; bit < COLUMNS_WORD; ++bit)
            if (w->live[word] >> bit & 1u)
                rows += c->filled[first + bit] * sizeof *c->value;
    }
    w->bytes = rows * POINTS_BLOCK;
}

/* ---- columns ---- */

/* Above half of the last-level cache, a frame leaves no data in the cache that is read again. */
static size_t far_from_bytes(void)
{
    long half = -1;
#ifdef _SC_LEVEL3_CACHE_SIZE
    half = sysconf(_SC_LEVEL3_CACHE_SIZE) / 2;
#endif
    return half > 0 && half < FAR_BYTES_MAX ? (size_t)half : FAR_BYTES_MAX;
}

mrt_result columns_create(columns *out, const points *like, uint32_t capacity, error *err)
{
    *out = (columns){.capacity = capacity,
                     .block_count = like->block_count,
                     .mark_words = words_of(capacity),
                     .far_from_bytes = far_from_bytes(),
                     .lanes = lanes_now()};
    size_t rows = capacity;
    out->stride = (size_t)like->padded_count + STAGGER;
    if (capacity <= COLUMNS_CAPACITY && rows < SIZE_MAX / sizeof(float) / out->stride - 1) {
        size_t marks = (size_t)out->mark_words * out->block_count;
        out->value = large_alloc((rows + 1) * out->stride * sizeof *out->value);
        out->mark = calloc(marks + 1, sizeof *out->mark);
        out->filled = calloc(rows + 1, sizeof *out->filled);
    }
    if (out->value && out->mark && out->filled && weights_create(&out->weights, capacity))
        return MRT_OK;
    columns_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for %u columns of %u vertices", capacity,
                     like->count);
}

void columns_destroy(columns *c)
{
    if (!c)
        return;
    large_free(c->value);
    free(c->mark);
    free(c->filled);
    weights_destroy(&c->weights);
    *c = (columns){0};
}

float *columns_row(const columns *c, uint32_t column)
{
    return c->value + column * c->stride;
}

void columns_note(columns *c, uint32_t count)
{
    columns_note_groups(c, 0, count, 1);
}

/* Clears the marks of all columns from `first` on. */
static void forget_marks(columns *c, uint32_t first)
{
    uint32_t word = first / COLUMNS_WORD;
    uint64_t kept = (UINT64_C(1) << first % COLUMNS_WORD) - 1;
    for (size_t block = 0; block < c->block_count; ++block) {
        uint64_t *mark = c->mark + block * c->mark_words;
        if (word < c->mark_words)
            mark[word] &= kept;
        for (uint32_t i = word + 1; i < c->mark_words; ++i)
            mark[i] = 0;
    }
}

void columns_note_groups(columns *c, uint32_t first, uint32_t count, uint32_t group)
{
    c->count = count;
    forget_marks(c, first);
    for (uint32_t column = first; column < count; ++column) {
        const float *last = columns_row(c, column - (column - first) % group + group - 1);
        uint64_t *mark = c->mark + column / COLUMNS_WORD;
        c->filled[column] = 0;
        for (uint32_t block = 0; block < c->block_count; ++block, mark += c->mark_words) {
            uint64_t is_filled = !c->lanes->is_zero(last + (size_t)block * POINTS_BLOCK);
            *mark |= is_filled << column % COLUMNS_WORD;
            c->filled[column] += (uint32_t)is_filled;
        }
    }
}

void columns_weigh(columns *c, const double *weight, uint32_t count)
{
    for (size_t i = 0; i < (size_t)3 * count; ++i)
        c->weights.value[i] = (float)weight[i];
    note_weights(&c->weights, c, count);
}

void columns_sum(const columns *c, float sum[3][POINTS_BLOCK], uint32_t first, uint32_t block)
{
    c->lanes->columns_sum(c, sum, first, block);
}

void columns_add(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block)
{
    lanes_of(ISA_GENERIC)->columns_add(out, base, sum, block);
}

void columns_move_blocks(const columns *c, points *out, const points *base, uint32_t first,
                         uint32_t end)
{
    c->lanes->columns_move(c, out, base, first, end);
}

typedef struct move_work {
    const columns *c;
    points *out;
    const points *base;
} move_work;

static void move_part(void *data, uint32_t first, uint32_t end)
{
    const move_work *w = data;
    columns_move_blocks(w->c, w->out, w->base, first, end);
}

/* Returns the cost of a frame on one thread. A frame waits for memory more than it computes: below
 * SHARED_FROM_BLOCKS a second thread makes it slower. */
static double cost_ns(const columns *c)
{
    uint32_t live = 0;
    for (uint32_t i = 0; i < c->weights.word_count; ++i)
        for (uint64_t left = c->weights.live[c->weights.word[i]]; left != 0; left &= left - 1)
            ++live;
    double each_ns = 0.2 + 0.1 * live;
    return c->block_count < SHARED_FROM_BLOCKS ? 0.0 : each_ns * POINTS_BLOCK * c->block_count;
}

void columns_move(columns *c, points *out, const points *base, const double *weight)
{
    columns_weigh(c, weight, c->count);
    move_work w = {.c = c, .out = out, .base = base};
    const pool_work work = {.run = move_part,
                            .data = &w,
                            .part_count = c->block_count,
                            .grain = GRAIN,
                            .cost_ns = cost_ns(c)};
    pool_run(&work);
}
