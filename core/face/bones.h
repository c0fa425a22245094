/* face/bones.h - how bones move: from degrees of freedom to rigid motions, with soft limits.
 * Jaw: opening about the hinge, with the condyles sliding forward and down as it opens; lateral and
 * forward motion whose envelope narrows as it opens (research: Posselt's envelope). Pure functions;
 * own sine and cosine: the same bits everywhere. [frame], no allocation. */
#ifndef MAROTTE_FACE_BONES_H
#define MAROTTE_FACE_BONES_H
#include "face/rig.h"

/* The degrees of freedom of a rig, in the order of its bones: jaw: open (rad), lateral (mm, to the
 * subject's left), forward (mm); ball: its turns (rad). Names "jaw.open", "eye.l.yaw". */
typedef struct bones_dof {
    char name[64];
    const char *unit; /* "rad" or "mm" */
    float min, max;
    uint32_t bone, index; /* which of the bone's */
} bones_dof;

typedef struct bones {
    const rig *rig; /* must outlive it */
    vec3 incisor;   /* mm: of the jaw */
    bones_dof dof[MRT_MAX_DOFS];
    uint32_t dof_count;
    uint32_t jaw; /* bone index, or RIG_NONE */
} bones;

/* incisor: used for the jaw when the rig names none. */
CHECKED mrt_result bones_init(bones *out, const rig *r, vec3 incisor, error *err);

/* Where each bone is for the values of the degrees of freedom (dof_count; NaN counts as 0), softly
 * limited: monotone, C1, identity at 0, exact well inside, never outside. out: bone_count. */
void bones_pose(rigid *out, const bones *b, const float *dof);

/* The jaw's motion alone (without its parent's). */
rigid bones_jaw(const bones *b, double open_rad, double lateral_mm, double forward_mm);

/* The jaw pose that comes closest to moving start to end (count by 3 doubles each, mm; weight: how
 * much each rides on the jaw, 0..1), least squares within the limits: opening first, then lateral
 * and forward if at least 2 controls say so. Fixed number of iterations. Writes the jaw's three
 * dofs. */
void bones_derive_jaw(float *out_dof, const bones *b, const double *start, const double *end,
                      const double *weight, uint32_t count);

#endif
