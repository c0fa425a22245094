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

/* Numbers in the order of the doubles. */
static uint64_t rank_of(double value)
{
    const uint64_t sign = UINT64_C(1) << 63;
    uint64_t bits;
    value += 0.0; /* there is one zero */
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
