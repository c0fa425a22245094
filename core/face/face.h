/* face/face.h - a face that is performed: bones, constrained controls, one displacement field per
 * bone, skin that slides over the skull. The design's formula:
 *   x'(v) = project( sum_b w_b(v) T_b( x(v) + m(v) sum_k B^b_k(v) g_k ) )
 * where x is the base shape with all bones at rest. While the projection is inactive this is
 *   x'(v) = x(v) + sum_j column_j(v) * weight_j,   weight_j a vector:
 * one column per control and bone that it touches (w_b m B^b_k, moved by R_b g_k), and four columns
 * per moving bone (w_b x, w_b y, w_b z, w_b, moved by the columns of R_b - I and by t_b). So a
 * frame is one pass over columns, exports are exact, and without a rig it is csrbf/shape.h.
 * Vertices in the engine's order. [frame] all but create/destroy: no allocation; same input, same
 * bits. */
#ifndef MAROTTE_FACE_FACE_H
#define MAROTTE_FACE_FACE_H
#include "csrbf/shape.h"
#include "face/bind.h"
#include "face/bones.h"

typedef struct face face;

/* rig NULL: the mesh alone, one fixed bone, everything free. The rig and the mesh must outlive it.
 * m: in mm. */
CHECKED mrt_result face_create(face **out, const rig *r, const mesh *m, const topology *t,
                               uint32_t control_capacity, error *err);
void face_destroy(face *f); /* NULL is fine */

const points_order *face_order(const face *f);
const points *face_shown(const face *f);
const points *face_rest(const face *f);
const binding *face_binding(const face *f);
const bones *face_bones(const face *f); /* dof_count 0 without a rig */
/* Contacts as plugins see them; until destroy. */
const mrt_contact *face_contacts(const face *f, uint32_t *out_count);

typedef struct face_control {
    vec3 start;       /* mm, where it takes hold of the face shown */
    uint32_t contact; /* 1 + index of the contact that it pulls; 0: a free point */
} face_control;

/* ---- anchored ---- */

/* The base becomes the shape shown with its bones at rest (no jump whatever the pose); the controls
 * take hold: starts are carried back through the bones' motion (dof: as in the last frame shown).
 * A control belongs to the field of each bone with a share of more than 2 % at it. */
CHECKED mrt_result face_engage(face *f, const csrbf_settings *settings, const face_control *control,
                               uint32_t count, error *err);
/* The frame: shown from base, for the ends of the controls (count by 3, mm, where each control is
 * to land in the shape shown) and the degrees of freedom (dof_count; NaN: not driven: the jaw is
 * derived from the controls that ride on it, others are 0). With no control engaged only bones
 * move. */
CHECKED mrt_result face_pull(face *f, const double *end, const float *dof, error *err);
/* Base := shown with its bones at rest; the engagement ends; nothing jumps. */
void face_commit(face *f);
void face_reset(face *f);

/* ---- unanchored ---- */

/* Drags the shape, carried back through the bones' motion, from -> to, then poses it: the bones
 * come from absolute poses, never accumulated. */
CHECKED mrt_result face_drag(face *f, const csrbf_settings *settings, const double *from,
                             const double *to, uint32_t count, const float *dof,
                             double *out_reached, shape_step *out_step, error *err);
void face_leak(face *f, double rate_per_s, double dt_s); /* towards the base */

bool face_is_near(const face *f, const double *point, uint32_t count, double radius);

/* ---- what happened ---- */

typedef struct face_columns { /* of the engagement; valid until the next engage */
    const points *base;
    const float *column; /* count rows of stride floats */
    size_t stride;
    const double *weight; /* count by 3: of the last face_pull */
    uint32_t count;
    uint32_t engagement; /* grows whenever base or columns change */
    bool is_exact;       /* false: the projection moved a vertex in the last frame shown */
} face_columns;
face_columns face_columns_now(const face *f);

typedef struct face_meter {
    double slope_bound;    /* of the field: < 1 nothing folds */
    double penetration_mm; /* how deep the projection found skin below its floor, before it acted */
    uint32_t projected_count; /* vertices that it moved */
    float dof[MRT_MAX_DOFS];  /* as posed, derived and limited ones included */
} face_meter;
const face_meter *face_metered(const face *f);
/* Smallest determinant of the whole map's Jacobian over the vertices with a field; the exact meter,
 * not for every frame. */
double face_min_determinant(const face *f);

#endif
