#include "csrbf/envelope.h"

#include "csrbf/lanes.h"

#include <stdlib.h>
#include <string.h>

bool envelope_create(envelope *out, uint32_t row_capacity)
{
    size_t rows = row_capacity;
    *out = (envelope){.row_capacity = row_capacity, .lanes = lanes_now()};
    out->first = calloc(rows + 1, sizeof *out->first);
    out->start = calloc(rows + 1, sizeof *out->start);
    out->value = calloc(rows * (rows + 1) / 2 + 1, sizeof *out->value);
    out->group =
        aligned_alloc(64, (rows + 1) * ENVELOPE_GROUPS * ENVELOPE_LANES * sizeof *out->group);
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

void envelope_keep(envelope *e, uint32_t row_count)
{
    e->row_count = row_count;
    e->factored_count = row_count;
    e->start[0] = 0;
}

void envelope_take(envelope *e, const envelope *from, uint32_t first, uint32_t row_count)
{
    const size_t begin = from->start[first], end = from->start[row_count];
    memcpy(e->first + first, from->first + first, (row_count - first) * sizeof *e->first);
    memcpy(e->start + first, from->start + first, (row_count - first + 1) * sizeof *e->start);
    memcpy(e->value + begin, from->value + begin, (end - begin) * sizeof *e->value);
    envelope_keep(e, row_count);
}

double *envelope_add_row(envelope *e, uint32_t first)
{
    uint32_t row = e->row_count++;
    e->first[row] = first;
    e->start[row + 1] = e->start[row] + (row - first + 1);
    return e->value + e->start[row];
}

bool envelope_factor(envelope *e, double smallest_pivot, uint32_t *out_row)
{
    if (!e->lanes->factor(e, smallest_pivot, out_row))
        return false;
    e->factored_count = e->row_count;
    return true;
}

void envelope_solve_few(const envelope *e, double *rhs)
{
    e->lanes->solve_few(e, rhs);
}

void envelope_solve_many(const envelope *e, double *rhs)
{
    e->lanes->solve_many(e, rhs);
}
