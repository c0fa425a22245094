#include "csrbf/order.h"

#include <stdbool.h>
#include <string.h>

enum { AXIS_BITS = 21 };

/* Puts two zero bits between each two bits of a 21-bit number. */
static uint64_t spread_bits(uint64_t v)
{
    v = (v | v << 32) & 0x001f00000000ffffu;
    v = (v | v << 16) & 0x001f0000ff0000ffu;
    v = (v | v << 8) & 0x100f00f00f00f00fu;
    v = (v | v << 4) & 0x10c30c30c30c30c3u;
    v = (v | v << 2) & 0x1249249249249249u;
    return v;
}

/* 0 .. 2^21 - 1; extent > 0. */
static uint64_t cell(double offset, double extent)
{
    const double last = (double)((1u << AXIS_BITS) - 1);
    double position = offset / extent * last;
    return position < last ? (uint64_t)position : (uint64_t)last;
}

static void compute_keys(order_item *item, uint32_t count)
{
    double low[3], extent = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        double high = item[0].at[axis];
        low[axis] = high;
        for (uint32_t i = 1; i < count; ++i) {
            double at = item[i].at[axis];
            low[axis] = at < low[axis] ? at : low[axis];
            high = at > high ? at : high;
        }
        extent = high - low[axis] > extent ? high - low[axis] : extent;
    }
    for (uint32_t i = 0; i < count; ++i) {
        item[i].key = 0;
        for (int axis = 0; axis < 3 && extent > 0.0; ++axis)
            item[i].key |= spread_bits(cell(item[i].at[axis] - low[axis], extent)) << axis;
    }
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

void order_sort(order_item *item, order_item *scratch, uint32_t count)
{
    if (count < 2)
        return;
    compute_keys(item, count);
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
