#include "io/read/ply_header.h"

#include <stdio.h>
#include <string.h>

static mrt_result malformed(error *err, const char *expected, text_view found)
{
    char text[48];
    text_copy(text, sizeof text, found);
    return error_set(err, MRT_ERR_FORMAT, "%s was expected, \"%s\" was found", expected, text);
}

size_t ply_type_size(ply_type type)
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
        return malformed(err, "a name of at most 63 letters", word);
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
        return malformed(err, "format ascii, binary_little_endian or binary_big_endian", word);
    if (!text_equals(version, "1.0"))
        return malformed(err, "version 1.0", version);
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
        return malformed(err, "the number of elements", word);
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
            return malformed(err, "a whole number type for the length of a list", word);
        (void)text_next_word(line, &word);
    }
    property->type = type_of(word);
    if (property->type == PLY_NONE)
        return malformed(err, "a type such as float or uchar", word);
    h->property_count += 1;
    h->element[h->element_count - 1].property_count += 1;
    return read_name(property->name, line, err);
}

/* Every element takes some bytes, so a count that they cannot hold is a lie. */
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

static mrt_result read_line(ply_header *h, text_view line, bool *out_end, bool *has_format,
                            error *err)
{
    text_view keyword = {line.end, line.end};
    if (line.end - line.at > PLY_LINE_LENGTH_MAX)
        return error_set(err, MRT_ERR_FORMAT, "the line is longer than %d bytes",
                         PLY_LINE_LENGTH_MAX);
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
    return malformed(err, "format, element, property, comment or end_header", keyword);
}

static mrt_result read_lines(ply_header *h, text_view *rest, error *err)
{
    text_view line;
    bool end = false, has_format = false;
    h->line_count = 1;
    if (!text_next_line(rest, &line) || !text_equals(text_trim(line), "ply"))
        return error_set(err, MRT_ERR_FORMAT, "\"ply\" was expected");
    while (!end) {
        h->line_count += 1;
        if (!text_next_line(rest, &line))
            return error_set(err, MRT_ERR_FORMAT, "the file ends before end_header");
        mrt_result result = read_line(h, line, &end, &has_format, err);
        if (result < 0)
            return result;
    }
    if (!has_format)
        return error_set(err, MRT_ERR_FORMAT, "the header has no format line");
    return check_counts(h, (size_t)(rest->end - rest->at), err);
}

mrt_result ply_header_parse(ply_header *out, text_view *rest, error *err)
{
    *out = (ply_header){0};
    mrt_result result = read_lines(out, rest, err);
    if (result < 0) {
        char prefix[32];
        (void)snprintf(prefix, sizeof prefix, "line %llu", (unsigned long long)out->line_count);
        error_prefix(err, prefix);
    }
    return result;
}
