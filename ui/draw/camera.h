/* draw/camera.h - projections of cameras and lights, from millimetres to the picture. Matrices are
 * column-major, as in OpenGL. Pure. [any] */
#ifndef MAROTTE_UI_DRAW_CAMERA_H
#define MAROTTE_UI_DRAW_CAMERA_H
#include "draw/draw.h"

typedef struct matrix4 {
    float m[16];
} matrix4;

/* Returns the camera with all numbers finite and in a range that can be drawn. */
draw_camera camera_made_safe(const draw_camera *camera);
/* Computes the position of the eye, mm. */
void camera_eye(const draw_camera *camera, float out[3]);
/* Computes unit vectors: right and up in the picture, and back, from the target to the eye. */
void camera_axes_of(const draw_camera *camera, float right[3], float up[3], float back[3]);
/* Computes the ray through a point of the picture (-1..1, right and up): a unit vector away from
 * the eye. */
void camera_ray(const draw_camera *camera, float aspect, const float on_screen[2], float out[3]);
/* Returns the projection. Its depth range covers the part of the ball at `centre` that is in front
 * of the eye. */
matrix4 camera_projection(const draw_camera *camera, float aspect, const float centre[3],
                          float radius_mm);
/* Returns the projection of parallel light over the ball, clip space -1..1. direction: unit,
 * towards the light. */
matrix4 camera_light_projection(const float direction[3], const float centre[3], float radius_mm);
/* Returns the projection with clip space -1..1 mapped to 0..1. */
matrix4 camera_to_texture(const matrix4 *projection);

#endif
