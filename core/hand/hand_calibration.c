#include "hand/hand.h"

#include "base/angle.h"

#include <math.h>
#include <string.h>

enum { FINGER_COUNT = 4 };

/* Sensors of the middle and of the distal joint, index to little. */
static const int middle_joint[FINGER_COUNT] = {5, 8, 12, 16};
static const int distal_joint[FINGER_COUNT] = {6, 9, 13, 17};

/* A starting pose for a hand that nobody has calibrated, averaged over the gloves of
 * research/hardware.md 2.1: rad = gain * (raw - zero) + rad_at_zero. Two rows are not taken as that
 * page suggests. Its thumb roll is 0 for a resting thumb, ours for a thumb in the plane of the
 * palm, which rests 0.6 rad in front of it. Its wrist pitch has the sign of a table in which
 * flexion is negative. */
static const struct gain {
    float gain, zero, rad_at_zero;
} default_gain[MRT_ANGLES] = {
    {0.0160f, 74, 0.6f},                                        /* thumb roll */
    {0.0142f, 80, 0},    {0.0185f, 100, 0}, {-0.0090f, 200, 0}, /* thumb MPJ, IJ, abduction */
    {0.0200f, 90, 0},    {0.0140f, 65, 0},  {0.0140f, 80, 0},   /* index MPJ, PIJ, DIJ */
    {0.0200f, 90, 0},    {0.0140f, 65, 0},  {0.0140f, 80, 0},   /* middle */
    {-0.0060f, 150, 0},                                         /* middle-index spread */
    {0.0200f, 90, 0},    {0.0140f, 65, 0},  {0.0140f, 80, 0},   /* ring */
    {-0.0060f, 150, 0},                                         /* ring-middle spread */
    {0.0200f, 90, 0},    {0.0140f, 65, 0},  {0.0140f, 80, 0},   /* little */
    {-0.0060f, 150, 0},                                         /* little-ring spread */
    {0.0090f, 103, 0},   {0.0148f, 134, 0}, {-0.0068f, 90, 0},  /* arch, wrist pitch, yaw */
};

static void expect_all_distal(hand_calibration *out)
{
    for (int i = 0; i < FINGER_COUNT; ++i)
        out->has_distal[i] = true;
}

void hand_calibration_identity(hand_calibration *out)
{
    memset(out, 0, sizeof *out);
    expect_all_distal(out);
}

void hand_calibration_default(hand_calibration *out)
{
    static const float raw_end[2] = {1.0f, 255.0f}; /* of a sensor byte */
    memset(out, 0, sizeof *out);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const struct gain *g = &default_gain[i];
        hand_table *table = &out->sensor[i];
        table->count = 2;
        for (int k = 0; k < 2; ++k) {
            table->raw[k] = raw_end[k];
            table->rad[k] = g->gain * (raw_end[k] - g->zero) + g->rad_at_zero;
        }
    }
    expect_all_distal(out);
}

/* Half a turn either way is more than any joint has: what a damaged table or sensor says beyond it
 * stays there. */
static double within_half_turn(double angle_rad)
{
    return fmin(fmax(angle_rad, -ANGLE_PI), ANGLE_PI);
}

static double table_value(const hand_table *table, double raw)
{
    uint32_t count = table->count < HAND_TABLE_MAX ? table->count : HAND_TABLE_MAX;
    if (count == 0)
        return raw;
    if (count == 1)
        return (double)table->rad[0];
    uint32_t k = 0;
    while (k + 2 < count && raw >= (double)table->raw[k + 1])
        ++k;
    double raw_0 = (double)table->raw[k], raw_1 = (double)table->raw[k + 1];
    double rad_0 = (double)table->rad[k], rad_1 = (double)table->rad[k + 1];
    double width = raw_1 - raw_0;
    return width > 0.0 ? rad_0 + (raw - raw_0) * ((rad_1 - rad_0) / width) : rad_0;
}

static double middle_raw(const hand_table *table)
{
    uint32_t count = table->count < HAND_TABLE_MAX ? table->count : HAND_TABLE_MAX;
    return count == 0 ? 0.0 : 0.5 * ((double)table->raw[0] + (double)table->raw[count - 1]);
}

/* As VirtualHand does for gloves of 18 sensors (hardware.md 2.2); 90 degrees give 30. */
static double distal_from_middle(double middle_rad)
{
    return fmax(0.32 * middle_rad * middle_rad - 0.17 * middle_rad, 0.0);
}

void hand_calibrate(const hand_calibration *calibration, const float *raw, float *out_rad)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const hand_table *table = &calibration->sensor[i];
        double value = isfinite(raw[i]) ? (double)raw[i] : middle_raw(table);
        double rad = table_value(table, value);
        out_rad[i] = isfinite(rad) ? (float)within_half_turn(rad) : 0.0f;
    }
    for (int i = 0; i < FINGER_COUNT; ++i)
        if (!calibration->has_distal[i])
            out_rad[distal_joint[i]] = (float)distal_from_middle((double)out_rad[middle_joint[i]]);
}
