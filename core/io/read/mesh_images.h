/* io/read/mesh_images.h - the pictures of a mesh: taken from a file, then decoded. [main], decoding
 * waits up to 20 s. */
#ifndef MAROTTE_IO_MESH_IMAGES_H
#define MAROTTE_IO_MESH_IMAGES_H
#include "base/budget.h"
#include "base/file.h"
#include "mesh/mesh.h"

#define MESH_IMAGE_SIZE_MAX ((size_t)64 << 20) /* bytes, encoded */

/* Asked before a picture is read: a mesh has at most 64. */
CHECKED mrt_result mesh_image_room(const mesh *m, error *err);
/* Adds a copy of an encoded picture where there is room, paid out of `b`. out_image: 1 + its index.
 */
CHECKED mrt_result mesh_image_add(mesh *m, uint32_t *out_image, const char *name, const void *data,
                                  size_t size, budget *b, error *err);
/* A picture is not drawn: of the first the note says why, of others how many there are. */
void mesh_image_note(mesh *m, const char *name, const char *why);

/* Decodes all that are still encoded, in the child process; at most 256 MB of pixels, so many small
 * pictures have shorter sides. What cannot be decoded stays without pixels, and the note says why.
 */
void mesh_images_decode(mesh *m);

#endif
