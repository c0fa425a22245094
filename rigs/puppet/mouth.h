/* rigs/puppet/mouth.h - lips, rolled like felt over a cord, and the bag behind them. [main] */
#ifndef MAROTTE_RIGS_PUPPET_MOUTH_H
#define MAROTTE_RIGS_PUPPET_MOUTH_H
#include "plan.h"
#include "sheet.h"

enum { MOUTH_POINTS = 2 * PLAN_MOUTH_COLUMNS + PLAN_MOUTH_ROWS + 1 };

/* A line around the lips, away_mm from where they leave the face: a half ring, lower lip first. */
void mouth_outline(vec3 out_point[MOUTH_POINTS], double away_mm);
/* From the line at 0 inwards: lips, part of the skin, and the bag, closed behind. */
CHECKED mrt_result mouth_build(sheet *s, const ring *outline, error *err);

#endif
