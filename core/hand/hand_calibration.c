#include "hand/hand.h"

#include "base/angle.h"
#include "hand/sensor.h"

#include <math.h>
#include <string.h>

static void expect_all_distal(hand_calibration *out)
{
    for (int i = 0; i < SENSOR_DISTAL_COUNT; ++i)
        out->has_distal[i] = true;
}

static void expect_usual_neutral(hand_calibration *out)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        out->neutral_rad[i] = sensor_table[i].neutral_rad;
}

void hand_calibration_identity(hand_calibration *out)
{
    memset(out, 0, sizeof *out);
    expect_all_distal(out);
    expect_usual_neutral(out);
}

void hand_calibration_default(hand_calibration *out)
{
    static const float raw_end[2] = {1.0f, 255.0f}; /* of a sensor byte */
    memset(out, 0, sizeof *out);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const sensor_facts *g = &sensor_table[i];
        hand_table *table = &out->sensor[i];
        table->count = 2;
        for (int k = 0; k < 2; ++k) {
            table->raw[k] = raw_end[k];
            table->rad[k] = g->gain * (raw_end[k] - g->zero) + g->rad_at_zero;
        }
    }
    expect_all_distal(out);
    expect_usual_neutral(out);
}

/* Half a turn either way is more than any joint has: what a damaged table or sensor says beyond it
 * stays there. */
static double within_half_turn(double angle_rad)
{
    return fmin(fmax(angle_rad, -ANGLE_PI), ANGLE_PI);
}

double hand_table_value(const hand_table *table, double raw)
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

/* As VirtualHand does for gloves of 18 sensors (hardware.md 2.2); 90 degrees give 30. A middle
 * joint bent backwards, on the parabola's other branch, bends no end joint. */
float hand_distal_from_middle(float middle_rad)
{
    double middle = fmax((double)middle_rad, 0.0);
    return (float)fmax(0.32 * middle * middle - 0.17 * middle, 0.0);
}

void hand_calibrate(const hand_calibration *calibration, const float *raw, float *out_rad)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const hand_table *table = &calibration->sensor[i];
        double value = isfinite(raw[i]) ? (double)raw[i] : middle_raw(table);
        double rad = hand_table_value(table, value);
        out_rad[i] = isfinite(rad) ? (float)within_half_turn(rad) : 0.0f;
    }
    for (int i = 0; i < SENSOR_DISTAL_COUNT; ++i)
        if (!calibration->has_distal[i])
            out_rad[sensor_distal[i]] = hand_distal_from_middle(out_rad[sensor_middle[i]]);
}
