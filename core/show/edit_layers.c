#include "show/edit_layers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- descriptions ---- */

static const int64_t second_ns = 1000000000;

edit_words edit_seconds(int64_t time_ns)
{
    edit_words out;
    uint64_t size = time_ns < 0 ? 0 - (uint64_t)time_ns : (uint64_t)time_ns;
    int length = snprintf(out.text, sizeof out.text, "%s%llu.%09llu", time_ns < 0 ? "-" : "",
                          (unsigned long long)(size / (uint64_t)second_ns),
                          (unsigned long long)(size % (uint64_t)second_ns));
    while (out.text[length - 1] == '0')
        out.text[--length] = '\0';
    if (out.text[length - 1] == '.')
        out.text[length - 1] = '\0';
    return out;
}

edit_words edit_span_words(int64_t from_ns, int64_t until_ns)
{
    edit_words out;
    (void)snprintf(out.text, sizeof out.text, "%.40s .. %.40s s", edit_seconds(from_ns).text,
                   edit_seconds(until_ns).text);
    return out;
}

edit_words edit_layer_words(const take_layer *layer)
{
    edit_words out;
    (void)snprintf(out.text, sizeof out.text, "layer %u '%.63s'", layer->id, layer->name);
    return out;
}

edit_words edit_clip_words(const take_layer *layer, const take_clip *clip)
{
    edit_words out;
    edit_words span =
        edit_span_words(clip->start_ns + layer->offset_ns, clip->end_ns + layer->offset_ns);
    (void)snprintf(out.text, sizeof out.text, "clip %u of '%.30s' (%.60s)", clip->id, layer->name,
                   span.text);
    return out;
}

/* ---- finding objects by id ---- */

/* "it has 1 'face', 2 'mouth'" */
static void list_layers(char *out, size_t size, const take *t)
{
    size_t used = 0;
    (void)snprintf(out, size, "it has no layers");
    for (uint32_t i = 0; i < t->layer_count && used + 1 < size; ++i) {
        int length = snprintf(out + used, size - used, "%s%u '%.20s'", i ? ", " : "it has ",
                              t->layer[i].id, t->layer[i].name);
        used += length > 0 ? (size_t)length : 0;
    }
}

mrt_result edit_find_layer(take_layer **out, take *t, uint32_t id, error *err)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (t->layer[i].id == id) {
            *out = &t->layer[i];
            return MRT_OK;
        }
    char list[512];
    list_layers(list, sizeof list, t);
    return error_set(err, MRT_ERR_ARGUMENT, "layer %u: the take has no such layer; %s", id, list);
}

mrt_result edit_find_clip(edit_spot *out, take *t, uint32_t id, error *err)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (t->layer[i].clip[k].id == id) {
                *out = (edit_spot){.layer = &t->layer[i], .index = k, .clip = &t->layer[i].clip[k]};
                return MRT_OK;
            }
    return error_set(err, MRT_ERR_ARGUMENT,
                     "clip %u: the take has no such clip; ids are listed by take show", id);
}

void edit_count_ids(take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        if (t->layer[i].id > t->id_count)
            t->id_count = t->layer[i].id;
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (t->layer[i].clip[k].id > t->id_count)
                t->id_count = t->layer[i].clip[k].id;
    }
}

int64_t edit_earliest_ns(const take_clip *clip)
{
    return take_warp_to_timeline(clip, 0);
}

int64_t edit_latest_ns(const take_clip *clip)
{
    int64_t length_ns = clip->to_ns - clip->from_ns;
    int64_t at_ns = take_warp_to_timeline(clip, length_ns);
    return take_warp_to_source(clip, at_ns) > length_ns ? at_ns - 1 : at_ns;
}

mrt_result edit_reserve(void **array, size_t element, uint32_t count, uint32_t cap,
                        const char *what, error *err)
{
    if (count >= cap)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the limit of %u is reached", what, count);
    void *larger = realloc(*array, element * ((size_t)count + 1));
    if (!larger)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory for one more", what);
    *array = larger;
    return MRT_OK;
}

/* ---- clips in a layer ---- */

void edit_clip_finish(take_clip *clip)
{
    free(clip->warp);
    *clip = (take_clip){0};
}

mrt_result edit_clip_copy(take_clip *out, const take_clip *clip, uint32_t id, error *err)
{
    take_warp_point *warp = calloc(clip->warp_count + (size_t)1, sizeof *warp);
    *out = (take_clip){0};
    if (!warp)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a clip");
    for (uint32_t i = 0; i < clip->warp_count; ++i)
        warp[i] = clip->warp[i];
    *out = *clip;
    out->id = id;
    out->warp = warp;
    return MRT_OK;
}

void edit_shift(take_clip *clip, int64_t by_ns)
{
    clip->start_ns += by_ns;
    clip->end_ns += by_ns;
    for (uint32_t i = 0; i < clip->warp_count; ++i)
        clip->warp[i].at_ns += by_ns;
}

void edit_fit_fades(take_clip *clip)
{
    int64_t length_ns = clip->end_ns - clip->start_ns;
    if (clip->fade_in_ns > length_ns)
        clip->fade_in_ns = length_ns;
    if (clip->fade_out_ns > length_ns - clip->fade_in_ns)
        clip->fade_out_ns = length_ns - clip->fade_in_ns;
}

void edit_grow(take *t, const take_layer *layer, const take_clip *clip)
{
    if (clip->end_ns + layer->offset_ns > t->duration_ns)
        t->duration_ns = clip->end_ns + layer->offset_ns;
}

/* ---- in order ---- */

static bool is_before(const take_clip *a, const take_clip *b)
{
    return a->start_ns != b->start_ns ? a->start_ns < b->start_ns : a->end_ns < b->end_ns;
}

mrt_result edit_insert_clip(take_layer *layer, take_clip clip, error *err)
{
    mrt_result result = edit_reserve((void **)&layer->clip, sizeof *layer->clip, layer->clip_count,
                                     EDIT_CLIPS_MAX, edit_layer_words(layer).text, err);
    if (result < 0) {
        edit_clip_finish(&clip);
        return result;
    }
    uint32_t index = layer->clip_count++;
    for (; index > 0 && is_before(&clip, &layer->clip[index - 1]); --index)
        layer->clip[index] = layer->clip[index - 1];
    layer->clip[index] = clip;
    return MRT_OK;
}

take_clip edit_remove_clip(edit_spot spot)
{
    take_clip clip = *spot.clip;
    uint32_t after = --spot.layer->clip_count - spot.index;
    memmove(spot.clip, spot.clip + 1, after * sizeof clip);
    return clip;
}

/* ---- material ---- */

static mrt_result fill_warp(take_clip *clip, const take_layer *layer, const edit *e, error *err)
{
    uint32_t count = e->warp_count ? e->warp_count : 1;
    clip->warp = calloc(count, sizeof *clip->warp);
    if (!clip->warp)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a clip");
    clip->warp_count = count;
    if (!e->warp_count)
        clip->warp[0] = (take_warp_point){clip->start_ns, e->source_ns};
    for (uint32_t i = 0; i < e->warp_count; ++i)
        clip->warp[i] =
            (take_warp_point){e->warp[i].at_ns - layer->offset_ns, e->warp[i].source_ns};
    return MRT_OK;
}

/* Checks that the clip shows some of the material, and nothing beyond it. */
static mrt_result check_shown(const take_layer *layer, const take_clip *clip, error *err)
{
    int64_t low_ns = edit_earliest_ns(clip), high_ns = edit_latest_ns(clip);
    if (clip->start_ns >= low_ns && clip->end_ns <= high_ns && clip->start_ns < clip->end_ns)
        return MRT_OK;
    edit_words asked =
        edit_span_words(clip->start_ns + layer->offset_ns, clip->end_ns + layer->offset_ns);
    edit_words there = edit_span_words(low_ns + layer->offset_ns, high_ns + layer->offset_ns);
    return error_set(
        err, MRT_ERR_ARGUMENT, "%s: %s was requested, but performance %lld can be shown only at %s",
        edit_layer_words(layer).text, asked.text, (long long)clip->performance, there.text);
}

edit edit_with_defaults(const edit *e, const take *t)
{
    edit full = *e;
    if (full.from_ns == EDIT_UNSAID)
        full.from_ns = t->start_ns;
    if (full.to_ns == EDIT_UNSAID)
        full.to_ns = t->start_ns + t->duration_ns;
    if (full.source_ns == EDIT_UNSAID)
        full.source_ns = 0;
    return full;
}

mrt_result edit_material(take_clip *out, take *t, const take_layer *layer, const edit *e,
                         int64_t start_ns, int64_t end_ns, error *err)
{
    const edit full = edit_with_defaults(e, t);
    *out = (take_clip){0};
    if (e->warp_count && e->source_ns != EDIT_UNSAID)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "$.source_ns: the warp already sets the first instant; remove one of the two");
    if (full.to_ns <= full.from_ns || full.to_ns - full.from_ns > EDIT_TIME_MAX_NS)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "$.to_ns: expected an end after from_ns (%lld), at most %.40s s later, "
                         "found %lld",
                         (long long)full.from_ns, edit_seconds(EDIT_TIME_MAX_NS).text,
                         (long long)full.to_ns);
    take_clip clip = {.performance = full.performance,
                      .part = (take_part)full.part,
                      .from_ns = full.from_ns,
                      .to_ns = full.to_ns,
                      .start_ns = start_ns,
                      .gain = 1.0};
    if (start_ns == EDIT_UNSAID)
        clip.start_ns = e->warp_count
                            ? e->warp[0].at_ns - layer->offset_ns
                            : full.from_ns - t->start_ns + full.source_ns - layer->offset_ns;
    mrt_result result = fill_warp(&clip, layer, &full, err);
    if (result < 0)
        return result;
    clip.end_ns = end_ns == EDIT_UNSAID ? edit_latest_ns(&clip) : end_ns;
    clip.id = ++t->id_count;
    result = check_shown(layer, &clip, err);
    if (result < 0)
        edit_clip_finish(&clip);
    *out = clip;
    return result;
}

/* ---- cutting ---- */

/* The clips of a layer during a cut: first those before the cut, then those after it. */
typedef struct edit_cutting {
    take_clip *clip;
    uint32_t count;
} edit_cutting;

static void put(edit_cutting *c, take_clip clip)
{
    edit_fit_fades(&clip);
    c->clip[c->count++] = clip;
}

static void put_before(edit_cutting *c, take_clip clip, int64_t in_ns)
{
    if (clip.end_ns > in_ns) {
        clip.end_ns = in_ns;
        clip.fade_out_ns = 0;
    }
    put(c, clip);
}

static void put_after(edit_cutting *c, take_clip clip, int64_t out_ns, int64_t later_ns)
{
    if (clip.start_ns < out_ns) {
        clip.start_ns = out_ns;
        clip.fade_in_ns = 0;
    }
    edit_shift(&clip, later_ns);
    put(c, clip);
}

/* Copies the part of a clip after the cut. The part before the cut keeps the id. */
static mrt_result copy_after(edit_cutting *after, take *t, const take_clip *clip, int64_t out_ns,
                             int64_t later_ns, error *err)
{
    take_clip copy;
    mrt_result result = edit_clip_copy(&copy, clip, ++t->id_count, err);
    if (result >= 0)
        put_after(after, copy, out_ns, later_ns);
    return result;
}

static mrt_result cut_clips(edit_cutting *before, edit_cutting *after, take *t, take_layer *layer,
                            int64_t in_ns, int64_t out_ns, int64_t later_ns, error *err)
{
    mrt_result result = MRT_OK;
    uint32_t count = layer->clip_count;
    layer->clip_count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        take_clip *clip = &layer->clip[i];
        bool has_before = clip->start_ns<in_ns, has_after = clip->end_ns> out_ns;
        if (result < 0 || (!has_before && !has_after)) {
            edit_clip_finish(clip);
            continue;
        }
        if (has_before && has_after)
            result = copy_after(after, t, clip, out_ns, later_ns, err);
        if (has_before)
            put_before(before, *clip, in_ns);
        else
            put_after(after, *clip, out_ns, later_ns);
    }
    return result;
}

mrt_result edit_cut(take *t, take_layer *layer, int64_t in_ns, int64_t out_ns, int64_t later_ns,
                    error *err)
{
    size_t room = layer->clip_count + (size_t)1;
    edit_cutting before = {.clip = calloc(2 * room, sizeof *layer->clip)};
    edit_cutting after = {.clip = calloc(room, sizeof *layer->clip)};
    mrt_result result = before.clip && after.clip
                            ? cut_clips(&before, &after, t, layer, in_ns, out_ns, later_ns, err)
                            : error_set(err, MRT_ERR_MEMORY, "%s: no memory to cut it",
                                        edit_layer_words(layer).text);
    if (before.clip && after.clip) {
        memcpy(before.clip + before.count, after.clip, after.count * sizeof *after.clip);
        free(layer->clip);
        layer->clip = before.clip;
        layer->clip_count = before.count + after.count;
        before.clip = NULL;
    }
    free(before.clip);
    free(after.clip);
    if (result >= 0 && layer->clip_count > EDIT_CLIPS_MAX)
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: the cut would create too many clips",
                           edit_layer_words(layer).text);
    return result;
}
