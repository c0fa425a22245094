/* poses/space.h - from how a hand is held to how much of each pose that is: demonstrations, and
 * between them ridge-regularised Gaussian radial basis functions in the space of the joint angles.
 * + - * / and sqrt alone: the same bits everywhere. Pure; [frame]. */
#ifndef MAROTTE_PLUGINS_POSES_SPACE_H
#define MAROTTE_PLUGINS_POSES_SPACE_H
#include <marotte/plugin.h>

enum { SPACE_POSES = 8, SPACE_SHOWN_MAX = 3, SPACE_MAX = SPACE_POSES * SPACE_SHOWN_MAX };

typedef struct space_shown {     /* what was demonstrated */
    unsigned count[SPACE_POSES]; /* demonstrations of each pose */
    unsigned next[SPACE_POSES];  /* which one the next replaces when there is no room */
    float angle[SPACE_POSES][SPACE_SHOWN_MAX][MRT_ANGLES]; /* rad */
} space_shown;

typedef struct space_fit { /* follows from what was demonstrated, ridge and width */
    int count;
    int pose[SPACE_MAX];
    double centre[SPACE_MAX][MRT_ANGLES]; /* in spreads of each angle */
    double per_spread[MRT_ANGLES];        /* 1/rad */
    double steepness;                     /* of the Gaussians: exp(-steepness squared distance) */
    double coefficient[SPACE_MAX][SPACE_POSES];
    double left_out; /* root mean square error of the weights at demonstrations that were left out;
                        of poses with two or more; < 0: there are none */
} space_fit;

void space_show(space_shown *self, unsigned pose, const float angle[MRT_ANGLES]);
/* width: of the Gaussians, in mean distances between demonstrations of different poses. */
void space_find(space_fit *out, const space_shown *shown, double ridge, double width);
/* How much of each pose it is: not negative, together at most 1. */
void space_weigh(const space_fit *self, const float angle[MRT_ANGLES], double out[SPACE_POSES]);

#endif
