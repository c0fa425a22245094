#include "take/edit_parts.h"

#include <stdlib.h>
#include <string.h>

static mrt_result check_name(const edit *e, error *err)
{
    if (e->name[0] != '\0')
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "$.name: a layer needs a name, such as \"mouth\"");
}

static mrt_result set_own(take_layer *layer, const edit *e, error *err)
{
    char(*own)[TAKE_NAME] = e->own_count ? calloc(e->own_count, sizeof *own) : NULL;
    if (e->own_count && !own)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", edit_layer_words(layer).text);
    for (uint32_t i = 0; i < e->own_count; ++i)
        memcpy(own[i], e->own[i], sizeof own[i]);
    free(layer->own);
    layer->own = own;
    layer->own_count = e->own_count;
    return MRT_OK;
}

static void move_layer(take *t, uint32_t from, uint32_t to)
{
    take_layer layer = t->layer[from];
    for (; from < to; ++from)
        t->layer[from] = t->layer[from + 1];
    for (; from > to; --from)
        t->layer[from] = t->layer[from - 1];
    t->layer[to] = layer;
}

static mrt_result add_layer(take *t, const edit *e, error *err)
{
    mrt_result result = check_name(e, err);
    if (result >= 0)
        result = edit_reserve((void **)&t->layer, sizeof *t->layer, t->layer_count, EDIT_LAYERS_MAX,
                              "layers", err);
    if (result < 0)
        return result;
    uint32_t top = t->layer_count++;
    t->layer[top] = (take_layer){.id = ++t->id_count, .gain = 1.0};
    memcpy(t->layer[top].name, e->name, sizeof t->layer[top].name);
    result = set_own(&t->layer[top], e, err);
    if (e->place < top)
        move_layer(t, top, e->place);
    return result;
}

static void remove_layer(take *t, uint32_t index)
{
    move_layer(t, index, t->layer_count - 1);
    take_layer *layer = &t->layer[--t->layer_count];
    for (uint32_t i = 0; i < layer->clip_count; ++i)
        edit_clip_finish(&layer->clip[i]);
    free(layer->clip);
    free(layer->own);
}

static mrt_result order_layer(take *t, take_layer *layer, const edit *e, error *err)
{
    if (e->place >= t->layer_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "$.place: expected 0 (the bottom) to %u (the top), found %u",
                         t->layer_count - 1, e->place);
    move_layer(t, (uint32_t)(layer - t->layer), e->place);
    return MRT_OK;
}

static mrt_result set_offset(take *t, take_layer *layer, const edit *e)
{
    layer->offset_ns = e->offset_ns;
    if (layer->clip_count)
        edit_grow(t, layer, &layer->clip[layer->clip_count - 1]);
    return MRT_OK;
}

static mrt_result rename_layer(take_layer *layer, const edit *e, error *err)
{
    mrt_result result = check_name(e, err);
    if (result >= 0)
        memcpy(layer->name, e->name, sizeof layer->name);
    return result;
}

mrt_result edit_apply_layer(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_LAYER_ADD)
        return add_layer(t, e, err);
    take_layer *layer;
    mrt_result result = edit_find_layer(&layer, t, e->layer, err);
    if (result < 0)
        return result;
    switch (e->kind) {
    case EDIT_LAYER_REMOVE:
        remove_layer(t, (uint32_t)(layer - t->layer));
        return MRT_OK;
    case EDIT_LAYER_RENAME:
        return rename_layer(layer, e, err);
    case EDIT_LAYER_ORDER:
        return order_layer(t, layer, e, err);
    case EDIT_LAYER_MUTE:
        layer->is_muted = e->is_muted;
        return MRT_OK;
    case EDIT_LAYER_SOLO:
        layer->is_solo = e->is_solo;
        return MRT_OK;
    case EDIT_LAYER_ADDITIVE:
        layer->is_additive = e->is_additive;
        return MRT_OK;
    case EDIT_LAYER_GAIN:
        layer->gain = e->gain;
        return MRT_OK;
    case EDIT_LAYER_OFFSET:
        return set_offset(t, layer, e);
    default:
        return set_own(layer, e, err);
    }
}
