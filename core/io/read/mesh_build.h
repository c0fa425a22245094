/* io/read/mesh_build.h - builds a mesh from the vertices and corners that a reader adds: polygons
 * become triangles, groups become parts. Does not cover the file formats. Memory grows only with
 * the added data, never with the counts in a header. One thread at a time. */
#ifndef MAROTTE_IO_MESH_BUILD_H
#define MAROTTE_IO_MESH_BUILD_H
#include "base/text.h"
#include "mesh/mesh.h"

enum {
    MESH_BUILD_NAMES_MAX = 65536, /* parts, and materials */
    MESH_BUILD_NAME_LENGTH_MAX = 255
};

typedef struct mesh_build_name { /* a part (name and material) or a material (material 0) */
    char *text;
    uint32_t material;
} mesh_build_name;

typedef struct mesh_build_table { /* names in order of appearance, found by hash */
    mesh_build_name *item;
    uint32_t *slot; /* slot_count, a power of two: 1 + item, 0 free */
    uint32_t count, slot_count;
} mesh_build_table;

typedef struct mesh_build {
    float *position;    /* vertex_count by 3 */
    float *normal;      /* normal_count by 3; dropped unless every vertex has one */
    uint32_t *triangle; /* triangle_count by 3 */
    uint32_t *part_of;  /* triangle_count */
    uint32_t *corner;   /* of the face being added */
    bool keeps_uv;      /* set before the first face: stores texture coordinates */
    float *corner_uv;   /* if keeps_uv: of each corner, as in glTF; NaN: none */
    float *triangle_uv; /* triangle_count by 3 by 2, likewise */
    float *uv;          /* of each vertex, once vertices are split */
    uint32_t *origin;   /* likewise: itself, or the vertex that it was split from */
    size_t vertex_count, vertex_capacity, triangle_count, triangle_capacity;
    size_t corner_count, corner_capacity, normal_count, normal_capacity;
    size_t corner_uv_capacity, triangle_uv_capacity;
    mesh_build_table parts, materials;
    uint32_t part; /* of the next face; UINT32_MAX: look it up */
    char group[MESH_BUILD_NAME_LENGTH_MAX + 1], material[MESH_BUILD_NAME_LENGTH_MAX + 1];
    size_t polygon_count; /* faces of more than 4 corners */
} mesh_build;

void mesh_build_init(mesh_build *b);
void mesh_build_finish(mesh_build *b); /* accepts NULL, zeroed, taken */

CHECKED mrt_result mesh_build_vertex(mesh_build *b, const float position[3], error *err);
/* Adds the normal, of any length, of the next vertex without one. */
CHECKED mrt_result mesh_build_normal(mesh_build *b, const float normal[3], error *err);
/* Set the group and the material of the following faces. text_copy makes the names printable. */
void mesh_build_group(mesh_build *b, text_view name);
void mesh_build_material(mesh_build *b, text_view name);
/* Add a face: first its corners, which refer to earlier vertices, then its end (>= 3 corners).
 */
CHECKED mrt_result mesh_build_corner(mesh_build *b, int64_t vertex, error *err);
CHECKED mrt_result mesh_build_face(mesh_build *b, error *err);
/* Sets the texture coordinates of the last corner, if the build keeps them. */
void mesh_build_corner_uv(mesh_build *b, const float uv[2]);
/* Moves everything into `out` and finishes `b`. A mesh without vertices or faces is an error. A
 * vertex with several texture coordinates is split: the first one keeps its number, the others
 * follow all vertices, and all of them share one point (mesh.point). */
CHECKED mrt_result mesh_build_take(mesh_build *b, mesh *out, error *err);

/* Sets first_vertex and vertex_count of every part from its triangles. */
void mesh_build_part_ranges(mesh *m);
/* Makes the normals unit; drops them all, with a note, if one has no direction. */
void mesh_build_unit_normals(mesh *m);
/* Converts a colour, sRGB 0..1 as scanners and editors write it, to linear RGBA. A colour that is
 * not finite becomes white: returns false. */
bool mesh_build_colour(float out_rgba[4], const float srgb[3]);
/* Notes the number of vertices that are white because their colour is not a number. */
void mesh_build_note_colours(mesh *m, size_t count);
/* Notes the number of triangles that use a vertex twice. */
void mesh_build_note_degenerate(mesh *m);
/* Sets the error "EXPECTED was expected, "FOUND" was found" of a text file. */
mrt_result mesh_text_unexpected(error *err, const char *expected, text_view found);
/* Returns whether a word is what programs write for NaN or infinity. */
bool mesh_text_is_not_finite(text_view word);
/* Refuses a line that is longer than the limit. */
CHECKED mrt_result mesh_text_check_line(text_view line, error *err);
/* Adds the prefix "line 3: " to the error. */
void mesh_text_at_line(error *err, uint64_t line_number);

/* Grows *array to hold `needed` elements of `size` bytes. */
CHECKED mrt_result mesh_build_grow(void **array, size_t *capacity, size_t needed, size_t size,
                                   error *err);

#endif
