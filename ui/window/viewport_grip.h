/* window/viewport_grip.h - the pointer's hold of the face: from where it takes hold and how it is
 * dragged to what the stage is told. Leaves out events, picking and drawing. Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_GRIP_H
#define MAROTTE_UI_WINDOW_VIEWPORT_GRIP_H
#include "draw/overlay.h"
#include "stage/pointer.h"

typedef struct viewport_grip {
    bool holds;
    pointer_grip how;
    float rest[3];   /* mm: what is held, of the rest face */
    float begin[3];  /* mm: that, as shown when it was taken */
    float offset[3]; /* mm: from the place under the pointer to what is held */
    float depth_mm;  /* towards the viewer, by the wheel */
    float at[3];     /* mm: where it is to be now */
} viewport_grip;

typedef struct viewport_grip_view { /* through what the pointer is seen */
    const draw_camera *camera;
    const uint32_t *rectangle; /* 4 */
    float pixel[2];            /* of the pointer */
} viewport_grip_view;

/* Takes hold of `rest`, which is shown at `shown`: neither jumps under the pointer. */
void viewport_grip_take(viewport_grip *self, pointer_grip how, const float rest[3],
                        const float shown[3], const viewport_grip_view *view);
/* In the plane that faces the camera. */
void viewport_grip_drag(viewport_grip *self, const viewport_grip_view *view);
/* towards_mm: towards the viewer, more. */
void viewport_grip_lift(viewport_grip *self, float towards_mm, const viewport_grip_view *view);
void viewport_grip_let_go(viewport_grip *self);

#endif
