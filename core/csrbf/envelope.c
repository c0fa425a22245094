#include "csrbf/envelope.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows of a group; group[LANES * column + lane]. With fewer lanes gcc 12 takes the loop over
 * columns for the one to vectorise, and shuffles. */
enum { LANES = 32 };

bool envelope_create(envelope *out, uint32_t row_capacity)
{
    size_t rows = row_capacity;
    *out = (envelope){.row_capacity = row_capacity};
    out->first = calloc(rows + 1, sizeof *out->first);
    out->start = calloc(rows + 1, sizeof *out->start);
    out->value = calloc(rows * (rows + 1) / 2 + 1, sizeof *out->value);
    out->group = calloc(rows * LANES + 1, sizeof *out->group);
    if (out->first && out->start && out->value && out->group)
        return true;
    envelope_destroy(out);
    return false;
}

void envelope_destroy(envelope *e)
{
    if (!e)
        return;
    free(e->first);
    free(e->start);
    free(e->value);
    free(e->group);
    *e = (envelope){0};
}

void envelope_clear(envelope *e)
{
    e->row_count = 0;
    e->start[0] = 0;
}

double *envelope_add_row(envelope *e, uint32_t first)
{
    uint32_t row = e->row_count++;
    e->first[row] = first;
    e->start[row + 1] = e->start[row] + (row - first + 1);
    return e->value + e->start[row];
}

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

/* sum (LANES) = entry - sum over k of group[k] * factor[k * stride], k ascending. */
static void subtract_products(double *restrict sum, const double *entry, const double *group,
                              const double *factor, uint32_t stride, uint32_t count)
{
    memcpy(sum, entry, LANES * sizeof *sum);
    for (uint32_t k = 0; k < count; ++k, group += LANES, factor += stride)
        for (int lane = 0; lane < LANES; ++lane)
            sum[lane] -= group[lane] * *factor;
}

/* Entries of the group's rows left of the group: column j needs the finished row j only. */
static void group_eliminate(envelope *e, uint32_t low, uint32_t row)
{
    for (uint32_t j = low; j < row; ++j) {
        uint32_t from = larger(low, e->first[j]);
        const double *finished = e->value + e->start[j] + (from - e->first[j]);
        double *entry = e->group + (size_t)LANES * j;
        double sum[LANES];
        subtract_products(sum, entry, e->group + (size_t)LANES * from, finished, 1, j - from);
        for (int lane = 0; lane < LANES; ++lane)
            entry[lane] = sum[lane] / finished[j - from];
    }
}

/* The triangle of the group against itself; false when a pivot is too small. What it leaves above
 * the diagonal is never used. */
static bool group_finish(envelope *e, uint32_t low, uint32_t row, uint32_t row_count,
                         double smallest_pivot, uint32_t *out_row)
{
    const double *left = e->group + (size_t)LANES * low;
    for (uint32_t column = 0; column < row_count; ++column) {
        double *entry = e->group + (size_t)LANES * (row + column);
        double sum[LANES];
        subtract_products(sum, entry, left, left + column, LANES, row + column - low);
        if (!(sum[column] > smallest_pivot)) {
            *out_row = row + column;
            return false;
        }
        entry[column] = sqrt(sum[column]);
        for (uint32_t lane = column + 1; lane < row_count; ++lane)
            entry[lane] = sum[lane] / entry[column];
    }
    return true;
}

bool envelope_factor(envelope *e, double smallest_pivot, uint32_t *out_row)
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

static inline void solve(const envelope *e, double *restrict rhs, const int lanes)
{
    for (uint32_t i = 0; i < e->row_count; ++i) {
        const double *value = e->value + e->start[i];
        double *row = rhs + (size_t)i * (size_t)lanes;
        for (uint32_t k = e->first[i]; k < i; ++k, ++value)
            for (int lane = 0; lane < lanes; ++lane)
                row[lane] -= *value * rhs[(size_t)k * (size_t)lanes + (size_t)lane];
        for (int lane = 0; lane < lanes; ++lane)
            row[lane] /= *value;
    }
    for (uint32_t i = e->row_count; i-- > 0;) {
        const double *value = e->value + e->start[i];
        double *row = rhs + (size_t)i * (size_t)lanes;
        for (int lane = 0; lane < lanes; ++lane)
            row[lane] /= value[i - e->first[i]];
        for (uint32_t k = e->first[i]; k < i; ++k, ++value)
            for (int lane = 0; lane < lanes; ++lane)
                rhs[(size_t)k * (size_t)lanes + (size_t)lane] -= *value * row[lane];
    }
}

void envelope_solve_few(const envelope *e, double *rhs)
{
    solve(e, rhs, ENVELOPE_FEW);
}

void envelope_solve_many(const envelope *e, double *rhs)
{
    solve(e, rhs, ENVELOPE_MANY);
}
