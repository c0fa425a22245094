/* rigs/mirror.h - from the half of a head at x >= 0, which a generator models, to the whole mesh
 * and its file. The same bytes on every run. [main] */
#ifndef MAROTTE_RIGS_MIRROR_H
#define MAROTTE_RIGS_MIRROR_H
#include "base/rigid.h"
#include "mesh/mesh.h"

/* What a point of the half holds, among other bits: x = 0, it is its own mirror image. */
enum { MIRROR_MIDDLE = 1 };

/* A mesh without triangles yet, for 2 half_triangle_count of them in `part_capacity` parts at most:
 * first the points of the half, then the images of those off the middle. out_image: point_count,
 * where the image of each is. */
CHECKED mrt_result mirror_points(mesh *out, const vec3 *point, const uint8_t *hold,
                                 int32_t point_count, int32_t half_triangle_count,
                                 uint32_t part_capacity, uint32_t *out_image, error *err);
/* The next part: triangle_count triangles that are in out->triangle already, behind those of the
 * parts before it. It has a material of its own, of the same name: that is what readers keep. */
CHECKED mrt_result mirror_add_part(mesh *out, const char *name, const mesh_material *look,
                                   uint32_t triangle_count, error *err);

/* main of a generator: writes what `build` makes to the file that the one argument names. */
int mirror_main(int argc, char **argv, const char *program,
                mrt_result (*build)(mesh *out, error *err));

#endif
