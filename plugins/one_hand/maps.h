/* one_hand/maps.h - the three classic maps from a hand to a face: muppet+, mask, layered waldo. A
 * reading is the measured state of a hand; a pose is a face independent of any rig. Each map is a
 * function of the difference between the hand and its neutral pose; no difference gives the rest
 * face exactly. Leaves out time, and which parts of a pose a rig has (fitting.h). Polynomials, + -
 * * / and sqrt only: the same bits everywhere. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_MAPS_H
#define MAROTTE_PLUGINS_ONE_HAND_MAPS_H
#include "settings.h"

/* Soft limit, C1: exactly x up to half of `up`, and constant `up` for x above 1.5 `up`; the same
 * with `down` for x < 0. */
double curve_limit(double x, double up, double down);
/* Dead zone, odd and C1: exactly 0 within +-dead, then a parabola as wide as the dead zone up to
 * slope 1. */
double curve_dead_zone(double x, double dead);

/* ---- reading of a hand ---- */

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

/* Reads a hand. side: MRT_LEFT or MRT_RIGHT; a left hand gives the reading of its mirror image.
 * Returns false if the hand has a number that is not finite. */
bool reading_from_hand(reading *out, const mrt_hand *hand, uint32_t side);
/* Updates the mean of `count` samples with the last one, `sample`. Equal samples do not change
 * it. */
void reading_average(reading *mean, const reading *sample, uint32_t count);
reading reading_difference(const reading *a, const reading *b);
/* Returns true if a hand can have this reading. Checks stored readings. */
bool reading_is_plausible(const reading *r);

/* ---- a face ---- */

/* Landmarks: pairs (left, right), then those on the midline. */
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
    DOF_SEAL = DOF_LID_LOWER + 2, /* 0 rest .. 1 lips closed */
    DOF_TONGUE,                   /* rad, out */
    DOF_COUNT
};
enum { POSE_DOFS = 3 * LANDMARK_COUNT, POSE_COUNT = POSE_DOFS + DOF_COUNT };
extern const char *const pose_landmark_names[LANDMARK_COUNT];
extern const char *const pose_dof_names[DOF_COUNT];

typedef struct pose {
    double value[POSE_COUNT]; /* 3 per landmark, then the degrees of freedom */
} pose;

/* Returns the LAYER_* that a value belongs to. */
int pose_layer(int index);
/* Swaps left and right. */
void pose_mirror(pose *p);
/* Direction that pose_add adds `amount` times to a landmark's pull: outwards to the landmark's own
 * side, up, to the front. */
typedef struct pose_part {
    int landmark; /* of a pair: both sides */
    double out, up, front;
} pose_part;
void pose_add(pose *p, const pose_part *parts, int count, double amount);

/* ---- the maps, for right hands ---- */

/* intensity: factor for brows, lids, corners, width, sneer. droop: droop of the lids, 0 .. 1
 * (smoothed in time by one_hand.c). */
void maps_muppet(pose *out, const reading *difference, double intensity, double droop,
                 const double *params);
void maps_mask(pose *out, const reading *difference, const double *params);
/* Writes only the values of the layer. */
void maps_waldo(pose *out, const reading *difference, int layer, const double *params);

/* Returns the droop of the lids by the middle finger, before smoothing in time. */
double maps_droop(const reading *difference, double intensity, const double *params);

#endif
