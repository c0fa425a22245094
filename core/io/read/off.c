/* Geomview OFF as text: [ST][C][N]OFF. Normals are kept; colours and texture coordinates are
 * checked to be numbers and skipped. A face may run over several lines. */
#include "io/read/mesh_build.h"
#include "io/mesh_file.h"

#include <stdio.h>
#include <string.h>

enum { VERTEX_BYTES_MIN = 5, FACE_BYTES_MIN = 7 };

typedef struct off_reader {
    mesh_build build;
    text_view rest, line; /* line: its unread part, without the comment */
    uint64_t line_number;
    int64_t vertex_count, face_count;
    bool has_normals;
    error *err;
} off_reader;

/* Reads the next line that is not empty or a comment. */
static mrt_result next_line(off_reader *r, const char *expected)
{
    text_view line;
    do {
        if (!text_next_line(&r->rest, &line))
            return error_set(r->err, MRT_ERR_FORMAT, "the file ends where %s was expected",
                             expected);
        r->line_number += 1;
        mrt_result result = mesh_text_check_line(line, r->err);
        if (result < 0)
            return result;
        const char *comment =
            line.at < line.end ? memchr(line.at, '#', (size_t)(line.end - line.at)) : NULL;
        r->line = text_trim((text_view){line.at, comment ? comment : line.end});
    } while (r->line.at == r->line.end);
    return MRT_OK;
}

static bool skip_letters(text_view *word, const char *letters)
{
    size_t length = strlen(letters);
    if ((size_t)(word->end - word->at) < length || memcmp(word->at, letters, length) != 0)
        return false;
    word->at += length;
    return true;
}

static mrt_result read_keyword(off_reader *r)
{
    text_view rest = r->line, word, next;
    int64_t number;
    if (text_next_word(&rest, &word) && text_int(word, &number))
        return MRT_OK; /* the keyword is optional */
    text_view keyword = word;
    (void)skip_letters(&word, "ST");
    (void)skip_letters(&word, "C");
    r->has_normals = skip_letters(&word, "N");
    if (!skip_letters(&word, "OFF") || word.at != word.end)
        return mesh_text_unexpected(r->err, "OFF, COFF, NOFF, CNOFF or STOFF", keyword);
    r->line = text_trim(rest);
    if (text_next_word(&rest, &next) && text_equals(next, "BINARY"))
        return error_set(r->err, MRT_ERR_UNSUPPORTED,
                         "binary OFF is not read: export it as text or as .ply");
    return r->line.at < r->line.end ? MRT_OK : next_line(r, "the counts");
}

static mrt_result read_counts(off_reader *r, size_t size)
{
    int64_t count[3] = {0, 0, 0};
    text_view word;
    int found = 0;
    for (; text_next_word(&r->line, &word); ++found)
        if (found == 3 || !text_int(word, &count[found]) || count[found] < 0)
            return mesh_text_unexpected(r->err, "vertex, face and edge count", word);
    if (found < 2)
        return error_set(r->err, MRT_ERR_FORMAT, "vertex, face and edge count were expected");
    if (count[0] > (int64_t)(size / VERTEX_BYTES_MIN) + 1 ||
        count[1] > (int64_t)(size / FACE_BYTES_MIN) + 1)
        return error_set(r->err, MRT_ERR_FORMAT,
                         "%lld vertices and %lld faces do not fit into a file of %zu bytes",
                         (long long)count[0], (long long)count[1], size);
    r->vertex_count = count[0];
    r->face_count = count[1];
    return MRT_OK;
}

static mrt_result read_vertex(off_reader *r)
{
    float number[6];
    int needed = r->has_normals ? 6 : 3, found = 0;
    text_view word;
    mrt_result result = next_line(r, "a vertex");
    if (result < 0)
        return result;
    for (; text_next_word(&r->line, &word); ++found) {
        float ignored;
        bool is_colour = found >= needed && mesh_text_is_not_finite(word);
        if (!is_colour && !text_float(word, found < needed ? &number[found] : &ignored))
            return mesh_text_unexpected(r->err, "a finite number", word);
    }
    if (found < needed)
        return error_set(r->err, MRT_ERR_FORMAT, "a vertex has %d numbers, %d were expected", found,
                         needed);
    result = mesh_build_vertex(&r->build, number, r->err);
    if (result == MRT_OK && r->has_normals)
        result = mesh_build_normal(&r->build, number + 3, r->err);
    return result;
}

/* Reads the next word of a face, which may run over several lines. */
static mrt_result next_corner(off_reader *r, text_view *out_word, int64_t corner, int64_t count)
{
    char expected[80];
    if (text_next_word(&r->line, out_word))
        return MRT_OK;
    (void)snprintf(expected, sizeof expected, "corner %lld of a face of %lld",
                   (long long)corner + 1, (long long)count);
    mrt_result result = next_line(r, expected);
    if (result == MRT_OK)
        (void)text_next_word(&r->line, out_word); /* the line is not empty */
    return result;
}

static mrt_result read_face(off_reader *r)
{
    text_view word;
    int64_t corner_count, vertex;
    float ignored;
    mrt_result result = next_line(r, "a face");
    if (result < 0)
        return result;
    if (!text_next_word(&r->line, &word) || !text_int(word, &corner_count) || corner_count < 0)
        return mesh_text_unexpected(r->err, "the number of corners", word);
    for (int64_t i = 0; i < corner_count; ++i) {
        result = next_corner(r, &word, i, corner_count);
        if (result < 0)
            return result;
        if (!text_int(word, &vertex))
            return mesh_text_unexpected(r->err, "a vertex index", word);
        result = mesh_build_corner(&r->build, vertex, r->err);
        if (result < 0)
            return result;
    }
    while (text_next_word(&r->line, &word))
        if (!text_float(word, &ignored) && !mesh_text_is_not_finite(word))
            return mesh_text_unexpected(r->err, "a colour", word);
    return mesh_build_face(&r->build, r->err);
}

static mrt_result read_file(off_reader *r, size_t size)
{
    mrt_result result = next_line(r, "OFF");
    if (result == MRT_OK)
        result = read_keyword(r);
    if (result == MRT_OK)
        result = read_counts(r, size);
    for (int64_t i = 0; result == MRT_OK && i < r->vertex_count; ++i)
        result = read_vertex(r);
    for (int64_t i = 0; result == MRT_OK && i < r->face_count; ++i)
        result = read_face(r);
    return result;
}

mrt_result off_parse(mesh *out, const void *data, size_t size, error *err)
{
    off_reader r = {.rest = text_view_of(data, size), .err = err};
    *out = (mesh){0};
    mesh_build_init(&r.build);
    mrt_result result = read_file(&r, size);
    if (result < 0) {
        mesh_text_at_line(err, r.line_number);
        mesh_build_finish(&r.build);
        return result;
    }
    result = mesh_build_take(&r.build, out, err);
    if (result == MRT_OK && text_trim(r.rest).at != r.rest.end)
        mesh_note(out, "data after the last face was skipped");
    return result;
}
