/* window/viewport/camera.h - the camera of the viewport in a person's hand: turned, moved, brought
 * nearer, glided to a view. Leaves out events and drawing. Lengths on the screen are points. Pure;
 * any thread. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_CAMERA_H
#define MAROTTE_UI_WINDOW_VIEWPORT_CAMERA_H
#include "draw/draw.h"

typedef enum viewport_side {
    VIEWPORT_FRONT = 0,
    VIEWPORT_SIDE,         /* asked for again: the other side */
    VIEWPORT_THREE_QUARTER /* the same */
} viewport_side;

typedef struct viewport_camera {
    draw_camera now, home; /* home: the whole face, from the front */
    draw_camera from, to;  /* of a glide */
    double glided_s;       /* < 0: it stands */
} viewport_camera;

/* The face's bounds, mm; aspect: width to height. */
void viewport_camera_init(viewport_camera *out, const float low[3], const float high[3],
                          float aspect);
/* Another face or another aspect: home changes; how far away the camera is and where it looks stay
 * the same in shares of the face. */
void viewport_camera_fit(viewport_camera *self, const float low[3], const float high[3],
                         float aspect);
/* By points of the pointer: the face follows it. */
void viewport_camera_orbit(viewport_camera *self, float right, float down);
/* height: of the picture, points. */
void viewport_camera_pan(viewport_camera *self, float right, float down, float height);
/* pixel: of the pointer in the rectangle (both in one unit): what is there stays there. */
void viewport_camera_zoom(viewport_camera *self, float notches, const uint32_t rectangle[4],
                          const float pixel[2]);

/* Within VIEWPORT_GLIDE_S, as viewport_camera_update lets time go on. */
#define VIEWPORT_GLIDE_S 0.2
void viewport_camera_glide(viewport_camera *self, viewport_side to);
void viewport_camera_frame(viewport_camera *self); /* the whole face, from where it stands */
void viewport_camera_turn(viewport_camera *self, double dt_s); /* as on a turntable */
void viewport_camera_update(viewport_camera *self, double dt_s);

/* What is kept between runs, and of views: draw_camera_keep; of a glide its end. */
draw_camera_view viewport_camera_keep(const viewport_camera *self);
void viewport_camera_recall(viewport_camera *self, const draw_camera_view *kept);

#endif
