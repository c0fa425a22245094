/* mesh/weld.h - which vertices of a mesh are one point of its surface. Files have a vertex twice
 * wherever a texture, a hard edge, a material or a part ends; the surface goes on there. [main] */
#ifndef MAROTTE_MESH_WELD_H
#define MAROTTE_MESH_WELD_H
#include "mesh/mesh.h"

/* Finds m->point and m->smooth anew; what a reader says of m->point (m->smooth is NULL then) is
 * kept: those are one vertex in all that follows. Two open edges of triangles that coincide (within
 * a millionth of the mesh's size), in opposite directions, are one edge, and their ends are one
 * point: but not where the two triangles face each other, as lips that touch, or lie on each other.
 * Where more than two edges meet, those that go on straightest are one. A chain of such edges that
 * differ in nothing (texture, normals, part) and ends at vertices that both sides share is a slit,
 * and stays open. Vertices of one point get the position and the target offsets of its first
 * vertex, bit for bit; those whose normals in the file are less than 20 degrees apart are smooth
 * (without normals: all). */
CHECKED mrt_result mesh_weld(mesh *m, error *err);

#endif
