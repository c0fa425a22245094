#include "face/rig_edit.h"

#include "face/rig/rig_document.h"
#include "face/rig/rig_edit_parts.h"
#include "face/rig/rig_paint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_TEXT = 512 };

mrt_result rig_edit_no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to change the rig");
}

mrt_result rig_edit_rename(char **out, const char *name, error *err)
{
    char *copy = strdup(name);
    if (!copy)
        return rig_edit_no_memory(err);
    free(*out);
    *out = copy;
    return MRT_OK;
}

mrt_result rig_edit_check_name(const char *name, error *err)
{
    size_t length = name ? strlen(name) : 0;
    for (size_t i = 0; i < length; ++i)
        if ((unsigned char)name[i] < 0x20 || name[i] == 0x7f)
            return error_set(err, MRT_ERR_ARGUMENT, "a name has no control characters");
    if (length < 1 || length > RIG_NAME_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "a name has 1 to %d letters", RIG_NAME_MAX);
    return MRT_OK;
}

/* ---- paths: selectors say in messages where they are ---- */

static void place_select(rig_select *select, const char *path)
{
    char *copy = strdup(path);
    if (copy) {
        free(select->path);
        select->path = copy;
    }
    for (uint32_t i = 0; i < select->child_count; ++i) {
        char child[PATH_TEXT];
        if (select->kind == SELECT_NOT)
            (void)snprintf(child, sizeof child, "%.400s.not", path);
        else
            (void)snprintf(child, sizeof child, "%.400s.%s[%u]", path,
                           select->kind == SELECT_ALL ? "all" : "any", i);
        place_select(&select->child[i], child);
    }
}

static void place_regions(rig *r)
{
    for (uint32_t i = 0; i < r->region_count; ++i) {
        rig_place place = rig_where(r, RIG_REGIONS, i);
        char path[PATH_TEXT];
        (void)snprintf(path, sizeof path, "%s.select", place.text);
        place_select(&r->region[i].select, path);
    }
}

/* ---- regions ---- */

static mrt_result check_region_index(const rig *r, uint32_t index, error *err)
{
    return index < r->region_count
               ? MRT_OK
               : error_set(err, MRT_ERR_ARGUMENT, "there is no region %u", index);
}

static bool is_share(double value)
{
    return isnan(value) || (value >= 0.0 && value <= 1.0);
}

static mrt_result check_says(const rig *r, const rig_edit_says *says, error *err)
{
    bool has_weight = !isnan(says->weight), has_mobility = !isnan(says->mobility);
    if (says->bone != RIG_NONE && says->bone >= r->bone_count)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no bone %u", says->bone);
    if (!is_share(says->weight) || !is_share(says->mobility))
        return error_set(err, MRT_ERR_ARGUMENT, "weight and mobility go from 0 to 1");
    if (says->is_rigid && (has_weight || has_mobility))
        return error_set(err, MRT_ERR_ARGUMENT, "what is rigid has no weight and mobility to say");
    if (!says->is_rigid && !has_weight && !has_mobility)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a region must say something: rigid, weight or "
                         "mobility");
    if (says->bone == RIG_NONE && (says->is_rigid || has_weight))
        return error_set(err, MRT_ERR_ARGUMENT, "choose the bone that these vertices ride on");
    return MRT_OK;
}

static mrt_result check_region_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = rig_edit_check_name(name, err);
    uint32_t other = result < 0 ? RIG_NONE : rig_edit_find_region(r, name);
    if (other != RIG_NONE && other != index)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "another region is called \"%s\"; choose another name", name);
    return result;
}

uint32_t rig_edit_find_region(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (r->region[i].name && strcmp(r->region[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

static void set_says(rig_region *region, const rig_edit_says *says)
{
    region->bone = says->bone;
    region->is_rigid = says->is_rigid;
    region->weight = rig_edit_round_share(says->weight, region->weight);
    region->mobility = rig_edit_round_share(says->mobility, region->mobility);
}

mrt_result rig_edit_add_region(rig *r, const char *name, const rig_edit_says *says,
                               uint32_t *out_index, error *err)
{
    bool has_name = name && name[0];
    mrt_result result = check_says(r, says, err);
    if (result >= 0 && has_name)
        result = check_region_name(r, RIG_NONE, name, err);
    if (result < 0)
        return result;
    if (r->region_count >= RIG_EDIT_ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig has at most %d regions",
                         RIG_EDIT_ENTRIES_MAX);
    rig_region *grown = realloc(r->region, (r->region_count + 2u) * sizeof *grown);
    if (!grown)
        return rig_edit_no_memory(err);
    r->region = grown;
    rig_region made = {.select = {.kind = SELECT_VERTICES}};
    made.name = has_name ? strdup(name) : NULL;
    if (has_name && !made.name)
        return rig_edit_no_memory(err);
    set_says(&made, says);
    r->region[r->region_count] = made;
    *out_index = r->region_count;
    r->region_count += 1;
    place_regions(r);
    return MRT_OK;
}

mrt_result rig_edit_remove_region(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_region_index(r, index, err);
    if (result < 0)
        return result;
    rig_select_finish(&r->region[index].select);
    free(r->region[index].name);
    memmove(&r->region[index], &r->region[index + 1],
            (r->region_count - index - 1) * sizeof *r->region);
    r->region_count -= 1;
    place_regions(r);
    return MRT_OK;
}

mrt_result rig_edit_move_region(rig *r, uint32_t index, uint32_t to, error *err)
{
    mrt_result result = check_region_index(r, index, err);
    if (result >= 0)
        result = check_region_index(r, to, err);
    if (result < 0)
        return result;
    rig_region moved = r->region[index];
    if (to > index)
        memmove(&r->region[index], &r->region[index + 1], (to - index) * sizeof moved);
    else
        memmove(&r->region[to + 1], &r->region[to], (index - to) * sizeof moved);
    r->region[to] = moved;
    place_regions(r);
    return MRT_OK;
}

mrt_result rig_edit_name_region(rig *r, uint32_t index, const char *name, error *err)
{
    bool has_name = name && name[0];
    mrt_result result = check_region_index(r, index, err);
    if (result >= 0 && has_name)
        result = check_region_name(r, index, name, err);
    if (result < 0)
        return result;
    char *copy = has_name ? strdup(name) : NULL;
    if (has_name && !copy)
        return rig_edit_no_memory(err);
    free(r->region[index].name);
    r->region[index].name = copy;
    return MRT_OK;
}

mrt_result rig_edit_set_region(rig *r, uint32_t index, const rig_edit_says *says, error *err)
{
    mrt_result result = check_region_index(r, index, err);
    if (result >= 0)
        result = check_says(r, says, err);
    if (result >= 0)
        set_says(&r->region[index], says);
    return result;
}

/* ---- painting ---- */

bool rig_edit_can_paint(const rig *r, uint32_t index)
{
    rig_select_kind kind = r->region[index].select.kind;
    return kind == SELECT_VERTICES || kind == SELECT_PAINTED;
}

void rig_edit_values(uint8_t *out, const rig *r, uint32_t index, uint32_t vertex_count)
{
    const rig_select *select = &r->region[index].select;
    memset(out, 0, vertex_count);
    for (uint32_t i = 0; i < select->range_count; ++i)
        for (uint32_t v = select->first[i]; v <= select->last[i] && v < vertex_count; ++v)
            out[v] = select->kind == SELECT_PAINTED ? select->value[i] : 255;
}

static bool is_soft(const uint8_t *value, uint32_t vertex_count)
{
    for (uint32_t v = 0; v < vertex_count; ++v)
        if (value[v] != 0 && value[v] != 255)
            return true;
    return false;
}

static bool uses_paint(const rig_select *select, const char *name)
{
    if (select->kind == SELECT_PAINTED && strcmp(select->name, name) == 0)
        return true;
    for (uint32_t i = 0; i < select->child_count; ++i)
        if (uses_paint(&select->child[i], name))
            return true;
    return false;
}

static bool is_paint_taken(const rig *r, uint32_t index, const char *name)
{
    uint32_t file;
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (i != index && uses_paint(&r->region[i].select, name))
            return true;
    return r->document && rig_document_paint(r->document, name, &file).value;
}

/* The one it has, if it alone has it; else after the region, numbered where that is taken. */
static void choose_paint_name(const rig *r, uint32_t index, char out[RIG_NAME_MAX + 1])
{
    const rig_region *region = &r->region[index];
    bool is_own = region->select.kind == SELECT_PAINTED;
    for (uint32_t i = 0; is_own && i < r->region_count; ++i)
        is_own = i == index || !uses_paint(&r->region[i].select, region->select.name);
    const char *base = is_own                     ? region->select.name
                       : region->name             ? region->name
                       : region->bone != RIG_NONE ? r->bone[region->bone].name
                                                  : "mobility";
    (void)snprintf(out, RIG_NAME_MAX + 1, "%.*s", RIG_NAME_MAX - 8, base);
    if (is_own)
        (void)snprintf(out, RIG_NAME_MAX + 1, "%s", base);
    for (uint32_t number = 2; !is_own && is_paint_taken(r, index, out); ++number)
        (void)snprintf(out, RIG_NAME_MAX + 1, "%.*s %u", RIG_NAME_MAX - 8, base, number);
}

mrt_result rig_edit_paint(rig *r, uint32_t index, const uint8_t *value, uint32_t vertex_count,
                          error *err)
{
    char name[RIG_NAME_MAX + 1];
    mrt_result result = check_region_index(r, index, err);
    rig_select made = {.kind = SELECT_VERTICES};
    if (result >= 0)
        result = rig_paint_set(&made, value, vertex_count, err);
    if (result < 0)
        return result;
    if (is_soft(value, vertex_count)) {
        choose_paint_name(r, index, name);
        made.kind = SELECT_PAINTED;
        made.name = strdup(name);
        if (!made.name) {
            rig_select_finish(&made);
            return rig_edit_no_memory(err);
        }
    } else {
        free(made.value);
        made.value = NULL;
    }
    rig_select_finish(&r->region[index].select);
    r->region[index].select = made;
    place_regions(r);
    return MRT_OK;
}
