/* Cholesky factor by the envelope, and the two solves. */
#include "csrbf/lanes_variant.h"

#include <math.h>
#include <string.h>

/* Of the group's rows, so many are worked on at once, against COLUMNS finished rows: as many sums
 * as the registers hold. */
#if defined(__AVX512F__)
enum { WIDE = 32 };
#elif defined(__AVX2__)
enum { WIDE = 8 };
#else
enum { WIDE = 4 };
#endif
enum { LANES = ENVELOPE_LANES, COLUMNS = 4 };

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* Column of the leftmost entry of the rows. */
static uint32_t group_first(const envelope *e, uint32_t row, uint32_t row_count)
{
    uint32_t first = e->first[row];
    for (uint32_t lane = 1; lane < row_count; ++lane)
        first = e->first[row + lane] < first ? e->first[row + lane] : first;
    return first;
}

static void group_load(envelope *e, uint32_t low, uint32_t row, uint32_t row_count)
{
    memset(e->group + (size_t)LANES * low, 0,
           (size_t)(row + row_count - low) * LANES * sizeof *e->group);
    for (uint32_t lane = 0; lane < row_count; ++lane) {
        const double *value = e->value + e->start[row + lane];
        for (uint32_t k = e->first[row + lane]; k <= row + lane; ++k)
            e->group[(size_t)LANES * k + lane] = *value++;
    }
}

static void group_store(envelope *e, uint32_t row, uint32_t row_count)
{
    for (uint32_t lane = 0; lane < row_count; ++lane) {
        double *value = e->value + e->start[row + lane];
        for (uint32_t k = e->first[row + lane]; k <= row + lane; ++k)
            *value++ = e->group[(size_t)LANES * k + lane];
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

/* The same for COLUMNS entries that follow each other, of WIDE lanes each, against as many rows of
 * the factor. */
static void subtract_tile(double *entry, const double *group, const double *const factor[COLUMNS],
                          uint32_t count)
{
    double a[WIDE], b[WIDE], c[WIDE], d[WIDE];
    const double *fa = factor[0], *fb = factor[1], *fc = factor[2], *fd = factor[3];
    memcpy(a, entry, sizeof a);
    memcpy(b, entry + LANES, sizeof b);
    memcpy(c, entry + (size_t)2 * LANES, sizeof c);
    memcpy(d, entry + (size_t)3 * LANES, sizeof d);
    for (uint32_t k = 0; k < count; ++k, group += LANES) {
        for (int lane = 0; lane < WIDE; ++lane) {
            const double value = group[lane];
            a[lane] -= value * fa[k];
            b[lane] -= value * fb[k];
            c[lane] -= value * fc[k];
            d[lane] -= value * fd[k];
        }
    }
    memcpy(entry, a, sizeof a);
    memcpy(entry + LANES, b, sizeof b);
    memcpy(entry + (size_t)2 * LANES, c, sizeof c);
    memcpy(entry + (size_t)3 * LANES, d, sizeof d);
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
    for (uint32_t lane = 0; lane < LANES; lane += WIDE)
        subtract_tile(e->group + (size_t)LANES * j + lane, e->group + (size_t)LANES * common + lane,
                      factor, j - common);
    for (uint32_t i = 0; i < COLUMNS; ++i)
        finish_column(e, j + i, larger(j, larger(low, e->first[j + i])));
}

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
        subtract_products(entry, left, left + column, LANES, row + column - low);
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
        group_store(e, row, row_count);
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
