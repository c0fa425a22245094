#include "take/take.h"

/* The first clip that ends after t_ns; clips are ordered by start and by end. */
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

/* The neighbour with which a clip cross-fades at its start (-1) or its end (+1), or NULL. */
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

/* 0 at `from`, 1 from `to` on. */
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

/* A fade keeps out of the cross-fade at the other end: there weights sum to 1. */
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
