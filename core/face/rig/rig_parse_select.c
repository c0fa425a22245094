#include "face/rig/rig_document.h"

#include "base/text.h"
#include "face/rig/rig_paint.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    DEPTH_MAX = 12,
    NODES_MAX = 4096,
    CHILDREN_MAX = 256,
    RANGES_MAX = INT32_MAX,
    GROUP_MAX = 255
};

static const struct {
    const char *key;
    rig_select_kind kind;
} kinds[] = {{"vertices", SELECT_VERTICES},
             {"group", SELECT_GROUP},
             {"attribute", SELECT_ATTRIBUTE},
             {"box", SELECT_BOX},
             {"ellipsoid", SELECT_ELLIPSOID},
             {"half_space", SELECT_HALF_SPACE},
             {"within", SELECT_WITHIN},
             {"all", SELECT_ALL},
             {"any", SELECT_ANY},
             {"not", SELECT_NOT},
             {"painted", SELECT_PAINTED}};
enum { KIND_COUNT = sizeof kinds / sizeof *kinds };
static const char kind_list[] = "one of vertices, group, attribute, box, ellipsoid, half_space, "
                                "within, all, any, not, painted";

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
}

/* ---- vertices ---- */

static mrt_result parse_range(uint32_t *first, uint32_t *last, const rig_node *at, error *err)
{
    if (!json_is_string(at->value)) {
        mrt_result result = rig_json_index(first, at, err);
        *last = *first;
        return result;
    }
    text_view rest = text_view_of(json_string_value(at->value), json_string_length(at->value));
    text_view word[2], more;
    int64_t number[2];
    bool is_range = text_next_field(&rest, '-', &word[0]) &&
                    text_next_field(&rest, '-', &word[1]) && !text_next_field(&rest, '-', &more) &&
                    text_int(word[0], &number[0]) && text_int(word[1], &number[1]);
    if (!is_range || number[0] < 0 || number[1] < number[0] || number[1] >= INT32_MAX)
        return rig_json_unexpected(err, at, "a vertex number, or a range like \"120-180\"");
    *first = (uint32_t)number[0];
    *last = (uint32_t)number[1];
    return MRT_OK;
}

static mrt_result parse_vertices(rig_select *out, const rig_node *at, error *err)
{
    mrt_result result =
        rig_json_array(at, "a list of vertices like [204, \"120-180\"]", RANGES_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(at->value);
    out->first = calloc(count + 1, sizeof *out->first);
    out->last = calloc(count + 1, sizeof *out->last);
    if (!out->first || !out->last)
        return no_memory(err);
    out->range_count = (uint32_t)count;
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        rig_node item = rig_json_item(at, i);
        result = parse_range(&out->first[i], &out->last[i], &item, err);
    }
    return result;
}

/* ---- shapes ---- */

static mrt_result parse_two_points(rig_select *out, const rig_node *at, const char *first,
                                   const char *second, const rig_selecting *s, error *err)
{
    mrt_result result = rig_json_object(at, "an object", err);
    if (result < 0)
        return result;
    rig_node a = rig_json_member(at, first), b = rig_json_member(at, second);
    const char *const known[] = {first, second, NULL};
    rig_json_note_unknown(s->note, at, known);
    result = rig_json_point(&out->a, &a, s->mm_per_unit, err);
    double scale = out->kind == SELECT_HALF_SPACE ? 1.0 : s->mm_per_unit;
    return result < 0 ? result : rig_json_point(&out->b, &b, scale, err);
}

static mrt_result parse_box(rig_select *out, const rig_node *at, const rig_selecting *s, error *err)
{
    mrt_result result = parse_two_points(out, at, "low", "high", s, err);
    if (result < 0)
        return result;
    if (out->a.x > out->b.x || out->a.y > out->b.y || out->a.z > out->b.z)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: low must not be above high in x, y or z; exchange them",
                         at->place.text);
    return MRT_OK;
}

static mrt_result parse_ellipsoid(rig_select *out, const rig_node *at, const rig_selecting *s,
                                  error *err)
{
    mrt_result result = parse_two_points(out, at, "centre", "radii", s, err);
    if (result < 0)
        return result;
    if (!(out->b.x > 0.0 && out->b.y > 0.0 && out->b.z > 0.0))
        return error_set(err, MRT_ERR_FORMAT, "%s.radii: expected three radii above 0",
                         at->place.text);
    return MRT_OK;
}

static mrt_result parse_half_space(rig_select *out, const rig_node *at, const rig_selecting *s,
                                   error *err)
{
    mrt_result result = parse_two_points(out, at, "point", "normal", s, err);
    if (result < 0)
        return result;
    if (!(vec3_length(out->b) > 1e-9))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.normal: expected a direction, found one of length 0", at->place.text);
    return MRT_OK;
}

static mrt_result parse_within(rig_select *out, const rig_node *at, const rig_selecting *s,
                               error *err)
{
    static const char *const known[] = {"mm", "of", NULL};
    mrt_result result = rig_json_object(at, "an object like {\"mm\": 12, \"of\": 4275}", err);
    if (result < 0)
        return result;
    rig_node mm = rig_json_member(at, "mm"), of = rig_json_member(at, "of");
    rig_json_note_unknown(s->note, at, known);
    result = rig_json_number(&out->within_mm, &mm, 0.0, 1e6, err);
    return result < 0 ? result : rig_json_index(&out->vertex, &of, err);
}

/* ---- joined ---- */

static mrt_result parse_children(rig_select *out, const rig_node *at, rig_selecting *s, error *err)
{
    mrt_result result = rig_json_array(at, "a list of selectors", CHILDREN_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(at->value);
    if (count == 0)
        return rig_json_unexpected(err, at, "at least one selector");
    out->child = calloc(count, sizeof *out->child);
    if (!out->child)
        return no_memory(err);
    out->child_count = (uint32_t)count;
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        rig_node item = rig_json_item(at, i);
        result = rig_select_parse(&out->child[i], &item, s, err);
    }
    return result;
}

static mrt_result parse_not(rig_select *out, const rig_node *at, rig_selecting *s, error *err)
{
    out->child = calloc(1, sizeof *out->child);
    if (!out->child)
        return no_memory(err);
    out->child_count = 1;
    return rig_select_parse(&out->child[0], at, s, err);
}

/* ---- painted ---- */

static mrt_result parse_painted(rig_select *out, const rig_node *at, rig_selecting *s, error *err)
{
    mrt_result result = rig_json_text(&out->name, at, "the name of a paint", RIG_NAME_MAX, err);
    if (result < 0 || !s->document)
        return result;
    uint32_t file;
    rig_node paint = rig_document_paint(s->document, out->name, &file);
    if (paint.value)
        return rig_paint_parse(out, &paint, s->budget, err);
    rig_word word = rig_word_of(out->name);
    return error_set(err, MRT_ERR_FORMAT, "%s: there is no paint \"%s\"; add it to $.paints",
                     at->place.text, word.text);
}

/* ---- any of them ---- */

static mrt_result parse_kind(rig_select *out, const rig_node *at, rig_selecting *s, error *err)
{
    switch (out->kind) {
    case SELECT_VERTICES:
        return parse_vertices(out, at, err);
    case SELECT_GROUP:
        return rig_json_text(&out->name, at, "the name of a part or material", GROUP_MAX, err);
    case SELECT_ATTRIBUTE:
        return rig_json_text(&out->name, at, "the name of a vertex attribute like \"_SKULL\"",
                             GROUP_MAX, err);
    case SELECT_BOX:
        return parse_box(out, at, s, err);
    case SELECT_ELLIPSOID:
        return parse_ellipsoid(out, at, s, err);
    case SELECT_HALF_SPACE:
        return parse_half_space(out, at, s, err);
    case SELECT_WITHIN:
        return parse_within(out, at, s, err);
    case SELECT_ALL:
    case SELECT_ANY:
        return parse_children(out, at, s, err);
    case SELECT_NOT:
        return parse_not(out, at, s, err);
    case SELECT_PAINTED:
        return parse_painted(out, at, s, err);
    case SELECT_NOTHING:
        break;
    }
    return rig_json_unexpected(err, at, kind_list);
}

static mrt_result find_kind(rig_select *out, const char **out_key, const rig_node *at,
                            const rig_selecting *s, error *err)
{
    const char *known[KIND_COUNT + 1] = {NULL};
    mrt_result result = rig_json_object(at, "an object", err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < KIND_COUNT; ++i) {
        known[i] = kinds[i].key;
        if (!json_object_get(at->value, kinds[i].key))
            continue;
        if (out->kind != SELECT_NOTHING)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: says both %s and %s; join them with \"all\" or \"any\"",
                             at->place.text, *out_key, kinds[i].key);
        out->kind = kinds[i].kind;
        *out_key = kinds[i].key;
    }
    if (out->kind == SELECT_NOTHING)
        return rig_json_unexpected(err, at, kind_list);
    rig_json_note_unknown(s->note, at, known);
    return MRT_OK;
}

mrt_result rig_select_parse(rig_select *out, const rig_node *at, rig_selecting *s, error *err)
{
    *out = (rig_select){0};
    if (s->depth >= DEPTH_MAX || s->node_count >= NODES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: selectors may be %d deep and %d in all; use groups or attributes",
                         at->place.text, DEPTH_MAX, NODES_MAX);
    s->node_count += 1;
    const char *key = "";
    mrt_result result = find_kind(out, &key, at, s, err);
    if (result < 0)
        return result;
    out->path = strdup(at->place.text);
    if (!out->path)
        return no_memory(err);
    rig_node value = rig_json_member(at, key);
    s->depth += 1;
    result = parse_kind(out, &value, s, err);
    s->depth -= 1;
    return result;
}

void rig_select_free_ranges(rig_select *select)
{
    free(select->first);
    free(select->last);
    free(select->value);
    select->first = select->last = NULL;
    select->value = NULL;
    select->range_count = 0;
}

void rig_select_finish(rig_select *select)
{
    for (uint32_t i = 0; select->child && i < select->child_count; ++i)
        rig_select_finish(&select->child[i]);
    free(select->child);
    free(select->path);
    free(select->name);
    rig_select_free_ranges(select);
    *select = (rig_select){0};
}
