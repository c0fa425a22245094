/* window/viewport/posed_shape.h - the poses of the rig as shapes of the face, found beside the
 * window on a face of their own. Leaves out drawing (viewport_portrait). [main] but for the thread,
 * which begins with the first face. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_POSED_SHAPE_H
#define MAROTTE_UI_WINDOW_VIEWPORT_POSED_SHAPE_H
#include "stage/perform/face_file.h"

typedef struct posed_shape posed_shape;
posed_shape *posed_shape_create(void);       /* NULL: no memory */
void posed_shape_destroy(posed_shape *self); /* NULL is fine; waits for the thread */

/* Each frame: the face on the stage, which is copied when it is another one. NULL: none. */
void posed_shape_follow(posed_shape *self, const face_file *of);
/* The rig with complete poses; NULL: not found yet, or there is none. Until the next follow. */
const rig *posed_shape_rig(posed_shape *self);

enum { POSED_TOGETHER = 2 };
/* The shape of these poses together (NULL: no more): vertex_count by 3, mm, in the mesh file's
 * order; NULL: not found yet, asked for again. Until the next call or follow. */
const float *posed_shape_of(posed_shape *self, const char *const pose[POSED_TOGETHER],
                            uint32_t *out_vertex_count);

#endif
