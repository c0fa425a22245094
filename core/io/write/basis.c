#include "io/write/basis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double basis_dot(const float *a, const float *b, size_t length)
{
    enum { LANES = 8 }; /* independent sums, which the processor can compute in parallel */
    double sum[LANES] = {0.0};
    size_t d = 0;
    for (; d + LANES <= length; d += LANES)
        for (size_t lane = 0; lane < LANES; ++lane)
            sum[lane] += (double)a[d + lane] * (double)b[d + lane];
    for (; d < length; ++d)
        sum[0] += (double)a[d] * (double)b[d];
    return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

void basis_subtract(float *out, float weight, const float *axis, size_t length)
{
    for (size_t d = 0; d < length; ++d)
        out[d] -= weight * axis[d];
}

/* Removes the axes in use from the row, twice because once is not enough in float32. Scales the row
 * to unit length. Returns false if only rounding errors were left. */
static bool orthonormalise(const basis *b, float *row)
{
    double before = sqrt(basis_dot(row, row, b->length));
    for (int pass = 0; pass < 2; ++pass)
        for (size_t j = 0; j < b->count; ++j) {
            const float *axis = b->axis + j * b->length;
            basis_subtract(row, (float)basis_dot(row, axis, b->length), axis, b->length);
        }
    double after = sqrt(basis_dot(row, row, b->length));
    if (!(after > 1e-5 * before) || !(after > 1e-30))
        return false;
    for (size_t d = 0; d < b->length; ++d)
        row[d] = (float)((double)row[d] / after);
    return true;
}

static bool reserve(basis *b, size_t row_count)
{
    if (row_count <= b->capacity)
        return true;
    size_t wanted = row_count + row_count / 4 + 8;
    if (wanted > b->cap)
        wanted = b->cap;
    float *grown = realloc(b->axis, wanted * b->length * sizeof *grown);
    if (!grown)
        return false;
    b->axis = grown;
    b->capacity = wanted;
    return true;
}

bool basis_add(basis *b, const float *residual)
{
    if (b->count == b->cap || !reserve(b, b->count + 1))
        return false;
    float *row = b->axis + b->count * b->length;
    memcpy(row, residual, b->length * sizeof *row);
    if (!orthonormalise(b, row))
        return false;
    b->count++;
    return true;
}

bool basis_add_candidate(basis *b)
{
    while (b->next < b->candidate_count && b->count < b->cap)
        if (basis_add(b, b->candidate + b->next++ * b->length))
            return true;
    return false;
}

void basis_finish(basis *b)
{
    free(b->axis);
    free(b->candidate);
    *b = (basis){0};
}
