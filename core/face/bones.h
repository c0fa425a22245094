/* face/bones.h - how bones move: from degrees of freedom to rigid motions, with soft limits.
 * Jaw: opening about the hinge, with the condyles sliding forward and down as it opens; lateral and
 * forward motion whose envelope narrows as it opens (research: Posselt's envelope). Pure functions;
 * own sine and cosine: the same bits everywhere. [frame], no allocation. */
#ifndef MAROTTE_FACE_BONES_H
#define MAROTTE_FACE_BONES_H
#include "face/rig.h"

/* The degrees of freedom of a rig, in the order of its bones: jaw: open (rad), lateral (mm, to the
 * subject's left), forward (mm); ball: its turns (rad). Names "jaw.open", "eye.l.yaw". The last one
 * of a rig with a mouth belongs to no bone: RIG_LIPS_SEAL, 0..1. */
typedef struct bones_dof {
    char name[64];
    const char *unit; /* "rad", "mm"; "" for a share */
    float min, max;
    uint32_t bone, index; /* which of the bone's; bone RIG_NONE: none */
} bones_dof;

/* The jaw's own frame: the axis between the condyles and what lies square to it. Unit vectors. */
typedef struct bones_hinge {
    vec3 middle;                  /* mm: between the condyles */
    vec3 left, up, forward, path; /* path: the way of the condyles, forward and down */
    double half_mm;               /* from the middle to a condyle */
    double depth_mm, rise_mm;     /* of the incisor, forward of the axis and above it */
    double arm_mm;                /* of the incisor, from the axis */
} bones_hinge;

typedef struct bones {
    const rig *rig; /* must outlive it; NULL: one fixed bone */
    vec3 incisor;   /* mm: of the jaw */
    bones_hinge hinge;
    bones_dof dof[MRT_MAX_DOFS];
    uint32_t dof_count, bone_count;
    uint32_t jaw;                      /* bone index, or RIG_NONE */
    uint32_t seal;                     /* index of RIG_LIPS_SEAL, or RIG_NONE */
    uint32_t first_dof[RIG_BONES_MAX]; /* of each bone */
    uint32_t order[RIG_BONES_MAX];     /* parents first */
    bool moves[RIG_BONES_MAX];         /* it has degrees of freedom, or what it rides on has */
} bones;

/* incisor: used for the jaw when the rig names none. rig NULL: one fixed bone. Refuses two jaws,
 * cyclic parents, hinges and turns without an axis, limits that are reversed, turns that cannot
 * follow what they name, more than MRT_MAX_DOFS degrees of freedom. */
CHECKED mrt_result bones_init(bones *out, const rig *r, vec3 incisor, error *err);

/* Where each bone is for the values of the degrees of freedom (dof_count; NaN counts as 0), softly
 * limited: monotone, C1, identity at 0, exact well inside, never outside. out: bone_count.
 * A turn that follows another (rig_follow) is posed as far as bones_followed says; the value of its
 * degree of freedom stays what it was driven to. */
void bones_pose(rigid *out, const bones *b, const float *dof);

/* The values that bones_pose poses for `dof` (dof_count each): limited, NaN as 0. */
void bones_limit(float *out_dof, const bones *b, const float *dof);

/* The way back: the least values that are limited to `limited`. */
void bones_unlimit(float *out_dof, const bones *b, const float *limited);

/* The jaw's motion alone (without its parent's), not limited: opening about the hinge, the condyles
 * sliding along their path, 33 degrees to Camper's plane; lateral: a turn about the upright axis
 * through the condyle of the side it goes to, such that the incisor goes so far; forward: further
 * along the path. Identity at 0, bit for bit. */
rigid bones_jaw(const bones *b, double open_rad, double lateral_mm, double forward_mm);
/* slide_mm smoothstep(20 mm, 45 mm, gap); gap: of the incisors, by the turn alone. */
double bones_slide(const bones *b, double open_rad);
/* The opening, and a little more where the jaw goes aside with its teeth together: cusps slide down
 * each other, by 0.4 mm at the incisor for each mm aside, until the gap is 12 mm wide. */
double bones_guided_opening(const bones *b, double open_rad, double lateral_mm);
/* The lateral turn alone: of bones_jaw, what comes after an opening by turn_rad. */
rigid bones_aside(const bones *b, double lateral_mm, double turn_rad);

/* The limits of lateral (to either side) and forward motion at an opening: they narrow linearly, to
 * 40 % at the widest. */
double bones_lateral_limit(const bones *b, double open_rad);
double bones_forward_limit(const bones *b, double open_rad);
/* How values are limited: 0 at 0, exact up to 85 % of a side's limit, from there a cubic that
 * reaches the limit at the limit, with slope 0; constant beyond. A side whose limit is 0 stops
 * hard. And the least value that is limited to `limited`. */
double bones_soft_limit(double value, double min, double max);
double bones_soft_limit_inverse(double limited, double min, double max);
/* How far a turn goes that is limited to `limited` and that another one takes along by `by_rad`, as
 * the gaze does a lid: less the further it goes to max, so that a closed lid stays closed; softly
 * within min and max; `limited` where by_rad is 0. Monotone in `limited`, C1. */
double bones_followed(double limited, double by_rad, double min, double max);

/* The jaw pose that comes closest to moving start to end (count by 3 doubles each, mm, in the frame
 * that the jaw rides in; weight: how much each rides on the jaw, 0..1), least squares within the
 * limits: opening first, then lateral and forward if at least 2 controls say so. The slide of the
 * condyles follows the opening and does not help to choose it: else the opening would leap where
 * the slide begins. Fixed number of iterations. Writes the jaw's three dofs, such that bones_pose
 * gives that pose; on entry out_dof holds their last values, and those that too few controls speak
 * of keep them. Controls that a pose of the jaw explains without a rest give that pose: nothing
 * jumps when they take hold anew. All 0, exactly, when start is end and they
 * were 0. */
void bones_derive_jaw(float *out_dof, const bones *b, const double *start, const double *end,
                      const double *weight, uint32_t count);

#endif
