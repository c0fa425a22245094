/* mesh/frame.h - the unit and the axes of the coordinates of a mesh file, and their text form.
 * Leaves out detecting them (io/read/mesh_frame.h). Pure. */
#ifndef MAROTTE_MESH_FRAME_H
#define MAROTTE_MESH_FRAME_H
#include <stdbool.h>

/* A direction of the file's coordinates. */
typedef enum mesh_axis {
    MESH_AXIS_AUTO = 0, /* not given */
    MESH_AXIS_X,
    MESH_AXIS_Y,
    MESH_AXIS_Z,
    MESH_AXIS_MINUS_X,
    MESH_AXIS_MINUS_Y,
    MESH_AXIS_MINUS_Z
} mesh_axis;

/* An OBJ may list fewer vertices than its pictures need, because a vertex can have several texture
 * coordinates. AS_WRITTEN reads it without pictures, with the vertices of the file, as in earlier
 * versions. */
typedef enum mesh_vertices { MESH_VERTICES_ALL = 0, MESH_VERTICES_AS_WRITTEN } mesh_vertices;

typedef struct mesh_frame { /* zeroed: not given */
    double mm_per_unit;
    mesh_axis up, forward;
    mesh_vertices vertices;
} mesh_frame;

/* Parse "mm", "cm", "m" or a number of mm; "x", "+y", "-z". False: invalid. */
bool mesh_unit_parse(double *out_mm, const char *word);
bool mesh_axis_parse(mesh_axis *out, const char *word);
const char *mesh_axis_name(mesh_axis axis); /* returns "y", "-z"; "" for MESH_AXIS_AUTO */

#endif
