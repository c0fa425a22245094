/* face/bones.h - motion of bones: from degrees of freedom to rigid motions, with soft limits. A jaw
 * opens about its hinge while the condyles slide forward and down. Its lateral and forward motion
 * narrows as it opens (research: Posselt's envelope). Pure functions with their own sine and
 * cosine, so that all machines give the same bits. [frame], no allocation. */
#ifndef MAROTTE_FACE_BONES_H
#define MAROTTE_FACE_BONES_H
#include "face/rig.h"

/* The degrees of freedom of a rig, in the order of its bones. Jaw: open (rad), lateral (mm, to
 * the subject's left), forward (mm). Ball: its turns (rad). Names are such as "jaw.open" or
 * "eye.l.yaw". In a rig with a mouth the last one is RIG_LIPS_SEAL, 0..1, and belongs to no
 * bone. */
typedef struct bones_dof {
    char name[64];
    const char *unit; /* "rad", "mm"; "" for a share */
    float min, max;
    uint32_t bone, index; /* index within the bone; bone RIG_NONE: belongs to no bone */
} bones_dof;

/* The jaw's own frame: the axis between the condyles and the directions perpendicular to it. Unit
 * vectors. */
typedef struct bones_hinge {
    vec3 middle; /* midpoint between the condyles, mm */
    vec3 left, up, forward,
        path;                 /* path: direction in which the condyles slide, forward and down */
    double half_mm;           /* from the middle to a condyle */
    double depth_mm, rise_mm; /* of the incisor: in front of the axis, and above it */
    double arm_mm;            /* distance of the incisor from the axis */
} bones_hinge;

typedef struct bones {
    const rig *rig; /* must outlive this; NULL: one fixed bone */
    vec3 incisor;   /* of the jaw, mm */
    bones_hinge hinge;
    bones_dof dof[MRT_MAX_DOFS];
    uint32_t dof_count, bone_count;
    uint32_t jaw;                      /* bone index, or RIG_NONE */
    uint32_t seal;                     /* index of RIG_LIPS_SEAL, or RIG_NONE */
    uint32_t first_dof[RIG_BONES_MAX]; /* first degree of freedom of each bone */
    uint32_t order[RIG_BONES_MAX];     /* bone indices, parents first */
    bool moves[RIG_BONES_MAX]; /* true if the bone or one of its parents has degrees of freedom */
} bones;

/* incisor: the jaw's, if the rig sets none. rig NULL: one fixed bone. Refuses two jaws, cyclic
 * parents, and more than MRT_MAX_DOFS degrees of freedom. Also refuses hinges and turns without an
 * axis, reversed limits, and turns that cannot follow the turn they name. */
CHECKED mrt_result bones_init(bones *out, const rig *r, vec3 incisor, error *err);

/* Computes the motion of each bone from the degrees of freedom (dof_count; NaN counts as 0); out:
 * bone_count. Soft limits apply: monotone, C1, identity at 0, exact well inside, never outside.
 * A turn that follows another (rig_follow) is posed by bones_followed; its degree of freedom keeps
 * the driven value. */
void bones_pose(rigid *out, const bones *b, const float *dof);

/* Computes the values that bones_pose uses for `dof` (dof_count each): limited, NaN as 0. */
void bones_limit(float *out_dof, const bones *b, const float *dof);

/* The inverse: the least values that are limited to `limited`. */
void bones_unlimit(float *out_dof, const bones *b, const float *limited);

/* Computes the jaw's own motion, without its parent's and without limits. It opens about the hinge
 * while the condyles slide along their path, 33 degrees to Camper's plane. lateral turns about the
 * upright axis through the condyle of the side that the jaw moves to, until the incisor has moved
 * that far. forward slides further along the path. Identity at 0, bit for bit. */
rigid bones_jaw(const bones *b, double open_rad, double lateral_mm, double forward_mm);
/* Returns slide_mm smoothstep(20 mm, 45 mm, gap), where gap is that of the incisors from the turn
 * alone. */
double bones_slide(const bones *b, double open_rad);
/* Returns the opening with the guidance of the teeth. When the jaw moves aside with its teeth
 * together, cusps slide down each other and open it by 0.4 mm at the incisor per mm aside. The
 * effect ends at a gap of 12 mm. */
double bones_guided_opening(const bones *b, double open_rad, double lateral_mm);
/* Computes the lateral turn alone: the part of bones_jaw that follows an opening by turn_rad. */
rigid bones_aside(const bones *b, double lateral_mm, double turn_rad);

/* Limits of lateral (to either side) and forward motion at an opening. They narrow linearly, to 40
 * % at the widest opening. */
double bones_lateral_limit(const bones *b, double open_rad);
double bones_forward_limit(const bones *b, double open_rad);
/* Applies a soft limit: 0 at 0, and exact up to 85 % of a side's limit. From there a cubic reaches
 * the limit at the limit, with slope 0; constant beyond. A side with limit 0 stops hard. The
 * inverse returns the least value that is limited to `limited`. */
double bones_soft_limit(double value, double min, double max);
double bones_soft_limit_inverse(double limited, double min, double max);
/* Returns the angle of a turn that is limited to `limited` and that follows another turn by
 * `by_rad`, as a lid follows the gaze. The effect shrinks towards max, so that a closed lid stays
 * closed. The result is softly limited to min and max, and equals `limited` if by_rad is 0.
 * Monotone in `limited`, C1. */
double bones_followed(double limited, double by_rad, double min, double max);

/* Finds the jaw pose that comes closest to moving start to end, by least squares within the limits.
 * start, end: count by 3, mm, in the frame of the jaw's parent. weight: share of each on the jaw,
 * 0..1.
 * The opening comes first, then lateral and forward if at least 2 controls determine them. The
 * slide of the condyles follows the opening but does not influence its choice. Otherwise the
 * opening would jump where the slide begins. The number of iterations is fixed.
 * Writes the jaw's three dofs, such that bones_pose gives that pose. On entry out_dof holds their
 * last values; values that too few controls determine keep them. If a pose of the jaw explains all
 * controls exactly, the result is that pose, so nothing jumps when controls are engaged again. The
 * result is exactly 0 if start equals end and all values were 0. */
void bones_derive_jaw(float *out_dof, const bones *b, const double *start, const double *end,
                      const double *weight, uint32_t count);

#endif
