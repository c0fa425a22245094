/* one_hand/pose.h - a face as this mapping thinks of it, whatever the rig has: a pull at each named
 * landmark and a value for each named degree of freedom, in face frame, mm of a face whose pupils
 * are 63 mm apart. All zero is the rest face. Leaves out which of them a rig really has
 * (fitting.h). Pure. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_POSE_H
#define MAROTTE_PLUGINS_ONE_HAND_POSE_H
#include "settings.h"

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
    DOF_LID_UPPER = DOF_EYE_PITCH + 2, /* 0 rest .. 1 closed */
    DOF_LID_LOWER = DOF_LID_UPPER + 2, /* 0 rest .. 1 closed */
    DOF_COUNT = DOF_LID_LOWER + 2
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
void pose_add_left(pose *p, const pose_part *parts, int count, double amount);
void pose_add_right(pose *p, const pose_part *parts, int count, double amount);

/* What a face does, as coordinates. */
typedef struct pose_axes {
    double jaw_open, jaw_lateral, jaw_forward; /* rad, mm, mm */
    double brow, tilt;                         /* mm up, mm inner up and outer down */
    double lid, squint;                        /* 0 .. 1 */
    double corner, smirk;                      /* mm smile, mm left up and right down */
    double width, sneer, lip;                  /* mm out per side, mm up, mm up */
    double nod, turn, gaze_yaw, gaze_pitch;    /* rad */
} pose_axes;
void pose_from_axes(pose *out, const pose_axes *axes, const double *params);

#endif
