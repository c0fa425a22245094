/* Stanford PLY, text and binary of either byte order: x y z, normals, colours, faces and triangle
 * strips, in any order. Lines may end with \r alone, as on old Macs. Other floating-point
 * properties of the vertices become attributes with the same name. */
#include "io/read/mesh_build.h"

#include "io/mesh_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLY_ELEMENTS_MAX = 32, PLY_PROPERTIES_MAX = 256 };

typedef enum ply_format { PLY_ASCII = 0, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN } ply_format;

typedef enum ply_type {
    PLY_NONE = 0,
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT32,
    PLY_FLOAT64
} ply_type;

typedef struct ply_property {
    char name[64];
    ply_type type;
    ply_type list_type; /* of the count of a list; PLY_NONE: a single value */
} ply_property;

typedef struct ply_element {
    char name[64];
    int64_t count;
    uint32_t first_property, property_count;
} ply_element;

typedef struct ply_header {
    ply_format format;
    ply_element element[PLY_ELEMENTS_MAX];
    ply_property property[PLY_PROPERTIES_MAX];
    uint32_t element_count, property_count;
    uint64_t line_count;
    char line_end; /* '\n', or '\r' where no '\n' follows it */
} ply_header;

/* ---- the header: every count in it is checked against the bytes that follow ---- */

static bool next_line_until(char line_end, text_view *rest, text_view *out_line)
{
    if (line_end == '\n' || rest->at == rest->end)
        return text_next_line(rest, out_line);
    const char *stop = memchr(rest->at, line_end, (size_t)(rest->end - rest->at));
    *out_line = (text_view){rest->at, stop ? stop : rest->end};
    rest->at = stop ? stop + 1 : rest->end;
    return true;
}

static size_t ply_type_size(ply_type type)
{
    static const size_t size[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return size[type];
}

static ply_type type_of(text_view word)
{
    static const struct {
        const char *name;
        ply_type type;
    } known[] = {{"char", PLY_INT8},      {"int8", PLY_INT8},       {"uchar", PLY_UINT8},
                 {"uint8", PLY_UINT8},    {"short", PLY_INT16},     {"int16", PLY_INT16},
                 {"ushort", PLY_UINT16},  {"uint16", PLY_UINT16},   {"int", PLY_INT32},
                 {"int32", PLY_INT32},    {"uint", PLY_UINT32},     {"uint32", PLY_UINT32},
                 {"float", PLY_FLOAT32},  {"float32", PLY_FLOAT32}, {"double", PLY_FLOAT64},
                 {"float64", PLY_FLOAT64}};
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (text_equals(word, known[i].name))
            return known[i].type;
    return PLY_NONE;
}

static mrt_result read_name(char out[64], text_view *line, error *err)
{
    text_view word = {line->end, line->end};
    if (!text_next_word(line, &word) || word.end - word.at > 63)
        return mesh_text_unexpected(err, "a name of at most 63 letters", word);
    text_copy(out, 64, word);
    return MRT_OK;
}

static mrt_result read_format(ply_header *h, text_view *line, error *err)
{
    text_view word = {line->end, line->end}, version = word;
    (void)text_next_word(line, &word);
    (void)text_next_word(line, &version);
    if (text_equals(word, "ascii"))
        h->format = PLY_ASCII;
    else if (text_equals(word, "binary_little_endian"))
        h->format = PLY_LITTLE_ENDIAN;
    else if (text_equals(word, "binary_big_endian"))
        h->format = PLY_BIG_ENDIAN;
    else
        return mesh_text_unexpected(err, "format ascii, binary_little_endian or binary_big_endian",
                                    word);
    if (!text_equals(version, "1.0"))
        return mesh_text_unexpected(err, "version 1.0", version);
    return MRT_OK;
}

static mrt_result read_element(ply_header *h, text_view *line, error *err)
{
    text_view word = {line->end, line->end};
    if (h->element_count == PLY_ELEMENTS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "more than %d elements", PLY_ELEMENTS_MAX);
    ply_element *element = &h->element[h->element_count];
    *element = (ply_element){.first_property = h->property_count};
    mrt_result result = read_name(element->name, line, err);
    if (result < 0)
        return result;
    if (!text_next_word(line, &word) || !text_int(word, &element->count) || element->count < 0)
        return mesh_text_unexpected(err, "the number of elements", word);
    h->element_count += 1;
    return MRT_OK;
}

static mrt_result read_property(ply_header *h, text_view *line, error *err)
{
    text_view word = {line->end, line->end};
    if (h->element_count == 0)
        return error_set(err, MRT_ERR_FORMAT, "a property before the first element");
    if (h->property_count == PLY_PROPERTIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "more than %d properties", PLY_PROPERTIES_MAX);
    ply_property *property = &h->property[h->property_count];
    *property = (ply_property){0};
    (void)text_next_word(line, &word);
    if (text_equals(word, "list")) {
        (void)text_next_word(line, &word);
        property->list_type = type_of(word);
        if (property->list_type == PLY_NONE || property->list_type >= PLY_FLOAT32)
            return mesh_text_unexpected(err, "a whole number type for the length of a list", word);
        (void)text_next_word(line, &word);
    }
    property->type = type_of(word);
    if (property->type == PLY_NONE)
        return mesh_text_unexpected(err, "a type such as float or uchar", word);
    h->property_count += 1;
    h->element[h->element_count - 1].property_count += 1;
    return read_name(property->name, line, err);
}

/* Checks the counts: each element needs some bytes, so the file size limits them. */
static mrt_result check_counts(const ply_header *h, size_t size, error *err)
{
    for (uint32_t i = 0; i < h->element_count; ++i) {
        const ply_element *e = &h->element[i];
        const ply_property *property = &h->property[e->first_property];
        size_t bytes = 0;
        if (e->property_count == 0)
            return error_set(err, MRT_ERR_FORMAT, "element \"%s\" has no properties", e->name);
        for (uint32_t p = 0; p < e->property_count; ++p) {
            ply_type type = property[p].list_type ? property[p].list_type : property[p].type;
            bytes += h->format == PLY_ASCII ? 2 : ply_type_size(type);
        }
        if ((uint64_t)e->count > (size + 1) / bytes)
            return error_set(err, MRT_ERR_FORMAT,
                             "%lld of \"%s\" do not fit into the %zu bytes after the header",
                             (long long)e->count, e->name, size);
    }
    return MRT_OK;
}

static mrt_result read_header_line(ply_header *h, text_view line, bool *out_end, bool *has_format,
                                   error *err)
{
    text_view keyword = {line.end, line.end};
    mrt_result result = mesh_text_check_line(line, err);
    if (result < 0)
        return result;
    (void)text_next_word(&line, &keyword);
    if (text_equals(keyword, "end_header")) {
        *out_end = true;
        return MRT_OK;
    }
    if (text_equals(keyword, "format")) {
        *has_format = true;
        return read_format(h, &line, err);
    }
    if (text_equals(keyword, "element"))
        return read_element(h, &line, err);
    if (text_equals(keyword, "property"))
        return read_property(h, &line, err);
    if (keyword.at == keyword.end || text_equals(keyword, "comment") ||
        text_equals(keyword, "obj_info"))
        return MRT_OK;
    return mesh_text_unexpected(err, "format, element, property, comment or end_header", keyword);
}

static mrt_result read_header_lines(ply_header *h, text_view *rest, error *err)
{
    text_view line;
    bool end = false, has_format = false;
    h->line_count = 1;
    h->line_end =
        rest->end - rest->at > 4 && rest->at[3] == '\r' && rest->at[4] != '\n' ? '\r' : '\n';
    if (!next_line_until(h->line_end, rest, &line) || !text_equals(text_trim(line), "ply"))
        return error_set(err, MRT_ERR_FORMAT, "\"ply\" was expected");
    while (!end) {
        h->line_count += 1;
        if (!next_line_until(h->line_end, rest, &line))
            return error_set(err, MRT_ERR_FORMAT, "the file ends before end_header");
        mrt_result result = read_header_line(h, line, &end, &has_format, err);
        if (result < 0)
            return result;
    }
    if (!has_format)
        return error_set(err, MRT_ERR_FORMAT, "the header has no format line");
    if (rest->at < rest->end && memchr(rest->at, '\n', (size_t)(rest->end - rest->at)))
        h->line_end = '\n'; /* a text body may have other lines than the header */
    return check_counts(h, (size_t)(rest->end - rest->at), err);
}

static mrt_result parse_header(ply_header *out, text_view *rest, error *err)
{
    *out = (ply_header){0};
    mrt_result result = read_header_lines(out, rest, err);
    if (result < 0)
        mesh_text_at_line(err, out->line_count);
    return result;
}

/* ---- the body ---- */

/* Use of a vertex property. The first nine are indices into `value`. */
typedef enum ply_role {
    ROLE_X = 0,
    ROLE_NX = 3,
    ROLE_RED = 6,
    ROLE_ATTRIBUTE = 9,
    ROLES_MAX = ROLE_ATTRIBUTE + 64,
    ROLE_PASSED_OVER
} ply_role;

typedef struct ply_reader {
    ply_header header;
    mesh_build build;
    text_view rest, line; /* line: unread part of the current line (text) */
    uint64_t line_number;
    ply_role role[PLY_PROPERTIES_MAX]; /* of the vertex element's properties */
    bool has_role[ROLE_ATTRIBUTE];
    uint32_t attribute_property[ROLES_MAX - ROLE_ATTRIBUTE];
    uint32_t attribute_count, passed_over_count;
    float *attribute; /* vertex by attribute_count */
    size_t attribute_capacity;
    float colour_full; /* maximum of integer colours; 1: floating-point colours */
    float *colour;     /* vertex by 4, linear */
    size_t colour_capacity, unreadable_count; /* unreadable: colours that are not numbers */
    error *err;
} ply_reader;

static mrt_result next_line(ply_reader *r)
{
    if (r->header.format != PLY_ASCII)
        return MRT_OK;
    do {
        if (!next_line_until(r->header.line_end, &r->rest, &r->line))
            return error_set(r->err, MRT_ERR_FORMAT, "the file ends too early");
        r->line_number += 1;
        mrt_result result = mesh_text_check_line(r->line, r->err);
        if (result < 0)
            return result;
        r->line = text_trim(r->line);
    } while (r->line.at == r->line.end);
    return MRT_OK;
}

static mrt_result end_line(const ply_reader *r)
{
    if (r->header.format == PLY_ASCII && r->line.at != r->line.end)
        return error_set(r->err, MRT_ERR_FORMAT, "more values than properties");
    return MRT_OK;
}

/* The result may be NaN if the type is floating-point. */
static mrt_result read_text(ply_reader *r, ply_type type, double *out)
{
    static const double low[] = {0, -128, 0, -32768, 0, -2147483648.0, 0};
    static const double high[] = {0, 127, 255, 32767, 65535, 2147483647.0, 4294967295.0};
    text_view word;
    int64_t whole;
    if (!text_next_word(&r->line, &word))
        return error_set(r->err, MRT_ERR_FORMAT, "fewer values than properties");
    if (type >= PLY_FLOAT32 && text_double(word, out))
        return MRT_OK;
    if (type >= PLY_FLOAT32 && mesh_text_is_not_finite(word)) {
        *out = (double)NAN;
        return MRT_OK;
    }
    if (type < PLY_FLOAT32 && text_int(word, &whole) && (double)whole >= low[type] &&
        (double)whole <= high[type]) {
        *out = (double)whole;
        return MRT_OK;
    }
    return mesh_text_unexpected(
        r->err, type >= PLY_FLOAT32 ? "a finite number" : "a whole number of its type", word);
}

static double decode(uint64_t bits, ply_type type)
{
    uint32_t bits32 = (uint32_t)bits;
    float single;
    double number;
    switch (type) {
    case PLY_INT8:
        return bits < 0x80 ? (double)bits : (double)bits - 256.0;
    case PLY_INT16:
        return bits < 0x8000 ? (double)bits : (double)bits - 65536.0;
    case PLY_INT32:
        return bits < 0x80000000u ? (double)bits : (double)bits - 4294967296.0;
    case PLY_FLOAT32:
        memcpy(&single, &bits32, sizeof single);
        return (double)single;
    case PLY_FLOAT64:
        memcpy(&number, &bits, sizeof number);
        return number;
    case PLY_NONE:
    case PLY_UINT8:
    case PLY_UINT16:
    case PLY_UINT32:
        break;
    }
    return (double)bits;
}

static mrt_result read_binary(ply_reader *r, ply_type type, double *out)
{
    size_t size = ply_type_size(type);
    uint64_t bits = 0;
    if ((size_t)(r->rest.end - r->rest.at) < size)
        return error_set(r->err, MRT_ERR_FORMAT, "the file ends too early");
    for (size_t i = 0; i < size; ++i) {
        size_t shift = r->header.format == PLY_LITTLE_ENDIAN ? i : size - 1 - i;
        bits |= (uint64_t)(unsigned char)r->rest.at[i] << (8 * shift);
    }
    r->rest.at += size;
    *out = decode(bits, type);
    return MRT_OK;
}

static mrt_result read_number(ply_reader *r, ply_type type, double *out)
{
    return r->header.format == PLY_ASCII ? read_text(r, type, out) : read_binary(r, type, out);
}

static mrt_result read_list_length(ply_reader *r, ply_type type, int64_t *out)
{
    double length;
    mrt_result result = read_number(r, type, &length);
    if (result < 0)
        return result;
    if (length < 0.0)
        return error_set(r->err, MRT_ERR_FORMAT, "the length of a list is negative");
    *out = (int64_t)length;
    return MRT_OK;
}

static mrt_result skip_property(ply_reader *r, const ply_property *property)
{
    int64_t length = 1;
    double ignored;
    mrt_result result = MRT_OK;
    if (property->list_type)
        result = read_list_length(r, property->list_type, &length);
    for (int64_t i = 0; result == MRT_OK && i < length; ++i)
        result = read_number(r, property->type, &ignored);
    return result;
}

/* ---- vertices ---- */

static ply_role known_role(const char *name)
{
    static const char *const known[ROLE_ATTRIBUTE] = {"x",  "y",   "z",     "nx",  "ny",
                                                      "nz", "red", "green", "blue"};
    for (int role = 0; role < ROLE_ATTRIBUTE; ++role)
        if (strcmp(name, known[role]) == 0)
            return (ply_role)role;
    return ROLE_PASSED_OVER;
}

static bool has_colours(const ply_reader *r)
{
    return r->has_role[ROLE_RED] && r->has_role[ROLE_RED + 1] && r->has_role[ROLE_RED + 2];
}

static mrt_result assign_roles(ply_reader *r, const ply_element *e)
{
    for (uint32_t i = 0; i < e->property_count; ++i) {
        const ply_property *property = &r->header.property[e->first_property + i];
        ply_role role = property->list_type ? ROLE_PASSED_OVER : known_role(property->name);
        if (role < ROLE_ATTRIBUTE && r->has_role[role])
            return error_set(r->err, MRT_ERR_FORMAT, "property \"%s\" appears twice",
                             property->name);
        if (role < ROLE_ATTRIBUTE) {
            r->has_role[role] = true;
            if (role >= ROLE_RED)
                r->colour_full = property->type == PLY_UINT8    ? 255.0f
                                 : property->type == PLY_UINT16 ? 65535.0f
                                                                : 1.0f;
        } else if (property->list_type == PLY_NONE && property->type >= PLY_FLOAT32 &&
                   ROLE_ATTRIBUTE + r->attribute_count < ROLES_MAX) {
            role = (ply_role)(ROLE_ATTRIBUTE + r->attribute_count);
            r->attribute_property[r->attribute_count] = e->first_property + i;
            r->attribute_count += 1;
        } else {
            r->passed_over_count += 1;
        }
        r->role[i] = role;
    }
    for (int role = ROLE_RED; role < ROLE_ATTRIBUTE && !has_colours(r); ++role)
        r->passed_over_count += r->has_role[role];
    if (!r->has_role[ROLE_X] || !r->has_role[ROLE_X + 1] || !r->has_role[ROLE_X + 2])
        return error_set(r->err, MRT_ERR_FORMAT, "the vertices have no x, y and z");
    return MRT_OK;
}

static mrt_result read_vertex_values(ply_reader *r, const ply_element *e, float value[ROLES_MAX])
{
    for (uint32_t i = 0; i < e->property_count; ++i) {
        const ply_property *property = &r->header.property[e->first_property + i];
        double number;
        mrt_result result;
        if (r->role[i] == ROLE_PASSED_OVER) {
            result = skip_property(r, property);
            if (result < 0)
                return result;
            continue;
        }
        result = read_number(r, property->type, &number);
        if (result < 0)
            return result;
        value[r->role[i]] = (float)number;
        bool is_colour = r->role[i] >= ROLE_RED && r->role[i] < ROLE_ATTRIBUTE;
        if (!is_colour && !isfinite(value[r->role[i]]))
            return error_set(r->err, MRT_ERR_FORMAT, "\"%s\" is not finite", property->name);
    }
    return MRT_OK;
}

static mrt_result add_colour(ply_reader *r, const float rgb[3])
{
    size_t used = (r->build.vertex_count - 1) * 4;
    mrt_result result = mesh_build_grow((void **)&r->colour, &r->colour_capacity, used + 4,
                                        sizeof *r->colour, r->err);
    if (result < 0)
        return result;
    const float srgb[3] = {rgb[0] / r->colour_full, rgb[1] / r->colour_full,
                           rgb[2] / r->colour_full};
    if (!mesh_build_colour(r->colour + used, srgb))
        r->unreadable_count += 1;
    return MRT_OK;
}

static mrt_result read_vertex(ply_reader *r, const ply_element *e)
{
    float value[ROLES_MAX];
    mrt_result result = read_vertex_values(r, e, value);
    if (result == MRT_OK)
        result = mesh_build_vertex(&r->build, value + ROLE_X, r->err);
    if (result == MRT_OK && r->has_role[ROLE_NX] && r->has_role[ROLE_NX + 1] &&
        r->has_role[ROLE_NX + 2])
        result = mesh_build_normal(&r->build, value + ROLE_NX, r->err);
    if (result == MRT_OK && has_colours(r))
        result = add_colour(r, value + ROLE_RED);
    if (result < 0 || r->attribute_count == 0)
        return result;
    size_t used = (r->build.vertex_count - 1) * r->attribute_count;
    result = mesh_build_grow((void **)&r->attribute, &r->attribute_capacity,
                             used + r->attribute_count, sizeof *r->attribute, r->err);
    if (result == MRT_OK)
        memcpy(r->attribute + used, value + ROLE_ATTRIBUTE,
               r->attribute_count * sizeof *r->attribute);
    return result;
}

/* ---- faces and other elements ---- */

static bool is_corner_list(const ply_property *property)
{
    return property->list_type && (strcmp(property->name, "vertex_indices") == 0 ||
                                   strcmp(property->name, "vertex_index") == 0);
}

static mrt_result read_corner_count(ply_reader *r, const ply_property *property, int64_t *out)
{
    if (property->type >= PLY_FLOAT32)
        return error_set(r->err, MRT_ERR_FORMAT, "the vertex indices must be whole numbers");
    return read_list_length(r, property->list_type, out);
}

static mrt_result read_corners(ply_reader *r, const ply_property *property)
{
    int64_t corner_count = 0;
    double index;
    mrt_result result = read_corner_count(r, property, &corner_count);
    for (int64_t i = 0; result == MRT_OK && i < corner_count; ++i) {
        result = read_number(r, property->type, &index);
        if (result == MRT_OK)
            result = mesh_build_corner(&r->build, (int64_t)index, r->err);
    }
    return result < 0 ? result : mesh_build_face(&r->build, r->err);
}

static mrt_result add_triangle(ply_reader *r, const int64_t corner[3])
{
    mrt_result result = MRT_OK;
    for (int i = 0; result == MRT_OK && i < 3; ++i)
        result = mesh_build_corner(&r->build, corner[i], r->err);
    return result < 0 ? result : mesh_build_face(&r->build, r->err);
}

/* Reads a list of triangle strips. Each vertex forms a triangle with the two before it, with
 * alternating orientation. -1 begins a new strip. A triangle that uses a vertex twice only joins
 * two strips. */
static mrt_result read_strips(ply_reader *r, const ply_property *property)
{
    int64_t count = 0, before[2] = {0, 0};
    double number;
    mrt_result result = read_corner_count(r, property, &count);
    for (int64_t i = 0, length = 0; result == MRT_OK && i < count; ++i) {
        result = read_number(r, property->type, &number);
        if (result < 0)
            break;
        int64_t vertex = (int64_t)number;
        if (vertex == -1) {
            length = 0;
            continue;
        }
        const int64_t corner[3] = {before[length % 2 ? 1 : 0], before[length % 2 ? 0 : 1], vertex};
        if (length >= 2 && corner[0] != corner[1] && corner[1] != vertex && corner[0] != vertex)
            result = add_triangle(r, corner);
        before[0] = before[1];
        before[1] = vertex;
        length += 1;
    }
    return result;
}

/* Reads an element. Skips all its properties except the list of its corners. */
static mrt_result read_surface(ply_reader *r, const ply_element *e,
                               mrt_result (*read_list)(ply_reader *, const ply_property *))
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result == MRT_OK && i < e->property_count; ++i) {
        const ply_property *property = &r->header.property[e->first_property + i];
        bool is_read = read_list && is_corner_list(property);
        result = is_read ? read_list(r, property) : skip_property(r, property);
    }
    return result;
}

static mrt_result read_face(ply_reader *r, const ply_element *e)
{
    return read_surface(r, e, read_corners);
}

static mrt_result read_strip_element(ply_reader *r, const ply_element *e)
{
    return read_surface(r, e, read_strips);
}

static mrt_result skip_element(ply_reader *r, const ply_element *e)
{
    return read_surface(r, e, NULL);
}

static bool is_strips(const ply_element *e)
{
    return strcmp(e->name, "tristrips") == 0;
}

static void name_element(const ply_reader *r, const ply_element *e, int64_t index)
{
    char prefix[96];
    if (r->header.format == PLY_ASCII) {
        mesh_text_at_line(r->err, r->line_number);
        return;
    }
    (void)snprintf(prefix, sizeof prefix, "%s %lld", e->name, (long long)index);
    error_prefix(r->err, prefix);
}

static mrt_result read_elements(ply_reader *r, const ply_element *e,
                                mrt_result (*read)(ply_reader *, const ply_element *))
{
    for (int64_t i = 0; i < e->count; ++i) {
        mrt_result result = next_line(r);
        if (result == MRT_OK)
            result = read(r, e);
        if (result == MRT_OK)
            result = end_line(r);
        if (result < 0) {
            name_element(r, e, i);
            return result;
        }
    }
    return MRT_OK;
}

static bool is_vertices(const ply_element *e)
{
    return strcmp(e->name, "vertex") == 0;
}

static bool is_faces(const ply_element *e)
{
    return strcmp(e->name, "face") == 0;
}

typedef enum ply_pass { PASS_ALL = 0, PASS_VERTICES, PASS_SURFACE } ply_pass;

/* Reads the elements of the pass and skips the others. */
static mrt_result read_pass(ply_reader *r, ply_pass pass)
{
    bool has_vertices = false;
    for (uint32_t i = 0; i < r->header.element_count; ++i) {
        const ply_element *e = &r->header.element[i];
        mrt_result result;
        if (is_vertices(e) && pass != PASS_SURFACE) {
            if (has_vertices)
                return error_set(r->err, MRT_ERR_FORMAT, "element \"vertex\" appears twice");
            has_vertices = true;
            result = assign_roles(r, e);
            if (result == MRT_OK)
                result = read_elements(r, e, read_vertex);
        } else if (is_faces(e) && pass != PASS_VERTICES) {
            result = read_elements(r, e, read_face);
        } else if (is_strips(e) && pass != PASS_VERTICES) {
            result = read_elements(r, e, read_strip_element);
        } else {
            result = read_elements(r, e, skip_element);
        }
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static bool has_surface_before_vertices(const ply_header *h)
{
    bool has_surface = false;
    for (uint32_t i = 0; i < h->element_count && !is_vertices(&h->element[i]); ++i)
        has_surface = has_surface || is_faces(&h->element[i]) || is_strips(&h->element[i]);
    return has_surface;
}

/* Faces before the vertices are read in a second pass, when the number of vertices is known. */
static mrt_result read_body(ply_reader *r)
{
    if (!has_surface_before_vertices(&r->header))
        return read_pass(r, PASS_ALL);
    const text_view body = r->rest;
    const uint64_t line_number = r->line_number;
    mrt_result result = read_pass(r, PASS_VERTICES);
    if (result < 0)
        return result;
    r->rest = body;
    r->line_number = line_number;
    return read_pass(r, PASS_SURFACE);
}

static mrt_result take_attributes(const ply_reader *r, mesh *out)
{
    if (r->attribute_count == 0)
        return MRT_OK;
    out->attribute = calloc(r->attribute_count, sizeof *out->attribute);
    if (!out->attribute)
        return error_set(r->err, MRT_ERR_MEMORY, "no memory for the attributes");
    for (uint32_t i = 0; i < r->attribute_count; ++i) {
        mesh_attribute *attribute = &out->attribute[i];
        out->attribute_count += 1;
        attribute->component_count = 1;
        attribute->name = strdup(r->header.property[r->attribute_property[i]].name);
        attribute->value = malloc(out->vertex_count * sizeof *attribute->value);
        if (!attribute->name || !attribute->value)
            return error_set(r->err, MRT_ERR_MEMORY, "no memory for the attributes");
        for (size_t v = 0; v < out->vertex_count; ++v)
            attribute->value[v] = r->attribute[v * r->attribute_count + i];
    }
    return MRT_OK;
}

static void note_what_was_not_read(const ply_reader *r, mesh *out)
{
    for (uint32_t i = 0; i < r->header.element_count; ++i) {
        const ply_element *e = &r->header.element[i];
        if (!is_vertices(e) && !is_faces(e) && !is_strips(e))
            mesh_note(out, "element \"%s\" was skipped", e->name);
    }
    if (r->passed_over_count)
        mesh_note(out, "%u vertex properties that are not floating-point numbers were skipped",
                  r->passed_over_count);
    mesh_build_note_colours(out, r->unreadable_count);
    if (text_trim(r->rest).at != r->rest.end)
        mesh_note(out, "data after the last element was skipped");
}

mrt_result ply_parse(mesh *out, const void *data, size_t size, error *err)
{
    *out = (mesh){0};
    ply_reader *r = calloc(1, sizeof *r);
    if (!r)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the reader");
    r->rest = text_view_of(data, size);
    r->err = err;
    mesh_build_init(&r->build);
    mrt_result result = parse_header(&r->header, &r->rest, err);
    r->line_number = r->header.line_count;
    if (result == MRT_OK)
        result = read_body(r);
    if (result == MRT_OK)
        result = mesh_build_take(&r->build, out, err);
    if (result == MRT_OK)
        result = take_attributes(r, out);
    if (result == MRT_OK && has_colours(r)) {
        out->colour = r->colour;
        r->colour = NULL;
    }
    if (result == MRT_OK)
        note_what_was_not_read(r, out);
    else
        mesh_destroy(out);
    mesh_build_finish(&r->build);
    free(r->attribute);
    free(r->colour);
    free(r);
    return result;
}
