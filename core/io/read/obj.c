/* Wavefront OBJ: reads v (with colours), vt, f, o, g, usemtl and mtllib (mtl.h). Normals and
 * smoothing are skipped, and all other statements are counted in a note. Texture coordinates are
 * used only in a file with mtllib. Without it, its vertices are not split. */
#include "io/read/mesh_build.h"
#include "io/read/mtl.h"
#include "base/file.h"
#include "io/mesh_file.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NUMBERS_MAX = 7, COLOURED = 6 }; /* x y z red green blue */

typedef struct obj_reader {
    mesh_build build;
    float *uv; /* uv_count by 2, as in glTF; NaN: the line is invalid */
    size_t uv_count, uv_capacity;
    size_t lost_count; /* corners with missing coordinates */
    float *colour;     /* colour_count by 4, linear; the vertices after them have none */
    size_t colour_count, colour_capacity;
    size_t coloured_count, unreadable_count; /* vertices with a colour; of them, not a number */
    text_view rest, line;
    uint64_t line_number;
    size_t unknown_count;
    char unknown[32]; /* the first unknown statement */
    error *err;
} obj_reader;

static bool next_line(obj_reader *r)
{
    r->line_number += 1;
    return text_next_line(&r->rest, &r->line);
}

/* Like text_next_word, but continues on the next line after a single backslash. */
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

/* Sets the colours of all vertices without one to white. */
static mrt_result fill_colours(obj_reader *r, size_t vertex_count)
{
    mrt_result result = mesh_build_grow((void **)&r->colour, &r->colour_capacity, vertex_count,
                                        4 * sizeof *r->colour, r->err);
    if (result < 0)
        return result;
    for (size_t i = r->colour_count * 4; i < vertex_count * 4; ++i)
        r->colour[i] = 1.0f;
    r->colour_count = vertex_count;
    return MRT_OK;
}

/* Sets the colour of the last vertex. */
static mrt_result add_colour(obj_reader *r, const float srgb[3])
{
    mrt_result result = fill_colours(r, r->build.vertex_count);
    if (result < 0)
        return result;
    r->coloured_count += 1;
    if (!mesh_build_colour(r->colour + (r->colour_count - 1) * 4, srgb))
        r->unreadable_count += 1;
    return MRT_OK;
}

/* Gives the mesh its colours. A vertex that was split has the colour of its first version. */
static mrt_result take_colours(obj_reader *r, size_t vertex_count, mesh *out)
{
    if (r->coloured_count == 0)
        return MRT_OK;
    mrt_result result = fill_colours(r, vertex_count);
    if (result < 0)
        return result;
    out->colour = malloc((size_t)out->vertex_count * 4 * sizeof *out->colour);
    if (!out->colour)
        return error_set(r->err, MRT_ERR_MEMORY, "no memory for the colours");
    for (uint32_t v = 0; v < out->vertex_count; ++v)
        memcpy(out->colour + (size_t)v * 4, r->colour + (size_t)mesh_point(out, v) * 4,
               4 * sizeof *out->colour);
    if (r->coloured_count < vertex_count)
        mesh_note(out, "%zu vertices have no colour and are white",
                  vertex_count - r->coloured_count);
    mesh_build_note_colours(out, r->unreadable_count);
    return MRT_OK;
}

static mrt_result read_vertex(obj_reader *r)
{
    float number[NUMBERS_MAX];
    size_t count = 0;
    text_view word;
    while (next_word(r, &word)) {
        if (count == NUMBERS_MAX)
            return mesh_text_unexpected(
                r->err, "a vertex of at most 7 numbers (x y z, weight or colour)", word);
        if (count >= 3 && mesh_text_is_not_finite(word))
            number[count] = NAN;
        else if (!text_float(word, &number[count]))
            return mesh_text_unexpected(r->err, "a finite number", word);
        count += 1;
    }
    if (count < 3)
        return error_set(r->err, MRT_ERR_FORMAT, "a vertex has %zu numbers, x y z were expected",
                         count);
    mrt_result result = mesh_build_vertex(&r->build, number, r->err);
    return result == MRT_OK && count >= COLOURED ? add_colour(r, number + 3) : result;
}

/* Reads "vt u" or "vt u v" and ignores further numbers. An invalid one loses only its texture
 * coordinates. */
static mrt_result read_uv(obj_reader *r)
{
    float number[2] = {0.0f, 0.0f};
    text_view word;
    bool is_good = next_word(r, &word) && text_float(word, &number[0]);
    if (is_good && next_word(r, &word))
        is_good = text_float(word, &number[1]);
    mrt_result result = mesh_build_grow((void **)&r->uv, &r->uv_capacity, r->uv_count + 1,
                                        2 * sizeof *r->uv, r->err);
    if (result < 0)
        return result;
    r->uv[r->uv_count * 2] = is_good ? number[0] : NAN;
    r->uv[r->uv_count * 2 + 1] = is_good ? 1.0f - number[1] : NAN;
    r->uv_count += 1;
    return MRT_OK;
}

/* Parses v, v/vt, v//vn or v/vt/vn; vt and vn may be empty. vn must be a number, but is not used.
 * out_uv: 0: none. */
static bool parse_corner(text_view word, int64_t *out_index, int64_t *out_uv)
{
    text_view field;
    int64_t number[2] = {0, 0};
    if (!text_next_field(&word, '/', &field) || !text_int(field, out_index))
        return false;
    for (int i = 0; i < 2 && text_next_field(&word, '/', &field); ++i)
        if (field.at < field.end && !text_int(field, &number[i]))
            return false;
    *out_uv = number[0];
    return !word.at;
}

static void put_uv(obj_reader *r, int64_t index)
{
    int64_t count = (int64_t)r->uv_count;
    bool is_there = index != 0 && index <= count && index >= -count;
    const float *uv = is_there ? r->uv + (index > 0 ? index - 1 : count + index) * 2 : NULL;
    if (uv && !isnan(uv[0]))
        mesh_build_corner_uv(&r->build, uv);
    else
        r->lost_count += 1;
}

static mrt_result read_face(obj_reader *r)
{
    text_view word;
    while (next_word(r, &word)) {
        int64_t index, uv;
        if (!parse_corner(word, &index, &uv))
            return mesh_text_unexpected(r->err, "a corner as v, v/vt, v//vn or v/vt/vn", word);
        int64_t vertex_count = (int64_t)r->build.vertex_count;
        if (index == 0 || index > vertex_count || index < -vertex_count)
            return error_set(r->err, MRT_ERR_FORMAT,
                             "a face uses vertex %lld, but %lld vertices are defined so far",
                             (long long)index, (long long)vertex_count);
        mrt_result result =
            mesh_build_corner(&r->build, index > 0 ? index - 1 : vertex_count + index, r->err);
        if (result < 0)
            return result;
        if (r->build.keeps_uv && uv != 0)
            put_uv(r, uv);
    }
    return mesh_build_face(&r->build, r->err);
}

static bool is_passed_over(text_view keyword)
{
    static const char *const known[] = {"vn", "s", "vt", "mtllib"};
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (text_equals(keyword, known[i]))
            return true;
    return *keyword.at == '#';
}

static mrt_result read_statement(obj_reader *r)
{
    text_view keyword;
    mrt_result result = mesh_text_check_line(r->line, r->err);
    if (result < 0 || !next_word(r, &keyword))
        return result;
    if (text_equals(keyword, "v"))
        return read_vertex(r);
    if (r->build.keeps_uv && text_equals(keyword, "vt"))
        return read_uv(r);
    if (is_passed_over(keyword))
        return MRT_OK;
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

/* ---- materials ---- */

/* Finds the names after the next mtllib. */
static bool next_library(text_view *rest, text_view *out_names)
{
    text_view line, keyword;
    while (text_next_line(rest, &line))
        if (text_next_word(&line, &keyword) && text_equals(keyword, "mtllib")) {
            *out_names = text_trim(line);
            return true;
        }
    return false;
}

static mrt_result add_looks(mesh *m, text_view text, const char *directory, mesh_vertices vertices,
                            error *err)
{
    mtl_library library = {0};
    mrt_result result = MRT_OK;
    const size_t size = (size_t)(text.end - text.at);
    for (text_view names; result >= 0 && next_library(&text, &names);) {
        char shown[128];
        error why = {""};
        mrt_result one = mtl_read(&library, names, directory, &why);
        text_copy(shown, sizeof shown, names);
        if (one == MRT_ERR_MEMORY)
            result = error_set(err, one, "%s", why.text);
        else if (one < 0)
            mesh_note(m, "its materials \"%s\" cannot be read, so it is grey: %s", shown, why.text);
    }
    uint32_t without_uv = result >= 0 ? mtl_apply(m, &library, directory, size) : 0;
    if (without_uv && vertices == MESH_VERTICES_AS_WRITTEN)
        mesh_note(m, "its pictures are not drawn: they need more vertices than the rig was made "
                     "for; marotte rig new drafts one that has them");
    else if (without_uv)
        mesh_note(m, "its pictures are not drawn: it has no texture coordinates");
    mtl_library_finish(&library);
    return result;
}

static mrt_result read_statements(obj_reader *r)
{
    while (next_line(r)) {
        uint64_t line_number = r->line_number;
        mrt_result result = read_statement(r);
        if (result < 0) {
            mesh_text_at_line(r->err, line_number);
            return result;
        }
    }
    return MRT_OK;
}

mrt_result obj_parse(mesh *out, const void *data, size_t size, const char *directory,
                     mesh_vertices vertices, error *err)
{
    const text_view all = text_view_of(data, size);
    obj_reader r = {.rest = all, .err = err};
    text_view search = all, names;
    *out = (mesh){0};
    mesh_build_init(&r.build);
    const bool has_looks = next_library(&search, &names);
    r.build.keeps_uv = has_looks && vertices == MESH_VERTICES_ALL;
    mrt_result result = read_statements(&r);
    const size_t vertex_count = r.build.vertex_count;
    free(r.uv);
    if (result < 0) {
        mesh_build_finish(&r.build);
        free(r.colour);
        return result;
    }
    result = mesh_build_take(&r.build, out, err);
    if (result == MRT_OK)
        result = take_colours(&r, vertex_count, out);
    free(r.colour);
    if (result == MRT_OK && r.unknown_count)
        mesh_note(out, "%zu statements were skipped, the first is \"%s\"", r.unknown_count,
                  r.unknown);
    if (result == MRT_OK && r.lost_count)
        mesh_note(out, "%zu corners refer to missing texture coordinates", r.lost_count);
    if (result == MRT_OK && has_looks)
        result = add_looks(out, all, directory, vertices, err);
    if (result < 0)
        mesh_destroy(out);
    return result;
}

/* ---- files that an OBJ refers to ---- */

static mrt_result tell(const char *directory, const char *name, obj_file *found, void *self,
                       error *err)
{
    char path[PATH_MAX];
    error ignored = {""};
    int length = snprintf(path, sizeof path, "%s%s", directory, name);
    bool is_read = length > 0 && (size_t)length < sizeof path && access(path, R_OK) == 0 &&
                   file_check_below(directory, path, &ignored) >= 0;
    return is_read ? found(self, name, err) : MRT_OK;
}

mrt_result obj_files(const void *data, size_t size, const char *directory, obj_file *found,
                     void *self, error *err)
{
    mtl_library library = {0};
    mrt_result result = MRT_OK;
    text_view text = text_view_of(data, size);
    for (text_view names; result >= 0 && next_library(&text, &names);) {
        error ignored = {""};
        if (mtl_read(&library, names, directory, &ignored) == MRT_ERR_MEMORY)
            result = error_set(err, MRT_ERR_MEMORY, "%s", ignored.text);
    }
    for (uint32_t i = 0; result >= 0 && i < library.file_count; ++i)
        result = tell(directory, library.file[i], found, self, err);
    for (size_t i = 0; i < library.count; ++i)
        for (int use = 0; result >= 0 && use < MTL_USES; ++use)
            if (use != MTL_CLEAR && library.material[i].map[use].file)
                result = tell(directory, library.material[i].map[use].file, found, self, err);
    mtl_library_finish(&library);
    return result;
}
