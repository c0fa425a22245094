#include "take/take.h"

#include <stdlib.h>
#include <string.h>

/* ---- lifetime ---- */

static void layer_finish(take_layer *layer)
{
    for (uint32_t i = 0; layer->clip && i < layer->clip_count; ++i)
        free(layer->clip[i].warp);
    free(layer->clip);
    free(layer->own);
}

void take_finish(take *t)
{
    if (!t)
        return;
    for (uint32_t i = 0; t->layer && i < t->layer_count; ++i)
        layer_finish(&t->layer[i]);
    free(t->layer);
    free(t->marker);
    *t = (take){0};
}

void take_track_finish(take_track *t)
{
    if (!t)
        return;
    free(t->input);
    free(t->device);
    free(t->plugin);
    free(t->calibration[0]);
    free(t->calibration[1]);
    *t = (take_track){0};
}

void take_performance_finish(take_performance *p)
{
    if (!p)
        return;
    free(p->mapping);
    free(p->rig);
    free(p->rig_json);
    free(p->again.calibration[0]);
    free(p->again.calibration[1]);
    *p = (take_performance){0};
}

/* ---- copies ---- */

/* NULL for nothing to copy: *out_failed tells that from no memory. */
static void *copy_of(const void *data, size_t size, size_t count, bool *out_failed)
{
    if (count == 0)
        return NULL;
    void *copy = calloc(count, size);
    if (copy)
        memcpy(copy, data, size * count);
    else
        *out_failed = true;
    return copy;
}

static void layer_copy(take_layer *out, const take_layer *layer, bool *out_failed)
{
    *out = *layer;
    out->own = copy_of(layer->own, sizeof *layer->own, layer->own_count, out_failed);
    out->clip = copy_of(layer->clip, sizeof *layer->clip, layer->clip_count, out_failed);
    for (uint32_t i = 0; out->clip && i < layer->clip_count; ++i) {
        const take_clip *clip = &layer->clip[i];
        out->clip[i].warp = copy_of(clip->warp, sizeof *clip->warp, clip->warp_count, out_failed);
    }
}

mrt_result take_copy(take *out, const take *t, error *err)
{
    bool failed = false;
    take copy = *t;
    copy.marker = copy_of(t->marker, sizeof *t->marker, t->marker_count, &failed);
    copy.layer = copy_of(t->layer, sizeof *t->layer, t->layer_count, &failed);
    for (uint32_t i = 0; copy.layer && i < t->layer_count; ++i)
        layer_copy(&copy.layer[i], &t->layer[i], &failed);
    *out = copy;
    if (!failed)
        return MRT_OK;
    take_finish(out);
    return error_set(err, MRT_ERR_MEMORY, "take %lld: no memory for a copy", (long long)t->id);
}

/* ---- time ---- */

/* floor(a b / c) and whether something was left over; UINT64_MAX when it does not fit. c > 0. */
static uint64_t multiply_divide(uint64_t a, uint64_t b, uint64_t c, bool *out_rest)
{
    uint64_t low = (a & UINT32_MAX) * (b & UINT32_MAX);
    uint64_t middle = (a >> 32) * (b & UINT32_MAX) + (low >> 32);
    uint64_t other = (a & UINT32_MAX) * (b >> 32) + (middle & UINT32_MAX);
    uint64_t high = (a >> 32) * (b >> 32) + (middle >> 32) + (other >> 32);
    low = (other << 32) | (low & UINT32_MAX);
    *out_rest = false;
    if (high == 0) {
        *out_rest = low % c != 0;
        return low / c;
    }
    if (high >= c)
        return UINT64_MAX;
    uint64_t quotient = 0;
    for (int bit = 63; bit >= 0; --bit) {
        bool carry = high >> 63;
        high = (high << 1) | ((low >> bit) & 1);
        quotient <<= 1;
        if (carry || high >= c) {
            high -= c;
            quotient |= 1;
        }
    }
    *out_rest = high != 0;
    return quotient;
}

static int64_t saturated_sum(int64_t a, int64_t b)
{
    if (b > 0 && a > INT64_MAX - b)
        return INT64_MAX;
    if (b < 0 && a < INT64_MIN - b)
        return INT64_MIN;
    return a + b;
}

/* Exact distance, which may need all 64 bits. */
static uint64_t distance(int64_t low, int64_t high)
{
    return (uint64_t)high - (uint64_t)low;
}

static int64_t signed_distance(uint64_t size, bool negative)
{
    if (size > INT64_MAX)
        return negative ? INT64_MIN : INT64_MAX;
    return negative ? -(int64_t)size : (int64_t)size;
}

/* `time_ns` moved as far as it is from `from_ns` to `to_ns`. */
static int64_t moved(int64_t time_ns, int64_t from_ns, int64_t to_ns)
{
    bool back = to_ns < from_ns;
    uint64_t size = back ? distance(to_ns, from_ns) : distance(from_ns, to_ns);
    return saturated_sum(time_ns, signed_distance(size, back));
}

typedef enum rounding { ROUND_DOWN, ROUND_UP } rounding;

/* y on the line through (x0, y0) and (x1, y1), both ascending. */
static int64_t line_at(int64_t x, const int64_t x_end[2], const int64_t y_end[2], rounding round)
{
    bool before = x < x_end[0];
    uint64_t from_start = before ? distance(x, x_end[0]) : distance(x_end[0], x);
    bool rest;
    uint64_t size = multiply_divide(from_start, distance(y_end[0], y_end[1]),
                                    distance(x_end[0], x_end[1]), &rest);
    if (rest && size != UINT64_MAX && before == (round == ROUND_DOWN))
        ++size;
    return saturated_sum(y_end[0], signed_distance(size, before));
}

/* The segment of the warp in which `time_ns` lies, by the coordinate at `offset` of a point. */
static uint32_t segment_of(const take_clip *clip, int64_t time_ns, bool by_source)
{
    uint32_t low = 0, high = clip->warp_count - 1; /* of the points where a segment starts */
    while (low + 1 < high) {
        uint32_t middle = low + (high - low) / 2;
        const take_warp_point *point = &clip->warp[middle];
        if ((by_source ? point->source_ns : point->at_ns) <= time_ns)
            low = middle;
        else
            high = middle;
    }
    return low;
}

int64_t take_warp_to_source(const take_clip *clip, int64_t at_ns)
{
    if (clip->warp_count == 0)
        return at_ns;
    const take_warp_point *p = clip->warp;
    if (clip->warp_count == 1)
        return moved(p->source_ns, p->at_ns, at_ns);
    p += segment_of(clip, at_ns, false);
    return line_at(at_ns, (int64_t[]){p[0].at_ns, p[1].at_ns},
                   (int64_t[]){p[0].source_ns, p[1].source_ns}, ROUND_DOWN);
}

int64_t take_warp_to_timeline(const take_clip *clip, int64_t source_ns)
{
    if (clip->warp_count == 0)
        return source_ns;
    const take_warp_point *p = clip->warp;
    if (clip->warp_count == 1)
        return moved(p->at_ns, p->source_ns, source_ns);
    p += segment_of(clip, source_ns, true);
    return line_at(source_ns, (int64_t[]){p[0].source_ns, p[1].source_ns},
                   (int64_t[]){p[0].at_ns, p[1].at_ns}, ROUND_UP);
}
