/* face/weights/weights_lips.h - the rims of the mouth (rig_mouth) on the mesh: paired along the
 * slit, and how far each vertex goes with them. What a frame does with that is in
 * frame/face_lips.c. Inside the room. [main] */
#ifndef MAROTTE_FACE_WEIGHTS_LIPS_H
#define MAROTTE_FACE_WEIGHTS_LIPS_H
#include "face/bind.h"

enum { LIPS_STATIONS_MAX = 33 };

/* A rig without a mouth, and rims that cannot be sealed (why_not), give no stations and no error.
 */
CHECKED mrt_result bind_lips_find(bind_lips *out, const rig *r, const mesh *m, const topology *t,
                                  error *err);
/* False: no memory; `out` can be finished. */
CHECKED bool bind_lips_copy(bind_lips *out, const bind_lips *from, uint32_t vertex_count);
void bind_lips_finish(bind_lips *lips); /* accepts zeroed */

#endif
