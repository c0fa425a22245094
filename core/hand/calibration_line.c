#include "hand/calibration_line.h"

#include "base/angle.h"
#include "hand/sensor.h"

#include <math.h>

static const double RADIANS_PER_DEGREE = ANGLE_PI / 180.0;
static const double BEYOND_DEG = 15.0;

hand_table calibration_line(int sensor, double gain, double zero, double rad_at_zero)
{
    const sensor_facts *facts = &sensor_table[sensor];
    double low_rad = ((double)facts->low_deg - BEYOND_DEG) * RADIANS_PER_DEGREE;
    double high_rad = ((double)facts->high_deg + BEYOND_DEG) * RADIANS_PER_DEGREE;
    double first_rad = gain > 0 ? low_rad : high_rad, last_rad = gain > 0 ? high_rad : low_rad;
    double first = zero + (first_rad - rad_at_zero) / gain;
    double last = zero + (last_rad - rad_at_zero) / gain;
    const double raw[5] = {first - 1.0, first, zero, last, last + 1.0};
    const double rad[5] = {first_rad, first_rad, rad_at_zero, last_rad, last_rad};
    hand_table out = {.count = 5};
    for (int i = 0; i < 5; ++i) {
        out.raw[i] = (float)raw[i];
        out.rad[i] = (float)rad[i];
    }
    return out;
}
