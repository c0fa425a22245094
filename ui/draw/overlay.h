/* draw/overlay.h - items over a face in space: hands, control vectors, support spheres, the axis of
 * the jaw. They have positions in mm, and are fainter where the face hides them. [thread of the
 * context] */
#ifndef MAROTTE_UI_DRAW_OVERLAY_H
#define MAROTTE_UI_DRAW_OVERLAY_H
#include "base/rigid.h"
#include "draw/draw.h"

typedef enum overlay_kind {
    OVERLAY_LINE = 0, /* from `from` to `to`; width in pixels */
    OVERLAY_ARROW,    /* the same, with a head at `to` */
    OVERLAY_BONE,     /* a tapering solid from `from` (radius_mm) to `to` (0.7 of it) */
    OVERLAY_BALL,     /* at `from`, radius_mm, solid and lit */
    OVERLAY_SPHERE,   /* at `from`, radius_mm: three rings and a faint skin */
    OVERLAY_DOT       /* at `from`; width in pixels, always round */
} overlay_kind;
typedef struct overlay_item {
    overlay_kind kind;
    float from[3], to[3], radius_mm, width_px;
    float rgba[4]; /* sRGB, 0..1 */
} overlay_item;
overlay_item overlay_line(vec3 from, vec3 to, float width_px, const float rgba[4]);
overlay_item overlay_dot(vec3 at, float width_px, const float rgba[4]);
/* Draws items into the rectangle where draw_render has just drawn the face, with the same
 * camera. */
void draw_overlay(draw_renderer *self, draw_target *target, const draw_face *face,
                  const draw_camera *camera, const uint32_t rectangle[4], const overlay_item *item,
                  uint32_t count);

typedef struct overlays overlays; /* programs and buffers of overlays */

overlays *overlays_create(error *err); /* NULL: failed */
void overlays_destroy(overlays *self);
/* The same as draw_overlay; to_light: unit, towards the light of solids. */
void overlays_draw(overlays *self, draw_target *target, const draw_face *face,
                   const draw_camera *camera, const float to_light[3], const uint32_t rectangle[4],
                   const overlay_item *item, uint32_t count);

/* Finds where the ray through a pixel of the rectangle hits the shown face: the nearest triangle
 * that faces the eye. */
typedef struct draw_hit {
    uint32_t triangle, vertex[3]; /* of the mesh file */
    float share[3];               /* barycentric coordinates of the vertices; sum 1 */
    float at[3], normal[3];       /* mm; normal: unit, towards the eye */
    float distance_mm;            /* from the eye */
} draw_hit;
bool draw_pick(draw_hit *out, const mesh *m, const float *position, const draw_camera *camera,
               const uint32_t rectangle[4], const float pixel[2]);
/* Computes the point on the ray of a pixel at the depth of `through`, in the plane that faces the
 * camera. */
bool draw_unproject(float out[3], const draw_camera *camera, const uint32_t rectangle[4],
                    const float pixel[2], const float through[3]);

#endif
