/* hand/guide_poses.h - what the poses of the guided calibration are, in angles, and whether raw
 * values can be such a pose. Inside the room. Pure. */
#ifndef MAROTTE_HAND_GUIDE_POSES_H
#define MAROTTE_HAND_GUIDE_POSES_H
#include "hand/guide.h"

typedef struct guide_poses {
    uint32_t sensors; /* bit i: the glove has sensor i */
    bool has[GUIDE_STEPS];
    float raw[GUIDE_STEPS][MRT_ANGLES];
} guide_poses;

const guide_poses *guide_poses_of(const guide *self); /* the guide's own */
bool guide_poses_has_sensor(const guide_poses *poses, int sensor);

/* The step that tells where the sensor's range ends, the other end being the flat hand;
 * GUIDE_STEPS: none does. */
guide_step guide_pose_end(int sensor);
/* The angle of the sensor at that end, rad. */
double guide_pose_end_rad(int sensor);
/* Whether the pose says that this sensor is at 0, as in the flat hand. */
bool guide_pose_is_zero(guide_step step, int sensor);
/* The finger bent in the step, 0 thumb .. 4 little; -1: none alone. */
int guide_pose_finger(guide_step step);

/* Whether between two poses the sensor moved by what its end angle takes on any glove. */
bool guide_pose_has_moved(const guide_poses *poses, int sensor, guide_step from, guide_step to);

/* NULL: nothing is odd. Else a sentence in out_reason; *out_refused: the pose cannot be. */
const char *guide_pose_check(const guide_poses *poses, guide_step step, char *out_reason,
                             size_t capacity, bool *out_refused);

#endif
