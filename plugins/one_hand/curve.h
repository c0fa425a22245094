/* one_hand/curve.h - the shapes of all answers: dead zones, soft limits, the jaw's knee, eased
 * ways. Polynomials only: the same bits everywhere. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_CURVE_H
#define MAROTTE_PLUGINS_ONE_HAND_CURVE_H

double curve_clamp(double x, double low, double high);
/* Exactly 0 within +-dead, odd, C1: a parabola as wide as the dead zone leads to slope 1. */
double curve_dead_zone(double x, double dead);
/* Exactly x for the nearer half, C1, stops at up from 1.5 up on; likewise down for x < 0. */
double curve_limit(double x, double up, double down);
/* Odd, monotone, C1: 0 -> 0, knee_x -> knee_y, 1 and more -> 1 (knees within 0 .. 1). */
double curve_knee(double x, double knee_x, double knee_y);
/* Minimum jerk from 0 to 1 (Flash and Hogan 1985); 0 before, 1 behind. */
double curve_ease(double t);

#endif
