/* face/frame/frame.h - what a face (face/face.h) is made of, and what the files of this folder do
 * for each other. */
#ifndef MAROTTE_FACE_FRAME_FRAME_H
#define MAROTTE_FACE_FRAME_FRAME_H
#include "base/arrays.h"
#include "face/frame/blend.h"
#include "face/face.h"
#include "face/frame/projection.h"

enum { FACE_BONES_PER_CONTROL = 4, FACE_POSE_COLUMNS = 4 };

/* A bone: how far each vertex follows its motion, and the displacement field that is applied to its
 * vertices before. */
typedef struct face_field {
    csrbf_solver *solver;
    float *weight;                    /* padded_count: w_b */
    float *pull;                      /* padded_count: w_b m */
    uint8_t *wanted;                  /* block_count: 1 where pull is not 0 all over */
    uint8_t *carried;                 /* block_count: 1 where weight is not 0 all over */
    uint32_t *control, control_count; /* the controls that belong to it, ascending */
    uint32_t first_column;            /* of its controls */
    uint32_t pose_column;             /* the first of four, when the bone moves */
    vec3 pivot;                       /* mm: what the pose columns count from */
    bool is_whole;                    /* pull is 1 everywhere */
} face_field;

/* A control that holds the face. */
typedef struct face_grip {
    double share[RIG_BONES_MAX];
    bool belongs[RIG_BONES_MAX];
    double mobility;  /* its pull is divided by that */
    double riding;    /* on the jaw, 0..1 */
    vec3 start;       /* mm, bones at rest */
    uint32_t contact; /* 1 + index; 0: a free point */
    bool is_dropped;  /* it can move nothing */
} face_grip;

/* Of each block of vertices, and of the frame shown last: face_shown.c. */
typedef struct face_blocks {
    uint8_t *is_stale;       /* 1: the next frame writes it, whatever changes */
    uint8_t *is_rest;        /* 1: the origin has the bits of rest there */
    uint8_t *carrier, *bone; /* the bone that alone moves the block (shading_shape.carrier): in this
                              * frame, and while no control moves it */
    float *weight;           /* column capacity by 3: of the last frame; 0 for new columns */
    uint64_t *changed;       /* scratch: columns, as columns.mark */
    uint64_t *of_controls;   /* scratch: the columns of controls with a weight other than 0 */
    rigid pose[RIG_BONES_MAX];
    stamps written;
} face_blocks;

/* A group of triangles with corners in a block: bits, which vertices they are. */
typedef struct limit_member {
    uint32_t group;
    uint64_t corners;
} limit_member;

/* How much of the pulls is applied, so that no skin folds or tears: face_limit.c. */
typedef struct face_limit {
    float (*posed)[4],
        (*added)[4]; /* of each vertex: its position by the bones alone; what controls add */
    const struct strain_loops *loops;
    struct limit_group *group;
    struct limit_patch *patch;     /* of each group */
    struct strain_shapes *shape;   /* of each group: patch.origin.shape, side by side */
    uint8_t *known;                /* of each group: limit.h */
    bool passes_over_nothing;      /* for a test: all groups are measured, whatever bounds say */
    struct limit_carried *carried; /* of each group: see limit_group */
    uint32_t *block;               /* likewise: of its vertices */
    uint64_t *corners;             /* of each of those: bits, which vertices are the group's */
    limit_member *group_of;        /* of each block the groups there, from first_of to the next's */
    uint32_t *first_of;
    struct limit_apart *apart;      /* of each two bones */
    struct limit_rooms *rooms;      /* face_limit_room.c */
    float turned[RIG_BONES_MAX][9]; /* of each bone: R - I */
    float *still;                   /* of each vertex: the share that no moving bone carries */
    uint32_t *bones_around;         /* of each vertex: bits, the main bones of its groups */
    float *steepest;   /* for each column of a control and each group: the greatest length of its
                          gradient */
    float *pull_bound; /* of each group: upper bound of the length of the gradient of `bounded` */
    float *change;     /* the part of that bound that the last change of `bounded` added */
    float *group_strain, *group_flip; /* of each group: upper bounds (strain: also of the gradient's
                                         size); INFINITY: not known in this pose */
    uint8_t *is_marked;               /* scratch: groups */
    double *bounded;                  /* column capacity by 3 */
    uint32_t *wanted;                 /* scratch: groups */
    uint32_t *candidate,
        candidate_count;            /* triangles that may be bent too far against neighbours */
    uint32_t *harmed, harmed_count; /* groups that the seal, the skull or teeth fold or bend */
    bool gives_less;                /* pulls gave way to that: pull_bound is not of f->given */
    float (*slid)[4];               /* of each vertex: where it is shown, in these blocks: */
    uint8_t *is_slid;
    /* Of each of the head's own shapes: as shapes.given, before pulls give way; as tip_share. */
    double *shaped, *shape_share;
    bool is_pose_known, is_at_rest; /* since the engagement; at rest `posed` is the origin */
    bool is_begun;                  /* begin_pose has been called for this frame */
    double *g;                      /* control_capacity by 3: what is given */
    uint8_t *is_changed;            /* of each block: by a step */
    uint8_t *is_posed, *is_added;   /* of each block: `posed`, `added` are of this frame */
    bool is_added_given;            /* `added` is of f->given as it is now */
    float (*step)[4];               /* clay: by how much each vertex was to move */
    float (*longest)[3];            /* of each triangle of skin: its edges at rest, mm */
    double *pose_weight;            /* column capacity by 3 */
    double *asked, *centre, *ridge, *likeness, *strain, *scratch; /* by controls */
    points shown_before, shown_after; /* clay, before and after a step */
    float *share;                     /* of each vertex: of a step of clay */
    double *tip_share;                /* control_capacity: likewise */
} face_limit;

/* One of the head's own shapes. */
typedef struct face_shape {
    const char *name;        /* of the mesh */
    uint32_t target, arkit;  /* index into mesh.target; which of ARKit's, or ARKIT_NONE */
    float dof[MRT_MAX_DOFS]; /* the bones' part of it, at weight 1 */
    uint32_t bones;          /* bits: those that do */
    bool follows_bones;      /* its weight follows from how the bones are posed */
    double bone_square;      /* of their motion, mm^2 */
    double purity;           /* 0..1: the share of its sum of squares that bones explain */
    double size_mm;          /* root mean square over the skin */
    uint32_t needs[2];       /* a corrective: 1 + the shapes that it corrects; 0: none */
} face_shape;

/* The share of a shape that a bone carries: columns for x, y and z. */
typedef struct face_shape_part {
    uint32_t shape, carrier; /* carrier: a bone that moves; RIG_BONES_MAX: all that do not */
    uint32_t column;
} face_shape_part;

/* The head's own shapes: face_shapes.c. The columns come first, before those of controls. */
typedef struct face_shapes {
    const mesh *m; /* whose */
    face_shape *shape;
    face_shape_part *part;
    uint32_t count, part_count;
    double amount; /* 0..1: how far shapes answer pulls; 0: not at all, as clay */
    double dof_mm[MRT_MAX_DOFS];
    bool covers[MRT_MAX_DOFS];   /* some shape moves it */
    bool derives[RIG_BONES_MAX]; /* pulls may pose it, as skin rides on it */
    uint32_t speaks_of, rides;   /* bits: the bones that shapes move; those that controls ride on */
    double *weight;              /* of the frame; the next solve starts there */
    double *asked;    /* lower bounds, by face_ask_shapes; 0 for shapes that follow bones */
    double *at;       /* shapes by control_capacity by 3: at the controls, mm */
    double *whole;    /* likewise, with the bones that follow */
    uint32_t derived; /* bits: the bones that followed when `whole` was computed */
    double *h, *few, *b, *low, *high, *y, *left, *scratch; /* shape_solve.h; few: of b */
    double *given,
        *strain;         /* face_limit.c: the applied share of each shape, and its excess strain */
    float *learnt;       /* scratch of loading, freed when the columns are filled */
    float (*longest)[3]; /* of each triangle of skin: its edges in any shape, mm */
} face_shapes;

/* The seal of the lips: face_lips.c. Stations as of bind_lips; rows of 3 are mm. */
typedef struct face_lips {
    uint32_t count;      /* of stations; 0: the face has no seal */
    uint32_t carrier;    /* the bone that the slit's axes turn with */
    uint32_t middle;     /* the station halfway */
    uint32_t *slot;      /* 4 a station: the ends of its edge of the upper rim, then of the lower */
    double *along;       /* 2 a station: how far along these edges it is */
    double *rest;        /* count by 3: of the upper rim */
    double *floor_mm;    /* by how much the rims cross at rest; <= 0 */
    double *open_mm;     /* how far they are apart at rest */
    double *from_corner; /* 0 at the corners .. 1 in the middle */
    columns columns;     /* one a station: how far a correction of 1 moves each vertex */
    uint8_t *reaches;    /* of each block: 1 where the seal can move vertices */
    uint32_t *group, group_count; /* of face_limit: with triangles that it can move, ascending */
    uint32_t *block, block_count; /* with vertices of these groups, ascending */
    float *at_slot;               /* column capacity by slots: the face's columns there */
    float *steepest;  /* of each station and each of these groups: the greatest length of the
                         gradient  of the sum of the columns from that station on */
    float *steepness; /* scratch: of each of these groups: upper bound of that of the seal */

    double *x, *y, *z;     /* scratch: of each slot: where bones and pulls bring it */
    double *upper, *lower; /* scratch: count by 3: the rims */
    double *correction;    /* count by 3: what the seal adds to upper - lower */
    float *shown;          /* likewise, in the frame shown last */
    bool is_meeting;       /* some correction is not 0 */

    /* face_limit.c: how much of the seal is applied, so that it folds nothing */
    double share, share_near;       /* everywhere, and as far as `near` says */
    double *near;                   /* of each station, 0..1 */
    float (*bare)[4], (*sealed)[4]; /* of each vertex of these blocks, while rims meet: where it is
                                       without and with the seal */
} face_lips;

/* The tongue behind the lips: face_tongue.c. */
typedef struct face_tongue {
    uint32_t bone;    /* RIG_NONE: none that could come out between lips */
    double free_rad;  /* how far out it is behind them all the same */
    double height_mm; /* of what is before them all the way out */
} face_tongue;

struct face {
    arrays arrays;  /* owns all arrays here but those marked otherwise */
    const rig *rig; /* or NULL */
    binding binding;
    bones bones;
    projection projection;
    points_order order;
    points rest, base, shown;
    points free;          /* unanchored: the shape with its bones at rest */
    const points *origin; /* the shape that the columns are added to: base or free */
    points before;        /* drag: the shape before, restored on an error */
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
    uint32_t shape_column_count;   /* those of shapes, which stay */
    uint32_t control_column_count; /* those of shapes and controls, before those of bones */
    bool is_pose_noted;            /* the columns are those of bones alone, noted, and 0 where no
                                    * vertex is carried */
    double *weight, *next_weight;  /* column capacity by 3: as the solve wants them */
    double *given; /* the weights of the shape shown: reduced where skin would fold or tear */
    bool is_given; /* `given` has been computed from `weight` */
    bool is_held;  /* and is less than it */

    csrbf_settings settings; /* of the engagement */
    uint32_t control_capacity, control_count;
    face_grip *grip, *next_grip; /* control_capacity; next: drag and engage */
    points grip_position;        /* control_capacity: the starts, for `cross` */
    float *cross;                /* a row for each control column: its value at the starts */
    matrix3x3 *rotation;         /* control_capacity: scratch of a frame */
    double *g, *position, *scratch, *gain; /* control_capacity by 3, gain by 1 */
    double *tip, *step, *pull, *from, *to; /* drag: control_capacity by 3 */

    float dof[MRT_MAX_DOFS]; /* as asked for or derived, not limited */
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
};

/* ---- face_grip.c ---- */

/* What holds at `at` (mm, in the shape shown), at a contact or (0) at the nearest vertex. */
void face_grip_at(face_grip *out, const face *f, vec3 at, uint32_t contact);
/* Lists each field's controls and gives them columns. */
void face_assign(face *f, const face_grip *grip, uint32_t count);
blend face_blend_at(const face *f, const face_grip *grip, const rigid *pose);
/* sum of the shares of the bones that it belongs to */
double face_share_held(const face *f, const face_grip *grip);

/* ---- face.c ---- */

/* The shape shown with its bones at rest: origin and what the controls add; out may be f->base or
 * f->free. Leaves the projection out. */
void face_bake(face *f, points *out);
/* The columns of the moving bones over the origin, behind those of the controls; notes all. */
void face_pose_columns(face *f);
/* weight: those of the bones for these poses, behind the first control_column_count. */
void face_pose_weights(face *f, double *weight, const rigid *pose);
/* The same of one bone that moves. */
void face_weigh_bone(const face *f, double *weight, uint32_t bone, const rigid *pose);
/* Some bone that moves is not at rest. */
bool face_is_posed(const face *f);
/* Puts the dofs and poses of a frame in force. */
void face_take_pose(face *f, const float *dof, const rigid *pose);

/* ---- face_engage.c ---- */

/* Factors the fields at the assigned grips and finds their columns over the base. */
CHECKED mrt_result face_hold(face *f, error *err);

/* ---- face_frame.c ---- */

/* The degrees of freedom to pose: driven ones as given, the jaw derived from the controls that ride
 * on it. end NULL: none does. */
CHECKED mrt_result face_resolve_dofs(face *f, float *out, const float *dof, const double *end,
                                     error *err);

/* ---- face_shapes.c: with no shapes all of these do nothing ---- */

/* Learns the shapes; and fills their columns once these are allocated. */
CHECKED mrt_result face_shapes_create(face *f, const mesh *m, error *err);
void face_shapes_fill(face *f);
/* After an engagement: what the shapes do at the controls. */
void face_shapes_engage(face *f);
/* The weights of a frame; resolved: the degrees of freedom, in and out. */
void face_shapes_solve(face *f, float *resolved, const float *dof, const double *end);
/* Without pulls: the weights that follow from the bones. */
void face_shapes_settle(face *f, const float *dof);
/* With the bones at rest: what the shapes add at a control; the part of that which face_limit.c
 * takes away; and the part that follows from the bones alone, at a control for these degrees of
 * freedom or at a vertex. */
vec3 face_shapes_at(const face *f, uint32_t control);
vec3 face_shapes_missing(const face *f, uint32_t control);
vec3 face_shapes_led_at(const face *f, uint32_t control, const float *dof);
vec3 face_shapes_led_slot(const face *f, uint32_t slot);
/* Sets the weights of the shapes' columns; takes off what follows from the bones; and makes
 * f->given from f->weight. */
void face_shapes_weigh(const face *f, double *weight, const rigid *pose);
void face_shapes_unlead(const face *f, double *weight);
void face_shapes_give(face *f);
bool face_shapes_weigh_something(const face *f);
bool face_shapes_are_held(const face *f); /* some are reduced */
const char *face_shapes_column_name(const face *f, uint32_t column, uint32_t *out_carrier);

/* ---- face_lips.c: where lips cannot be sealed all of these do nothing ---- */

CHECKED mrt_result face_lips_create(face *f, error *err);
void face_lips_destroy(face *f);
/* Called when the columns have changed. */
void face_lips_engage(face *f);
/* Finds the corrections for f->given and the pose; strength: 0..1 of lips.seal. */
void face_lips_meet(face *f, double strength);
/* Updates lips.steepness to the corrections. */
void face_lips_bound(face *f);
/* Takes all corrections away. */
void face_lips_part(face *f);
/* sum += what the seal adds in the block. */
void face_lips_sum(const face *f, float sum[3][POINTS_BLOCK], uint32_t block);
/* Whether the corrections differ from those shown last; they are those from now on. */
bool face_lips_show(face *f);

/* The gap between the rims in the middle of the slit, in the current shape. */
double face_lips_open_mm(face *f);

/* ---- face_tongue.c ---- */

void face_tongue_create(face *f);
/* Called when f->given and the lips of a frame are known: turns the tongue back behind them. */
void face_tongue_hold(face *f);

/* ---- face_limit.c ---- */

CHECKED mrt_result face_limit_create(face *f, error *err);
/* Called when the columns have changed. */
void face_limit_engage(face *f);
/* f->given := f->weight, reduced near where the skin would fold or tear; sets held_back_mm. A
 * function of f->weight, the pose and the engagement alone. */
void face_limit_pull(face *f);
/* Called when f->given is shown. Where skin that was pushed aside by what lies under it folds,
 * pulls give way, and the face is written again. */
void face_limit_slide(face *f);
/* After face_limit_pull on a face with shapes: whether it has summed a block, and that sum of all
 * columns but those of bones, so that it need not be computed again. */
bool face_limit_knows(const face *f, uint32_t block);
void face_limit_added(const face *f, float sum[3][POINTS_BLOCK], uint32_t block);
/* How many times its length at rest an edge may have. */
double face_stretch_most(const csrbf_settings *settings);

/* ---- face_shown.c ---- */

CHECKED mrt_result face_shown_create(face *f, error *err);
/* Writes the blocks that f->given, the pose and the seal change. */
void face_write(face *f);
/* Called when a block of the origin, or of the next origin, has been written. */
void face_touch(face *f, uint32_t block, const points *origin);
void face_touch_all(face *f);
/* The same for all blocks in which `now` differs from `before`. */
void face_touch_changed(face *f, const points *now, const points *before);
/* Called before the columns change. */
void face_forget_columns(face *f);
/* Some of the columns are not zero all over the block; some: as columns.mark. */
bool face_reaches(const columns *c, const uint64_t *some, uint32_t block);
/* Shows the rest shape with its bones at rest; the origin must be the rest shape already. */
void face_show_rest(face *f);

/* ---- face_skin.c ---- */

/* The normal of a triangle, as long as twice its area. */
vec3 face_skin_area(const points *p, const uint32_t *corner);
/* The same at rest, rotated as the bones alone rotate it: by the mean weights of its corners. */
vec3 face_skin_along(const face *f, const uint32_t *corner);
CHECKED mrt_result face_skin_create(face *f, const mesh *m, error *err);

#endif
