/* hand_guide_poses.h - what a person does in each step of the guided calibration, degrees. */
#ifndef MAROTTE_TEST_HAND_GUIDE_POSES_H
#define MAROTTE_TEST_HAND_GUIDE_POSES_H
#include "hand/guide.h"
#include "hand/sensor.h"

#include <string.h>

static inline void set_finger(double *pose, int finger, double knuckle, double middle, double end)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (sensor_table[i].finger != finger)
            continue;
        if (sensor_table[i].kind == SENSOR_KNUCKLE)
            pose[i] = knuckle;
        if (sensor_table[i].kind == SENSOR_MIDDLE_JOINT)
            pose[i] = middle;
        if (sensor_table[i].kind == SENSOR_END_JOINT)
            pose[i] = end;
    }
}

/* The middle finger drags the ring finger's knuckle by half. */
static inline void pose_of(double *pose, guide_step step)
{
    memset(pose, 0, MRT_ANGLES * sizeof *pose);
    if (step == GUIDE_RELAXED) {
        for (int finger = 1; finger < 5; ++finger)
            set_finger(pose, finger, 30, 25, 10);
        pose[SENSOR_THUMB_ROLL] = 40;
        pose[SENSOR_ARCH] = 8;
    } else if (step == GUIDE_FIST) {
        for (int finger = 1; finger < 5; ++finger)
            set_finger(pose, finger, 90, 100, 80);
    } else if (step == GUIDE_THUMB_ACROSS) {
        set_finger(pose, 0, 50, 0, 80);
        pose[SENSOR_THUMB_ROLL] = 80;
    } else if (step == GUIDE_SPREAD) {
        pose[SENSOR_THUMB_ABDUCTION] = 53;
        pose[SENSOR_MIDDLE_INDEX_SPREAD] = 17;
        pose[SENSOR_RING_MIDDLE_SPREAD] = 14;
        pose[SENSOR_LITTLE_RING_SPREAD] = 32;
    } else if (step >= GUIDE_THUMB_ALONE) {
        set_finger(pose, (int)step - GUIDE_THUMB_ALONE, 80, 90, 60);
        if (step == GUIDE_MIDDLE_ALONE)
            pose[SENSOR_RING_MPJ] = 40;
    }
}

#endif
