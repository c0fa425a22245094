/* face/weights/weights_lips.h - the rims of the mouth (rig_mouth) on the mesh: their pairing along
 * the slit, and how far each vertex moves with them. frame/face_lips.c uses them in each frame.
 * Private to this folder. [main] */
#ifndef MAROTTE_FACE_WEIGHTS_LIPS_H
#define MAROTTE_FACE_WEIGHTS_LIPS_H
#include "face/bind.h"

enum { LIPS_STATIONS_MAX = 33 };

/* A rig without a mouth gives no stations and no error. So do rims that cannot be sealed; then
 * why_not is set. */
CHECKED mrt_result bind_lips_find(bind_lips *out, const rig *r, const mesh *m, const topology *t,
                                  error *err);
/* Returns false without memory; `out` can then be finished. */
CHECKED bool bind_lips_copy(bind_lips *out, const bind_lips *from, uint32_t vertex_count);
void bind_lips_finish(bind_lips *lips); /* accepts zeroed */

#endif
