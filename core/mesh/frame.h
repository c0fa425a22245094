/* mesh/frame.h - the unit and the axes of a mesh file's coordinates, and how a person writes them.
 * Leaves out finding them out (io/read/mesh_frame.h). Pure. */
#ifndef MAROTTE_MESH_FRAME_H
#define MAROTTE_MESH_FRAME_H
#include <stdbool.h>

/* A direction of the file's coordinates. */
typedef enum mesh_axis {
    MESH_AXIS_AUTO = 0, /* not said */
    MESH_AXIS_X,
    MESH_AXIS_Y,
    MESH_AXIS_Z,
    MESH_AXIS_MINUS_X,
    MESH_AXIS_MINUS_Y,
    MESH_AXIS_MINUS_Z
} mesh_axis;

/* An OBJ lists fewer vertices than its pictures need: a vertex may lie at several places of one. As
 * written it has no pictures, as it was read before it had them. */
typedef enum mesh_vertices { MESH_VERTICES_ALL = 0, MESH_VERTICES_AS_WRITTEN } mesh_vertices;

typedef struct mesh_frame { /* zeros: not said */
    double mm_per_unit;
    mesh_axis up, forward;
    mesh_vertices vertices;
} mesh_frame;

/* "mm", "cm", "m" or a number of mm; "x", "+y", "-z". False: it is none. */
bool mesh_unit_parse(double *out_mm, const char *word);
bool mesh_axis_parse(mesh_axis *out, const char *word);
const char *mesh_axis_name(mesh_axis axis); /* "y", "-z"; "" for MESH_AXIS_AUTO */

#endif
