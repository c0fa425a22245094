#include "csrbf/envelope.h"

#include "csrbf/lanes.h"

#include <stdlib.h>

bool envelope_create(envelope *out, uint32_t row_capacity)
{
    size_t rows = row_capacity;
    *out = (envelope){.row_capacity = row_capacity, .lanes = lanes_now()};
    out->first = calloc(rows + 1, sizeof *out->first);
    out->start = calloc(rows + 1, sizeof *out->start);
    out->value = calloc(rows * (rows + 1) / 2 + 1, sizeof *out->value);
    out->group = aligned_alloc(64, (rows + 1) * ENVELOPE_LANES * sizeof *out->group);
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

bool envelope_factor(envelope *e, double smallest_pivot, uint32_t *out_row)
{
    return e->lanes->factor(e, smallest_pivot, out_row);
}

void envelope_solve_few(const envelope *e, double *rhs)
{
    e->lanes->solve_few(e, rhs);
}

void envelope_solve_many(const envelope *e, double *rhs)
{
    e->lanes->solve_many(e, rhs);
}
