/* io/read/mesh_shape.h - measures of a mesh from which its axes are detected (mesh_frame.c): along
 * which axis left and right are alike, and from which side the surface has most relief, as a face
 * has. Pure. */
#ifndef MAROTTE_IO_MESH_SHAPE_H
#define MAROTTE_IO_MESH_SHAPE_H
#include "mesh/mesh.h"

/* The share of the surface, 0..1, whose mirror image lies on the surface, for mirror planes at
 * right angles to each axis of the file (x 0, y 1, z 2) near the middle. A mesh without area: 0. */
void mesh_symmetry(double out[3], const mesh *m);

/* How uneven the surface is that is seen from each side, in cells of a 64th of the size: the mean
 * amount of the depth's Laplacian. out[axis][0]: seen from the positive side, [1]: from the
 * negative one. False: no memory. */
CHECKED bool mesh_relief(double out[3][2], const mesh *m);

#endif
