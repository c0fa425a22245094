/* window/viewport/posed_shape.h - computes the shapes of poses in a background thread, on a
 * separate copy of the face. Leaves out drawing (viewport_portrait). [main], except for the thread,
 * which starts with the first face. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_POSED_SHAPE_H
#define MAROTTE_UI_WINDOW_VIEWPORT_POSED_SHAPE_H
#include "stage/perform/face_file.h"

typedef struct posed_shape posed_shape;
posed_shape *posed_shape_create(void);       /* NULL: no memory */
void posed_shape_destroy(posed_shape *self); /* waits for the thread; accepts NULL */

/* Follows the face of the stage. Call it in each frame; a new face is copied. NULL: none. */
void posed_shape_follow(posed_shape *self, const face_file *of);
/* Returns the rig with complete poses; NULL: not ready, or no rig. Valid until the next follow. */
const rig *posed_shape_rig(posed_shape *self);

enum { POSED_TOGETHER = 2 };
/* Returns the shape of the sum of these poses (NULL: end): vertex_count by 3, mm, in the order of
 * the mesh file. Returns NULL while it is being computed; call again. Valid until the next call or
 * follow. */
const float *posed_shape_of(posed_shape *self, const char *const pose[POSED_TOGETHER],
                            uint32_t *out_vertex_count);

#endif
