/* face/rig/rig_rims.h - the rims of the slit between the lips, found on the surface of a head.
 * frame/face_lips.c seals them. Private to this folder. [main] or a worker. */
#ifndef MAROTTE_FACE_RIG_RIMS_H
#define MAROTTE_FACE_RIG_RIMS_H
#include "face/bind.h"
#include "face/rig/rig_anatomy.h"

/* Allocates both rims of `out`: chains of vertices from the subject's right corner of the mouth to
 * the left one, with common ends. The caller frees them. A mesh without a slit leaves them NULL and
 * sets why_not to a message. */
CHECKED mrt_result rig_rims_find(rig_mouth *out, char why_not[BIND_FAULT], const rig_anatomy *a,
                                 const mesh *m, const topology *t, error *err);
/* Sets the rims of a mouth that mesh_cut_mouth opened in m along that chain. */
CHECKED mrt_result rig_rims_of_cut(rig_mouth *out, const uint32_t *chain, uint32_t count,
                                   const mesh *m, error *err);

#endif
