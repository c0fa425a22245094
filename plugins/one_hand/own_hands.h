/* one_hand/own_hands.h - hand poses of a performer's own: the face shows a face, the performer
 * answers with a hand. Answers move the hand poses of the table by a Gaussian process whose prior
 * is the table: what all answers have in common moves every face, what one answer has of its own
 * moves that face and its neighbours, the more often it is given the more. Each half by its own
 * joints.
 * + - * / and sqrt only. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_OWN_HANDS_H
#define MAROTTE_PLUGINS_ONE_HAND_OWN_HANDS_H
#include "faces.h"

enum { OWN_HANDS_ROUNDS_MAX = 100 };
typedef struct own_hands {
    device_kind device;                 /* that they were given with */
    unsigned rounds[FACE_NAMES];        /* 0: none given */
    float deg[FACE_NAMES][JOINT_COUNT]; /* mean of the rounds, from neutral */
} own_hands;

/* An answer by another kind of device begins anew. */
void own_hands_add(own_hands *to, device_kind device, int name, const double deg[JOINT_COUNT]);
void own_hands_forget(own_hands *from, int name);
/* For what was stored. */
bool own_hands_are_plausible(const own_hands *all);

typedef enum own_hands_verdict {
    OWN_HANDS_NONE = 0, /* none for that half */
    OWN_HANDS_TAKEN,
    OWN_HANDS_NONSENSE /* they do not follow the faces: the table is used */
} own_hands_verdict;
/* Hand poses of the half, by face; those of the table where the answers say nothing. */
own_hands_verdict own_hands_bend(double out_deg[FACE_COUNT][JOINT_COUNT], const own_hands *all,
                                 device_kind device, face_half which);

#endif
