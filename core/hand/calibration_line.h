/* hand/calibration_line.h - a sensor's table from a gain and a zero, within what its joint can do.
 * Inside the room. Pure. */
#ifndef MAROTTE_HAND_CALIBRATION_LINE_H
#define MAROTTE_HAND_CALIBRATION_LINE_H
#include "hand/hand.h"

/* rad = gain * (raw - zero) + rad_at_zero, up to 15 degrees beyond the clinical range of the joint
 * (sensor.h), where the angle stays: the table's end slopes are 0. gain: not 0. */
hand_table calibration_line(int sensor, double gain, double zero, double rad_at_zero);

#endif
