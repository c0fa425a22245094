/* mesh/weld.h - finds the vertices of a mesh that are one point of its surface. Files repeat a
 * vertex wherever a texture, a hard edge, a material or a part ends, but the surface continues
 * there. [main] */
#ifndef MAROTTE_MESH_WELD_H
#define MAROTTE_MESH_WELD_H
#include "mesh/mesh.h"

/* Sets m->point and m->smooth. Points that a reader has set in m->point (m->smooth is NULL then)
 * are kept: their vertices are treated as one.
 * Two open edges of triangles that coincide (within a millionth of the mesh's size), in opposite
 * directions, are one edge, and their ends are one point. This does not apply if the two triangles
 * face each other, like lips that touch, or are on each other. If more than two edges meet, the
 * straightest continuations are joined.
 * A chain of such edges with equal attributes (texture, normals, part) whose ends are vertices that
 * both sides share is a slit, and stays open.
 * Vertices of one point get exactly the position and the target offsets of its first vertex. Those
 * whose normals in the file differ by less than 20 degrees are smooth (without normals: all). */
CHECKED mrt_result mesh_weld(mesh *m, error *err);

#endif
