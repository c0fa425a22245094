/* Cholesky factor by the envelope, and the two solves. */
#include "csrbf/lanes_variant.h"

#include <math.h>
#include <string.h>

/* So many columns of a group are worked on against as many finished rows at once, all LANES rows of
 * the group wide: as many sums as the registers hold. */
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

/* Column of the leftmost entry of the rows. */
static uint32_t group_first(const envelope *e, uint32_t row, uint32_t row_count)
{
    uint32_t first = e->first[row];
    for (uint32_t lane = 1; lane < row_count; ++lane)
        first = e->first[row + lane] < first ? e->first[row + lane] : first;
    return first;
}

enum { STRETCH = 8 }; /* columns of a group that are filled together: they stay in the cache */

static void group_load(envelope *e, uint32_t low, uint32_t row, uint32_t row_count)
{
    uint32_t end = row + row_count;
    memset(e->group + (size_t)LANES * low, 0, (size_t)(end - low) * LANES * sizeof *e->group);
    for (uint32_t column = low; column < end; column += STRETCH)
        for (uint32_t lane = 0; lane < row_count; ++lane) {
            uint32_t first = e->first[row + lane], from = larger(column, first);
            uint32_t to = lesser(column + STRETCH, row + lane + 1);
            const double *value = e->value + e->start[row + lane];
            for (uint32_t k = from; k < to; ++k)
                e->group[(size_t)LANES * k + lane] = value[k - first];
        }
}

static void group_store(envelope *e, uint32_t low, uint32_t row, uint32_t row_count)
{
    uint32_t end = row + row_count;
    for (uint32_t column = low; column < end; column += STRETCH)
        for (uint32_t lane = 0; lane < row_count; ++lane) {
            uint32_t first = e->first[row + lane], from = larger(column, first);
            uint32_t to = lesser(column + STRETCH, row + lane + 1);
            double *value = e->value + e->start[row + lane];
            for (uint32_t k = from; k < to; ++k)
                value[k - first] = e->group[(size_t)LANES * k + lane];
        }
}

/* entry (LANES) -= sum over k of group[k] * factor[k * stride], k ascending. */
static void subtract_products(double *entry, const double *group, const double *factor,
                              uint32_t stride, uint32_t count)
{
    double sum[LANES];
    memcpy(sum, entry, sizeof sum);
    for (uint32_t k = 0; k < count; ++k, group += LANES, factor += stride)
        for (int lane = 0; lane < LANES; ++lane)
            sum[lane] -= group[lane] * *factor;
    memcpy(entry, sum, sizeof sum);
}

static const double *factor_at(const envelope *e, uint32_t row, uint32_t column)
{
    return e->value + e->start[row] + (column - e->first[row]);
}

/* Entries in column j of the group's rows, which have their products up to column `from`. */
static void finish_column(envelope *e, uint32_t j, uint32_t from)
{
    double *entry = e->group + (size_t)LANES * j;
    const double pivot = *factor_at(e, j, j);
    if (from < j)
        subtract_products(entry, e->group + (size_t)LANES * from, factor_at(e, j, from), 1,
                          j - from);
    for (int lane = 0; lane < LANES; ++lane)
        entry[lane] = entry[lane] / pivot;
}

#ifdef __AVX512F__
/* The same for COLUMNS entries that follow each other against as many rows of the factor. */
static inline void subtract_tile(double *entry, const double *group,
                                 const double *const factor[COLUMNS], size_t stride, uint32_t count)
{
    double a[LANES], b[LANES], c[LANES], d[LANES];
    const double *fa = factor[0], *fb = factor[1], *fc = factor[2], *fd = factor[3];
    memcpy(a, entry, sizeof a);
    memcpy(b, entry + LANES, sizeof b);
    memcpy(c, entry + (size_t)2 * LANES, sizeof c);
    memcpy(d, entry + (size_t)3 * LANES, sizeof d);
    for (uint32_t k = 0; k < count; ++k, group += LANES) {
        for (int lane = 0; lane < LANES; ++lane) {
            const double value = group[lane];
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

static void subtract_rows(double *entry, const double *group, const double *const factor[COLUMNS],
                          uint32_t count)
{
    subtract_tile(entry, group, factor, 1, count);
}

/* COLUMNS columns of the group's own triangle, against what is left of them. */
static void subtract_left(double *entry, const double *left, uint32_t column, uint32_t count)
{
    const double *const factor[COLUMNS] = {left + column, left + column + 1, left + column + 2,
                                           left + column + 3};
    subtract_tile(entry, left, factor, LANES, count);
}

/* COLUMNS columns of the group from j on: what they have in common together, the rest alone. */
static void eliminate_tile(envelope *e, uint32_t low, uint32_t j)
{
    const double *factor[COLUMNS];
    uint32_t common = low;
    for (uint32_t i = 0; i < COLUMNS; ++i)
        common = larger(common, e->first[j + i]);
    common = common < j ? common : j;
    for (uint32_t i = 0; i < COLUMNS; ++i) {
        uint32_t from = larger(low, e->first[j + i]);
        if (from < common)
            subtract_products(e->group + (size_t)LANES * (j + i), e->group + (size_t)LANES * from,
                              factor_at(e, j + i, from), 1, common - from);
        factor[i] = from < j ? factor_at(e, j + i, common) : e->value;
    }
    subtract_rows(e->group + (size_t)LANES * j, e->group + (size_t)LANES * common, factor,
                  j - common);
    for (uint32_t i = 0; i < COLUMNS; ++i)
        finish_column(e, j + i, larger(j, larger(low, e->first[j + i])));
}
#else
static void subtract_left(double *entry, const double *left, uint32_t column, uint32_t count)
{
    subtract_products(entry, left, left + column, LANES, count);
}

static void eliminate_tile(envelope *e, uint32_t low, uint32_t j)
{
    finish_column(e, j, larger(low, e->first[j]));
}
#endif

/* Entries of the group's rows left of the group: column j needs the finished row j only. */
static void group_eliminate(envelope *e, uint32_t low, uint32_t row)
{
    uint32_t j = low;
    for (; j + COLUMNS <= row; j += COLUMNS)
        eliminate_tile(e, low, j);
    for (; j < row; ++j)
        finish_column(e, j, larger(low, e->first[j]));
}

/* The triangle of the group against itself; false when a pivot is too small. What it leaves above
 * the diagonal is never used. */
static bool group_finish(envelope *e, uint32_t low, uint32_t row, uint32_t row_count,
                         double smallest_pivot, uint32_t *out_row)
{
    const double *left = e->group + (size_t)LANES * low;
    for (uint32_t column = 0; column < row_count; ++column) {
        double *entry = e->group + (size_t)LANES * (row + column);
        uint32_t tile = column / COLUMNS * COLUMNS, end = row - low + column;
        uint32_t done = tile + COLUMNS <= row_count ? row - low + tile : 0;
        if (done > 0 && column == tile)
            subtract_left(entry, left, column, done);
        if (done < end)
            subtract_products(entry, left + (size_t)LANES * done,
                              left + (size_t)LANES * done + column, LANES, end - done);
        if (!(entry[column] > smallest_pivot)) {
            *out_row = row + column;
            return false;
        }
        const double root = sqrt(entry[column]);
        entry[column] = root;
        for (uint32_t lane = column + 1; lane < row_count; ++lane)
            entry[lane] /= root;
    }
    return true;
}

bool LANES(factor)(envelope *e, double smallest_pivot, uint32_t *out_row)
{
    for (uint32_t row = 0; row < e->row_count; row += LANES) {
        uint32_t left = e->row_count - row, row_count = left < LANES ? left : LANES;
        uint32_t low = group_first(e, row, row_count);
        group_load(e, low, row, row_count);
        group_eliminate(e, low, row);
        if (!group_finish(e, low, row, row_count, smallest_pivot, out_row))
            return false;
        group_store(e, low, row, row_count);
    }
    return true;
}

/* ---- solves ---- */

static inline void solve(const envelope *e, double *restrict rhs, const int width)
{
    for (uint32_t i = 0; i < e->row_count; ++i) {
        const double *value = e->value + e->start[i];
        double *row = rhs + (size_t)i * (size_t)width;
        for (uint32_t k = e->first[i]; k < i; ++k, ++value)
            for (int lane = 0; lane < width; ++lane)
                row[lane] -= *value * rhs[(size_t)k * (size_t)width + (size_t)lane];
        for (int lane = 0; lane < width; ++lane)
            row[lane] /= *value;
    }
    for (uint32_t i = e->row_count; i-- > 0;) {
        const double *value = e->value + e->start[i];
        double *row = rhs + (size_t)i * (size_t)width;
        for (int lane = 0; lane < width; ++lane)
            row[lane] /= value[i - e->first[i]];
        for (uint32_t k = e->first[i]; k < i; ++k, ++value)
            for (int lane = 0; lane < width; ++lane)
                rhs[(size_t)k * (size_t)width + (size_t)lane] -= *value * row[lane];
    }
}

void LANES(solve_few)(const envelope *e, double *rhs)
{
    solve(e, rhs, ENVELOPE_FEW);
}

void LANES(solve_many)(const envelope *e, double *rhs)
{
    solve(e, rhs, ENVELOPE_MANY);
}
