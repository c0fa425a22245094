/* io/mesh_images.h - the pictures of a mesh, decoded. [main], waits up to 20 s. */
#ifndef MAROTTE_IO_MESH_IMAGES_H
#define MAROTTE_IO_MESH_IMAGES_H
#include "mesh/mesh.h"

/* Decodes all that are still encoded, in the child process; at most 256 MB of pixels, so many small
 * pictures have shorter sides. What cannot be decoded stays without pixels, and the note says why.
 */
void mesh_images_decode(mesh *m);

#endif
