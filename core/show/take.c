#include "show/take.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

const take_own_part take_own_part_of[TAKE_OWN_PARTS] = {
    {TAKE_PALETTE, TAKE_PALETTE_ID, TAKE_PALETTE_LAYER},
    {TAKE_LIFE, TAKE_LIFE_ID, TAKE_LIFE_LAYER}};

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
    free(p->patch);
    free(p->again.calibration[0]);
    free(p->again.calibration[1]);
    *p = (take_performance){0};
}

/* ---- shared texts ---- */

enum { TEXTS_MAX = 6 };

struct take_texts {
    _Atomic uint32_t holder_count;
    char *text[TEXTS_MAX]; /* owned */
};

static take_texts *make_texts(char *const text[TEXTS_MAX])
{
    take_texts *texts = calloc(1, sizeof *texts);
    if (!texts)
        return NULL;
    atomic_init(&texts->holder_count, 1);
    memcpy(texts->text, text, sizeof texts->text);
    return texts;
}

take_texts *take_track_texts(const take_track *t)
{
    char *const text[TEXTS_MAX] = {t->input, t->device, t->plugin, t->calibration[0],
                                   t->calibration[1]};
    return make_texts(text);
}

take_texts *take_performance_texts(const take_performance *p)
{
    char *const text[TEXTS_MAX] = {p->mapping,
                                   p->rig,
                                   p->rig_json,
                                   p->patch,
                                   p->again.calibration[0],
                                   p->again.calibration[1]};
    return make_texts(text);
}

take_texts *take_texts_hold(take_texts *self)
{
    atomic_fetch_add_explicit(&self->holder_count, 1, memory_order_relaxed);
    return self;
}

void take_texts_drop(take_texts *self)
{
    if (!self || atomic_fetch_sub(&self->holder_count, 1) > 1)
        return;
    for (int i = 0; i < TEXTS_MAX; ++i)
        free(self->text[i]);
    free(self);
}

/* ---- copies ---- */

/* Copies data. NULL: nothing to copy, or *out_failed is true and memory ran out. */
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

/* Returns floor(a b / c) and whether there is a remainder; UINT64_MAX if it does not fit. c > 0. */
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

/* Returns the exact distance, which may need all 64 bits. */
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

/* Returns `time_ns` moved by to_ns - from_ns. */
static int64_t moved(int64_t time_ns, int64_t from_ns, int64_t to_ns)
{
    bool back = to_ns < from_ns;
    uint64_t size = back ? distance(to_ns, from_ns) : distance(from_ns, to_ns);
    return saturated_sum(time_ns, signed_distance(size, back));
}

typedef enum rounding { ROUND_DOWN, ROUND_UP } rounding;

/* Returns y on the line through (x0, y0) and (x1, y1), both ascending. */
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

/* Returns the segment of the warp that contains `time_ns`, by the coordinate at `offset` of a
 * point. */
static uint32_t segment_of(const take_clip *clip, int64_t time_ns, bool by_source)
{
    uint32_t low = 0,
             high = clip->warp_count - 1; /* index among the points where a segment starts */
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

/* ---- the active clips at an instant ---- */

/* Returns the first clip that ends after t_ns; clips are sorted by start and by end. */
static uint32_t first_ending_after(const take_layer *layer, int64_t t_ns)
{
    uint32_t low = 0, high = layer->clip_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (layer->clip[middle].end_ns > t_ns)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Returns the neighbour that a clip cross-fades with at its start (-1) or its end (+1), or NULL. */
static const take_clip *overlapping(const take_layer *layer, uint32_t index, int direction)
{
    int64_t other = (int64_t)index + direction;
    if (other < 0 || other >= layer->clip_count)
        return NULL;
    const take_clip *clip = &layer->clip[index], *neighbour = &layer->clip[other];
    const take_clip *first = direction < 0 ? neighbour : clip;
    const take_clip *second = direction < 0 ? clip : neighbour;
    return !neighbour->is_muted && second->start_ns < first->end_ns ? neighbour : NULL;
}

/* Returns 0 at `from`, and 1 from `to` on. */
static double ramp(int64_t t_ns, int64_t from_ns, int64_t to_ns)
{
    if (t_ns >= to_ns)
        return 1.0;
    return t_ns <= from_ns ? 0.0 : (double)(t_ns - from_ns) / (double)(to_ns - from_ns);
}

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* A fade does not enter the cross-fade at the other end, because weights sum to 1 there. */
static double weight_at(const take_layer *layer, uint32_t index, int64_t t_ns)
{
    const take_clip *clip = &layer->clip[index];
    const take_clip *before = overlapping(layer, index, -1);
    const take_clip *after = overlapping(layer, index, +1);
    int64_t alone_from_ns = before ? before->end_ns : clip->start_ns;
    int64_t alone_to_ns = after ? after->start_ns : clip->end_ns;
    double weight = 1.0;
    if (before)
        weight *= ramp(t_ns, clip->start_ns, before->end_ns);
    else if (clip->fade_in_ns > 0)
        weight *= ramp(t_ns, clip->start_ns,
                       clip->start_ns + least(clip->fade_in_ns, alone_to_ns - clip->start_ns));
    if (after)
        weight *= 1.0 - ramp(t_ns, after->start_ns, clip->end_ns);
    else if (clip->fade_out_ns > 0)
        weight *=
            1.0 - ramp(t_ns, clip->end_ns - least(clip->fade_out_ns, clip->end_ns - alone_from_ns),
                       clip->end_ns);
    return weight;
}

uint32_t take_at(take_voice out[2], const take_layer *layer, int64_t at_ns)
{
    int64_t t_ns = at_ns - layer->offset_ns;
    uint32_t count = 0;
    for (uint32_t i = first_ending_after(layer, t_ns); i < layer->clip_count && count < 2; ++i) {
        const take_clip *clip = &layer->clip[i];
        if (clip->start_ns > t_ns)
            break;
        if (!clip->is_muted)
            out[count++] = (take_voice){.clip = clip,
                                        .source_ns = take_warp_to_source(clip, t_ns),
                                        .weight = weight_at(layer, i, t_ns)};
    }
    return count;
}
