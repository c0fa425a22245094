#include "io/mesh_file.h"

#include "base/file.h"
#include "base/text.h"
#include "base/trace.h"
#include "io/read/mesh_child.h"
#include "io/read/mesh_frame.h"
#include "io/read/mesh_images.h"
#include "mesh/weld.h"

#include <stdlib.h>
#include <string.h>

static const size_t FILE_SIZE_MAX = (size_t)1 << 30; /* bytes */

typedef enum mesh_format {
    FORMAT_UNKNOWN = 0,
    FORMAT_OBJ,
    FORMAT_PLY,
    FORMAT_OFF,
    FORMAT_GLTF,
    FORMAT_FOREIGN /* read by OpenMesh */
} mesh_format;

/* ---- detecting the format ---- */

/* Returns the first word outside '#' comments. */
static text_view first_word(const file_bytes *bytes)
{
    text_view rest = text_view_of(bytes->data, bytes->size < 4096 ? bytes->size : 4096);
    text_view line, word = {rest.end, rest.end};
    while (text_next_line(&rest, &line))
        if (text_next_word(&line, &word) && *word.at != '#')
            return word;
    return (text_view){rest.end, rest.end};
}

static mesh_format format_of_content(const file_bytes *bytes)
{
    static const char *const off[] = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                      "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
    if (bytes->size >= 4 && memcmp(bytes->data, "glTF", 4) == 0)
        return FORMAT_GLTF;
    if (bytes->size >= 4 && memcmp(bytes->data, "ply", 3) == 0 &&
        (bytes->data[3] == '\n' || bytes->data[3] == '\r'))
        return FORMAT_PLY;
    text_view word = first_word(bytes);
    for (size_t i = 0; i < sizeof off / sizeof *off; ++i)
        if (text_equals(word, off[i]))
            return FORMAT_OFF;
    return word.at < word.end && *word.at == '{' ? FORMAT_GLTF : FORMAT_UNKNOWN;
}

/* Names a file type that users often confuse with a mesh; NULL: none of these. */
static const char *other_kind(const file_bytes *bytes)
{
    static const struct {
        const char *begins, *is;
        size_t size;
    } known[] = {{"\x89PNG", "a PNG picture", 4},
                 {"\xff\xd8\xff", "a JPEG picture", 3},
                 {"Kaydara FBX", "an FBX file: import it into Blender and export it as .glb", 11},
                 {"BLENDER", "a Blender file: export it from Blender as .glb", 7},
                 {"PK\x03\x04", "an archive: unpack it first", 4},
                 {"7z\xbc\xaf", "an archive: unpack it first", 4},
                 {"Rar!", "an archive: unpack it first", 4},
                 {"RIFF", "a sound or a film", 4},
                 {"%PDF", "a document", 4},
                 {"<!DOCTYPE", "a web page: download the file itself", 9},
                 {"<html", "a web page: download the file itself", 5},
                 {"version https://git-lfs", "a Git LFS pointer: download the file itself", 23}};
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (bytes->size >= known[i].size &&
            memcmp(bytes->data, known[i].begins, known[i].size) == 0)
            return known[i].is;
    return NULL;
}

static mesh_format format_of_name(const char *path)
{
    static const struct {
        const char *extension;
        mesh_format format;
    } known[] = {{"obj", FORMAT_OBJ},     {"ply", FORMAT_PLY},      {"off", FORMAT_OFF},
                 {"gltf", FORMAT_GLTF},   {"glb", FORMAT_GLTF},     {"vrm", FORMAT_GLTF},
                 {"stl", FORMAT_FOREIGN}, {"stla", FORMAT_FOREIGN}, {"stlb", FORMAT_FOREIGN},
                 {"om", FORMAT_FOREIGN}};
    file_extension extension = file_extension_of(path);
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (strcmp(extension.text, known[i].extension) == 0)
            return known[i].format;
    return FORMAT_UNKNOWN;
}

/* Parses a format that refers to other files. */
static mrt_result parse_in_folder(mesh *out, mesh_format format, const file_bytes *bytes,
                                  const char *path, mesh_vertices vertices, error *err)
{
    char *directory = file_directory(path);
    if (!directory)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = format == FORMAT_GLTF
                            ? gltf_parse(out, bytes->data, bytes->size, directory, err)
                            : obj_parse(out, bytes->data, bytes->size, directory, vertices, err);
    free(directory);
    return result;
}

static mrt_result parse(mesh *out, mesh_format format, const file_bytes *bytes, const char *path,
                        mesh_vertices vertices, error *err)
{
    switch (format) {
    case FORMAT_OBJ:
    case FORMAT_GLTF:
        return parse_in_folder(out, format, bytes, path, vertices, err);
    case FORMAT_PLY:
        return ply_parse(out, bytes->data, bytes->size, err);
    case FORMAT_OFF:
        return off_parse(out, bytes->data, bytes->size, err);
    case FORMAT_FOREIGN:
        return mesh_child_read(out, path, err);
    case FORMAT_UNKNOWN:
        break;
    }
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "unknown mesh format: marotte reads .obj .ply .off .glb .gltf .vrm .stl .om");
}

/* glTF prescribes its unit and axes; programs that write STL have z up most often. */
static mesh_frame usual_frame(mesh_format format, const char *path)
{
    if (format == FORMAT_GLTF)
        return (mesh_frame){.mm_per_unit = 1000.0, .up = MESH_AXIS_Y, .forward = MESH_AXIS_Z};
    return strncmp(file_extension_of(path).text, "stl", 3) == 0
               ? (mesh_frame){.up = MESH_AXIS_Z, .forward = MESH_AXIS_MINUS_Y}
               : (mesh_frame){0};
}

mrt_result mesh_file_read(mesh *out, const char *path, const mesh_frame *frame, error *err)
{
    static const mesh_frame nothing = {0};
    file_bytes bytes;
    *out = (mesh){0};
    mrt_result result = file_read(&bytes, path, FILE_SIZE_MAX, err);
    if (result < 0)
        return result;
    mesh_format format = format_of_content(&bytes);
    if (format == FORMAT_UNKNOWN)
        format = format_of_name(path);
    const char *other = other_kind(&bytes);
    result =
        other ? error_set(err, MRT_ERR_FORMAT, "not a mesh file: %s", other)
              : parse(out, format, &bytes, path, frame ? frame->vertices : MESH_VERTICES_ALL, err);
    file_bytes_finish(&bytes);
    if (result == MRT_OK) {
        mesh_images_decode(out);
        const mesh_frame usual = usual_frame(format, path);
        result = mesh_frame_apply(out, frame ? frame : &nothing, &usual, err);
    }
    if (result == MRT_OK && !(out->path = strdup(path)))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a name");
    if (result == MRT_OK)
        result = mesh_validate(out, err);
    if (result == MRT_OK)
        result = mesh_weld(out, err);
    if (result < 0) {
        error_prefix(err, path);
        mesh_destroy(out);
    }
    TRACE(TRACE_IO, "%s: read %u vertices, %u triangles", path, out->vertex_count,
          out->triangle_count);
    return result;
}
