#include "csrbf/tangents.h"

#include "base/large.h"
#include "csrbf/lanes.h"
#include "csrbf/response.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As many points as `like`, all at zero. */
static mrt_result create_rows(points *out, const points *like, error *err)
{
    points_order order = {0};
    float *zeros = calloc((size_t)3 * like->count + 1, sizeof *zeros);
    if (!zeros)
        return error_set(err, MRT_ERR_MEMORY, "no memory for tangents at %u vertices", like->count);
    mrt_result result = points_order_create(&order, zeros, like->count, err);
    if (result >= 0)
        result = points_create(out, &order, zeros, err);
    points_order_destroy(&order);
    free(zeros);
    return result;
}

mrt_result tangents_create(tangents *out, const points *like, uint32_t capacity, error *err)
{
    *out = (tangents){0};
    mrt_result result = create_rows(&out->first, like, err);
    if (result >= 0)
        result = create_rows(&out->second, like, err);
    if (result >= 0)
        result = columns_create(&out->along1, like, capacity, err);
    if (result >= 0)
        result = columns_create(&out->along2, like, capacity, err);
    if (result >= 0)
        result = columns_packed_create(&out->packed1, &out->along1, err);
    if (result >= 0)
        result = columns_packed_create(&out->packed2, &out->along2, err);
    out->rest = large_alloc((size_t)6 * like->padded_count * sizeof *out->rest);
    if (result >= 0 && !out->rest)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for tangents");
    if (result < 0)
        tangents_destroy(out);
    return result;
}

void tangents_destroy(tangents *t)
{
    if (!t)
        return;
    points_destroy(&t->first);
    points_destroy(&t->second);
    columns_destroy(&t->along1);
    columns_destroy(&t->along2);
    columns_packed_destroy(&t->packed1);
    columns_packed_destroy(&t->packed2);
    free(t->rest);
    t->rest = NULL;
}

/* Two unit vectors across (x, y, z), which is unit: away from its largest component. */
static void span(float a[3], float b[3], float x, float y, float z)
{
    bool flat = fabsf(z) < 0.7f;
    float ux = flat ? y : 0.0f, uy = flat ? -x : z, uz = flat ? 0.0f : -y;
    float square = ux * ux + uy * uy + uz * uz;
    float inverse = 1.0f / sqrtf(square > 1e-30f ? square : 1.0f);
    a[0] = ux * inverse;
    a[1] = uy * inverse;
    a[2] = uz * inverse;
    b[0] = y * a[2] - z * a[1];
    b[1] = z * a[0] - x * a[2];
    b[2] = x * a[1] - y * a[0];
}

static void set_tangents(tangents *t, const float *const n[3])
{
    for (uint32_t slot = 0; slot < t->first.padded_count; ++slot) {
        float a[3], b[3];
        span(a, b, n[0][slot], n[1][slot], n[2][slot]);
        t->first.x[slot] = a[0];
        t->first.y[slot] = a[1];
        t->first.z[slot] = a[2];
        t->second.x[slot] = b[0];
        t->second.y[slot] = b[1];
        t->second.z[slot] = b[2];
    }
}

static void pack_rest(tangents *t)
{
    const float *const row[6] = {t->first.x,  t->first.y,  t->first.z,
                                 t->second.x, t->second.y, t->second.z};
    for (size_t slot = 0; slot < t->first.padded_count; ++slot)
        for (size_t k = 0; k < 6; ++k) {
            size_t block = slot / POINTS_BLOCK;
            t->rest[(6 * block + k) * POINTS_BLOCK + slot % POINTS_BLOCK] =
                (int16_t)lrintf(row[k][slot] * TANGENTS_UNIT);
        }
}

bool tangents_engage(tangents *t, const csrbf_solver *solver, const points *base,
                     const float *const n[3], uint32_t count)
{
    if (!csrbf_derivatives(solver, &t->along1, &t->along2, base, NULL, NULL))
        return false;
    set_tangents(t, n);
    pack_rest(t);
    (void)csrbf_derivatives(solver, &t->along1, &t->along2, base, &t->first, &t->second);
    columns_note(&t->along1, count);
    columns_note(&t->along2, count);
    columns_packed_take(&t->packed1, &t->along1);
    columns_packed_take(&t->packed2, &t->along2);
    return true;
}

void tangents_weigh(tangents *t, const double *displacement)
{
    columns_packed_weigh(&t->packed1, &t->along1, displacement);
    columns_packed_weigh(&t->packed2, &t->along2, displacement);
}

void tangents_normals_blocks(const tangents *t, float *const n[3], const uint8_t *wanted,
                             uint32_t first, uint32_t end)
{
    t->along1.lanes->normals(t, n, wanted, first, end);
}

void tangents_normals(tangents *t, float *const n[3], const double *displacement)
{
    tangents_weigh(t, displacement);
    tangents_normals_blocks(t, n, NULL, 0, t->along1.block_count);
}
