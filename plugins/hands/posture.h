/* hands/posture.h - how a hand is held, for mappings that go by joint angles: which hand performs,
 * how far its fingers are bent; and the curves that such mappings ease with: + - * / and sqrt
 * alone, the same bits everywhere. Pure; [frame]. */
#ifndef MAROTTE_PLUGINS_HANDS_POSTURE_H
#define MAROTTE_PLUGINS_HANDS_POSTURE_H
#include <marotte/plugin.h>

/* For a stepped parameter: right first while both are present. */
extern const char *const posture_hand_labels[];
#define POSTURE_HAND_PARAM(id)                                                                     \
    {                                                                                              \
        id, MRT_PARAM_STEPPED, "Hand", "Hand", "", "Which hand performs.", 0, 2, 0,                \
            posture_hand_labels                                                                    \
    }

/* The hand that performs; NULL: none is present, or it holds an angle that is none. */
const mrt_hand *posture_hand(const mrt_frame *frame, double choice);

/* Mean of the knuckles and middle joints of the four fingers, rad: 0 flat, some 1.5 a fist. */
double posture_bend(const mrt_hand *hand);

/* The part of the way that is gone in dt_s with the time constant time_s: 0 .. 1. */
double posture_share(double dt_s, double time_s);
/* Minimum jerk from 0 to 1; 0 before, 1 behind. */
double posture_ease(double t);
/* x made no larger than most, smoothly, and nearly x while small. */
double posture_limit(double x, double most);
double posture_clamp(double x, double low, double high);

#endif
