/* poses/space.h - converts a hand pose to weights of the face's poses: ridge-regularised Gaussian
 * radial basis functions between demonstrations, in the space of the joint angles. + - * / and sqrt
 * only: the same bits everywhere. Pure; [frame]. */
#ifndef MAROTTE_PLUGINS_POSES_SPACE_H
#define MAROTTE_PLUGINS_POSES_SPACE_H
#include <marotte/plugin.h>

enum { SPACE_POSES = 8, SPACE_SHOWN_MAX = 3, SPACE_MAX = SPACE_POSES * SPACE_SHOWN_MAX };

typedef struct space_shown {     /* demonstrations */
    unsigned count[SPACE_POSES]; /* demonstrations of each pose */
    unsigned next[SPACE_POSES];  /* index that the next demonstration replaces when full */
    float angle[SPACE_POSES][SPACE_SHOWN_MAX][MRT_ANGLES]; /* rad */
} space_shown;

typedef struct space_fit { /* derived from the demonstrations, ridge and width */
    int count;
    int pose[SPACE_MAX];
    double centre[SPACE_MAX][MRT_ANGLES]; /* in units of the spread of each angle */
    double per_spread[MRT_ANGLES];        /* 1/rad */
    double steepness;                     /* of the Gaussians: exp(-steepness squared distance) */
    double coefficient[SPACE_MAX][SPACE_POSES];
    double left_out; /* leave-one-out error: root mean square of the weights, over poses with two or
                        more demonstrations; < 0: none */
} space_fit;

void space_show(space_shown *self, unsigned pose, const float angle[MRT_ANGLES]);
/* Fits the functions. width: of the Gaussians, in mean distances between demonstrations of
 * different poses. */
void space_find(space_fit *out, const space_shown *shown, double ridge, double width);
/* Writes the weight of each pose: not negative, with a sum of at most 1. */
void space_weights(const space_fit *self, const float angle[MRT_ANGLES], double out[SPACE_POSES]);

#endif
