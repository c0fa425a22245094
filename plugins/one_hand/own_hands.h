/* one_hand/own_hands.h - personal hand poses: the program shows a face, and the performer answers
 * with a hand pose. The answers move the hand poses of the table, by a Gaussian process with the
 * table as its prior. The common part of all answers moves every face. The rest of an answer moves
 * its face and similar ones, the more often it is given the more. Each half uses its own joints. +
 * - * / and sqrt only. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_OWN_HANDS_H
#define MAROTTE_PLUGINS_ONE_HAND_OWN_HANDS_H
#include "faces.h"

enum { OWN_HANDS_ROUNDS_MAX = 100 };
typedef struct own_hands {
    device_kind device;                 /* device of the answers */
    unsigned rounds[FACE_NAMES];        /* 0: none given */
    float deg[FACE_NAMES][JOINT_COUNT]; /* mean of the rounds, relative to neutral */
} own_hands;

/* Adds an answer. An answer with another kind of device discards the earlier ones. */
void own_hands_add(own_hands *to, device_kind device, int name, const double deg[JOINT_COUNT]);
void own_hands_forget(own_hands *from, int name);
/* Checks stored answers. */
bool own_hands_are_plausible(const own_hands *all);

typedef enum own_hands_verdict {
    OWN_HANDS_NONE = 0, /* none for that half */
    OWN_HANDS_TAKEN,
    OWN_HANDS_NONSENSE /* they do not match the faces: the table is used */
} own_hands_verdict;
/* Writes the hand poses of the half, by face; those of the table for faces that the answers do not
 * affect. */
own_hands_verdict own_hands_bend(double out_deg[FACE_COUNT][JOINT_COUNT], const own_hands *all,
                                 device_kind device, face_half which);

#endif
