/* draw/overlays.h - the programs and buffers that draw_overlay uses; part of the renderer. The
 * thread of the context. */
#ifndef MAROTTE_UI_DRAW_OVERLAYS_H
#define MAROTTE_UI_DRAW_OVERLAYS_H
#include "draw/camera.h"
#include "draw/overlay.h"

typedef struct overlays overlays;

overlays *overlays_create(error *err); /* NULL: failed */
void overlays_destroy(overlays *self);

typedef struct overlays_view { /* of one draw_overlay */
    draw_camera camera;        /* made safe */
    matrix4 projection;        /* that of the face */
    uint32_t width, height;    /* of the rectangle */
    float lift_mm;             /* towards the eye, of lines and dots */
    float to_light[3];
} overlays_view;
/* The framebuffer and the viewport are set, the state is gl_state_enter's. */
void overlays_draw(overlays *self, const overlays_view *view, const overlay_item *item,
                   uint32_t count);

#endif
