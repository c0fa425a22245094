#include "face/rig/rig_fields.h"

#include "base/angle.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double coordinate_cap = 1e6, radian_per_degree = ANGLE_PI / 180.0;
enum { FIELDS_MAX = 32 };

/* ---- read ---- */

mrt_result rig_json_vertex(uint32_t *out, const json_node *at, error *err)
{
    json_int_t value = json_integer_value(at->value);
    if (!json_is_integer(at->value) || value < 0 || value >= INT32_MAX)
        return json_node_unexpected(err, at, "a vertex number of the mesh file, from 0");
    *out = (uint32_t)value;
    return MRT_OK;
}

mrt_result rig_json_point(vec3 *out, const json_node *at, double scale, error *err)
{
    double point[3];
    mrt_result result = json_node_numbers(point, 3, at, -coordinate_cap, coordinate_cap,
                                          "three numbers [x, y, z]", err);
    if (result >= 0)
        *out = (vec3){point[0] * scale, point[1] * scale, point[2] * scale};
    return result;
}

static mrt_result read_bone(uint32_t *out, const json_node *at, const rig *r, error *err)
{
    const char *name = json_string_value(at->value);
    if (!name)
        return json_node_unexpected(err, at, "the name of a bone");
    *out = rig_find_bone(r, name);
    if (*out != RIG_NONE)
        return MRT_OK;
    json_words word = json_shown(name);
    return error_set(err, MRT_ERR_FORMAT, "%s: the rig has no bone \"%s\"; add it to $.bones",
                     at->path.text, word.text);
}

static mrt_result read_radii(vec3 *out, const json_node *at, double mm_per_unit, error *err)
{
    mrt_result result = rig_json_point(out, at, mm_per_unit, err);
    if (result < 0 || (out->x > 0.0 && out->y > 0.0 && out->z > 0.0))
        return result;
    return error_set(err, MRT_ERR_FORMAT, "%s: expected three radii greater than 0", at->path.text);
}

static mrt_result read_direction(vec3 *out, const json_node *at, error *err)
{
    mrt_result result = rig_json_point(out, at, 1.0, err);
    if (result < 0 || vec3_length(*out) > 1e-9)
        return result;
    return error_set(err, MRT_ERR_FORMAT, "%s: expected a direction, found a vector of length 0",
                     at->path.text);
}

/* The range must include 0, the pose at rest. */
static mrt_result read_range(double out_rad[2], const rig_field *f, const json_node *at, error *err)
{
    double deg[2];
    mrt_result result = json_node_numbers(deg, 2, at, f->low, f->high,
                                          "two angles [least, greatest] in degrees", err);
    if (result < 0)
        return result;
    if (deg[0] >= deg[1])
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: [%g, %g] is reversed or empty; write the smaller angle first",
                         at->path.text, deg[0], deg[1]);
    if (deg[0] > 0.0 || deg[1] < 0.0)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: [%g, %g] does not include 0, the pose of the mesh; widen the range",
                         at->path.text, deg[0], deg[1]);
    out_rad[0] = deg[0] * radian_per_degree;
    out_rad[1] = deg[1] * radian_per_degree;
    return MRT_OK;
}

static mrt_result read_vertices(uint32_t **out, uint32_t *out_count, const rig_field *f,
                                const json_node *at, error *err)
{
    size_t count = json_array_size(at->value);
    if ((double)count < f->low || (double)count > f->high)
        return json_node_unexpected(err, at, f->expected);
    *out = malloc(count * sizeof **out);
    mrt_result result = *out ? MRT_OK : rig_no_memory(err);
    *out_count = result < 0 ? 0 : (uint32_t)count;
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node vertex = json_node_item(at, i);
        result = rig_json_vertex(*out + i, &vertex, err);
    }
    return result;
}

static mrt_result read_word(int *out, const rig_field *f, const json_node *at, error *err)
{
    const char *word = json_string_value(at->value);
    for (int value = (int)f->low; word && value <= (int)f->high; ++value)
        if (strcmp(f->word(value), word) == 0) {
            *out = value;
            return MRT_OK;
        }
    return json_node_unexpected(err, at, f->expected);
}

static bool is_auto(const json_node *at)
{
    const char *word = json_string_value(at->value);
    return word && strcmp(word, "auto") == 0;
}

static mrt_result read_value(void *to, void *count, const rig_field *f, const json_node *at,
                             rig_reading *in, error *err)
{
    mrt_result result;
    switch (f->kind) {
    case FIELD_NUMBER:
        return json_node_number(to, at, f->low, f->high, err);
    case FIELD_POINT:
        return rig_json_point(to, at, in->mm_per_unit, err);
    case FIELD_RADII:
        return read_radii(to, at, in->mm_per_unit, err);
    case FIELD_DIRECTION:
        return read_direction(to, at, err);
    case FIELD_AXIS:
        result = read_direction(to, at, err);
        if (result >= 0)
            *(vec3 *)to = vec3_normalised(*(vec3 *)to, (vec3){1.0, 0.0, 0.0});
        return result;
    case FIELD_RANGE:
        return read_range(to, f, at, err);
    case FIELD_TEXT:
        return rig_json_text(to, at, f->expected, (size_t)f->high, err);
    case FIELD_VERTEX:
        return rig_json_vertex(to, at, err);
    case FIELD_VERTICES:
        return read_vertices(to, count, f, at, err);
    case FIELD_FLAG:
        return json_node_flag(to, at, err);
    case FIELD_WORD:
        return read_word(to, f, at, err);
    case FIELD_BONE:
        return f->use == FIELD_OPTIONAL && is_auto(at) ? MRT_OK : read_bone(to, at, in->r, err);
    case FIELD_OBJECT:
        result = json_node_object(at, f->expected, err);
        return result < 0 ? result : rig_fields_read(to, f->inner, at, in, err);
    case FIELD_CUSTOM:
        break;
    }
    return MRT_OK;
}

json_node rig_field_member(const json_node *at, const char *key, const rig_reading *in)
{
    uint32_t file;
    return at ? json_node_member(at, key) : rig_document_scalar(in->document, key, &file);
}

mrt_result rig_field_read(void *out, const rig_field *f, const json_node *at, rig_reading *in,
                          error *err)
{
    char *base = out;
    if (f->kind == FIELD_CUSTOM)
        return f->read ? f->read(out, at, in, err) : MRT_OK;
    json_node value = rig_field_member(at, f->key, in);
    if (!value.value && f->use != FIELD_NEEDED)
        return MRT_OK;
    mrt_result result = read_value(base + f->offset, base + f->count_offset, f, &value, in, err);
    return result < 0 || !f->check ? result : f->check(out, &value, err);
}

void rig_fields_note_unknown(const rig_field *fields, const json_node *at, rig_reading *in)
{
    const char *known[FIELDS_MAX + 1] = {NULL};
    void *step = NULL;
    for (int i = 0; fields[i].key && i < FIELDS_MAX; ++i)
        known[i] = fields[i].key;
    for (const char *key; (key = json_node_unknown(at, known, &step)) != NULL;)
        rig_note(in->note, "%s: unknown key, ignored; it is kept in the file",
                 json_node_member(at, key).path.text);
}

mrt_result rig_fields_read(void *out, const rig_field *fields, const json_node *at, rig_reading *in,
                           error *err)
{
    mrt_result result = MRT_OK;
    if (at)
        rig_fields_note_unknown(fields, at, in);
    for (const rig_field *f = fields; result >= 0 && f->key; ++f)
        result = rig_field_read(out, f, at, in, err);
    return result;
}

/* ---- write: only what differs from the file, so that its text stays ---- */

static bool is_same(double a, double b)
{
    return !(a < b) && !(a > b);
}

json_t *rig_number_to_json(double value)
{
    double whole =
        floor(value + 0.5); /* 30 degrees converted to radians and back are not exactly 30 */
    bool is_whole = fabs(value) < 1e9 && fabs(value - whole) <= 1e-13 * fabs(value);
    return is_whole ? json_integer((json_int_t)whole) : json_real(value);
}

json_t *rig_point_to_json(vec3 point, double mm_per_unit)
{
    json_t *out = json_array();
    json_array_append_new(out, rig_number_to_json(point.x / mm_per_unit));
    json_array_append_new(out, rig_number_to_json(point.y / mm_per_unit));
    json_array_append_new(out, rig_number_to_json(point.z / mm_per_unit));
    return out;
}

void rig_set(json_t *to, const char *key, json_t *value, rig_writing *w)
{
    w->failed |= json_object_set_new(to, key, value) != 0;
}

void rig_set_text(json_t *to, const char *key, const char *text, rig_writing *w)
{
    const char *before = json_string_value(json_object_get(to, key));
    if (!before || strcmp(before, text) != 0)
        rig_set(to, key, json_string(text), w);
}

void rig_set_number(json_t *to, const char *key, double value, double scale, double usual,
                    rig_writing *w)
{
    const json_t *there = json_object_get(to, key);
    double before = there ? json_number_value(there) * scale : usual;
    if (isnan(before) || !is_same(before, value))
        rig_set(to, key, rig_number_to_json(value / scale), w);
}

static vec3 point_of(const json_t *value, double scale)
{
    return (vec3){json_number_value(json_array_get(value, 0)) * scale,
                  json_number_value(json_array_get(value, 1)) * scale,
                  json_number_value(json_array_get(value, 2)) * scale};
}

static bool holds_point(const json_t *value, vec3 before, vec3 point)
{
    return json_array_size(value) == 3 && is_same(before.x, point.x) &&
           is_same(before.y, point.y) && is_same(before.z, point.z);
}

void rig_set_point(json_t *to, const char *key, vec3 point, rig_writing *w)
{
    const json_t *there = json_object_get(to, key);
    bool same_unit = is_same(w->source_mm_per_unit, w->mm_per_unit);
    if (!same_unit || !holds_point(there, point_of(there, w->source_mm_per_unit), point))
        rig_set(to, key, rig_point_to_json(point, w->mm_per_unit), w);
}

json_t *rig_set_object(json_t *to, const char *key, rig_writing *w)
{
    if (!json_is_object(json_object_get(to, key)))
        rig_set(to, key, json_object(), w);
    return json_object_get(to, key);
}

/* Axes have length 1 in memory, but need not in the file. */
static void write_axis(json_t *to, const char *key, vec3 axis, rig_writing *w)
{
    const json_t *there = json_object_get(to, key);
    vec3 before = vec3_normalised(point_of(there, 1.0), (vec3){0.0, 0.0, 0.0});
    if (!holds_point(there, before, axis))
        rig_set(to, key, rig_point_to_json(rig_round_axis(axis), 1.0), w);
}

static void write_range(json_t *to, const rig_field *f, const double rad[2], rig_writing *w)
{
    const json_t *there = json_object_get(to, f->key);
    double low = there ? json_number_value(json_array_get(there, 0)) * radian_per_degree : 0.0;
    double high = there ? json_number_value(json_array_get(there, 1)) * radian_per_degree
                  : f->use == FIELD_NEEDED ? (double)NAN
                                           : f->usual;
    if (!isnan(high) && is_same(low, rad[0]) && is_same(high, rad[1]))
        return;
    json_t *range = json_array();
    json_array_append_new(range, rig_number_to_json(rad[0] / radian_per_degree));
    json_array_append_new(range, rig_number_to_json(rad[1] / radian_per_degree));
    rig_set(to, f->key, range, w);
}

static void write_vertex(json_t *to, const rig_field *f, uint32_t vertex, rig_writing *w)
{
    const json_t *there = json_object_get(to, f->key);
    if (!there ? f->use == FIELD_NEEDED || vertex > 0 : json_integer_value(there) != vertex)
        rig_set(to, f->key, json_integer((json_int_t)vertex), w);
}

static void write_vertices(json_t *to, const char *key, const uint32_t *vertex, uint32_t count,
                           rig_writing *w)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; ++i)
        json_array_append_new(list, json_integer((json_int_t)vertex[i]));
    rig_set(to, key, list, w);
}

static void write_word(json_t *to, const rig_field *f, int value, rig_writing *w)
{
    const json_t *there = json_object_get(to, f->key);
    if (there || !is_same(value, f->usual))
        rig_set_text(to, f->key, f->word(value), w);
}

/* An object without fields is not added. */
static void write_object(json_t *to, const rig_field *f, const void *of, rig_writing *w)
{
    json_t *there = json_object_get(to, f->key);
    json_t *inner = there ? json_incref(there) : json_object();
    rig_fields_write(inner, f->inner, of, w);
    if (there || json_object_size(inner) == 0)
        json_decref(inner);
    else
        rig_set(to, f->key, inner, w);
}

static bool is_omitted(const rig_field *f, const void *from)
{
    switch (f->use == FIELD_OMITTED ? f->kind : FIELD_CUSTOM) {
    case FIELD_NUMBER:
        return isnan(f->usual) ? isnan(*(const double *)from)
                               : is_same(*(const double *)from, f->usual);
    case FIELD_WORD:
        return is_same(*(const int *)from, f->usual);
    case FIELD_BONE:
        return *(const uint32_t *)from == RIG_NONE;
    default:
        return false;
    }
}

static void write_value(json_t *to, const rig_field *f, const void *from, uint32_t count,
                        rig_writing *w)
{
    switch (f->kind) {
    case FIELD_NUMBER:
        rig_set_number(to, f->key, *(const double *)from, 1.0,
                       f->use == FIELD_NEEDED ? (double)NAN : f->usual, w);
        break;
    case FIELD_POINT:
    case FIELD_RADII:
        rig_set_point(to, f->key, *(const vec3 *)from, w);
        break;
    case FIELD_DIRECTION:
        rig_set(to, f->key, rig_point_to_json(*(const vec3 *)from, 1.0), w);
        break;
    case FIELD_AXIS:
        write_axis(to, f->key, *(const vec3 *)from, w);
        break;
    case FIELD_RANGE:
        write_range(to, f, from, w);
        break;
    case FIELD_TEXT:
        rig_set_text(to, f->key, *(char *const *)from, w);
        break;
    case FIELD_VERTEX:
        write_vertex(to, f, *(const uint32_t *)from, w);
        break;
    case FIELD_VERTICES:
        if (*(uint32_t *const *)from)
            write_vertices(to, f->key, *(uint32_t *const *)from, count, w);
        break;
    case FIELD_FLAG:
        if (*(const bool *)from)
            rig_set(to, f->key, json_true(), w);
        else if (json_is_true(json_object_get(to, f->key)))
            json_object_del(to, f->key);
        break;
    case FIELD_WORD:
        write_word(to, f, *(const int *)from, w);
        break;
    case FIELD_BONE:
        if (*(const uint32_t *)from != RIG_NONE)
            rig_set_text(to, f->key, w->r->bone[*(const uint32_t *)from].name, w);
        else if (json_object_get(to, f->key))
            rig_set_text(to, f->key, "auto", w);
        break;
    case FIELD_OBJECT:
        write_object(to, f, from, w);
        break;
    case FIELD_CUSTOM:
        break;
    }
}

void rig_field_write(json_t *to, const rig_field *f, const void *of, rig_writing *w)
{
    const char *from = (const char *)of + f->offset;
    uint32_t count = 0;
    if (f->kind == FIELD_VERTICES)
        memcpy(&count, (const char *)of + f->count_offset, sizeof count);
    if (f->kind == FIELD_CUSTOM && f->write)
        f->write(to, of, w);
    else if (is_omitted(f, from))
        json_object_del(to, f->key);
    else
        write_value(to, f, from, count, w);
}

void rig_fields_write(json_t *to, const rig_field *fields, const void *of, rig_writing *w)
{
    for (const rig_field *f = fields; f->key; ++f)
        rig_field_write(to, f, of, w);
}
