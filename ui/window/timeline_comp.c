#include "window/timeline_drag.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FADE_NS     100000000LL /* of a span that is punched in; less where it is short */
#define SHORTEST_NS 20000000LL  /* that can be swiped */

static bool meets(const take_layer *layer, own_region region)
{
    const own_part *part = own_part_of(region);
    for (uint32_t i = 0; i < layer->own_count; ++i)
        for (uint32_t k = 0; k < part->pattern_count; ++k)
            if (own_patterns_meet(layer->own[i], part->pattern[k]))
                return true;
    return layer->own_count == 0;
}

static const take_clip *clip_at(const take_layer *layer, int64_t at_ns)
{
    take_voice voice[2];
    uint32_t count = take_at(voice, layer, at_ns - layer->offset_ns);
    if (count == 0)
        return NULL;
    return count == 2 && voice[1].weight > voice[0].weight ? voice[1].clip : voice[0].clip;
}

typedef struct origin { /* of what is comped */
    const take_layer *layer;
    const take_clip *clip;
} origin;

/* The topmost layer that moves the region there; OWN_REGION_COUNT: the lowest that speaks. */
static origin find_origin(const take *from, own_region region, int64_t at_ns)
{
    for (uint32_t n = 0; n < from->layer_count; ++n) {
        bool is_all = region == OWN_REGION_COUNT;
        uint32_t index = is_all ? n : from->layer_count - 1 - n;
        const take_layer *layer = &from->layer[index];
        const take_clip *clip = clip_at(layer, at_ns);
        if (clip && own_layer_is_heard(from, index) && (is_all || meets(layer, region)))
            return (origin){layer, clip};
    }
    return (origin){NULL, NULL};
}

/* The curve of the origin, on the timeline of the take that it comes into. */
static mrt_result give_warp(edit *e, origin of, int64_t later_ns, error *err)
{
    int64_t by_ns = of.layer->offset_ns + later_ns;
    if (of.clip->warp_count == 1) {
        e->source_ns = take_warp_to_source(of.clip, e->in_ns - by_ns);
        return MRT_OK;
    }
    e->warp = calloc(of.clip->warp_count, sizeof *e->warp);
    if (!e->warp)
        return error_set(err, MRT_ERR_MEMORY, "comp: no memory for a curve");
    e->warp_count = of.clip->warp_count;
    for (uint32_t i = 0; i < e->warp_count; ++i)
        e->warp[i] = (take_warp_point){of.clip->warp[i].at_ns + by_ns, of.clip->warp[i].source_ns};
    return MRT_OK;
}

static mrt_result fill(edit *e, origin of, int64_t later_ns, int64_t in_ns, int64_t out_ns,
                       error *err)
{
    e->performance = of.clip->performance;
    e->from_ns = of.clip->from_ns;
    e->to_ns = of.clip->to_ns;
    e->in_ns = in_ns;
    e->out_ns = out_ns;
    e->fade_ns = (out_ns - in_ns) / 4 < FADE_NS ? (out_ns - in_ns) / 4 : FADE_NS;
    return give_warp(e, of, later_ns, err);
}

/* What of in..out the origins of all regions show. */
static bool clamp_span(const take *from, int64_t later_ns, uint32_t regions, int64_t *in_ns,
                       int64_t *out_ns)
{
    int64_t middle_ns = *in_ns + (*out_ns - *in_ns) / 2 - later_ns;
    bool has_some = false;
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        own_region of = regions == TIMELINE_ALL_REGIONS ? OWN_REGION_COUNT : (own_region)region;
        origin o = find_origin(from, of, middle_ns);
        if (!(regions & 1u << region) || !o.clip)
            continue;
        has_some = true;
        int64_t by_ns = o.layer->offset_ns + later_ns;
        if (*in_ns < o.clip->start_ns + by_ns)
            *in_ns = o.clip->start_ns + by_ns;
        if (*out_ns > o.clip->end_ns + by_ns)
            *out_ns = o.clip->end_ns + by_ns;
    }
    return has_some;
}

static uint32_t lowest_layer(const take *t)
{
    return t->layer_count ? t->layer[0].id : 0;
}

static uint32_t give_up(edit *out, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        edit_finish(&out[i]);
    return 0;
}

uint32_t timeline_comp_edits(edit out[TIMELINE_DRAG_EDITS], const take *t, const take *from,
                             int64_t later_ns, uint32_t regions, uint32_t layer, int64_t *in_ns,
                             int64_t *out_ns, error *err)
{
    bool is_all = regions == TIMELINE_ALL_REGIONS;
    if (!clamp_span(from, later_ns, regions, in_ns, out_ns) || *out_ns - *in_ns < SHORTEST_NS) {
        (void)error_set(err, MRT_ERR_ARGUMENT,
                        "that take shows nothing of these parts there; swipe where its lane has a "
                        "curve");
        return 0;
    }
    int64_t middle_ns = *in_ns + (*out_ns - *in_ns) / 2 - later_ns;
    uint32_t count = 0;
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        if (!(regions & 1u << region) || (is_all && count))
            continue;
        origin o = find_origin(from, is_all ? OWN_REGION_COUNT : (own_region)region, middle_ns);
        if (!o.clip)
            continue;
        edit *e = &out[count++];
        edit_init(e, is_all ? EDIT_PUNCH : EDIT_COMP);
        e->layer = !is_all ? 0 : layer ? layer : lowest_layer(t);
        e->regions = is_all ? 0 : 1u << region;
        if (fill(e, o, later_ns, *in_ns, *out_ns, err) < 0)
            return give_up(out, count);
    }
    return count;
}
