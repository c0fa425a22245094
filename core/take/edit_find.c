#include "take/edit_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "it has 1 'face', 2 'mouth'" */
static void list_layers(char *out, size_t size, const take *t)
{
    size_t used = 0;
    (void)snprintf(out, size, "it has none");
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
        return error_set(err, MRT_ERR_ARGUMENT, "%s: there are %u, and no room for more", what,
                         count);
    void *larger = realloc(*array, element * ((size_t)count + 1));
    if (!larger)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory for one more", what);
    *array = larger;
    return MRT_OK;
}
