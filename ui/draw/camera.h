/* draw/camera.h - from millimetres to the picture: the projections of cameras and lights. Matrices
 * are column-major as OpenGL wants them. Pure; any thread. */
#ifndef MAROTTE_UI_DRAW_CAMERA_H
#define MAROTTE_UI_DRAW_CAMERA_H
#include "draw/draw.h"

typedef struct matrix4 {
    float m[16];
} matrix4;

/* The camera with every number finite and in a range that can be drawn. */
draw_camera camera_made_safe(const draw_camera *camera);
/* Where the eye is, mm. */
void camera_eye(const draw_camera *camera, float out[3]);
/* Unit vectors: where right and up of the picture are, and where the eye is from the target. */
void camera_axes_of(const draw_camera *camera, float right[3], float up[3], float back[3]);
/* The ray through a point of the picture (-1..1, right and up): unit, away from the eye. */
void camera_ray(const draw_camera *camera, float aspect, const float on_screen[2], float out[3]);
/* Depth covers the ball at centre, as far as it is before the eye. */
matrix4 camera_projection(const draw_camera *camera, float aspect, const float centre[3],
                          float radius_mm);
/* Parallel light from `direction` (unit, towards the light) over the ball; clip space -1..1. */
matrix4 camera_light_projection(const float direction[3], const float centre[3], float radius_mm);
/* Clip space -1..1 to 0..1 after `projection`. */
matrix4 camera_to_texture(const matrix4 *projection);

#endif
