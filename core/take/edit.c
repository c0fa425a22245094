#include "take/edit.h"

#include "take/edit_parts.h"

static mrt_result apply_by_kind(take *t, const edit *e, error *err)
{
    if (e->kind <= EDIT_TAKE_RESTORE)
        return edit_apply_take(t, e, err);
    if (e->kind <= EDIT_MARKER_REMOVE)
        return edit_apply_marker(t, e, err);
    if (e->kind <= EDIT_LAYER_OWN)
        return edit_apply_layer(t, e, err);
    if (e->kind <= EDIT_CLIP_PERFORM)
        return edit_apply_clip(t, e, err);
    if (e->kind <= EDIT_RANGE_INSERT)
        return edit_apply_range(t, e, err);
    return e->kind <= EDIT_COMP ? edit_apply_punch(t, e, err) : edit_apply_audio(t, e, err);
}

mrt_result edit_apply_onto(take *t, const edit *e, error *err)
{
    mrt_result result = edit_check_arguments(e, err);
    if (result < 0)
        return result;
    edit_count_ids(t);
    result = apply_by_kind(t, e, err);
    return result < 0 ? result : edit_check(t, err);
}

mrt_result edit_apply(take *t, const edit *e, error *err)
{
    take changed;
    mrt_result result = take_copy(&changed, t, err);
    if (result < 0)
        return result;
    result = edit_apply_onto(&changed, e, err);
    if (result < 0) {
        take_finish(&changed);
        return result;
    }
    take_finish(t);
    *t = changed;
    return MRT_OK;
}

/* ---- what it refers to ---- */

static const take_clip *find_clip(const take *t, uint32_t id)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (t->layer[i].clip[k].id == id)
                return &t->layer[i].clip[k];
    return NULL;
}

bool edit_refers(edit_reference *out, const edit *e, const take *before)
{
    *out = (edit_reference){.performance = e->performance};
    if (e->kind == EDIT_CLIP_PERFORM) {
        const take_clip *clip = find_clip(before, e->clip);
        out->from_ns = clip ? clip->from_ns : 0;
        out->to_ns = clip ? clip->to_ns : 0;
        return clip != NULL;
    }
    edit full = edit_with_defaults(e, before);
    out->from_ns = full.from_ns;
    out->to_ns = full.to_ns;
    return e->kind == EDIT_CLIP_ADD || e->kind == EDIT_PUNCH || e->kind == EDIT_COMP;
}
