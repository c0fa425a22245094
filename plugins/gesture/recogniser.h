/* gesture/recogniser.h - which of some taught gestures a hand makes: the nearest one, when the hand
 * has held it for a moment; and how a hand was held lately, to teach it. Leaves out what comes of
 * it. + - * / and sqrt alone. [frame] */
#ifndef MAROTTE_PLUGINS_GESTURE_RECOGNISER_H
#define MAROTTE_PLUGINS_GESTURE_RECOGNISER_H
#include <marotte/plugin.h>

enum { GESTURES = 4, NO_GESTURE = GESTURES, RECOGNISER_WINDOW = 64 };

typedef struct centroid {
    float angle[MRT_ANGLES]; /* rad */
} centroid;
extern const centroid recogniser_shipped[GESTURES];

typedef struct recogniser {
    centroid taught[GESTURES];
    float past[RECOGNISER_WINDOW][MRT_ANGLES]; /* a ring of samples */
    double past_s[RECOGNISER_WINDOW];          /* of each */
    unsigned at, filled;                       /* the next to be written; how many are */
    double now_s;                              /* since reset */
    unsigned current, candidate;               /* gestures; NO_GESTURE: none */
    double candidate_s;                        /* how long it has been held */
} recogniser;

/* For a list of memory.h. */
#define RECOGNISER_MEMORY(of)                                                                      \
    MEMORY_FLOATS((of).taught), MEMORY_FLOATS((of).past), MEMORY_DOUBLES((of).past_s),             \
        MEMORY_WHOLES((of).at, RECOGNISER_WINDOW - 1),                                             \
        MEMORY_WHOLES((of).filled, RECOGNISER_WINDOW), MEMORY_DOUBLES((of).now_s),                 \
        MEMORY_WHOLES((of).current, NO_GESTURE), MEMORY_WHOLES((of).candidate, NO_GESTURE),        \
        MEMORY_DOUBLES((of).candidate_s)

void recogniser_reset(recogniser *self, const centroid taught[GESTURES]);
/* Once per frame, first; hand: NULL while it is away. */
void recogniser_watch(recogniser *self, const mrt_hand *hand, double dt_s);
/* The gesture is the way in which the hand was held in the last 0.3 s. As it is being made it does
 * not begin until it is made again. False: there was no hand. */
bool recogniser_teach(recogniser *self, unsigned gesture);

typedef struct recogniser_limits {
    double reject_deg, leave_deg, dwell_s;
} recogniser_limits;
/* Returns the gesture that begins in this frame; NO_GESTURE: none. */
unsigned recogniser_step(recogniser *self, const mrt_hand *hand, double dt_s,
                         const recogniser_limits *limits);

#endif
