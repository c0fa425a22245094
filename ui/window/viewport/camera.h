/* window/viewport/camera.h - the camera of the viewport: orbit, pan, zoom and animated moves to a
 * view. Leaves out events and drawing. Lengths on the screen are points. Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_CAMERA_H
#define MAROTTE_UI_WINDOW_VIEWPORT_CAMERA_H
#include "draw/draw.h"

typedef enum viewport_side {
    VIEWPORT_FRONT = 0,
    VIEWPORT_SIDE,         /* requested again: the other side */
    VIEWPORT_THREE_QUARTER /* likewise */
} viewport_side;

typedef struct viewport_camera {
    draw_camera now, home; /* home: whole face from the front */
    draw_camera from, to;  /* ends of a glide */
    double glided_s;       /* < 0: no glide */
} viewport_camera;

/* Initialises the camera. low, high: bounds of the face, mm; aspect: width / height. */
void viewport_camera_init(viewport_camera *out, const float low[3], const float high[3],
                          float aspect);
/* Adapts to another face or aspect. Home changes, and distance and target keep their ratio to the
 * size of the face. */
void viewport_camera_fit(viewport_camera *self, const float low[3], const float high[3],
                         float aspect);
/* Orbits by a movement of the pointer, points. The face follows the pointer. */
void viewport_camera_orbit(viewport_camera *self, float right, float down);
/* Pans. height: height of the picture, points. */
void viewport_camera_pan(viewport_camera *self, float right, float down, float height);
/* Zooms around the pointer. pixel: pointer in the rectangle, both in the same unit. */
void viewport_camera_zoom(viewport_camera *self, float notches, const uint32_t rectangle[4],
                          const float pixel[2]);

/* Duration of a glide. viewport_camera_update advances it. */
#define VIEWPORT_GLIDE_S 0.2
void viewport_camera_glide(viewport_camera *self, viewport_side to);
void viewport_camera_frame(
    viewport_camera *self); /* shows the whole face from the current direction */
void viewport_camera_turn(viewport_camera *self, double dt_s); /* rotates like a turntable */
void viewport_camera_update(viewport_camera *self, double dt_s);

/* Returns the view for saving (draw_camera_keep). During a glide: its end. */
draw_camera_view viewport_camera_keep(const viewport_camera *self);
void viewport_camera_recall(viewport_camera *self, const draw_camera_view *kept);

#endif
