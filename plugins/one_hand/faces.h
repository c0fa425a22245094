/* one_hand/faces.h - the faces that a hand can say: which of the rig's poses each is made of, and
 * how the hand is held for it, for each kind of device. hands.c has the hand poses; the program
 * tests/bench/find_hands writes it. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_FACES_H
#define MAROTTE_PLUGINS_ONE_HAND_FACES_H
#include "fitting.h"
#include "joints.h"

enum { FACE_PARTS_MAX = 3 };
typedef struct face_part {
    const char *pose; /* of the rig; NULL: no more */
    double share;
} face_part;
typedef struct face_recipe {
    const char *name; /* in the performer's words */
    face_half half;   /* of the poses: the other half is left out */
    face_part part[FACE_PARTS_MAX];
} face_recipe;

enum { FACE_COUNT = 65 };
extern const face_recipe face_recipes[FACE_COUNT];
int face_name_of(int face); /* index into face_names */

enum { FACE_IS_ITSELF = -1, FACE_IS_MISSING = -2 };
typedef struct posed_hand {
    int8_t deg[JOINT_COUNT]; /* away from the neutral pose; 0: joints of the other half */
    int same_as;             /* face that is shown instead, since the device cannot tell the two
                                apart; FACE_IS_ITSELF: it can */
} posed_hand;
extern const posed_hand posed_hands[DEVICE_KINDS][FACE_COUNT];

/* The face as the rig's poses make it, in the unit of a pose: mm on a head whose pupils are 63 mm
 * apart. False: the rig has none of its poses, or they do not move that half. */
bool face_find(pose *out, const face_recipe *recipe, const fitting *fit, const mrt_rig_pose *poses,
               uint32_t pose_count);

#endif
