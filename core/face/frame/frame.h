/* face/frame/frame.h - the data of a face (face/face.h), and the functions that the files of this
 * folder share. */
#ifndef MAROTTE_FACE_FRAME_FRAME_H
#define MAROTTE_FACE_FRAME_FRAME_H
#include "base/angle.h"
#include "base/arrays.h"
#include "base/bytes.h"
#include "face/frame/blend.h"
#include "face/face.h"
#include "face/frame/projection.h"

enum { FACE_BONES_PER_CONTROL = 4, FACE_POSE_COLUMNS = 4 };
enum { FACE_SWINGS = 2 }; /* turns of a bone that its spring swings */

/* A bone: how far each vertex follows its motion, and the displacement field that moves these
 * vertices first. */
typedef struct face_field {
    csrbf_solver *solver;
    float *weight;    /* padded_count: w_b */
    float *pull;      /* padded_count: w_b m */
    uint8_t *wanted;  /* block_count: 1 for blocks where pull is not 0 everywhere */
    uint8_t *carried; /* block_count: 1 for blocks where weight is not 0 everywhere */
    uint32_t *control, control_count; /* its controls, ascending */
    uint32_t first_column;            /* first column of its controls */
    uint32_t pose_column;             /* the first of four, if the bone moves */
    vec3 pivot;                       /* mm: origin of the pose columns */
    bool is_whole;                    /* pull is 1 everywhere */
} face_field;

/* A control that holds the face. */
typedef struct face_grip {
    double share[RIG_BONES_MAX];
    bool belongs[RIG_BONES_MAX];
    double mobility;  /* divisor of its pull */
    double riding;    /* share on the jaw, 0..1 */
    vec3 start;       /* mm, bones at rest */
    uint32_t contact; /* 1 + index; 0 for a free point */
    bool is_dropped;  /* the control can move nothing */
} face_grip;

/* Data per block of vertices, and of the last frame shown: face_shown.c. */
typedef struct face_blocks {
    uint8_t *is_stale;       /* 1: the next frame must write the block */
    uint8_t *is_rest;        /* 1: the origin has the bits of the rest shape in the block */
    uint8_t *carrier, *bone; /* the only bone that moves the block (shading_shape.carrier): in this
                                frame, and without controls */
    float *weight;           /* column capacity by 3: from the last frame; 0 for new columns */
    uint64_t *changed;       /* scratch: columns, as columns.mark */
    uint64_t *of_controls;   /* scratch: columns of controls with a weight other than 0 */
    rigid pose[RIG_BONES_MAX];
    stamps written;
} face_blocks;

/* A group of triangles with corners in a block, and bits for those corner vertices. */
typedef struct limit_member {
    uint32_t group;
    uint64_t corners;
} limit_member;

/* The part of the pulls that is applied, so that no skin folds or tears: face_limit.c. */
typedef struct face_limit {
    float (*posed)[4], (*added)[4]; /* of each vertex: its position by the bones alone; the
                                       displacement by controls */
    const struct strain_loops *loops;
    struct limit_group *group;
    struct limit_patch *patch;     /* of each group */
    struct strain_shapes *shape;   /* of each group: patch.origin.shape, contiguous */
    uint8_t *known;                /* of each group: bits, see limit.h */
    bool measures_all_groups;      /* for a test: measures all groups, ignoring the bounds */
    struct limit_carried *carried; /* of each group: see limit_group */
    uint32_t *block;               /* the same: blocks of its vertices */
    uint64_t *corners;             /* of each of those: bits of the group's vertices */
    limit_member
        *group_of; /* for each block the groups there, from its first_of to the next one's */
    uint32_t *first_of;
    struct limit_apart *apart;      /* of each pair of bones */
    struct limit_rooms *rooms;      /* face_limit_room.c */
    float turned[RIG_BONES_MAX][9]; /* of each bone: R - I */
    float *still;                   /* of each vertex: the share of bones that do not move */
    uint32_t *bones_around;         /* of each vertex: bits of the main bones of its groups */
    float *steepest;   /* for each column of a control and each group: the greatest length of its
                          gradient */
    float *pull_bound; /* of each group: upper bound of the length of the gradient of `bounded` */
    float *change;     /* the part of that bound that the last change of `bounded` added */
    float *group_strain, *group_flip; /* of each group: upper bounds (the strain also bounds the
                                         gradient's size); INFINITY if not known in this pose */
    uint8_t *is_marked;               /* scratch: groups */
    double *bounded;                  /* column capacity by 3 */
    uint32_t *wanted;                 /* scratch: groups */
    uint32_t *candidate,
        candidate_count;            /* triangles that may be bent too far against neighbours */
    uint32_t *harmed, harmed_count; /* groups that the seal, the skull or teeth fold or bend */
    bool gives_less; /* pulls were reduced because of those groups, so pull_bound does not belong to
                        f->given */
    float (*slid)[4]; /* of each vertex: its shown position, in the blocks marked by is_slid */
    uint8_t *is_slid;
    /* Of each of the head's own shapes: shapes.given before pulls are reduced; its share, as
     * tip_share. */
    double *shaped, *shape_share;
    bool is_pose_known, is_at_rest; /* since the engagement; at rest `posed` equals the origin */
    bool is_begun;                  /* begin_pose was called for this frame */
    double *g;                      /* control_capacity by 3: the pulls that are applied */
    uint8_t *is_changed;            /* of each block: changed by a step */
    uint8_t *is_posed, *is_added;   /* of each block: `posed` or `added` belongs to this frame */
    bool is_added_given;            /* `added` belongs to the current f->given */
    float (*step)[4];               /* drag: the full step of each vertex */
    float (*longest)[3];            /* of each triangle of skin: lengths of its edges at rest, mm */
    double *pose_weight;            /* column capacity by 3 */
    double *asked, *centre, *ridge, *likeness, *strain, *scratch; /* per control */
    points shown_before, shown_after; /* drag: the shapes before and after a step */
    float *share;                     /* of each vertex: its share of a drag step */
    double *tip_share;                /* control_capacity: the same for tips */
} face_limit;

/* One of the head's own shapes. */
typedef struct face_shape {
    const char *name;        /* name in the mesh */
    uint32_t target, arkit;  /* index in mesh.target; index of ARKit's shape, or ARKIT_NONE */
    float dof[MRT_MAX_DOFS]; /* the part that bones do, at weight 1 */
    uint32_t bones;          /* bits of those bones */
    bool follows_bones;      /* its weight follows from the pose of the bones */
    double bone_square;      /* sum of squares of the bones' motion, mm^2 */
    double purity;           /* 0..1: the share of its sum of squares that bones explain */
    double size_mm;          /* root mean square over the skin */
    uint32_t needs[2];       /* for a corrective: 1 + the shapes that it corrects; 0 for none */
} face_shape;

/* The share of a shape that a bone carries: columns for x, y and z. */
typedef struct face_shape_part {
    uint32_t shape, carrier; /* carrier: a bone that moves; RIG_BONES_MAX for all that do not */
    uint32_t column;
} face_shape_part;

/* The head's own shapes: face_shapes.c. Their columns come before those of controls. */
typedef struct face_shapes {
    const mesh *m; /* the mesh that they belong to */
    face_shape *shape;
    face_shape_part *part;
    uint32_t count, part_count;
    double amount; /* 0..1: strength with which shapes answer pulls; 0: not at all, as clay */
    double dof_mm[MRT_MAX_DOFS];
    bool covers[MRT_MAX_DOFS];   /* some shape moves this degree of freedom */
    bool derives[RIG_BONES_MAX]; /* pulls may pose this bone, since skin rides on it */
    uint32_t speaks_of, rides;   /* bits: bones that shapes move; bones that controls ride on */
    double *weight;              /* weights of the frame; the next solve starts there */
    double *asked;    /* lower bounds from face_set_least_weights; 0 for shapes that follow bones */
    double *at;       /* shapes by control_capacity by 3: offsets at the controls, mm */
    double *whole;    /* the same, including the bones that follow */
    uint32_t derived; /* bits: the bones that followed when `whole` was computed */
    double *h, *few, *b, *low, *high, *y, *left, *scratch; /* see shape_solve.h; few: part of b */
    double *given,
        *strain;   /* face_limit.c: the applied share of each shape, and its excess strain */
    float *learnt; /* scratch of loading, freed after the columns are filled */
    float (
        *longest)[3]; /* of each triangle of skin: greatest length of its edges in any shape, mm */
} face_shapes;

/* The seal of the lips: face_lips.c. Stations as in bind_lips; rows of 3 are mm. */
typedef struct face_lips {
    uint32_t count;   /* number of stations; 0 if the face has no seal */
    uint32_t carrier; /* the bone that turns the axes of the slit */
    uint32_t middle;  /* the station in the middle */
    uint32_t *slot;   /* 4 per station: the ends of its edge of the upper rim, then of the lower */
    double *along;    /* 2 per station: its position along these edges */
    double *rest;     /* count by 3: of the upper rim */
    double *floor_mm; /* the negative depth by which the rims cross at rest; 0 if they do not */
    double *open_mm;  /* distance of the rims at rest */
    double *from_corner; /* 0 at the corners .. 1 in the middle */
    columns columns;     /* one per station: how far a correction of 1 moves each vertex */
    uint8_t *reaches;    /* of each block: 1 if the seal can move vertices */
    uint32_t *group,
        group_count; /* groups of face_limit with triangles that it can move, ascending */
    uint32_t *block, block_count; /* blocks with vertices of these groups, ascending */
    float *at_slot;   /* column capacity by slots: values of the face's columns at the slots */
    float *steepest;  /* of each station and each of these groups: the greatest length of the
                         gradient of the sum of the columns from that station on */
    float *steepness; /* scratch: of each of these groups: bound of the seal's gradient */

    double *x, *y, *z;     /* scratch: of each slot: its position by bones and pulls */
    double *upper, *lower; /* scratch: count by 3: the rims */
    double *correction;    /* count by 3: the seal's contribution to upper - lower */
    float *shown;          /* the same in the last frame shown */
    bool is_meeting;       /* at least one correction is not 0 */

    /* face_limit.c: the part of the seal that is applied, so that it folds nothing */
    double share, share_near;       /* everywhere; near the stations, weighted by `near` */
    double *near;                   /* of each station, 0..1 */
    float (*bare)[4], (*sealed)[4]; /* of each vertex of these blocks, while rims meet: its position
                                       without and with the seal */
} face_lips;

/* The tongue behind the lips: face_tongue.c. */
typedef struct face_tongue {
    uint32_t bone;    /* RIG_NONE if no tongue can come out between the lips */
    double free_rad;  /* greatest turn at which its tip is still behind the lips */
    double height_mm; /* height of the part in front of the lips at its greatest turn */
} face_tongue;

/* A bone with a spring, and its mass. Positions in mm, velocities in mm/s, as shown. */
typedef struct face_spring {
    uint32_t bone;
    uint32_t turn[FACE_SWINGS], turn_count; /* turns of the bone that move the tip */
    double reach_mm;                        /* of the tip, from the bone that carries it */
    bool has_place;                         /* else it is at rest, and the rest is not known */
    vec3 tip, way[FACE_SWINGS];             /* of the last step, without the swing */
    vec3 position, velocity;                /* of the mass */
    double swing_rad[FACE_SWINGS];
} face_spring;

/* The loose parts: face_springs.c. */
typedef struct face_springs {
    face_spring of[RIG_BONES_MAX]; /* parents first */
    uint32_t count;
    bool swings[RIG_BONES_MAX]; /* of each bone: it has a spring, or rides on a bone that has one */
    double share;               /* 0..1, of the swing */
    bool has_time;
    int64_t time_ns; /* of the last step */
    /* The same before the steps of time_ns, which a further step of that time takes back. */
    bool has_before, had_time;
    int64_t before_ns;
    face_spring before[RIG_BONES_MAX];
} face_springs;

struct face {
    arrays arrays;  /* owner of all arrays here, except those that face_destroy frees one by one */
    const rig *rig; /* may be NULL */
    binding binding;
    bones bones;
    projection projection;
    points_order order;
    points rest, base, shown;
    points free;          /* unanchored mode: the shape with its bones at rest */
    const points *origin; /* base or free: the shape that the columns are added to */
    points before;        /* drag: the previous shape, restored on an error */
    float *mobility;      /* padded_count */
    face_blocks blocks;

    mrt_contact *contact;
    uint32_t *contact_slot;
    uint32_t contact_count;

    uint32_t bone_count;
    face_field field[RIG_BONES_MAX];
    columns columns;
    bool wants_shapes;
    face_shapes shapes;
    uint32_t shape_column_count;   /* columns of shapes, which stay */
    uint32_t control_column_count; /* columns of shapes and controls, followed by those of bones */
    bool is_pose_noted; /* the columns are only those of bones, are noted, and are 0 in blocks that
                           no bone carries */
    double *weight, *next_weight; /* column capacity by 3: result of the solve */
    double *given; /* weights of the shape shown: reduced where skin would fold or tear */
    bool is_given; /* `given` was computed from `weight` */
    bool is_held;  /* `given` is less than `weight` */

    csrbf_settings settings; /* of the engagement */
    uint32_t control_capacity, control_count;
    face_grip *grip, *next_grip; /* control_capacity; next: for drag and engage */
    points grip_position;        /* control_capacity: the starts, for `cross` */
    float *cross;                /* one row per control column: its values at the starts */
    matrix3x3 *rotation;         /* control_capacity: scratch of a frame */
    double *g, *position, *scratch, *gain; /* control_capacity by 3, gain by 1 */
    double *tip, *step, *pull, *from, *to; /* drag: control_capacity by 3 */

    float dof[MRT_MAX_DOFS]; /* as requested or derived, before limits, without the swing */
    rigid pose[RIG_BONES_MAX];
    face_meter meter;
    uint32_t engagement;
    bool is_exact;

    uint32_t *skin; /* skin_count by 3 slots: triangles with a mobile vertex */
    uint32_t skin_count;
    surface_meter *surface_meter; /* of the skin */
    face_limit limit;
    face_lips lips;
    face_tongue tongue;
    face_springs springs;
};

/* ---- face_grip.c ---- */

/* Fills a grip at `at` (mm, in the shape shown): at a contact, or at the nearest vertex if contact
 * is 0. */
void face_grip_at(face_grip *out, const face *f, vec3 at, uint32_t contact);
/* Lists each field's controls and assigns their columns. */
void face_assign(face *f, const face_grip *grip, uint32_t count);
blend face_blend_at(const face *f, const face_grip *grip, const rigid *pose);
/* Returns the sum of the shares of the bones that the grip belongs to. */
double face_share_held(const face *f, const face_grip *grip);

/* ---- face.c ---- */

/* Computes the shape shown with its bones at rest: the origin plus the controls' displacement,
 * without the projection. out may be f->base or f->free. */
void face_bake(face *f, points *out);
/* Computes the columns of the moving bones over the origin, after those of the controls. Notes all
 * columns. */
void face_pose_columns(face *f);
/* Computes the bones' weights for these poses; they follow the first control_column_count
 * weights. */
void face_pose_weights(face *f, double *weight, const rigid *pose);
/* The same for one moving bone. */
void face_weigh_bone(const face *f, double *weight, uint32_t bone, const rigid *pose);
/* Returns true if some moving bone is not at rest. */
bool face_is_posed(const face *f);
/* Makes the dofs and poses of a frame current. */
void face_set_pose(face *f, const float *dof, const rigid *pose);
/* Sets meter.dof and meter.driven for these driven dofs. */
void face_note_dofs(face *f, const float *dof);

/* ---- face_engage.c ---- */

/* Factors the fields at the assigned grips and computes their columns over the base. */
CHECKED mrt_result face_hold(face *f, error *err);

/* ---- face_frame.c ---- */

/* Computes the degrees of freedom to pose: driven ones as given, the jaw derived from the controls
 * that ride on it. end NULL: no control. */
CHECKED mrt_result face_resolve_dofs(face *f, float *out, const float *dof, const double *end,
                                     error *err);

/* ---- face_shapes.c: without shapes all of these do nothing ---- */

/* Analyses the shapes. face_shapes_fill fills their columns once these are allocated. */
CHECKED mrt_result face_shapes_create(face *f, const mesh *m, error *err);
void face_shapes_fill(face *f);
/* Computes the effect of the shapes at the controls. Call after an engagement. */
void face_shapes_engage(face *f);
/* Computes the weights of a frame. resolved: the degrees of freedom, in and out. */
void face_shapes_solve(face *f, float *resolved, const float *dof, const double *end);
/* Computes the weights that follow from the bones, without pulls. */
void face_shapes_settle(face *f, const float *dof);
/* Offsets by the shapes with the bones at rest. _at: at a control. _missing: the part of it that
 * face_limit.c removes. _led: the part that follows from the bones alone, at a control for these
 * degrees of freedom, or at a vertex. */
vec3 face_shapes_at(const face *f, uint32_t control);
vec3 face_shapes_missing(const face *f, uint32_t control);
vec3 face_shapes_led_at(const face *f, uint32_t control, const float *dof);
vec3 face_shapes_led_slot(const face *f, uint32_t slot);
/* Sets the weights of the shapes' columns; removes the part that follows from the bones; computes
 * f->given from f->weight. */
void face_shapes_weigh(const face *f, double *weight, const rigid *pose);
void face_shapes_unlead(const face *f, double *weight);
void face_shapes_apply(face *f);
bool face_shapes_weigh_something(const face *f);
bool face_shapes_are_held(const face *f); /* true if some are reduced */
const char *face_shapes_column_name(const face *f, uint32_t column, uint32_t *out_carrier);

/* ---- face_lips.c: if the lips cannot be sealed all of these do nothing ---- */

CHECKED mrt_result face_lips_create(face *f, error *err);
void face_lips_destroy(face *f);
/* Call when the columns have changed. */
void face_lips_engage(face *f);
/* Computes the corrections for f->given and the pose; strength: value of lips.seal, 0..1. */
void face_lips_solve(face *f, double strength);
/* Updates lips.steepness to the corrections. */
void face_lips_bound(face *f);
/* Sets all corrections to 0. */
void face_lips_clear(face *f);
/* Adds the displacement by the seal in the block to sum. */
void face_lips_sum(const face *f, float sum[3][POINTS_BLOCK], uint32_t block);
/* Returns whether the corrections differ from those last shown, and stores them as shown. */
bool face_lips_show(face *f);

/* Returns the gap between the rims in the middle of the slit, in the current shape. */
double face_lips_open_mm(face *f);

/* ---- face_tongue.c ---- */

void face_tongue_create(face *f);
/* Turns the tongue back behind the lips. Call when f->given and the lips of a frame are known. */
void face_tongue_limit(face *f);

/* ---- face_springs.c: without springs all of these do nothing ---- */

void face_springs_create(face *f);
/* Brings all parts to rest, wherever the bones are next. */
void face_springs_rest(face *f);
/* Writes dof with the swing added, for bones_pose. out may be dof. */
void face_add_swing(const face *f, float *out, const float *dof);
/* bones_pose of the driven degrees of freedom and the swing. */
void face_pose_bones(const face *f, rigid *out, const float *dof);
void face_springs_write(bytes_out *out, const face *f);
void face_springs_read(bytes_in *in, face *f);

/* ---- face_limit.c ---- */

CHECKED mrt_result face_limit_create(face *f, error *err);
/* Call when the columns have changed. */
void face_limit_engage(face *f);
/* Sets f->given to f->weight, reduced near places where the skin would fold or tear. Sets
 * held_back_mm. Depends only on f->weight, the pose and the engagement. */
void face_limit_pull(face *f);
/* Call when f->given is shown. Where skin folds that the skull or teeth pushed aside, reduces the
 * pulls and writes the face again. */
void face_limit_slide(face *f);
/* After face_limit_pull on a face with shapes: whether it has summed a block. face_limit_added
 * copies that sum, of all columns except those of bones, so that it is not computed twice. */
bool face_limit_has_sum(const face *f, uint32_t block);
void face_limit_added(const face *f, float sum[3][POINTS_BLOCK], uint32_t block);
/* Returns the greatest length of an edge over its length at rest. */
double face_stretch_most(const csrbf_settings *settings);

/* ---- face_shown.c ---- */

CHECKED mrt_result face_shown_create(face *f, error *err);
/* Writes the blocks that f->given, the pose and the seal change. */
void face_write(face *f);
/* Call when a block of the origin, or of the next origin, has been written. */
void face_mark_stale(face *f, uint32_t block, const points *origin);
void face_mark_all_stale(face *f);
/* The same for all blocks in which `now` differs from `before`. */
void face_mark_changed_stale(face *f, const points *now, const points *before);
/* Call before the columns change. */
void face_discard_columns(face *f);
/* Returns true if at least one of the columns is not 0 everywhere in the block; some: as
 * columns.mark. */
bool face_reaches(const columns *c, const uint64_t *some, uint32_t block);
/* Shows the rest shape with its bones at rest. The origin must already be the rest shape. */
void face_show_rest(face *f);

/* ---- face_skin.c ---- */

/* Returns the normal of a triangle, with the length of twice its area. */
vec3 face_skin_area(const points *p, const uint32_t *corner);
/* The same at rest, rotated by the bones alone, with the mean weights of its corners. */
vec3 face_skin_along(const face *f, const uint32_t *corner);
CHECKED mrt_result face_skin_create(face *f, const mesh *m, error *err);

#endif
