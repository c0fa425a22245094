#include "io/read/mesh_wire.h"

#include "base/text.h"

#include <stdlib.h>
#include <string.h>

enum { MAGIC_SIZE = 8, HEADER_SIZE = 20, COUNT_MAX = INT32_MAX / 3 };
static const char MESH_MAGIC[MAGIC_SIZE + 1] = "MRTMESH1",
                                          FAILURE_MAGIC[MAGIC_SIZE + 1] = "MRTFAIL1";

/* The header: magic, vertex count, triangle count, note length; then positions, triangles, note. */
void mesh_wire_write(FILE *stream, const mesh *m)
{
    uint32_t note_length = m->note ? (uint32_t)strlen(m->note) : 0;
    uint32_t header[3] = {m->vertex_count, m->triangle_count, note_length};
    (void)fwrite(MESH_MAGIC, 1, MAGIC_SIZE, stream);
    (void)fwrite(header, sizeof *header, 3, stream);
    (void)fwrite(m->position, 3 * sizeof *m->position, m->vertex_count, stream);
    (void)fwrite(m->triangle, 3 * sizeof *m->triangle, m->triangle_count, stream);
    if (note_length)
        (void)fwrite(m->note, 1, note_length, stream);
}

void mesh_wire_write_failure(FILE *stream, const char *text)
{
    (void)fwrite(FAILURE_MAGIC, 1, MAGIC_SIZE, stream);
    (void)fwrite(text, 1, strlen(text), stream);
}

static mrt_result parse_failure(const char *text, size_t length, error *err)
{
    char reason[512];
    text_copy(reason, sizeof reason, text_view_of(text, length));
    return error_set(err, MRT_ERR_FORMAT, "%s", reason);
}

static void copy_note(mesh *out, const char *at, const char *end)
{
    text_view rest = {at, end}, line;
    char text[256];
    while (text_next_line(&rest, &line)) {
        text_copy(text, sizeof text, line);
        mesh_note(out, "%s", text);
    }
}

mrt_result mesh_wire_parse(mesh *out, const void *data, size_t size, error *err)
{
    const char *at = data;
    uint32_t header[3];
    *out = (mesh){0};
    if (size >= MAGIC_SIZE && memcmp(at, FAILURE_MAGIC, MAGIC_SIZE) == 0)
        return parse_failure(at + MAGIC_SIZE, size - MAGIC_SIZE, err);
    if (size < HEADER_SIZE || memcmp(at, MESH_MAGIC, MAGIC_SIZE) != 0)
        return error_set(err, MRT_ERR_FORMAT, "the reader did not finish");
    memcpy(header, at + MAGIC_SIZE, sizeof header);
    uint64_t position_size = (uint64_t)header[0] * 12, triangle_size = (uint64_t)header[1] * 12;
    if (header[0] > COUNT_MAX || header[1] > COUNT_MAX ||
        HEADER_SIZE + position_size + triangle_size + header[2] != size)
        return error_set(err, MRT_ERR_FORMAT, "the reader did not finish");
    mrt_result result = mesh_create(out, header[0], header[1], err);
    if (result < 0)
        return result;
    memcpy(out->position, at + HEADER_SIZE, (size_t)position_size);
    memcpy(out->triangle, at + HEADER_SIZE + position_size, (size_t)triangle_size);
    copy_note(out, at + HEADER_SIZE + position_size + triangle_size, at + size);
    result = mesh_validate(out, err);
    if (result < 0)
        mesh_destroy(out);
    return result;
}
