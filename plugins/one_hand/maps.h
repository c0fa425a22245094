/* one_hand/maps.h - from a hand to a face as this mapping thinks of it: what a hand says (a
 * reading), a face whatever the rig has (a pose), and the three ways from one to the other:
 * muppet+, mask, layered waldo. Each is a function of the hand's difference to its neutral pose; no
 * difference gives the rest face exactly. Leaves out time, and which of a pose a rig really has
 * (fitting.h). Polynomials, + - * / and sqrt only: the same bits everywhere. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_MAPS_H
#define MAROTTE_PLUGINS_ONE_HAND_MAPS_H
#include "settings.h"

/* Exactly x for the nearer half, C1, stops at up from 1.5 up on; likewise down for x < 0. */
double curve_limit(double x, double up, double down);
/* Exactly 0 within +-dead, odd, C1: a parabola as wide as the dead zone leads to slope 1. */
double curve_dead_zone(double x, double dead);

/* ---- what a hand says ---- */

enum {
    READING_ANGLES = 0,                         /* MRT_ANGLES, deg */
    READING_TIPS = READING_ANGLES + MRT_ANGLES, /* thumb to little: x, y, z each, mm */
    READING_PALM = READING_TIPS + 5 * 3,        /* x, y, z, mm */
    READING_COUNT = READING_PALM + 3,
    READING_MIDDLE_KNUCKLE = READING_ANGLES + 7
};
typedef struct reading {
    double value[READING_COUNT];
} reading;

/* side: MRT_LEFT or MRT_RIGHT; a left hand gives the reading of its mirror image. False when the
 * hand holds a number that is none. */
bool reading_take(reading *out, const mrt_hand *hand, uint32_t side);
/* mean becomes the mean of count samples, of which sample is the last. Equal samples: no change. */
void reading_average(reading *mean, const reading *sample, uint32_t count);
reading reading_difference(const reading *a, const reading *b);
/* Whether a hand can be like this at all: for what was stored. */
bool reading_is_plausible(const reading *r);

/* ---- a face ---- */

/* Places: pairs (left, right), then those on the midline. */
enum {
    LANDMARK_BROW_INNER = 0,
    LANDMARK_BROW_MID = 2,
    LANDMARK_BROW_OUTER = 4,
    LANDMARK_CHEEK = 6,
    LANDMARK_CHEEK_LOWER = 8,
    LANDMARK_NASOLABIAL = 10,
    LANDMARK_NOSE_WING = 12,
    LANDMARK_MOUTH_CORNER = 14,
    LANDMARK_LIP_UPPER_SIDE = 16,
    LANDMARK_LIP_LOWER_SIDE = 18,
    LANDMARK_JAW_ANGLE = 20,
    LANDMARK_FIRST_MID = 22,
    LANDMARK_LIP_UPPER_MID = LANDMARK_FIRST_MID,
    LANDMARK_LIP_LOWER_MID,
    LANDMARK_CHIN,
    LANDMARK_NOSE_TIP,
    LANDMARK_FOREHEAD_MID,
    LANDMARK_COUNT
};
enum {
    DOF_JAW_OPEN = 0,                  /* rad */
    DOF_JAW_LATERAL,                   /* mm to the subject's left */
    DOF_JAW_FORWARD,                   /* mm */
    DOF_NOD,                           /* rad, down */
    DOF_TURN,                          /* rad, to the subject's left */
    DOF_EYE_YAW,                       /* pairs: rad, to the subject's left */
    DOF_EYE_PITCH = DOF_EYE_YAW + 2,   /* rad, up */
    DOF_LID_UPPER = DOF_EYE_PITCH + 2, /* 0 rest .. 1 closed; wide below 0 */
    DOF_LID_LOWER = DOF_LID_UPPER + 2,
    DOF_SEAL = DOF_LID_LOWER + 2, /* 0 rest .. 1 the lips are closed */
    DOF_TONGUE,                   /* rad, out */
    DOF_COUNT
};
enum { POSE_DOFS = 3 * LANDMARK_COUNT, POSE_COUNT = POSE_DOFS + DOF_COUNT };
extern const char *const pose_landmark_names[LANDMARK_COUNT];
extern const char *const pose_dof_names[DOF_COUNT];

typedef struct pose {
    double value[POSE_COUNT]; /* 3 per landmark, then the degrees of freedom */
} pose;

/* LAYER_* that a value belongs to. */
int pose_layer(int index);
/* Left and right exchanged. */
void pose_mirror(pose *p);
/* A landmark's pull made longer by `amount` times a direction: out to the landmark's own side, up,
 * front. */
typedef struct pose_part {
    int landmark; /* of a pair: both sides */
    double out, up, front;
} pose_part;
void pose_add(pose *p, const pose_part *parts, int count, double amount);

/* ---- from one to the other: hands are right ones here, and poses those of a right hand ---- */

/* intensity: factor for brows, lids, corners, width, sneer. droop: how far the lids droop, 0 .. 1
 * (one_hand.c follows it in time). */
void maps_muppet(pose *out, const reading *difference, double intensity, double droop,
                 const double *params);
void maps_mask(pose *out, const reading *difference, const double *params);
/* Only the values of the layer are meant. */
void maps_waldo(pose *out, const reading *difference, int layer, const double *params);

/* What the middle finger asks of the lids, before it is followed in time. */
double maps_droop(const reading *difference, double intensity, const double *params);

#endif
