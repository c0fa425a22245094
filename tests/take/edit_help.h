/* What the tests of edits share: takes to edit, edits as short JSON, deep comparison, and a list of
 * edits in memory. */
#ifndef MAROTTE_TESTS_EDIT_HELP_H
#define MAROTTE_TESTS_EDIT_HELP_H
#include "show/history.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HELP_JSON = 8192 };
static const int64_t help_s = 1000000000, help_ms = 1000000;

/* 'text' for "text", 2100m (ms) for 2100000000 (ns). */
static inline void help_json(char out[HELP_JSON], const char *brief)
{
    size_t used = 0;
    for (const char *at = brief; *at && used + 8 < HELP_JSON; ++at) {
        bool is_ms = *at == 'm' && at > brief && at[-1] >= '0' && at[-1] <= '9';
        const char *piece = *at == '\'' ? "\"" : is_ms ? "000000" : NULL;
        if (piece)
            used += (size_t)snprintf(out + used, HELP_JSON - used, "%s", piece);
        else
            out[used++] = *at;
    }
    out[used] = '\0';
}

static inline mrt_result help_apply(take *t, const char *brief, error *err)
{
    char json[HELP_JSON];
    edit e;
    help_json(json, brief);
    err->text[0] = '\0';
    mrt_result result = edit_parse(&e, json, strlen(json), err);
    if (result < 0)
        return result;
    result = edit_apply(t, &e, err);
    edit_finish(&e);
    return result;
}

static inline void help_do(take *t, const char *brief)
{
    error err;
    if (help_apply(t, brief, &err) < 0)
        fail_msg("%s: %s", brief, err.text);
}

/* ---- deep comparison ---- */

static inline bool help_same_clip(const take_clip *a, const take_clip *b)
{
    return a->id == b->id && a->performance == b->performance && a->from_ns == b->from_ns &&
           a->to_ns == b->to_ns && a->start_ns == b->start_ns && a->end_ns == b->end_ns &&
           a->fade_in_ns == b->fade_in_ns && a->fade_out_ns == b->fade_out_ns &&
           a->gain == b->gain && a->smooth_s == b->smooth_s && a->is_muted == b->is_muted &&
           a->colour == b->colour && a->warp_count == b->warp_count &&
           memcmp(a->warp, b->warp, a->warp_count * sizeof *a->warp) == 0;
}

static inline bool help_same_layer(const take_layer *a, const take_layer *b)
{
    bool same = a->id == b->id && strcmp(a->name, b->name) == 0 && a->is_muted == b->is_muted &&
                a->is_solo == b->is_solo && a->is_additive == b->is_additive &&
                a->gain == b->gain && a->offset_ns == b->offset_ns &&
                a->own_count == b->own_count && a->clip_count == b->clip_count;
    for (uint32_t i = 0; same && i < a->own_count; ++i)
        same = strcmp(a->own[i], b->own[i]) == 0;
    for (uint32_t i = 0; same && i < a->clip_count; ++i)
        same = help_same_clip(&a->clip[i], &b->clip[i]);
    return same;
}

static inline bool help_same(const take *a, const take *b)
{
    bool same = a->id == b->id && a->start_ns == b->start_ns && a->duration_ns == b->duration_ns &&
                a->is_deleted == b->is_deleted && strcmp(a->scene, b->scene) == 0 &&
                strcmp(a->shot, b->shot) == 0 && a->number == b->number &&
                strcmp(a->name, b->name) == 0 && strcmp(a->note, b->note) == 0 &&
                a->rating == b->rating && a->fps == b->fps &&
                a->timecode_frame == b->timecode_frame && a->is_drop_frame == b->is_drop_frame &&
                a->layer_count == b->layer_count && a->marker_count == b->marker_count &&
                a->audio.audio == b->audio.audio && a->audio.offset_ns == b->audio.offset_ns &&
                a->audio.in_ns == b->audio.in_ns && a->audio.out_ns == b->audio.out_ns &&
                a->audio.gain == b->audio.gain && a->id_count == b->id_count;
    for (uint32_t i = 0; same && i < a->marker_count; ++i)
        same = a->marker[i].at_ns == b->marker[i].at_ns &&
               strcmp(a->marker[i].text, b->marker[i].text) == 0;
    for (uint32_t i = 0; same && i < a->layer_count; ++i)
        same = help_same_layer(&a->layer[i], &b->layer[i]);
    return same;
}

/* Refused with a line that has `why` in it; the take is as it was. */
static inline void help_refused(take *t, const char *brief, const char *why)
{
    take before;
    error err;
    if (take_copy(&before, t, &err) < 0)
        fail_msg("%s", err.text);
    if (help_apply(t, brief, &err) >= 0)
        fail_msg("%s: it was not refused", brief);
    if (!strstr(err.text, why) || strchr(err.text, '\n'))
        fail_msg("%s: \"%s\" does not say \"%s\"", brief, err.text, why);
    if (!help_same(t, &before))
        fail_msg("%s: the take has changed", brief);
    take_finish(&before);
}

/* ---- takes ---- */

/* 10 s long; layer 1 'face' shows performance 7 in clip 2, from its start to its end. */
static inline take help_take(void)
{
    take t = {.id = 1, .start_ns = 1000 * help_s, .duration_ns = 10 * help_s};
    help_do(&t, "{'op':'layer.add','name':'face'}");
    help_do(&t, "{'op':'clip.add','layer':1,'performance':7}");
    return t;
}

static inline void help_check(const take *t)
{
    error err;
    if (edit_check(t, &err) < 0)
        fail_msg("%s", err.text);
}

/* What a layer shows at an instant, as text: "2@1.5*0.25 3@0*0.75". */
static inline const char *help_shown(const take_layer *layer, int64_t at_ns)
{
    static char text[128];
    take_voice voice[2];
    size_t used = 0;
    text[0] = '\0';
    uint32_t count = take_at(voice, layer, at_ns);
    for (uint32_t i = 0; i < count; ++i)
        used +=
            (size_t)snprintf(text + used, sizeof text - used, "%s%u@%g*%g", i ? " " : "",
                             voice[i].clip->id, (double)voice[i].source_ns / 1e9, voice[i].weight);
    return text;
}

/* ---- a list of edits in memory ---- */

enum { HELP_EDITS = 256 };
typedef struct help_list {
    char *base[8], *text[HELP_EDITS];
    int64_t base_count, head, last;
    bool is_full;         /* the next change fails */
    edit_reference shows; /* of the last edit */
} help_list;

static inline mrt_result help_list_extent(void *self, history_extent *out, error *err)
{
    const help_list *list = self;
    (void)err;
    *out = (history_extent){1 - list->base_count, list->head, list->last};
    return MRT_OK;
}

static inline mrt_result help_list_read(void *self, int64_t n, const char **out_text,
                                        size_t *out_size, error *err)
{
    const help_list *list = self;
    if (n > list->last || n < 1 - list->base_count)
        return error_set(err, MRT_ERR_IO, "edit %lld is not there", (long long)n);
    *out_text = n >= 1 ? list->text[n - 1] : list->base[n + list->base_count - 1];
    *out_size = strlen(*out_text);
    return MRT_OK;
}

static inline char *help_copy(const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    if (copy)
        memcpy(copy, text, size);
    return copy;
}

static inline mrt_result help_list_append(void *self, const char *text, const edit_reference *shows,
                                          error *err)
{
    help_list *list = self;
    list->shows = shows ? *shows : (edit_reference){0};
    if (list->is_full || list->head >= HELP_EDITS)
        return error_set(err, MRT_ERR_IO, "the disk is full");
    while (list->last > list->head)
        free(list->text[--list->last]);
    list->text[list->last++] = help_copy(text);
    list->head = list->last;
    return MRT_OK;
}

static inline mrt_result help_list_set_head(void *self, int64_t head, error *err)
{
    help_list *list = self;
    if (list->is_full)
        return error_set(err, MRT_ERR_IO, "the disk is full");
    list->head = head;
    return MRT_OK;
}

static inline void help_list_base(help_list *list, const char *brief)
{
    char json[HELP_JSON];
    help_json(json, brief);
    list->base[list->base_count++] = help_copy(json);
}

static inline history_store help_store(help_list *list)
{
    return (history_store){
        list, help_list_extent, help_list_read, help_list_append, help_list_set_head, NULL};
}

static inline void help_list_finish(help_list *list)
{
    while (list->last > 0)
        free(list->text[--list->last]);
    while (list->base_count > 0)
        free(list->base[--list->base_count]);
}

#endif
