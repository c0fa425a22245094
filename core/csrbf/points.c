#include "csrbf/points.h"

#include "base/large.h"
#include "csrbf/block_range.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- orders ---- */

enum { AXIS_BITS = 21 };

/* Inserts two zero bits between each two bits of a 21-bit number. */
static uint64_t spread_bits(uint64_t v)
{
    v = (v | v << 32) & 0x001f00000000ffffu;
    v = (v | v << 16) & 0x001f0000ff0000ffu;
    v = (v | v << 8) & 0x100f00f00f00f00fu;
    v = (v | v << 4) & 0x10c30c30c30c30c3u;
    v = (v | v << 2) & 0x1249249249249249u;
    return v;
}

/* Returns a cell number 0 .. 2^21 - 1; extent > 0. */
static uint64_t cell(double offset, double extent)
{
    const double last = (double)((1u << AXIS_BITS) - 1);
    double position = offset / extent * last;
    return position < last ? (uint64_t)position : (uint64_t)last;
}

typedef struct extent {
    double low[3], size[3];
} extent;

static extent extent_of(const order_item *item, uint32_t count)
{
    extent out;
    for (int axis = 0; axis < 3; ++axis) {
        double low = item[0].at[axis], high = low;
        for (uint32_t i = 1; i < count; ++i) {
            double at = item[i].at[axis];
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        out.low[axis] = low;
        out.size[axis] = high - low;
    }
    return out;
}

static int longest_axis(const extent *e)
{
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        longest = e->size[axis] > e->size[longest] ? axis : longest;
    return longest;
}

static void compute_curve_keys(order_item *item, uint32_t count)
{
    const extent e = extent_of(item, count);
    const double side = e.size[longest_axis(&e)];
    for (uint32_t i = 0; i < count; ++i) {
        item[i].key = 0;
        for (int axis = 0; axis < 3 && side > 0.0; ++axis)
            item[i].key |= spread_bits(cell(item[i].at[axis] - e.low[axis], side)) << axis;
    }
}

/* Maps doubles to integers in the same order. */
static uint64_t rank_of(double value)
{
    const uint64_t sign = UINT64_C(1) << 63;
    uint64_t bits;
    value += 0.0; /* makes -0 equal to 0 */
    memcpy(&bits, &value, sizeof bits);
    return bits & sign ? ~bits : bits | sign;
}

static int compute_axis_keys(order_item *item, uint32_t count)
{
    const extent e = extent_of(item, count);
    const int axis = longest_axis(&e);
    for (uint32_t i = 0; i < count; ++i)
        item[i].key = rank_of(item[i].at[axis]);
    return axis;
}

static bool comes_before(const order_item *a, const order_item *b)
{
    if (a->key != b->key)
        return a->key < b->key;
    for (int axis = 0; axis < 3; ++axis)
        if (a->at[axis] != b->at[axis])
            return a->at[axis] < b->at[axis];
    return a->row < b->row;
}

static void merge_runs(order_item *out, const order_item *a, uint32_t a_count, const order_item *b,
                       uint32_t b_count)
{
    uint32_t i = 0, j = 0;
    while (i < a_count && j < b_count)
        *out++ = comes_before(&b[j], &a[i]) ? b[j++] : a[i++];
    memcpy(out, a + i, (size_t)(a_count - i) * sizeof *out);
    memcpy(out + (a_count - i), b + j, (size_t)(b_count - j) * sizeof *out);
}

static uint32_t smaller(uint64_t a, uint64_t b)
{
    return (uint32_t)(a < b ? a : b);
}

static void sort_by_keys(order_item *item, order_item *scratch, uint32_t count)
{
    order_item *from = item, *to = scratch;
    for (uint64_t run = 1; run < count; run *= 2) {
        for (uint64_t at = 0; at < count; at += 2 * run) {
            uint32_t a_count = smaller(run, count - at);
            uint32_t b_count = smaller(run, count - at - a_count);
            merge_runs(to + at, from + at, a_count, from + at + a_count, b_count);
        }
        order_item *swap = from;
        from = to;
        to = swap;
    }
    if (from != item)
        memcpy(item, from, (size_t)count * sizeof *item);
}

void order_sort(order_item *item, order_item *scratch, uint32_t count)
{
    if (count < 2)
        return;
    compute_curve_keys(item, count);
    sort_by_keys(item, scratch, count);
}

int order_sort_along(order_item *item, order_item *scratch, uint32_t count)
{
    if (count < 2)
        return 0;
    int axis = compute_axis_keys(item, count);
    sort_by_keys(item, scratch, count);
    return axis;
}

/* ---- points ---- */

enum { STAGGER = 80 }; /* floats between two streams: not a power of two */

static bool usable(float v)
{
    return fabsf(v) <= POINTS_REACH; /* false for NaN */
}

static mrt_result check_rows(const float *xyz, uint32_t count, error *err)
{
    for (uint32_t i = 0; i < count; ++i)
        for (size_t axis = 0; axis < 3; ++axis)
            if (!usable(xyz[(size_t)3 * i + axis]))
                return error_set(err, MRT_ERR_ARGUMENT,
                                 "vertex %u: coordinate %g is not within +-%g", i,
                                 (double)xyz[(size_t)3 * i + axis], (double)POINTS_REACH);
    return MRT_OK;
}

mrt_result points_order_create(points_order *out, const float *xyz, uint32_t count, error *err)
{
    *out = (points_order){.count = count};
    mrt_result result = check_rows(xyz, count, err);
    if (result < 0)
        return result;
    order_item *item = calloc((size_t)count + 1, sizeof *item);
    order_item *scratch = calloc((size_t)count + 1, sizeof *scratch);
    out->file_of_slot = calloc((size_t)count + 1, sizeof *out->file_of_slot);
    out->slot_of_file = calloc((size_t)count + 1, sizeof *out->slot_of_file);
    if (!item || !scratch || !out->file_of_slot || !out->slot_of_file) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory to order %u vertices", count);
        points_order_destroy(out);
    } else {
        for (uint32_t i = 0; i < count; ++i) {
            item[i].row = i;
            for (size_t axis = 0; axis < 3; ++axis)
                item[i].at[axis] = (double)xyz[(size_t)3 * i + axis];
        }
        order_sort(item, scratch, count);
        for (uint32_t slot = 0; slot < count; ++slot) {
            out->file_of_slot[slot] = item[slot].row;
            out->slot_of_file[item[slot].row] = slot;
        }
    }
    free(scratch);
    free(item);
    return result;
}

void points_order_destroy(points_order *order)
{
    if (!order)
        return;
    free(order->file_of_slot);
    free(order->slot_of_file);
    *order = (points_order){0};
}

mrt_result points_create(points *out, const points_order *order, const float *xyz, error *err)
{
    *out = (points){.count = order->count};
    mrt_result result = check_rows(xyz, order->count, err);
    if (result < 0)
        return result;
    size_t blocks = ((size_t)order->count + POINTS_BLOCK - 1) / POINTS_BLOCK;
    size_t stream = blocks * POINTS_BLOCK + STAGGER;
    if (blocks * POINTS_BLOCK > UINT32_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%u vertices are too many", order->count);
    out->block_count = (uint32_t)blocks;
    out->padded_count = (uint32_t)(blocks * POINTS_BLOCK);
    out->x = large_alloc(3 * stream * sizeof(float));
    out->block = calloc(blocks + 1, sizeof *out->block);
    if (!out->x || !out->block) {
        points_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u vertices", order->count);
    }
    memset(out->x, 0, 3 * stream * sizeof(float));
    out->y = out->x + stream;
    out->z = out->y + stream;
    for (uint32_t slot = 0; slot < out->padded_count; ++slot) {
        uint32_t last = order->count - 1;
        const float *row = xyz + (size_t)3 * order->file_of_slot[slot < last ? slot : last];
        out->x[slot] = row[0];
        out->y[slot] = row[1];
        out->z[slot] = row[2];
    }
    points_update_bounds(out);
    return MRT_OK;
}

void points_destroy(points *p)
{
    if (!p)
        return;
    large_free(p->x);
    free(p->block);
    *p = (points){0};
}

void points_copy(points *out, const points *from)
{
    size_t stream = (size_t)from->padded_count * sizeof(float);
    memcpy(out->x, from->x, stream);
    memcpy(out->y, from->y, stream);
    memcpy(out->z, from->z, stream);
    memcpy(out->block, from->block, (size_t)from->block_count * sizeof *from->block);
}

void points_copy_block(points *out, const points *from, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK, size = POINTS_BLOCK * sizeof(float);
    memcpy(out->x + first, from->x + first, size);
    memcpy(out->y + first, from->y + first, size);
    memcpy(out->z + first, from->z + first, size);
    out->block[block] = from->block[block];
}

void points_to_rows(float *out_xyz, const points *p, const points_order *order)
{
    for (uint32_t slot = 0; slot < p->count; ++slot) {
        float *row = out_xyz + (size_t)3 * order->file_of_slot[slot];
        row[0] = p->x[slot];
        row[1] = p->y[slot];
        row[2] = p->z[slot];
    }
}

_Static_assert((int)BLOCK_RANGE == (int)POINTS_BLOCK, "a range is that of a block");

void points_update_block(points *p, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    points_bounds *b = &p->block[block];
    block_range(b->low, b->high, p->x + first, p->y + first, p->z + first);
}

void points_update_bounds(points *p)
{
    for (uint32_t block = 0; block < p->block_count; ++block)
        points_update_block(p, block);
}

void points_at(double out[3], const points *p, size_t slot)
{
    out[0] = (double)p->x[slot];
    out[1] = (double)p->y[slot];
    out[2] = (double)p->z[slot];
}

const float *const *points_streams(const points *p, const float *out[3])
{
    out[0] = p->x;
    out[1] = p->y;
    out[2] = p->z;
    return out;
}

points_bounds points_extent(const points *p)
{
    points_bounds all = {{0}, {0}};
    for (uint32_t block = 0; block < p->block_count; ++block)
        for (int axis = 0; axis < 3; ++axis) {
            float low = p->block[block].low[axis], high = p->block[block].high[axis];
            if (block == 0 || low < all.low[axis])
                all.low[axis] = low;
            if (block == 0 || high > all.high[axis])
                all.high[axis] = high;
        }
    return all;
}

bool points_are_usable(const points *p)
{
    for (uint32_t block = 0; block < p->block_count; ++block) {
        size_t first = (size_t)block * POINTS_BLOCK;
        unsigned refused = 0; /* counted without branches, so that it is vectorised */
        for (size_t i = first; i < first + POINTS_BLOCK; ++i) {
            refused += !usable(p->x[i]);
            refused += !usable(p->y[i]);
            refused += !usable(p->z[i]);
        }
        if (refused > 0)
            return false;
    }
    return true;
}

double points_bounds_distance_squared(const points_bounds *bounds, const double at[3])
{
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        double below = (double)bounds->low[axis] - at[axis];
        double above = at[axis] - (double)bounds->high[axis];
        double outside = below > above ? below : above;
        if (outside > 0.0)
            sum += outside * outside;
    }
    return sum;
}

uint32_t points_nearest(const points *p, vec3 at)
{
    const double x[3] = {at.x, at.y, at.z};
    double best = (double)INFINITY;
    uint32_t found = 0;
    for (uint32_t block = 0; block < p->block_count; ++block) {
        uint32_t first = block * POINTS_BLOCK;
        if (points_bounds_distance_squared(&p->block[block], x) >= best)
            continue;
        for (uint32_t slot = first; slot < first + POINTS_BLOCK && slot < p->count; ++slot) {
            vec3 way = vec3_sub(points_position(p, slot), at);
            double square = vec3_dot(way, way);
            if (square < best) {
                best = square;
                found = slot;
            }
        }
    }
    return found;
}
