/* window/rig_gizmo.h - places in space that are taken hold of: which of them the pointer means,
 * where it drags one to, and what the axis of the jaw looks like. mm. Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_RIG_GIZMO_H
#define MAROTTE_UI_WINDOW_RIG_GIZMO_H
#include "draw/overlay.h"
#include "face/rig_edit.h"

typedef struct rig_ray { /* of the pointer, see viewport_stroke */
    vec3 eye, ray, forward;
    double point_rad;
} rig_ray;

/* The place nearest to the ray; RIG_NONE: none within so many points of the screen. */
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
void rig_gizmo_places(vec3 out[RIG_HANDLES], const rig_edit_jaw *jaw);
/* A handle goes to `to`; is_even: both ends of the axis stay mirror images in x = middle_mm, and
 * the incisor in the middle. */
void rig_gizmo_put(rig_edit_jaw *jaw, rig_handle handle, vec3 to, bool is_even, double middle_mm);

enum { RIG_GIZMO_ITEMS = 48 };
/* The axis, its ends, the incisor and the way that it opens along; widths in points. Most of it is
 * inside the head, where things are drawn faintly: so each is there several times. held:
 * RIG_HANDLES: none. Returns how many. */
uint32_t rig_gizmo_draw(overlay_item out[RIG_GIZMO_ITEMS], const rig_edit_jaw *jaw,
                        rig_handle held);

#endif
