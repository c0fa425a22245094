/* draw/occlusion.h - how much of the room each vertex sees in the rest shape: eye sockets and
 * nostrils are dark, noses are not. Baked once by looking at the mesh from many sides. The thread
 * of the context. */
#ifndef MAROTTE_UI_DRAW_OCCLUSION_H
#define MAROTTE_UI_DRAW_OCCLUSION_H
#include "draw/face.h"

/* out_openness: one per vertex, 0 (sees nothing) .. 1. The face's buffers (but not the openness)
 * and normals are there. position: vertex_count by 3, mm. */
CHECKED mrt_result occlusion_bake(float *out_openness, const draw_face *face, const float *position,
                                  error *err);

#endif
