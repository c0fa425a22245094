/* The Cholesky factor of an envelope, and the two solves. */
#include "csrbf/lanes.h"
#include "csrbf/saddle.h"

#include <math.h>
#include <string.h>

/* COLUMNS columns of a group are combined with COLUMNS finished rows at a time, for all LANES rows
 * of the group: as many sums as fit into registers. */
enum { LANES = ENVELOPE_LANES };
#ifdef __AVX512F__
enum { COLUMNS = 4 };
#else
enum { COLUMNS = 1 };
#endif

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static uint32_t lesser(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static const double *factor_at(const envelope *e, uint32_t row, uint32_t column)
{
    return e->value + e->start[row] + (column - e->first[row]);
}

/* ---- a group of rows ---- */

typedef struct group {
    double *entry;           /* LANES values for each column */
    uint32_t low;            /* its first column; a multiple of COLUMNS */
    uint32_t row, row_count; /* at most LANES */
} group;

static double *column_of(const group *g, uint32_t column)
{
    return g->entry + (size_t)LANES * column;
}

enum { STRETCH = 8 }; /* columns filled together: they stay in the cache */

static void group_load(group *g, const envelope *e)
{
    const uint32_t end = g->row + g->row_count;
    g->low = g->row;
    for (uint32_t row = g->row; row < end; ++row)
        g->low = lesser(g->low, e->first[row]);
    g->low = g->low / COLUMNS * COLUMNS;
    memset(column_of(g, g->low), 0, (size_t)(end - g->low) * LANES * sizeof *g->entry);
    for (uint32_t column = g->low; column < end; column += STRETCH)
        for (uint32_t lane = 0; lane < g->row_count; ++lane) {
            uint32_t row = g->row + lane, from = larger(column, e->first[row]);
            uint32_t to = lesser(column + STRETCH, row + 1);
            for (uint32_t k = from; k < to; ++k)
                column_of(g, k)[lane] = *factor_at(e, row, k);
        }
}

static void group_store(const group *g, envelope *e)
{
    const uint32_t end = g->row + g->row_count;
    for (uint32_t column = g->low; column < end; column += STRETCH)
        for (uint32_t lane = 0; lane < g->row_count; ++lane) {
            uint32_t row = g->row + lane, from = larger(column, e->first[row]);
            uint32_t to = lesser(column + STRETCH, row + 1);
            double *value = e->value + e->start[row];
            for (uint32_t k = from; k < to; ++k)
                value[k - e->first[row]] = column_of(g, k)[lane];
        }
}

/* entry (LANES) -= sum over k of column[k] * factor[k * stride], k ascending. */
static void subtract_products(double *entry, const double *column, const double *factor,
                              uint32_t stride, uint32_t count)
{
    double sum[LANES];
    memcpy(sum, entry, sizeof sum);
    for (uint32_t k = 0; k < count; ++k, column += LANES, factor += stride)
        for (int lane = 0; lane < LANES; ++lane)
            sum[lane] -= column[lane] * *factor;
    memcpy(entry, sum, sizeof sum);
}

/* Finishes the entries in column j of the group's rows; the products up to column `from` are
 * already subtracted. */
static void finish_column(const group *g, const envelope *e, uint32_t j, uint32_t from)
{
    double *entry = column_of(g, j);
    const double pivot = *factor_at(e, j, j);
    if (from < j)
        subtract_products(entry, column_of(g, from), factor_at(e, j, from), 1, j - from);
    for (int lane = 0; lane < LANES; ++lane)
        entry[lane] = entry[lane] / pivot;
}

#ifdef __AVX512F__
/* The same for COLUMNS consecutive entries and as many rows of the factor. */
static inline void subtract_tile(double *entry, const double *column,
                                 const double *const factor[COLUMNS], size_t stride, uint32_t count)
{
    double a[LANES], b[LANES], c[LANES], d[LANES];
    const double *fa = factor[0], *fb = factor[1], *fc = factor[2], *fd = factor[3];
    memcpy(a, entry, sizeof a);
    memcpy(b, entry + LANES, sizeof b);
    memcpy(c, entry + (size_t)2 * LANES, sizeof c);
    memcpy(d, entry + (size_t)3 * LANES, sizeof d);
    for (uint32_t k = 0; k < count; ++k, column += LANES) {
        for (int lane = 0; lane < LANES; ++lane) {
            const double value = column[lane];
            a[lane] -= value * fa[k * stride];
            b[lane] -= value * fb[k * stride];
            c[lane] -= value * fc[k * stride];
            d[lane] -= value * fd[k * stride];
        }
    }
    memcpy(entry, a, sizeof a);
    memcpy(entry + LANES, b, sizeof b);
    memcpy(entry + (size_t)2 * LANES, c, sizeof c);
    memcpy(entry + (size_t)3 * LANES, d, sizeof d);
}

static void subtract_rows(double *entry, const double *column, const double *const factor[COLUMNS],
                          uint32_t count)
{
    subtract_tile(entry, column, factor, 1, count);
}

/* Subtracts the products of the group's own triangle for COLUMNS columns. */
static void subtract_left(double *entry, const double *left, uint32_t column, uint32_t count)
{
    const double *const factor[COLUMNS] = {left + column, left + column + 1, left + column + 2,
                                           left + column + 3};
    subtract_tile(entry, left, factor, LANES, count);
}

/* Eliminates COLUMNS columns of the group, beginning at j: first the entries that they have in
 * common, then the rest. */
static void eliminate_tile(const group *g, const envelope *e, uint32_t j)
{
    const double *factor[COLUMNS];
    uint32_t common = g->low;
    for (uint32_t i = 0; i < COLUMNS; ++i)
        common = larger(common, e->first[j + i]);
    common = lesser(common, j);
    for (uint32_t i = 0; i < COLUMNS; ++i) {
        uint32_t from = larger(g->low, e->first[j + i]);
        if (from < common)
            subtract_products(column_of(g, j + i), column_of(g, from), factor_at(e, j + i, from), 1,
                              common - from);
        factor[i] = from < j ? factor_at(e, j + i, common) : e->value;
    }
    subtract_rows(column_of(g, j), column_of(g, common), factor, j - common);
    for (uint32_t i = 0; i < COLUMNS; ++i)
        finish_column(g, e, j + i, larger(j, larger(g->low, e->first[j + i])));
}
#else
static void subtract_left(double *entry, const double *left, uint32_t column, uint32_t count)
{
    subtract_products(entry, left, left + column, LANES, count);
}

static void eliminate_tile(const group *g, const envelope *e, uint32_t j)
{
    finish_column(g, e, j, larger(g->low, e->first[j]));
}
#endif

/* Factors the triangle of the group itself. Returns false if a pivot is too small. Values above the
 * diagonal are undefined and never used. */
static bool group_finish(const group *g, double smallest_pivot, uint32_t *out_row)
{
    const double *left = column_of(g, g->low);
    const uint32_t before = g->row - g->low;
    for (uint32_t column = 0; column < g->row_count; ++column) {
        double *entry = column_of(g, g->row + column);
        uint32_t tile = column / COLUMNS * COLUMNS, end = before + column;
        uint32_t done = tile + COLUMNS <= g->row_count ? before + tile : 0;
        if (done > 0 && column == tile)
            subtract_left(entry, left, column, done);
        if (done < end)
            subtract_products(entry, left + (size_t)LANES * done,
                              left + (size_t)LANES * done + column, LANES, end - done);
        if (!(entry[column] > smallest_pivot)) {
            *out_row = g->row + column;
            return false;
        }
        const double root = sqrt(entry[column]);
        entry[column] = root;
        for (uint32_t lane = column + 1; lane < g->row_count; ++lane)
            entry[lane] /= root;
    }
    return true;
}

/* ---- the factor ---- */

/* Loads the next groups, beginning at `row`. Returns their number. */
static uint32_t load_groups(group g[ENVELOPE_GROUPS], const envelope *e, uint32_t row)
{
    uint32_t count = 0;
    for (; count < ENVELOPE_GROUPS && row < e->row_count; row += LANES, ++count) {
        g[count] = (group){.entry = e->group + (size_t)count * LANES * e->row_capacity,
                           .row = row,
                           .row_count = lesser(e->row_count - row, LANES)};
        group_load(&g[count], e);
    }
    return count;
}

/* Eliminates columns first .. end - 1 of the groups, which are all left of the groups. Column j
 * only needs the finished row j, which is read once for all groups. */
static void eliminate(const group *g, uint32_t count, const envelope *e, uint32_t first,
                      uint32_t end)
{
    for (uint32_t j = first; j < end; j += COLUMNS)
        for (uint32_t i = 0; i < count; ++i)
            if (j >= g[i].low)
                eliminate_tile(&g[i], e, j);
}

bool LANES(factor)(envelope *e, double smallest_pivot, uint32_t *out_row)
{
    for (uint32_t row = e->factored_count; row < e->row_count; row += LANES * ENVELOPE_GROUPS) {
        group g[ENVELOPE_GROUPS];
        uint32_t count = load_groups(g, e, row), low = row;
        for (uint32_t i = 0; i < count; ++i)
            low = lesser(low, g[i].low);
        eliminate(g, count, e, low, row);
        for (uint32_t i = 0; i < count; ++i) {
            eliminate(&g[i], 1, e, row, g[i].row);
            if (!group_finish(&g[i], smallest_pivot, out_row))
                return false;
            group_store(&g[i], e);
        }
    }
    return true;
}

/* ---- solves: the loops over lanes must stay separate loops; otherwise gcc combines several k, and
 * shuffles more than it adds ---- */

/* sum -= value[k] times side k. */
static inline void subtract_sides(double *restrict sum, const double *restrict value,
                                  const double *restrict side, uint32_t count, const int width)
{
    for (uint32_t k = 0; k < count; ++k, side += width)
        for (int lane = 0; lane < width; ++lane)
            sum[lane] -= value[k] * side[lane];
}

/* Finishes row i of L y = b; the products up to column `from` are already subtracted. */
static inline void finish_forward(const envelope *e, double *rhs, uint32_t i, uint32_t from,
                                  const int width)
{
    double sum[ENVELOPE_MANY], *row = rhs + (size_t)i * (size_t)width;
    const double pivot = *factor_at(e, i, i);
    memcpy(sum, row, (size_t)width * sizeof *sum);
    subtract_sides(sum, factor_at(e, i, from), rhs + (size_t)from * (size_t)width, i - from, width);
    for (int lane = 0; lane < width; ++lane)
        row[lane] = sum[lane] / pivot;
}

/* Divides row i of L^T x = y by its pivot, and subtracts it from the rows from `from` on. */
static inline void begin_backward(const envelope *e, double *rhs, uint32_t i, uint32_t from,
                                  const int width)
{
    double *row = rhs + (size_t)i * (size_t)width, *side = rhs + (size_t)from * (size_t)width;
    const double *value = factor_at(e, i, from), pivot = *factor_at(e, i, i);
    for (int lane = 0; lane < width; ++lane)
        row[lane] /= pivot;
    for (uint32_t k = from; k < i; ++k, ++value, side += width)
        for (int lane = 0; lane < width; ++lane)
            side[lane] -= *value * row[lane];
}

enum { ROWS = 4 }; /* rows processed together: the sides are read once */

/* Returns the first column where all rows i .. i + ROWS - 1 have entries; at most i. */
static uint32_t common_first(const envelope *e, uint32_t i)
{
    uint32_t common = 0;
    for (uint32_t row = i; row < i + ROWS; ++row)
        common = larger(common, e->first[row]);
    return lesser(common, i);
}

static inline void load_rows(double *const out[ROWS], const double *row, const int width)
{
    for (int i = 0; i < ROWS; ++i)
        memcpy(out[i], row + i * width, (size_t)width * sizeof *row);
}

/* Subtracts the products of columns `common` to i - 1 from rows i .. i + ROWS - 1. */
static inline void forward_tile(const envelope *e, double *rhs, uint32_t i, uint32_t common,
                                const int width)
{
    const double *fa = factor_at(e, i, common), *fb = factor_at(e, i + 1, common);
    const double *fc = factor_at(e, i + 2, common), *fd = factor_at(e, i + 3, common);
    const double *side = rhs + common * (size_t)width;
    double *row = rhs + i * (size_t)width;
    double a[ENVELOPE_MANY], b[ENVELOPE_MANY], c[ENVELOPE_MANY], d[ENVELOPE_MANY];
    double *const sum[ROWS] = {a, b, c, d};
    load_rows(sum, row, width);
    for (uint32_t k = 0; k < i - common; ++k, side += width)
#pragma GCC unroll 1
        for (int lane = 0; lane < width; ++lane) {
            a[lane] -= fa[k] * side[lane];
            b[lane] -= fb[k] * side[lane];
            c[lane] -= fc[k] * side[lane];
            d[lane] -= fd[k] * side[lane];
        }
    for (int k = 0; k < ROWS; ++k)
        memcpy(row + k * width, sum[k], (size_t)width * sizeof *row);
}

/* Subtracts rows i .. i + ROWS - 1 from columns `common` to i - 1, the last row first. */
static inline void backward_tile(const envelope *e, double *rhs, uint32_t i, uint32_t common,
                                 const int width)
{
    const double *fa = factor_at(e, i, common), *fb = factor_at(e, i + 1, common);
    const double *fc = factor_at(e, i + 2, common), *fd = factor_at(e, i + 3, common);
    double *side = rhs + common * (size_t)width;
    double a[ENVELOPE_MANY], b[ENVELOPE_MANY], c[ENVELOPE_MANY], d[ENVELOPE_MANY];
    double *const taken[ROWS] = {a, b, c, d};
    load_rows(taken, rhs + i * (size_t)width, width);
    for (uint32_t k = 0; k < i - common; ++k, side += width)
#pragma GCC unroll 1
        for (int lane = 0; lane < width; ++lane) {
            double left = side[lane] - fd[k] * d[lane];
            left -= fc[k] * c[lane];
            left -= fb[k] * b[lane];
            side[lane] = left - fa[k] * a[lane];
        }
}

static inline void forward_rows(const envelope *e, double *rhs, uint32_t i, const int width)
{
    const uint32_t common = common_first(e, i);
    const size_t step = (size_t)width;
    for (uint32_t row = i; row < i + ROWS; ++row)
        if (e->first[row] < common)
            subtract_sides(rhs + row * step, factor_at(e, row, e->first[row]),
                           rhs + e->first[row] * step, common - e->first[row], width);
    if (common < i)
        forward_tile(e, rhs, i, common, width);
    for (uint32_t row = i; row < i + ROWS; ++row)
        finish_forward(e, rhs, row, larger(i, e->first[row]), width);
}

static inline void backward_rows(const envelope *e, double *rhs, uint32_t i, const int width)
{
    const uint32_t common = common_first(e, i);
    const size_t step = (size_t)width;
    for (uint32_t row = i + ROWS; row-- > i;)
        begin_backward(e, rhs, row, larger(i, e->first[row]), width);
    if (common < i)
        backward_tile(e, rhs, i, common, width);
    for (uint32_t row = i + ROWS; row-- > i;)
        for (uint32_t k = e->first[row]; k < common; ++k)
            for (size_t lane = 0; lane < step; ++lane)
                rhs[k * step + lane] -= *factor_at(e, row, k) * rhs[row * step + lane];
}

/* Returns the first row whose sides are not all zero: above it y is also zero. */
static inline uint32_t first_side(const envelope *e, const double *rhs, const int width)
{
    size_t entries = (size_t)e->row_count * (size_t)width, entry = 0;
    while (entry < entries && rhs[entry] == 0.0)
        ++entry;
    return (uint32_t)(entry / (size_t)width);
}

static inline void solve(const envelope *e, double *rhs, const int width)
{
    uint32_t whole = e->row_count / ROWS * ROWS, i = first_side(e, rhs, width) / ROWS * ROWS;
    for (; i < whole; i += ROWS)
        forward_rows(e, rhs, i, width);
    for (i = larger(i, whole); i < e->row_count; ++i)
        finish_forward(e, rhs, i, e->first[i], width);
    for (i = e->row_count; i > whole; --i)
        begin_backward(e, rhs, i - 1, e->first[i - 1], width);
    for (; i > 0; i -= ROWS)
        backward_rows(e, rhs, i - ROWS, width);
}

void LANES(solve_few)(const envelope *e, double *rhs)
{
    solve(e, rhs, ENVELOPE_FEW);
}

void LANES(solve_many)(const envelope *e, double *rhs)
{
    solve(e, rhs, ENVELOPE_MANY);
}
