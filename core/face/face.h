/* face/face.h - a face that is performed: bones, controls with exact targets, one displacement
 * field per bone, and skin that slides over the skull. Formula of a frame:
 *   x'(v) = project( sum_b w_b(v) T_b( x(v) + m(v) sum_k B^b_k(v) g_k ) )
 * where x is the base shape with all bones at rest. While the projection is inactive this
 * equals
 *   x'(v) = x(v) + sum_j column_j(v) * weight_j,   weight_j a vector.
 * There is one column per control and bone that it touches (w_b m B^b_k, moved by R_b g_k).
 * Each moving bone has four more columns (w_b x, w_b y, w_b z, w_b, moved by the columns of R_b
 * - I and by t_b). Their x is measured from the bone's own centre, so that a turned head loses
 * no digits. So a frame is one pass over columns, and exports are exact. Without a rig the
 * result equals csrbf/shape.h, bit for bit.
 * The seal of the lips (RIG_LIPS_SEAL) is added between the sum and the projection; it is not a
 * column. Vertices are in the engine's order. All functions except create and destroy are
 * [frame]: they allocate nothing, and the same input gives the same bits. */
#ifndef MAROTTE_FACE_FACE_H
#define MAROTTE_FACE_FACE_H
#include "base/stamps.h"
#include "csrbf/shape.h"
#include "face/bind.h"
#include "face/bones.h"
#include "mesh/shading.h"
#include "mesh/surface_meter.h"

typedef struct face face;

/* Creates a face. rig NULL: the mesh alone, with one fixed bone and everything free. The rig
 * and the mesh must outlive the face. m: in mm. */
CHECKED mrt_result face_create(face **out, const rig *r, const mesh *m, const topology *t,
                               uint32_t control_capacity, error *err);
/* As face_create, with an existing binding. Takes ownership of it and zeroes b, also on errors. */
CHECKED mrt_result face_create_bound(face **out, const rig *r, const mesh *m, binding *b,
                                     uint32_t control_capacity, error *err);
/* As face_create_bound, and uses the mesh's morph targets as the head's own shapes; see below. */
CHECKED mrt_result face_create_shaped(face **out, const rig *r, const mesh *m, binding *b,
                                      uint32_t control_capacity, error *err);
void face_destroy(face *f); /* NULL is fine */

const points_order *face_order(const face *f);
const points *face_shown(const face *f);
/* Stamps of the blocks of face_shown, for readers that copy only what changed. A block is
 * skipped if nothing moves it, or if it moves as in the frame before. The bits equal those of a
 * whole frame. */
const stamps *face_written(const face *f);
/* The same for the normals. Blocks that only bones move keep their normals at rest. Valid until
 * the next frame. */
shading_shape face_shading(const face *f);
const points *face_rest(const face *f);
const binding *face_binding(const face *f);
const bones *face_bones(const face *f); /* dof_count is 0 without a rig */
/* Contacts as plugins see them. Valid until destroy. */
const mrt_contact *face_contacts(const face *f, uint32_t *out_count);
/* Position of a contact (1 + index) in the shape shown, mm. */
vec3 face_contact_now(const face *f, uint32_t contact);

typedef struct face_control {
    vec3 start;       /* mm, the point of the face shown that it holds */
    uint32_t contact; /* 1 + index of the contact that it pulls; 0 for a free point */
} face_control;

/* ---- anchored ---- */

/* Engages the controls. The shape shown, with its bones at rest, becomes the base, so nothing
 * jumps in any pose. The starts are carried back through the bones' motion (dof: as in the last
 * frame shown).
 * The shares of a control are the weights at its contact. For a free point they are those at
 * the nearest vertex shown. A control belongs to the fields of at most four bones, those with a
 * share above 2 % there.
 * Where the mobility is below 1/10, a control lands short of its end. Below 1/100 it moves
 * nothing (face_meter.dropped_count). The motion that the projection adds is not part of the
 * base: each frame computes it again.
 * On error nothing has changed. count 0 ends the engagement. */
CHECKED mrt_result face_engage(face *f, const csrbf_settings *settings, const face_control *control,
                               uint32_t count, error *err);
/* Computes a frame from the base. end: count by 3, mm, where each control must land in the
 * shape shown. dof: dof_count degrees of freedom; NaN: not driven; dof NULL: none is driven. A
 * jaw that is not driven is derived from the controls that ride on it; other such degrees of
 * freedom are 0.
 * A control rides on the jaw if its share there is above 1/2, and fully from 9/10. A jaw
 * without riding controls keeps its pose; with only one, it keeps its lateral and forward
 * values. With no control engaged only bones move. Values that are not finite are an error, and
 * the shape shown is kept. */
CHECKED mrt_result face_pull(face *f, const double *end, const float *dof, error *err);
/* The two halves of face_pull. face_aim runs once per sample and depends on the frame before,
 * because of the derived jaw. face_show moves the vertices, once per drawn frame. */
CHECKED mrt_result face_aim(face *f, const double *end, const float *dof, error *err);
void face_show(face *f);
/* Carries the ends of controls along with the bones. rides: 1 for each control that rides on
 * the bones. On entry `end` is the end with all bones at rest. On return it is the end after
 * the bones that `dof` drives have moved. Other ends are unchanged. */
void face_ride(const face *f, double *end, const uint8_t *rides, const float *dof);
/* The inverse for all controls: `end` becomes the end with all bones at rest. */
void face_unride(const face *f, double *end, const float *dof);
/* Makes the shape shown, with its bones at rest, the base. Ends the engagement; nothing jumps. */
void face_commit(face *f);
void face_reset(face *f);

/* ---- the head's own shapes ----
 *
 * A face with a rig whose mesh has morph targets first answers a pull with these shapes. The
 * solver looks for few small weights in 0..1 that explain where the controls go, starting at
 * those of the frame before. The fields do the rest, so controls still land on their ends.
 * Bones take over the part of a shape that they can do. Of jawOpen only the difference to the
 * jaw's motion is a shape, and its weight is how far the jaw is open. A bone that moves skin
 * (the jaw, a lid) and is not driven follows the weights. An unanchored drag uses only the
 * shapes that the bones lead to. */

/* Sets the strength of the shapes, initially 1. With 0 the face is like clay, with the same
 * bits as a face without shapes. Call between frames. */
void face_set_shapes(face *f, double amount);
/* Number of a mesh's targets that a face uses: the first ones, or 0 if they need more than 1
 * GiB. */
enum { FACE_SHAPES_MAX = 320 };
uint32_t face_shapes_of(const mesh *m);
/* The shapes that move something; their names are those of the mesh. */
uint32_t face_shape_count(const face *f);
const char *face_shape_name(const face *f, uint32_t index);
/* Writes which shapes make up a name; out: face_shape_count weights. A shape with this name
 * counts 1 (ARKit's in any spelling, "eyeBlink_L"); otherwise the weights are those of the
 * mesh's expression of this name. Returns false if all are 0. */
bool face_shape_parts(const face *f, const char *name, float *out);
/* Weight in the frame, 0..1: as set, or less where skin would fold. */
double face_shape_weight(const face *f, uint32_t index);
/* Part of the shape that bones do, at weight 1: MRT_MAX_DOFS values; valid until destroy. */
const float *face_shape_dofs(const face *f, uint32_t index);
/* Sets the least weight of each shape, starting with the next frame (0..1, face_shape_count
 * values; NULL: 0). Contacts are pulled from where these weights bring them, so pulls add to
 * them, as to driven bones. The caller must drive the bones' part of a shape itself. A shape
 * that follows bones ignores its weight. */
void face_set_least_weights(face *f, const float *weight);
/* Offset that the shape adds at weight 1 with the bones at rest, mm: vertices by 3, in the
 * file's order. */
void face_shape_offset(const face *f, uint32_t index, float *out);

/* ---- loose parts ----
 *
 * Bones with a spring (rig_spring) swing about the pose that their degrees of freedom, driven or
 * not, and their parents give them. */

/* Lets them swing up to this time, in equal steps of at most 1/240 s, and poses them. The first
 * call, and the first after face_reset, finds them at rest. A gap of more than 0.1 s counts as 0.1
 * s. Parts that are faster than a hand can move a head are carried along. Call after each face_aim
 * or face_drag. Returns true if a bone has moved; face_show then shows it. */
bool face_swing(face *f, int64_t time_ns);
/* Takes back the swing of this time, if there was one: several steps of the same time swing as one
 * step with their last pose. Call before the face_aim or face_drag of a step. */
void face_swing_begin(face *f, int64_t time_ns);
bool face_dof_swings(const face *f, uint32_t dof); /* a spring moves this degree of freedom */
/* 0..1: the share of the swing that is shown; initially that of the rig. 0: they hold still. Call
 * between frames. */
void face_set_springs(face *f, double share);
/* Moves the time of the last face_swing to another clock. */
void face_shift_time(face *f, int64_t by_ns);
bool face_has_springs(const face *f);
/* Copies the swing of another face of the same rig, and its time. The next face_swing shows it. */
void face_copy_swing(face *f, const face *from);

/* ---- unanchored ---- */

/* Drags the shape from `from` to `to`, then poses it. The points are carried back through the
 * bones' motion (from: of the frame before, to: of this frame). Bone poses are absolute, never
 * accumulated. A jaw that is not driven keeps its pose; other degrees of freedom are 0. The
 * weights are those of the vertex shown that is nearest to `from`. A vertex moves by m sum_b
 * w_b d_b. Ends an anchored engagement. On error nothing has moved. */
CHECKED mrt_result face_drag(face *f, const csrbf_settings *settings, const double *from,
                             const double *to, uint32_t count, const float *dof,
                             double *out_reached, shape_step *out_step, error *err);
/* Eases the unposed shape towards the base, as shape_leak. Ends an anchored engagement. */
void face_leak(face *f, double rate_per_s, double dt_s);
/* Moves the unposed shape and the base towards the rest shape by this part of the way (0..1).
 * Ends an anchored engagement. */
void face_restore(face *f, double part);

/* True if a point (count by 3) is closer than radius to the base while engaged, else to the
 * shape shown. */
bool face_is_near(const face *f, const double *point, uint32_t count, double radius);

/* Sets csrbf_settings.stretch_most of the current engagement. */
void face_set_stretch_most(face *f, double factor);
/* Whether a free control at a point of the shape shown would move skin. */
bool face_can_grip(const face *f, vec3 at);
/* Finds the vertex shown that is nearest to `at` of those that a control moves fully, at least
 * apart_mm away from each of the points taken. Returns false if there is none. */
bool face_movable_near(const face *f, vec3 at, const vec3 *taken, uint32_t count, double apart_mm,
                       vec3 *out);

/* ---- stored state ---- */

/* Stores all state that later frames depend on. Writes at most `capacity` bytes; bytes may be
 * NULL. Returns the size: some KB, plus 12 bytes per vertex if the base is not the rest shape.
 * After face_load on a face of the same rig and mesh, the same calls give the same bits.
 * Columns are not stored; face_load computes them again. */
size_t face_save(const face *f, void *bytes, size_t capacity);
/* Restores a stored state. On error (bytes of another face, or damaged) the face is reset. */
CHECKED mrt_result face_load(face *f, const void *bytes, size_t size, error *err);

uint32_t face_control_count(const face *f); /* engaged controls, or 0 */

/* ---- readings ---- */

typedef struct face_columns { /* columns of the engagement; valid until the next engage */
    const points *base;
    const float *column; /* count rows of stride floats */
    size_t stride;
    const double *weight; /* count by 3: from the last face_pull */
    uint32_t count;
    uint32_t engagement; /* increases whenever base or columns change */
    bool is_exact; /* false if the projection or the seal moved a vertex in the last frame shown */
} face_columns;
face_columns face_columns_now(const face *f);
/* Writes the name of a column. A shape along an axis is "mouthSmile.x", with "@jaw" appended
 * for the part that a moving bone carries. A contact is "mouth.corner.l", a free point
 * "control2"; both get "@bone" if several bones are involved. The motion of a bone is
 * "jaw.turn_x" to "jaw.turn_z" and "jaw.shift". */
enum { FACE_COLUMN_NAME = 160 };
void face_column_name(const face *f, uint32_t column, char out[FACE_COLUMN_NAME]);
typedef struct face_column { /* a column of a control */
    uint32_t control;        /* FACE_NO_CONTROL for a column of a bone's motion */
    double share; /* share of its bone at the control; a control with several bones has one column
                     for each */
} face_column;
#define FACE_NO_CONTROL UINT32_MAX
face_column face_column_at(const face *f, uint32_t column);
/* Settings of the engagement. */
csrbf_settings face_settings(const face *f);
/* A control of the engagement. Its start is the point that it holds while the bones are at
 * rest. */
face_control face_control_at(const face *f, uint32_t control);

typedef struct face_meter {
    double slope_bound;         /* of the field; below 1 nothing folds */
    double penetration_mm;      /* greatest depth of skin below its floor, before the projection
                                   corrected it */
    uint32_t projected_count;   /* number of vertices that the projection moved; for tests */
    float dof[MRT_MAX_DOFS];    /* as posed, including derived and limited values, and the swing */
    float driven[MRT_MAX_DOFS]; /* the same without the swing of loose parts */
    uint32_t dropped_count;     /* engaged controls that can move nothing (mobility 0) */
    double held_back_mm; /* greatest distance by which a control falls short of its end, because the
                            skin would fold or tear; 0 if nothing is held back */
} face_meter;
const face_meter *face_metered(const face *f);
/* Returns how close the face is to folding; <= 0 if it folds. Exact, but too slow for every
 * frame.
 * Without a rig: the smallest determinant of the map's Jacobian at the vertices of the base
 * (shape_min_determinant of the last pull; 1 while nothing is engaged).
 * With a rig the weights are defined on the surface, so the surface is measured, over all
 * triangles of skin (with a mobile vertex). The value is the area as shown over the area at
 * rest, projected along the normal at rest as turned by the bones alone. That is the
 * determinant of the map from the triangle at rest into its own plane. It is <= 0 where skin is
 * squashed to nothing, or turned by more than 90 degrees from where the bones turn it, as in
 * any fold. */
double face_min_determinant(const face *f);
/* The same with a rig, and the position of that triangle at rest, mm. */
double face_worst_triangle(const face *f, vec3 *out_rest);
typedef struct face_surface { /* state of the skin as shown, in both modes */
    double min_determinant;   /* face_min_determinant; <= 0 if it folds */
    surface_state skin;       /* triangles with a mobile vertex */
    double held_back_mm;      /* face_meter.held_back_mm */
} face_surface;
/* Takes some 10 ns per triangle of skin. */
face_surface face_measure_surface(const face *f);
/* Returns the greatest depth of a vertex below a proxy's floor as shown, mm; 0 if all are above. */
double face_penetration_mm(const face *f);

#endif
