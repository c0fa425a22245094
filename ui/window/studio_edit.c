/* What the edit actions do to the clip, layer or marker that is chosen, or to the take. */
#include "window/studio_state.h"

#include <stdio.h>

static const take_layer *layer_of(const take *t, uint32_t id)
{
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        if (t->layer[i].id == id)
            return &t->layer[i];
    return NULL;
}

static const take_clip *clip_of(const take *t, uint32_t id, const take_layer **out_layer)
{
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (t->layer[i].clip[k].id == id) {
                *out_layer = &t->layer[i];
                return &t->layer[i].clip[k];
            }
    return NULL;
}

/* The clip that is chosen, or the only one that is under the play head. */
static const take_clip *clip_at(const studio *self, int64_t at_ns, const take_layer **out_layer)
{
    const take *t = studio_take(self);
    const take_clip *found = NULL;
    uint32_t count = 0;
    if (self->choice.clip)
        return clip_of(t, self->choice.clip, out_layer);
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k) {
            const take_layer *lane = &t->layer[i];
            const take_clip *clip = &lane->clip[k];
            if (at_ns <= clip->start_ns + lane->offset_ns ||
                at_ns >= clip->end_ns + lane->offset_ns)
                continue;
            *out_layer = lane;
            found = clip;
            count += 1;
        }
    return count == 1 ? found : NULL;
}

static bool is_within(const take_clip *clip, const take_layer *lane, int64_t at_ns)
{
    return at_ns > clip->start_ns + lane->offset_ns && at_ns < clip->end_ns + lane->offset_ns;
}

/* ---- why not ---- */

static const char *why_no_split(const studio *self)
{
    const take_layer *lane = NULL;
    const int64_t at_ns = live_place(self->live).at_ns;
    const take_clip *clip = clip_at(self, at_ns, &lane);
    if (!clip)
        return "choose a clip of the timeline";
    return is_within(clip, lane, at_ns) ? NULL : "the play head is not within the clip";
}

static const char *why_no_trim(const studio *self)
{
    const take_layer *lane = NULL;
    const take *t = studio_take(self);
    const int64_t at_ns = live_place(self->live).at_ns;
    if (self->choice.clip) {
        const take_clip *clip = clip_of(t, self->choice.clip, &lane);
        return clip && is_within(clip, lane, at_ns) ? NULL : "the play head is not within the clip";
    }
    return at_ns > 0 && at_ns < t->duration_ns ? NULL : "the play head is not within the take";
}

const char *studio_edit_why_not(studio *self, action of)
{
    const studio_choice *choice = &self->choice;
    if (!self->history)
        return "no take is chosen";
    if (!show_is_writable(self->show))
        return "the show can only be read";
    if (self->status.is_recording && self->status.take == self->chosen)
        return "the take is being recorded";
    switch (of) {
    case ACTION_SPLIT:
        return why_no_split(self);
    case ACTION_TRIM_START:
    case ACTION_TRIM_END:
        return why_no_trim(self);
    case ACTION_REMOVE:
        return choice->clip || choice->layer || choice->marker >= 0
                   ? NULL
                   : "choose a clip, a layer or a marker of the timeline";
    case ACTION_MUTE:
        return choice->clip || choice->layer ? NULL : "choose a clip or a layer of the timeline";
    case ACTION_SOLO:
        return choice->layer || choice->clip ? NULL : "choose a layer of the timeline";
    default:
        return NULL;
    }
}

/* ---- doing it ---- */

static bool make_split(const studio *self, edit *out)
{
    const take_layer *lane = NULL;
    const int64_t at_ns = live_place(self->live).at_ns;
    const take_clip *clip = clip_at(self, at_ns, &lane);
    if (!clip)
        return false;
    edit_init(out, EDIT_CLIP_SPLIT);
    out->clip = clip->id;
    out->at_ns = at_ns;
    return true;
}

static bool make_trim(const studio *self, edit *out, bool is_end)
{
    const int64_t at_ns = live_place(self->live).at_ns;
    const take *t = studio_take(self);
    if (self->choice.clip) {
        edit_init(out, EDIT_CLIP_TRIM);
        out->clip = self->choice.clip;
        *(is_end ? &out->end_ns : &out->start_ns) = at_ns;
        return true;
    }
    edit_init(out, EDIT_RANGE_KEEP);
    out->in_ns = is_end ? 0 : at_ns;
    out->out_ns = is_end ? at_ns : t->duration_ns;
    return true;
}

static bool make_remove(const studio *self, edit *out)
{
    const studio_choice *choice = &self->choice;
    edit_init(out, choice->marker >= 0 ? EDIT_MARKER_REMOVE
                   : choice->clip      ? EDIT_CLIP_REMOVE
                                       : EDIT_LAYER_REMOVE);
    if (choice->marker >= 0)
        out->marker = (uint32_t)choice->marker;
    else if (choice->clip)
        out->clip = choice->clip;
    else
        out->layer = choice->layer;
    return true;
}

static bool make_mute(const studio *self, edit *out)
{
    const take_layer *lane = NULL;
    const take_clip *clip = clip_of(studio_take(self), self->choice.clip, &lane);
    if (clip) {
        edit_init(out, EDIT_CLIP_MUTE);
        out->clip = clip->id;
        out->is_muted = !clip->is_muted;
        return true;
    }
    lane = layer_of(studio_take(self), self->choice.layer);
    if (!lane)
        return false;
    edit_init(out, EDIT_LAYER_MUTE);
    out->layer = lane->id;
    out->is_muted = !lane->is_muted;
    return true;
}

static bool make_solo(const studio *self, edit *out)
{
    const take_layer *lane = layer_of(studio_take(self), self->choice.layer);
    if (!lane)
        (void)clip_of(studio_take(self), self->choice.clip, &lane);
    if (!lane)
        return false;
    edit_init(out, EDIT_LAYER_SOLO);
    out->layer = lane->id;
    out->is_solo = !lane->is_solo;
    return true;
}

static bool make(const studio *self, action of, edit *out)
{
    switch (of) {
    case ACTION_SPLIT:
        return make_split(self, out);
    case ACTION_TRIM_START:
    case ACTION_TRIM_END:
        return make_trim(self, out, of == ACTION_TRIM_END);
    case ACTION_REMOVE:
        return make_remove(self, out);
    case ACTION_MUTE:
        return make_mute(self, out);
    case ACTION_SOLO:
        return make_solo(self, out);
    default:
        edit_init(out, EDIT_TAKE_RATE);
        out->rating = (uint32_t)(of - ACTION_RATE_0);
        return true;
    }
}

void studio_edit_do(studio *self, action of)
{
    edit e = {0};
    if (make(self, of, &e))
        studio_heard(studio_edit(self, &e));
    edit_finish(&e);
}
