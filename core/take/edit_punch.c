#include "take/edit_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct punch_span { /* in the time of the layer */
    int64_t in_ns, out_ns, fade_ns;
} punch_span;

static mrt_result check_span(const edit *e, error *err)
{
    if (e->in_ns >= e->out_ns)
        return error_set(err, MRT_ERR_ARGUMENT, "%s %s: expected an end after the start",
                         edit_name(e->kind), edit_span_words(e->in_ns, e->out_ns).text);
    if (e->fade_ns <= (e->out_ns - e->in_ns) / 2)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s %s: cross-fades of %s s do not fit into it twice; at most %s s do",
                     edit_name(e->kind), edit_span_words(e->in_ns, e->out_ns).text,
                     edit_seconds(e->fade_ns).text, edit_seconds((e->out_ns - e->in_ns) / 2).text);
}

/* ---- where it may begin and end ---- */

typedef struct soft_span { /* where the weights of a clip change */
    int64_t from_ns, until_ns;
} soft_span;

static bool cross_fade(const take_clip *first, const take_clip *second)
{
    return !first->is_muted && !second->is_muted && second->start_ns < first->end_ns;
}

/* The cross-fade or fade around an instant, its ends left out. */
static bool find_soft_span(soft_span *out, const take_layer *layer, int64_t at_ns)
{
    for (uint32_t i = 0; i < layer->clip_count; ++i) {
        const take_clip *clip = &layer->clip[i];
        bool crosses_before = i > 0 && cross_fade(clip - 1, clip);
        bool crosses_after = i + 1 < layer->clip_count && cross_fade(clip, clip + 1);
        int64_t fade_in_ns = crosses_before ? 0 : clip->fade_in_ns;
        int64_t fade_out_ns = crosses_after ? clip->end_ns - clip[1].start_ns : clip->fade_out_ns;
        const soft_span span[2] = {{clip->start_ns, clip->start_ns + fade_in_ns},
                                   {clip->end_ns - fade_out_ns, clip->end_ns}};
        for (int k = 0; k < 2 && !clip->is_muted; ++k)
            if (span[k].from_ns < at_ns && at_ns < span[k].until_ns) {
                *out = span[k];
                return true;
            }
    }
    return false;
}

/* Outside of the span everything is to stay as it is: a fade cannot be cut. */
static mrt_result check_hard(const take_layer *layer, const edit *e, int64_t at_ns, error *err)
{
    soft_span span;
    if (!find_soft_span(&span, layer, at_ns))
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: %s s lies within a fade of %s; choose %s s or %s s", edit_name(e->kind),
                     edit_seconds(at_ns + layer->offset_ns).text, edit_layer_words(layer).text,
                     edit_seconds(span.from_ns + layer->offset_ns).text,
                     edit_seconds(span.until_ns + layer->offset_ns).text);
}

/* ---- what is there reaches over the fades, as far as it was recorded ---- */

/* A fade that is longer than the cross-fade is somebody's wish: it stays. */
static bool reach_over_start(take_layer *layer, const punch_span *span)
{
    for (uint32_t i = layer->clip_count; i-- > 0;) {
        take_clip *clip = &layer->clip[i];
        if (clip->is_muted || clip->end_ns != span->in_ns)
            continue;
        if (clip->fade_out_ns > span->fade_ns)
            return false;
        int64_t latest_ns = edit_latest_ns(clip), end_ns = span->in_ns + span->fade_ns;
        if (latest_ns > clip->end_ns)
            clip->end_ns = latest_ns < end_ns ? latest_ns : end_ns;
        clip->fade_out_ns = 0;
        return true;
    }
    return false;
}

static bool reach_over_end(take_layer *layer, const punch_span *span)
{
    for (uint32_t i = 0; i < layer->clip_count; ++i) {
        take_clip *clip = &layer->clip[i];
        if (clip->is_muted || clip->start_ns != span->out_ns)
            continue;
        if (clip->fade_in_ns > span->fade_ns)
            return false;
        int64_t earliest_ns = edit_earliest_ns(clip), start_ns = span->out_ns - span->fade_ns;
        if (earliest_ns < clip->start_ns)
            clip->start_ns = earliest_ns > start_ns ? earliest_ns : start_ns;
        clip->fade_in_ns = 0;
        return true;
    }
    return false;
}

static mrt_result punch_layer(take *t, take_layer *layer, const edit *e, error *err)
{
    punch_span span = {e->in_ns - layer->offset_ns, e->out_ns - layer->offset_ns, e->fade_ns};
    take_clip clip;
    mrt_result result = check_hard(layer, e, span.in_ns, err);
    if (result >= 0)
        result = check_hard(layer, e, span.out_ns, err);
    if (result >= 0)
        result = edit_material(&clip, t, layer, e, span.in_ns, span.out_ns, err);
    if (result < 0)
        return result;
    result = edit_cut(t, layer, span.in_ns, span.out_ns, 0, err);
    if (result < 0) {
        edit_clip_finish(&clip);
        return result;
    }
    clip.fade_in_ns = reach_over_start(layer, &span) ? 0 : span.fade_ns;
    clip.fade_out_ns = reach_over_end(layer, &span) ? 0 : span.fade_ns;
    edit_grow(t, layer, &clip);
    return edit_lay(layer, clip, err);
}

/* ---- comp: a layer for each part of the face ---- */

typedef struct part { /* of the face; patterns until the edit goes */
    char name[TAKE_NAME];
    uint32_t pattern_count;
    char pattern[EDIT_OWN_MAX][TAKE_NAME];
} part;

static void part_of_region(part *out, own_region region)
{
    const own_part *own = own_part_of(region);
    *out = (part){.pattern_count = own->pattern_count};
    (void)snprintf(out->name, sizeof out->name, "%s", own->name);
    for (uint32_t i = 0; i < own->pattern_count; ++i)
        (void)snprintf(out->pattern[i], sizeof out->pattern[i], "%s", own->pattern[i]);
}

static void part_of_patterns(part *out, const edit *e)
{
    *out = (part){.pattern_count = e->own_count};
    memcpy(out->name, e->name[0] ? e->name : e->own[0], sizeof out->name);
    memcpy(out->pattern, e->own, e->own_count * sizeof *e->own);
}

static bool is_layer_of(const take_layer *layer, const part *p)
{
    if (layer->own_count != p->pattern_count || layer->is_additive)
        return false;
    for (uint32_t i = 0; i < p->pattern_count; ++i)
        if (strcmp(layer->own[i], p->pattern[i]) != 0)
            return false;
    return true;
}

static bool meets(const take_layer *layer, const part *p)
{
    for (uint32_t i = 0; i < layer->own_count; ++i)
        for (uint32_t k = 0; k < p->pattern_count; ++k)
            if (own_patterns_meet(layer->own[i], p->pattern[k]))
                return true;
    return layer->own_count == 0;
}

/* The layer of exactly that part, unless a later one could speak over it. */
static take_layer *find_comp_layer(take *t, const part *p)
{
    for (uint32_t i = t->layer_count; i-- > 0;) {
        if (is_layer_of(&t->layer[i], p))
            return &t->layer[i];
        if (meets(&t->layer[i], p))
            return NULL;
    }
    return NULL;
}

static mrt_result add_comp_layer(take_layer **out, take *t, part *p, error *err)
{
    edit add;
    edit_init(&add, EDIT_LAYER_ADD);
    memcpy(add.name, p->name, sizeof add.name);
    add.own = p->pattern;
    add.own_count = p->pattern_count;
    mrt_result result = edit_apply_layer(t, &add, err);
    *out = result < 0 ? NULL : &t->layer[t->layer_count - 1];
    return result;
}

static mrt_result comp_part(take *t, part *p, const edit *e, error *err)
{
    take_layer *layer = find_comp_layer(t, p);
    mrt_result result = layer ? MRT_OK : add_comp_layer(&layer, t, p, err);
    return result < 0 ? result : punch_layer(t, layer, e, err);
}

static mrt_result comp(take *t, const edit *e, error *err)
{
    if ((e->regions != 0) == (e->own_count != 0))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "comp: expected either regions, such as [\"mouth\"], or own, such as "
                         "[\"jaw.*\"]");
    part p;
    if (e->own_count) {
        part_of_patterns(&p, e);
        return comp_part(t, &p, e, err);
    }
    mrt_result result = MRT_OK;
    for (uint32_t region = 0; result >= 0 && region < OWN_REGION_COUNT; ++region) {
        if (!(e->regions & 1u << region))
            continue;
        part_of_region(&p, (own_region)region);
        result = comp_part(t, &p, e, err);
    }
    return result;
}

mrt_result edit_apply_punch(take *t, const edit *e, error *err)
{
    take_layer *layer;
    mrt_result result = check_span(e, err);
    if (result < 0)
        return result;
    if (e->kind == EDIT_COMP)
        return comp(t, e, err);
    result = edit_find_layer(&layer, t, e->layer, err);
    return result < 0 ? result : punch_layer(t, layer, e, err);
}
