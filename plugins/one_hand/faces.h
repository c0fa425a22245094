/* one_hand/faces.h - the faces that a hand can perform: the rig's poses that each is made of, and
 * the hand pose for it, for each kind of device. The hand poses are in hands.c, which the program
 * tests/bench/find_hands writes. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_FACES_H
#define MAROTTE_PLUGINS_ONE_HAND_FACES_H
#include "fitting.h"
#include "joints.h"

enum { FACE_PARTS_MAX = 3 };
typedef struct face_part {
    const char *pose; /* name of a pose of the rig; NULL: end */
    double share;
} face_part;
typedef struct face_recipe {
    const char *name; /* in the performer's words */
    face_half half;   /* half of the poses that is used */
    face_part part[FACE_PARTS_MAX];
} face_recipe;

enum { FACE_COUNT = 65 };
extern const face_recipe face_recipes[FACE_COUNT];
int face_name_of(int face); /* index into face_names */

enum { FACE_IS_ITSELF = -1, FACE_IS_MISSING = -2 };
typedef struct posed_hand {
    int8_t deg[JOINT_COUNT]; /* relative to the neutral pose; 0 for joints of the other half */
    int same_as;             /* face shown instead, because the device cannot distinguish the two;
                                FACE_IS_ITSELF: it can */
} posed_hand;
extern const posed_hand posed_hands[DEVICE_KINDS][FACE_COUNT];

/* Builds the face from the rig's poses, in the unit of a pose: mm on a head whose pupils are 63 mm
 * apart. Returns false if the rig has none of its poses, or they do not move that half. */
bool face_find(pose *out, const face_recipe *recipe, const fitting *fit, const mrt_rig_pose *poses,
               uint32_t pose_count);

#endif
