/* window/rig/gizmo.h - drawing of a rig on its face: handles that can be dragged, the axis of the
 * jaw, and the colours of weights and mobility. mm. Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_RIG_GIZMO_H
#define MAROTTE_UI_WINDOW_RIG_GIZMO_H
#include "draw/overlay.h"

#include "face/bind.h"
#include "face/rig_edit.h"

typedef struct rig_ray { /* ray of the pointer, see viewport_stroke */
    vec3 eye, ray, forward;
    double point_rad;
} rig_ray;

/* Returns the position nearest to the ray, or RIG_NONE if none is within reach_points on the
 * screen. */
uint32_t rig_gizmo_nearest(const rig_ray *ray, const vec3 *at, uint32_t count, double reach_points);
/* Computes the intersection of the ray with the plane through `through` that faces the eye. Returns
 * false if there is none. */
bool rig_gizmo_reach(vec3 *out, const rig_ray *ray, vec3 through);
/* Returns the distance of two rays of one eye on the screen, points. */
double rig_gizmo_points_between(const rig_ray *a, const rig_ray *b);

typedef enum rig_handle {
    RIG_HANDLE_LEFT = 0,
    RIG_HANDLE_RIGHT,
    RIG_HANDLE_INCISOR,
    RIG_HANDLES
} rig_handle;
void rig_gizmo_positions(vec3 out[RIG_HANDLES], const rig_edit_jaw *jaw);
/* Moves a handle to `to`. is_even: keeps both ends of the axis symmetric to x = middle_mm, and the
 * incisor in the middle. */
void rig_gizmo_move(rig_edit_jaw *jaw, rig_handle handle, vec3 to, bool is_even, double middle_mm);

enum { RIG_GIZMO_ITEMS = 48 };
/* Draws the axis, its ends, the incisor and its opening path; widths in points. Hidden items are
 * drawn faintly and most of these are inside the head, so each item is added several times. held
 * RIG_HANDLES: none. Returns the number of items. */
uint32_t rig_gizmo_draw(overlay_item out[RIG_GIZMO_ITEMS], const rig_edit_jaw *jaw,
                        rig_handle held);

void rig_tint_of_bone(float out[3], const rig *r, uint32_t bone); /* RIG_NONE: colour of mobility */
uint32_t rig_tint_chip(const rig *r, uint32_t bone);              /* same colour as 0xRRGGBBAA */

/* Mixes the colours of the bones by weight, paler for lower mobility. rgb: vertex_count by 3. */
void rig_tint_bones(float *rgb, const rig *r, const binding *b);
void rig_tint_mobility(float *rgb, const binding *b);
/* Mixes a colour over a muted face. share: vertex_count, 0..1. */
void rig_tint_share(float *rgb, const float *share, uint32_t vertex_count, const float colour[3]);
void rig_tint_plain(float *rgb, uint32_t vertex_count); /* for a face without a valid binding */
void rig_tint_mix(float rgb[3], const float colour[3], float share);

#endif
