/* hand/guide_solve.h - from the poses that were taken to a calibration: tables, residuals,
 * cross-talk, the neutral pose. Inside the room. Pure. */
#ifndef MAROTTE_HAND_GUIDE_SOLVE_H
#define MAROTTE_HAND_GUIDE_SOLVE_H
#include "hand/guide_poses.h"

/* Needs the flat hand. low, high: MRT_ANGLES raw values seen. Everything of `out` is set but name,
 * date and hand length. */
void guide_solve(const guide_poses *poses, uint32_t side, const float *low, const float *high,
                 calibration_file *out);

#endif
