/* draw/overlay.h - what lies over a face in space: hands, control vectors, support spheres, the
 * jaw's axis. Things in mm are seen through the face, more faintly where it hides them. The thread
 * of the context. */
#ifndef MAROTTE_UI_DRAW_OVERLAY_H
#define MAROTTE_UI_DRAW_OVERLAY_H
#include "base/rigid.h"
#include "draw/draw.h"

typedef enum overlay_kind {
    OVERLAY_LINE = 0, /* from, to; width in pixels */
    OVERLAY_ARROW,    /* the same, with a head at `to` */
    OVERLAY_BONE,     /* a tapering solid from `from` (radius_mm) to `to` (0.7 of it) */
    OVERLAY_BALL,     /* at from, radius_mm, solid and lit */
    OVERLAY_SPHERE,   /* at from, radius_mm: three rings and a faint skin */
    OVERLAY_DOT       /* at from; width in pixels, always round */
} overlay_kind;
typedef struct overlay_item {
    overlay_kind kind;
    float from[3], to[3], radius_mm, width_px;
    float rgba[4]; /* sRGB, 0..1 */
} overlay_item;
overlay_item overlay_line(vec3 from, vec3 to, float width_px, const float rgba[4]);
overlay_item overlay_dot(vec3 at, float width_px, const float rgba[4]);
/* Into the rectangle where draw_render has just drawn the face, with the same camera. */
void draw_overlay(draw_renderer *self, draw_target *target, const draw_face *face,
                  const draw_camera *camera, const uint32_t rectangle[4], const overlay_item *item,
                  uint32_t count);

typedef struct overlays overlays; /* the programs and buffers that draw them */

overlays *overlays_create(error *err); /* NULL: failed */
void overlays_destroy(overlays *self);
/* As draw_overlay; to_light: unit, towards what lights the solids. */
void overlays_draw(overlays *self, draw_target *target, const draw_face *face,
                   const draw_camera *camera, const float to_light[3], const uint32_t rectangle[4],
                   const overlay_item *item, uint32_t count);

/* Where the ray through a pixel of the rectangle meets the face as shown: the nearest triangle that
 * faces the eye. */
typedef struct draw_hit {
    uint32_t triangle, vertex[3]; /* of the mesh file */
    float share[3];               /* of the vertices; sum 1 */
    float at[3], normal[3];       /* mm; unit, towards the eye */
    float distance_mm;            /* from the eye */
} draw_hit;
bool draw_pick(draw_hit *out, const mesh *m, const float *position, const draw_camera *camera,
               const uint32_t rectangle[4], const float pixel[2]);
/* The point of a pixel's ray at the depth of `through`, in the plane that faces the camera. */
bool draw_unproject(float out[3], const draw_camera *camera, const uint32_t rectangle[4],
                    const float pixel[2], const float through[3]);

#endif
