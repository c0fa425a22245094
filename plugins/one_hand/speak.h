/* one_hand/speak.h - one half of a face as a function of its joints: linear in the joints, plus the
 * engine's radial functions (Wendland C2) over them, so that each hand pose gives its face exactly.
 * Around the neutral pose is a dead zone (the well), and no pull becomes much longer than in any of
 * the faces. With points, additional waypoints on the way to the two widest jaws make the jaw open
 * evenly. The gaze follows the thumb's roll; for brows and lids the roll is a switch (joints.h,
 * eye_side). + - * / and sqrt only: the same bits everywhere. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_SPEAK_H
#define MAROTTE_PLUGINS_ONE_HAND_SPEAK_H
#include "joints.h"

enum { SPEAK_FACES_MAX = 64, SPEAK_WAYPOINTS = 4, SPEAK_JOINTS_MAX = JOINT_INDEX_KNUCKLE };
enum { SPEAK_CENTRES_MAX = 1 + SPEAK_FACES_MAX + SPEAK_WAYPOINTS };

/* A face and its hand pose. */
typedef struct speak_face {
    double deg[JOINT_COUNT];
    pose pose; /* values of the other half are ignored */
} speak_face;

/* Coordinates of the function. */
typedef enum speak_space {
    SPEAK_JOINTS = 0, /* weighted degrees */
    SPEAK_SWITCHED,   /* the same, with the switch instead of the thumb's roll: brows and lids */
    SPEAK_SPACES
} speak_space;

typedef struct speak_half {
    face_half half;
    device_kind device;
    int first, joint_count;           /* joints: first .. first + joint_count - 1 */
    double per_deg[SPEAK_JOINTS_MAX]; /* weight of each joint; 0: not measured */
    double well;                      /* weighted degrees */
    int value_count,
        value[POSE_COUNT]; /* indices of the pose values that at least one face moves */
    speak_space space[POSE_COUNT];
    double linear[POSE_COUNT][SPEAK_JOINTS_MAX];
    int centre_count; /* the rest pose, the faces, the waypoints */
    double centre[SPEAK_SPACES][SPEAK_CENTRES_MAX][SPEAK_JOINTS_MAX];
    double residual[SPEAK_CENTRES_MAX][POSE_COUNT];
    double radius[SPEAK_SPACES];
    double longest[LANDMARK_COUNT]; /* mm of a pose: longest pull of any face at the landmark */
} speak_half;

typedef struct speak_settings {
    double well;   /* radius of the dead zone, weighted degrees */
    double ridge;  /* of the linear part, in squared weighted degrees per face */
    double radius; /* of the radial functions, in mean distances between neighbouring faces */
    bool has_waypoints;
} speak_settings;
extern const speak_settings speak_settings_of[DEVICE_KINDS][HALF_COUNT];
/* Weighted degrees from one position of the switch to the next. */
extern const double speak_switch_way;

/* Returns false if two faces have the same hand pose. */
bool speak_find(speak_half *out, face_half which, device_kind device, const speak_face *faces,
                int count);
/* Writes the half's values of the pose; does not change the others. */
void speak_value(const speak_half *self, const double deg[JOINT_COUNT], pose *out);

#endif
