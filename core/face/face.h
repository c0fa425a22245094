/* face/face.h - a face that is performed: bones, constrained controls, one displacement field per
 * bone, skin that slides over the skull. The design's formula:
 *   x'(v) = project( sum_b w_b(v) T_b( x(v) + m(v) sum_k B^b_k(v) g_k ) )
 * where x is the base shape with all bones at rest. While the projection is inactive this is
 *   x'(v) = x(v) + sum_j column_j(v) * weight_j,   weight_j a vector:
 * one column per control and bone that it touches (w_b m B^b_k, moved by R_b g_k), and four columns
 * per moving bone (w_b x, w_b y, w_b z, w_b, moved by the columns of R_b - I and by t_b; x from
 * the bone's own centre, so that a turned head loses no digits). So a frame is one pass over
 * columns, exports are exact, and without a rig it is csrbf/shape.h, bit for bit.
 * The seal of the lips (RIG_LIPS_SEAL) is added between the sum and the projection, and is no
 * column. Vertices in the engine's order. [frame] all but create/destroy: no allocation; same
 * input, same bits. */
#ifndef MAROTTE_FACE_FACE_H
#define MAROTTE_FACE_FACE_H
#include "base/stamps.h"
#include "csrbf/shape.h"
#include "face/bind.h"
#include "face/bones.h"
#include "mesh/shading.h"
#include "mesh/surface_meter.h"

typedef struct face face;

/* rig NULL: the mesh alone, one fixed bone, everything free. The rig and the mesh must outlive it.
 * m: in mm. */
CHECKED mrt_result face_create(face **out, const rig *r, const mesh *m, const topology *t,
                               uint32_t control_capacity, error *err);
/* The same with a binding that is there already; takes it over, zeroes b, on errors too. */
CHECKED mrt_result face_create_bound(face **out, const rig *r, const mesh *m, binding *b,
                                     uint32_t control_capacity, error *err);
/* The same, and the mesh's morph targets are its own shapes: see below. */
CHECKED mrt_result face_create_shaped(face **out, const rig *r, const mesh *m, binding *b,
                                      uint32_t control_capacity, error *err);
void face_destroy(face *f); /* NULL is fine */

const points_order *face_order(const face *f);
const points *face_shown(const face *f);
/* Which blocks of it have been written since a reader looked last. What nothing moves, or moves as
 * it did in the frame before, is not written: the bits are those of a whole frame all the same. */
const stamps *face_written(const face *f);
/* The same for its normals, with what the bones carry as it is at rest; until the next frame. */
shading_shape face_shading(const face *f);
const points *face_rest(const face *f);
const binding *face_binding(const face *f);
const bones *face_bones(const face *f); /* dof_count 0 without a rig */
/* Contacts as plugins see them; until destroy. */
const mrt_contact *face_contacts(const face *f, uint32_t *out_count);
/* Where a contact (1 + index) is in the shape shown, mm. */
vec3 face_contact_now(const face *f, uint32_t contact);

typedef struct face_control {
    vec3 start;       /* mm, where it takes hold of the face shown */
    uint32_t contact; /* 1 + index of the contact that it pulls; 0: a free point */
} face_control;

/* ---- anchored ---- */

/* The base becomes the shape shown with its bones at rest (no jump whatever the pose); the controls
 * take hold: starts are carried back through the bones' motion (dof: as in the last frame shown).
 * The shares of a control are the weights at its contact, or at the vertex shown that is nearest to
 * a free point. A control belongs to the field of each bone with a share of more than 2 % at it, of
 * at most four. Where the mobility is below 1/10 a control lands short of its end; where it is
 * below 1/100 it moves nothing (face_meter.dropped_count). What the projection adds is not baked
 * in: it is found anew in each frame. On error nothing has changed. count 0 ends the engagement. */
CHECKED mrt_result face_engage(face *f, const csrbf_settings *settings, const face_control *control,
                               uint32_t count, error *err);
/* The frame: shown from base, for the ends of the controls (count by 3, mm, where each control is
 * to land in the shape shown) and the degrees of freedom (dof_count; NaN: not driven: the jaw is
 * derived from the controls that ride on it, others are 0; dof NULL: none is driven). A control
 * rides on the jaw if its share there is above 1/2, fully from 9/10 on; a jaw on which none rides
 * stays as it is, and so do lateral and forward on which one alone rides. With no control engaged
 * only bones move. Not finite: error, shown is kept. */
CHECKED mrt_result face_pull(face *f, const double *end, const float *dof, error *err);
/* Its two halves: what depends on the frame before (the derived jaw), once per sample; and the
 * vertices, once per drawn frame. */
CHECKED mrt_result face_aim(face *f, const double *end, const float *dof, error *err);
void face_show(face *f);
/* Ends for controls that ride on the bones (rides: 1 for each such control): on entry their `end`
 * is how far they are to be pulled with all bones at rest, on return where that lands once the
 * bones that `dof` drives have moved. Other ends stay. */
void face_ride(const face *f, double *end, const uint8_t *rides, const float *dof);
/* The way back, for all controls: ends become how far each is pulled with all bones at rest. */
void face_unride(const face *f, double *end, const float *dof);
/* Base := shown with its bones at rest; the engagement ends; nothing jumps. */
void face_commit(face *f);
void face_reset(face *f);

/* ---- the head's own shapes ----
 *
 * A face with a rig whose mesh has morph targets answers a pull with them first: of all weights in
 * 0..1 the few small ones that explain where the controls go, found from those of the frame before
 * on; the fields do what is left, so controls land on their ends all the same. What bones can do of
 * a shape they do: of jawOpen only what is beside the jaw's motion is a shape, and its weight is
 * how far the jaw is open. A bone that skin rides on and that nobody drives (the jaw, a lid) goes
 * with the weights. Clay that is dragged has only the shapes that bones lead to. */

/* 0: clay, and the bits of a face without shapes; 1 to begin with. Between frames. */
void face_set_shapes(face *f, double amount);
/* How many of a mesh's targets a face takes: the first ones; none where that is beyond 1 GiB. */
enum { FACE_SHAPES_MAX = 320 };
uint32_t face_shapes_of(const mesh *m);
/* Those that move something; the names are the mesh's. */
uint32_t face_shape_count(const face *f);
const char *face_shape_name(const face *f, uint32_t index);
/* out: face_shape_count; how much of each is in what is called so: 1 of shapes of that name
 * (ARKit's whoever writes it, "eyeBlink_L"), else their weights in the mesh's expression of that
 * name. False: all are 0. */
bool face_shape_parts(const face *f, const char *name, float *out);
/* Of the frame, 0..1: as given, less than asked for where skin would fold. */
double face_shape_weight(const face *f, uint32_t index);
/* What bones do of it at weight 1: MRT_MAX_DOFS; until destroy. */
const float *face_shape_dofs(const face *f, uint32_t index);
/* From the next frame on each has at least that weight (0..1, face_shape_count of them; NULL: 0),
 * and contacts are pulled from where it brings them: pulls add to it, as to bones that are driven.
 * What bones do of a shape has to be driven beside it; one that follows bones is left to them. */
void face_ask_shapes(face *f, const float *weight);
/* What it adds at weight 1 with the bones at rest, mm: vertices by 3, in the file's order. */
void face_shape_offset(const face *f, uint32_t index, float *out);

/* ---- unanchored ---- */

/* Drags the shape, carried back through the bones' motion (from: of the frame before, to: of this
 * one), from -> to, then poses it: the bones come from absolute poses, never accumulated. A jaw
 * that is not driven stays as it is, other dofs are 0. The weights are those of the vertex shown
 * that is nearest to `from`. A vertex moves by m sum_b w_b d_b. An anchored engagement ends. On
 * error nothing has moved. */
CHECKED mrt_result face_drag(face *f, const csrbf_settings *settings, const double *from,
                             const double *to, uint32_t count, const float *dof,
                             double *out_reached, shape_step *out_step, error *err);
/* The unposed shape eases towards the base, as shape_leak; an anchored engagement ends. */
void face_leak(face *f, double rate_per_s, double dt_s);
/* So much (0..1) of the way from the unposed shape, and from the base, to the rest shape; an
 * anchored engagement ends. */
void face_restore(face *f, double part);

/* Whether a point (count by 3) is closer than radius to the base while engaged, else to the shape
 * shown. */
bool face_is_near(const face *f, const double *point, uint32_t count, double radius);

/* ---- kept ---- */

/* All that frames to come depend on, as bytes (at most `capacity` are written; bytes may be NULL).
 * Returns the size that it takes: some KB, and 12 bytes a vertex for a base that is not the rest
 * shape. After face_load of them, on a face of the same rig and mesh, the same calls give the same
 * bits. Columns are found anew. */
size_t face_save(const face *f, void *bytes, size_t capacity);
/* On error (bytes of another face, or damaged) the face is reset. */
CHECKED mrt_result face_load(face *f, const void *bytes, size_t size, error *err);

uint32_t face_control_count(const face *f); /* engaged; 0: none */

/* ---- what happened ---- */

typedef struct face_columns { /* of the engagement; valid until the next engage */
    const points *base;
    const float *column; /* count rows of stride floats */
    size_t stride;
    const double *weight; /* count by 3: of the last face_pull */
    uint32_t count;
    uint32_t engagement; /* grows whenever base or columns change */
    bool is_exact; /* false: the projection or the seal moved a vertex in the last frame shown */
} face_columns;
face_columns face_columns_now(const face *f);
/* What a column is of: a shape along an axis ("mouthSmile.x", with "@jaw" behind for what a moving
 * bone carries of it); a contact ("mouth.corner.l"), a free point by its number ("control2"), both
 * with "@bone" behind when several bones are in it; or a bone's motion: "jaw.turn_x" to
 * "jaw.turn_z", "jaw.shift". */
enum { FACE_COLUMN_NAME = 160 };
void face_column_name(const face *f, uint32_t column, char out[FACE_COLUMN_NAME]);
typedef struct face_column { /* one of a control */
    uint32_t control;        /* FACE_NO_CONTROL: the column is one of a bone's motion */
    double share;            /* of its bone there: the field of a control with several bones is that
                                of all its columns */
} face_column;
#define FACE_NO_CONTROL UINT32_MAX
face_column face_column_at(const face *f, uint32_t column);
/* Of the engagement. */
csrbf_settings face_settings(const face *f);
/* A control of the engagement; its start is where it holds the face with its bones at rest. */
face_control face_control_at(const face *f, uint32_t control);

typedef struct face_meter {
    double slope_bound;    /* of the field: < 1 nothing folds */
    double penetration_mm; /* how deep the projection found skin below its floor, before it acted */
    uint32_t projected_count; /* vertices that it moved; for tests */
    float dof[MRT_MAX_DOFS];  /* as posed, derived and limited ones included */
    uint32_t dropped_count;   /* controls of the engagement that can move nothing: mobility 0 */
    double held_back_mm; /* by so much the control furthest from its end falls short of it, because
                            the skin would fold or tear; 0: nothing is held back */
} face_meter;
const face_meter *face_metered(const face *f);
/* How close the face is to folding; <= 0: it folds. The exact meter, not for every frame.
 * Without a rig: the smallest determinant of the map's Jacobian at the vertices of the base
 * (shape_min_determinant of the last pull; 1 while nothing is engaged).
 * With a rig the weights live on the surface, so the surface is measured: of each triangle of skin
 * (one with a mobile vertex) the area as shown over the area at rest, seen along its normal at rest
 * as the bones alone turn it. That is the determinant of the map from the triangle at rest into its
 * own plane: <= 0 where skin is squashed to nothing, or turned by more than 90 degrees from where
 * the bones turn it, as in any fold. */
double face_min_determinant(const face *f);
/* With a rig: the same, and where at rest that triangle is, mm. */
double face_worst_triangle(const face *f, vec3 *out_rest);
typedef struct face_surface { /* the skin as shown, anchored or not */
    double min_determinant;   /* face_min_determinant; <= 0: it folds */
    surface_state skin;       /* triangles with a mobile vertex */
    double held_back_mm;      /* face_meter.held_back_mm */
} face_surface;
/* Some 10 ns for each triangle of skin. */
face_surface face_judge(const face *f);
/* How far the vertex furthest below a proxy's floor is below it as shown, mm; 0: none. */
double face_penetration_mm(const face *f);

#endif
