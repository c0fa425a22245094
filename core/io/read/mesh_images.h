/* io/read/mesh_images.h - the pictures of a mesh: taken from a file, then decoded. [main], decoding
 * waits up to 20 s. */
#ifndef MAROTTE_IO_MESH_IMAGES_H
#define MAROTTE_IO_MESH_IMAGES_H
#include "base/budget.h"
#include "base/file.h"
#include "mesh/mesh.h"

#define MESH_IMAGE_SIZE_MAX ((size_t)64 << 20) /* bytes, encoded */

/* Fails if the mesh has no space for another picture; call it before reading one. A mesh has at
 * most 64. */
CHECKED mrt_result mesh_image_room(const mesh *m, error *err);
/* Adds a copy of an encoded picture if the mesh has space, and pays for it from `b`. out_image: 1 +
 * its index. */
CHECKED mrt_result mesh_image_add(mesh *m, uint32_t *out_image, const char *name, const void *data,
                                  size_t size, budget *b, error *err);
/* Notes that a picture is not drawn: the reason for the first picture, and the number of the
 * others. */
void mesh_image_note(mesh *m, const char *name, const char *why);

/* Decodes all encoded pictures in the child process, at most 256 MB of pixels: many small pictures
 * are reduced in size. A picture that cannot be decoded stays without pixels, and the note gives
 * the reason. */
void mesh_images_decode(mesh *m);

#endif
