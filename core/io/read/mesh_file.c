#include "io/mesh_file.h"

#include "base/file.h"
#include "base/text.h"
#include "io/read/mesh_child.h"
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
    FORMAT_FOREIGN /* OpenMesh reads it */
} mesh_format;

/* ---- which format ---- */

/* The first word that is no '#' comment. */
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

static mesh_format format_of_name(const char *path)
{
    static const struct {
        const char *extension;
        mesh_format format;
    } known[] = {{"obj", FORMAT_OBJ},      {"ply", FORMAT_PLY},      {"off", FORMAT_OFF},
                 {"gltf", FORMAT_GLTF},    {"glb", FORMAT_GLTF},     {"stl", FORMAT_FOREIGN},
                 {"stla", FORMAT_FOREIGN}, {"stlb", FORMAT_FOREIGN}, {"om", FORMAT_FOREIGN}};
    file_extension extension = file_extension_of(path);
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (strcmp(extension.text, known[i].extension) == 0)
            return known[i].format;
    return FORMAT_UNKNOWN;
}

static mrt_result parse_gltf(mesh *out, const file_bytes *bytes, const char *path, error *err)
{
    char *directory = file_directory(path);
    if (!directory)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = gltf_parse(out, bytes->data, bytes->size, directory, err);
    free(directory);
    return result;
}

static mrt_result parse(mesh *out, mesh_format format, const file_bytes *bytes, const char *path,
                        error *err)
{
    switch (format) {
    case FORMAT_OBJ:
        return obj_parse(out, bytes->data, bytes->size, err);
    case FORMAT_PLY:
        return ply_parse(out, bytes->data, bytes->size, err);
    case FORMAT_OFF:
        return off_parse(out, bytes->data, bytes->size, err);
    case FORMAT_GLTF:
        return parse_gltf(out, bytes, path, err);
    case FORMAT_FOREIGN:
        return mesh_child_read(out, path, err);
    case FORMAT_UNKNOWN:
        break;
    }
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "no mesh format that is known: .obj .ply .off .glb .gltf .stl .om are read");
}

/* ---- its unit ---- */

static void scale(mesh *m, double mm_per_unit)
{
    m->mm_per_unit = mm_per_unit;
    for (size_t i = 0; i < (size_t)m->vertex_count * 3; ++i)
        m->position[i] = (float)((double)m->position[i] * mm_per_unit);
    for (uint32_t t = 0; t < m->target_count; ++t)
        for (size_t i = 0; i < (size_t)m->vertex_count * 3; ++i)
            m->target[t].offset[i] = (float)((double)m->target[t].offset[i] * mm_per_unit);
    for (uint32_t j = 0; j < m->joint_count; ++j)
        for (size_t i = 3; i < 12; i += 4)
            m->joint[j].rest[i] = (float)((double)m->joint[j].rest[i] * mm_per_unit);
}

/* ---- its axes ---- */

static void axis_vector(int out[3], mesh_axis axis)
{
    out[0] = out[1] = out[2] = 0;
    if (axis != MESH_AXIS_AUTO)
        out[(axis - MESH_AXIS_X) % 3] = axis < MESH_AXIS_MINUS_X ? 1 : -1;
}

/* Rows: where each axis of the mesh lies in the file. */
static void turn_vectors(int turn[3][3], float *vector, size_t count)
{
    for (float *v = vector, *end = vector + count * 3; v < end; v += 3) {
        const float from[3] = {v[0], v[1], v[2]};
        for (int row = 0; row < 3; ++row)
            for (int axis = 0; axis < 3; ++axis)
                if (turn[row][axis])
                    v[row] = turn[row][axis] > 0 ? from[axis] : -from[axis];
    }
}

/* Up becomes +y, forward +z, and the left of whoever looks out of the face +x: no bit of a number
 * changes but its sign. */
static void turn_axes(mesh *m, mesh_axis up, mesh_axis forward)
{
    int turn[3][3];
    axis_vector(turn[1], up);
    axis_vector(turn[2], forward);
    for (int i = 0; i < 3; ++i)
        turn[0][i] = turn[1][(i + 1) % 3] * turn[2][(i + 2) % 3] -
                     turn[1][(i + 2) % 3] * turn[2][(i + 1) % 3];
    turn_vectors(turn, m->position, m->vertex_count);
    if (m->normal)
        turn_vectors(turn, m->normal, m->vertex_count);
    for (uint32_t t = 0; t < m->target_count; ++t)
        turn_vectors(turn, m->target[t].offset, m->vertex_count);
    for (uint32_t j = 0; j < m->joint_count; ++j)
        for (size_t column = 0; column < 4; ++column) {
            float *rest = m->joint[j].rest + column, vector[3] = {rest[0], rest[4], rest[8]};
            turn_vectors(turn, vector, 1);
            for (size_t row = 0; row < 3; ++row)
                rest[row * 4] = vector[row];
        }
}

static void set_axes(mesh *m)
{
    if (m->up == MESH_AXIS_AUTO)
        m->up = MESH_AXIS_Y;
    if (m->forward == MESH_AXIS_AUTO)
        m->forward = MESH_AXIS_Z;
    if (m->up == MESH_AXIS_Y && m->forward == MESH_AXIS_Z)
        return;
    turn_axes(m, m->up, m->forward);
    if (m->forward == MESH_AXIS_MINUS_Z)
        mesh_note(m, "it is VRM 0, which faces -z: it is turned round");
}

/* The unit in which a head is between 100 and 1000 mm high. */
static double guess_mm_per_unit(mesh *m)
{
    static const struct {
        const char *name;
        double mm;
    } unit[] = {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}};
    float low[3], high[3];
    mesh_bounds(m, low, high);
    double height = (double)high[1] - (double)low[1];
    for (size_t i = 0; i < sizeof unit / sizeof *unit; ++i) {
        double height_mm = height * unit[i].mm;
        if (height_mm >= 100.0 && height_mm <= 1000.0) {
            mesh_note(m, "the unit is taken for %s: so the height is %.0f mm", unit[i].name,
                      height_mm);
            return unit[i].mm;
        }
    }
    mesh_note(m, "the height of %g is no head's in m, cm or mm: taken for mm", height);
    return 1.0;
}

static double mm_per_unit_of(mesh *m, mesh_unit unit, mesh_format format)
{
    switch (unit) {
    case MESH_UNIT_MM:
        return 1.0;
    case MESH_UNIT_CM:
        return 10.0;
    case MESH_UNIT_M:
        return 1000.0;
    case MESH_UNIT_AUTO:
        break;
    }
    return format == FORMAT_GLTF ? 1000.0 : guess_mm_per_unit(m);
}

mrt_result mesh_file_read(mesh *out, const char *path, mesh_unit unit, error *err)
{
    file_bytes bytes;
    *out = (mesh){0};
    mrt_result result = file_read(&bytes, path, FILE_SIZE_MAX, err);
    if (result < 0)
        return result;
    mesh_format format = format_of_content(&bytes);
    if (format == FORMAT_UNKNOWN)
        format = format_of_name(path);
    result = parse(out, format, &bytes, path, err);
    file_bytes_finish(&bytes);
    if (result == MRT_OK) {
        set_axes(out);
        mesh_images_decode(out);
        scale(out, mm_per_unit_of(out, unit, format));
        result = mesh_validate(out, err);
    }
    if (result == MRT_OK)
        result = mesh_weld(out, err);
    if (result < 0) {
        error_prefix(err, path);
        mesh_destroy(out);
    }
    return result;
}
