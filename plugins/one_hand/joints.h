/* one_hand/joints.h - the joints of a hand that move each half of the face, and what each kind of
 * device measures of them. The two halves use different joints, so that a mouth and an upper half
 * add without affecting each other. Hands are right hands, and angles are degrees relative to the
 * neutral pose. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_JOINTS_H
#define MAROTTE_PLUGINS_ONE_HAND_JOINTS_H
#include "maps.h"

/* Mouth first, then the upper half. */
enum {
    JOINT_THUMB_DROP = 0, /* abduction: a dropping thumb moves away from the palm */
    JOINT_THUMB_MIDDLE,   /* MPJ, bent */
    JOINT_THUMB_TIP,      /* IJ, bent */
    JOINT_INDEX_CURL,     /* PIJ, bent */
    JOINT_MIDDLE_CURL,
    JOINT_SPREAD,       /* mean of the three spreads */
    JOINT_RING_KNUCKLE, /* MPJ, bent */
    JOINT_RING_CURL,
    JOINT_LITTLE_KNUCKLE,
    JOINT_LITTLE_CURL,

    JOINT_INDEX_KNUCKLE,
    JOINT_MIDDLE_KNUCKLE,
    JOINT_THUMB_ROLL, /* across the palm */
    JOINT_ARCH,
    JOINT_COUNT
};

typedef enum face_half { HALF_MOUTH = 0, HALF_UPPER, HALF_COUNT } face_half;
extern const int half_first_joint[HALF_COUNT + 1];
/* Returns the half that a value of a pose belongs to; HALF_COUNT: none, the turns of the head. */
face_half half_of_value(int pose_index);

/* What kind of hand a device measures. */
typedef enum device_kind {
    DEVICE_JOINTS = 0, /* every joint: gloves of 18 and 22 sensors, recordings */
    DEVICE_POINTS,     /* points of a bare hand: cameras, headsets */
    DEVICE_CURLS,      /* one bend per finger, and the wrist */
    DEVICE_KINDS
} device_kind;

/* Returns the device kind set by the parameter, or detected from the channels of the input; input
 * NULL: every joint. */
device_kind device_of_input(const double *params, const mrt_channels *input, uint32_t side);
/* Returns true if the input measures that hand. */
bool device_measures(const mrt_channels *input, uint32_t side);

/* Converts the difference of two readings of a hand to joint angles. */
void joints_of(double out_deg[JOINT_COUNT], const reading *difference);

typedef struct joint_traits {
    double noise_deg;           /* of the device; 0: it does not measure this joint */
    double least_deg, most_deg; /* comfortable range, relative to the neutral pose */
} joint_traits;
extern const joint_traits joint_traits_of[DEVICE_KINDS][JOINT_COUNT];

/* The thumb's roll selects a wink and a single raised brow, like a switch of three positions: 1
 * across the palm, -1 back, 0 both eyes and brows. Between them is a steep transition without
 * hysteresis. A bent index finger keeps it at 0, because a grasping hand rolls its thumb too. */
double eye_side(device_kind device, const double deg[JOINT_COUNT]);
typedef struct roll_switch {
    double least_deg, most_deg; /* range of the transition, in both directions */
    double pose_deg;            /* roll of the hand poses; 0: no switch */
} roll_switch;
extern const roll_switch roll_switch_of[DEVICE_KINDS];

#endif
