/* window/rig/gizmo.h - how a rig looks on its face: handles in space that are grabbed, what the
 * axis of the jaw looks like, and the colours of weights and mobility. mm. Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_RIG_GIZMO_H
#define MAROTTE_UI_WINDOW_RIG_GIZMO_H
#include "draw/overlay.h"

#include "face/bind.h"
#include "face/rig_edit.h"

typedef struct rig_ray { /* of the pointer, see viewport_stroke */
    vec3 eye, ray, forward;
    double point_rad;
} rig_ray;

/* The position nearest to the ray; RIG_NONE: none within so many points of the screen. */
uint32_t rig_gizmo_nearest(const rig_ray *ray, const vec3 *at, uint32_t count, double reach_points);
/* The point of the ray in the plane through `through` that faces the eye; false: there is none. */
bool rig_gizmo_reach(vec3 *out, const rig_ray *ray, vec3 through);
/* How many points of the screen lie between two rays of one eye. */
double rig_gizmo_points_between(const rig_ray *a, const rig_ray *b);

typedef enum rig_handle {
    RIG_HANDLE_LEFT = 0,
    RIG_HANDLE_RIGHT,
    RIG_HANDLE_INCISOR,
    RIG_HANDLES
} rig_handle;
void rig_gizmo_positions(vec3 out[RIG_HANDLES], const rig_edit_jaw *jaw);
/* A handle goes to `to`; is_even: both ends of the axis stay mirror images in x = middle_mm, and
 * the incisor in the middle. */
void rig_gizmo_put(rig_edit_jaw *jaw, rig_handle handle, vec3 to, bool is_even, double middle_mm);

enum { RIG_GIZMO_ITEMS = 48 };
/* The axis, its ends, the incisor and the way that it opens along; widths in points. Most of it is
 * inside the head, where things are drawn faintly: so each is there several times. held:
 * RIG_HANDLES: none. Returns how many. */
uint32_t rig_gizmo_draw(overlay_item out[RIG_GIZMO_ITEMS], const rig_edit_jaw *jaw,
                        rig_handle held);

void rig_tint_of_bone(float out[3], const rig *r, uint32_t bone); /* RIG_NONE: of mobility */
uint32_t rig_tint_chip(const rig *r, uint32_t bone);              /* the same as 0xRRGGBBAA */

/* rgb: vertex_count by 3. Bones mixed by weight, the paler the less a vertex can be pulled. */
void rig_tint_bones(float *rgb, const rig *r, const binding *b);
void rig_tint_mobility(float *rgb, const binding *b);
/* share: vertex_count, 0..1: the colour over what recedes. */
void rig_tint_share(float *rgb, const float *share, uint32_t vertex_count, const float colour[3]);
void rig_tint_plain(float *rgb, uint32_t vertex_count); /* of a face that could not be laid */
void rig_tint_mix(float rgb[3], const float colour[3], float share);

#endif
