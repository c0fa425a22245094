#include "face/rig/rig_document.h"

#include <stdio.h>
#include <string.h>

/* ---- as JSON ---- */

static json_t *pair_to_json(const char *first, json_t *a, const char *second, json_t *b)
{
    json_t *out = json_object();
    int failed = json_object_set_new(out, first, a);
    failed |= json_object_set_new(out, second, b);
    if (!failed)
        return out;
    json_decref(out);
    return NULL;
}

static json_t *vertices_to_json(const rig_select *select)
{
    json_t *out = json_array();
    for (uint32_t i = 0; i < select->range_count; ++i) {
        char range[32];
        (void)snprintf(range, sizeof range, "%u-%u", select->first[i], select->last[i]);
        json_array_append_new(out, select->first[i] == select->last[i]
                                       ? json_integer((json_int_t)select->first[i])
                                       : json_string(range));
    }
    return out;
}

static json_t *children_to_json(const rig_select *select, double mm_per_unit)
{
    json_t *out = json_array();
    for (uint32_t i = 0; i < select->child_count; ++i)
        json_array_append_new(out, rig_select_to_json(&select->child[i], mm_per_unit));
    return out;
}

json_t *rig_select_to_json(const rig_select *select, double mm_per_unit)
{
    json_t *a = rig_point_to_json(select->a, mm_per_unit);
    json_t *b = rig_point_to_json(select->b, mm_per_unit);
    json_t *direction = rig_point_to_json(select->b, 1.0);
    json_t *out = NULL;
    switch (select->kind) {
    case SELECT_VERTICES:
        out = json_pack("{so}", "vertices", vertices_to_json(select));
        break;
    case SELECT_GROUP:
        out = json_pack("{ss}", "group", select->name);
        break;
    case SELECT_ATTRIBUTE:
        out = json_pack("{ss}", "attribute", select->name);
        break;
    case SELECT_BOX:
        out = json_pack("{so}", "box", pair_to_json("low", json_incref(a), "high", json_incref(b)));
        break;
    case SELECT_ELLIPSOID:
        out = json_pack("{so}", "ellipsoid",
                        pair_to_json("centre", json_incref(a), "radii", json_incref(b)));
        break;
    case SELECT_HALF_SPACE:
        out = json_pack("{so}", "half_space",
                        pair_to_json("point", json_incref(a), "normal", json_incref(direction)));
        break;
    case SELECT_WITHIN:
        out = json_pack("{so}", "within",
                        pair_to_json("mm", rig_number_to_json(select->within_mm), "of",
                                     json_integer((json_int_t)select->vertex)));
        break;
    case SELECT_ALL:
        out = json_pack("{so}", "all", children_to_json(select, mm_per_unit));
        break;
    case SELECT_ANY:
        out = json_pack("{so}", "any", children_to_json(select, mm_per_unit));
        break;
    case SELECT_NOT:
        out = json_pack("{so}", "not", rig_select_to_json(&select->child[0], mm_per_unit));
        break;
    case SELECT_PAINTED:
        out = json_pack("{ss}", "painted", select->name);
        break;
    case SELECT_NOTHING:
        break;
    }
    json_decref(a);
    json_decref(b);
    json_decref(direction);
    return out;
}

/* ---- comparison ---- */

static bool points_equal(vec3 a, vec3 b)
{
    return !(a.x < b.x) && !(a.x > b.x) && !(a.y < b.y) && !(a.y > b.y) && !(a.z < b.z) &&
           !(a.z > b.z);
}

static bool ranges_equal(const rig_select *a, const rig_select *b)
{
    if (a->kind == SELECT_PAINTED) /* the paint is the table's */
        return true;
    if (a->range_count != b->range_count)
        return false;
    size_t size = a->range_count * sizeof *a->first;
    return size == 0 ||
           (memcmp(a->first, b->first, size) == 0 && memcmp(a->last, b->last, size) == 0);
}

bool rig_select_equals(const rig_select *a, const rig_select *b)
{
    if (a->kind != b->kind || a->child_count != b->child_count || !a->name != !b->name ||
        (a->name && strcmp(a->name, b->name) != 0) || !ranges_equal(a, b) ||
        !points_equal(a->a, b->a) || !points_equal(a->b, b->b) || a->vertex != b->vertex ||
        a->within_mm < b->within_mm || a->within_mm > b->within_mm)
        return false;
    for (uint32_t i = 0; i < a->child_count; ++i)
        if (!rig_select_equals(&a->child[i], &b->child[i]))
            return false;
    return true;
}
