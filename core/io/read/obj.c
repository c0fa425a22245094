/* Wavefront OBJ: v, f, o, g and usemtl are read; texture coordinates, normals, smoothing and
 * material libraries are passed over; everything else is counted in a note. */
#include "io/read/mesh_build.h"
#include "io/mesh_file.h"

#include <stdio.h>

enum { LINE_LENGTH_MAX = 1 << 20, NUMBERS_MAX = 7 };

typedef struct obj_reader {
    mesh_build build;
    text_view rest, line;
    uint64_t line_number;
    size_t unknown_count;
    char unknown[32]; /* the first unknown statement */
    error *err;
} obj_reader;

static mrt_result malformed(obj_reader *r, const char *expected, text_view found)
{
    char text[48];
    text_copy(text, sizeof text, found);
    return error_set(r->err, MRT_ERR_FORMAT, "%s was expected, \"%s\" was found", expected, text);
}

static bool next_line(obj_reader *r)
{
    r->line_number += 1;
    return text_next_line(&r->rest, &r->line);
}

/* As text_next_word, going on in the next line after a single backslash. */
static bool next_word(obj_reader *r, text_view *out_word)
{
    while (text_next_word(&r->line, out_word)) {
        if (!text_equals(*out_word, "\\") || text_trim(r->line).at != text_trim(r->line).end)
            return true;
        if (!next_line(r))
            return false;
    }
    return false;
}

static mrt_result read_vertex(obj_reader *r)
{
    float number[NUMBERS_MAX];
    size_t count = 0;
    text_view word;
    while (next_word(r, &word)) {
        if (count == NUMBERS_MAX)
            return malformed(r, "a vertex of at most 7 numbers (x y z, weight or colour)", word);
        if (!text_float(word, &number[count]))
            return malformed(r, "a finite number", word);
        count += 1;
    }
    if (count < 3)
        return error_set(r->err, MRT_ERR_FORMAT, "a vertex has %zu numbers, x y z were expected",
                         count);
    return mesh_build_vertex(&r->build, number, r->err);
}

/* v, v/vt, v//vn or v/vt/vn; vt and vn must be numbers, but what they point to is not used. */
static bool parse_corner(text_view word, int64_t *out_index)
{
    text_view field;
    int64_t ignored;
    if (!text_next_field(&word, '/', &field) || !text_int(field, out_index))
        return false;
    for (int i = 0; i < 2 && text_next_field(&word, '/', &field); ++i) {
        bool may_be_empty = i == 0 && word.at;
        if (field.at == field.end ? !may_be_empty : !text_int(field, &ignored))
            return false;
    }
    return !word.at;
}

static mrt_result read_face(obj_reader *r)
{
    text_view word;
    while (next_word(r, &word)) {
        int64_t index;
        if (!parse_corner(word, &index))
            return malformed(r, "a corner as v, v/vt, v//vn or v/vt/vn", word);
        int64_t vertex_count = (int64_t)r->build.vertex_count;
        if (index == 0 || index > vertex_count || index < -vertex_count)
            return error_set(r->err, MRT_ERR_FORMAT,
                             "a face uses vertex %lld, but %lld vertices are defined so far",
                             (long long)index, (long long)vertex_count);
        mrt_result result =
            mesh_build_corner(&r->build, index > 0 ? index - 1 : vertex_count + index, r->err);
        if (result < 0)
            return result;
    }
    return mesh_build_face(&r->build, r->err);
}

static bool is_passed_over(text_view keyword)
{
    static const char *const known[] = {"vt", "vn", "s", "mtllib"};
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (text_equals(keyword, known[i]))
            return true;
    return *keyword.at == '#';
}

static mrt_result read_statement(obj_reader *r)
{
    text_view keyword;
    if (r->line.end - r->line.at > LINE_LENGTH_MAX)
        return error_set(r->err, MRT_ERR_FORMAT, "the line is longer than %d bytes",
                         LINE_LENGTH_MAX);
    if (!next_word(r, &keyword) || is_passed_over(keyword))
        return MRT_OK;
    if (text_equals(keyword, "v"))
        return read_vertex(r);
    if (text_equals(keyword, "f"))
        return read_face(r);
    if (text_equals(keyword, "g") || text_equals(keyword, "o"))
        mesh_build_group(&r->build, text_trim(r->line));
    else if (text_equals(keyword, "usemtl"))
        mesh_build_material(&r->build, text_trim(r->line));
    else if (r->unknown_count++ == 0)
        text_copy(r->unknown, sizeof r->unknown, keyword);
    return MRT_OK;
}

mrt_result obj_parse(mesh *out, const void *data, size_t size, error *err)
{
    obj_reader r = {.rest = text_view_of(data, size), .err = err};
    *out = (mesh){0};
    mesh_build_init(&r.build);
    while (next_line(&r)) {
        uint64_t line_number = r.line_number;
        mrt_result result = read_statement(&r);
        if (result < 0) {
            char prefix[32];
            (void)snprintf(prefix, sizeof prefix, "line %llu", (unsigned long long)line_number);
            error_prefix(err, prefix);
            mesh_build_finish(&r.build);
            return result;
        }
    }
    mrt_result result = mesh_build_take(&r.build, out, err);
    if (result == MRT_OK && r.unknown_count)
        mesh_note(out, "%zu statements were skipped, the first is \"%s\"", r.unknown_count,
                  r.unknown);
    return result;
}
