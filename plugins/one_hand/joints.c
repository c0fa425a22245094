#include "joints.h"

#include <string.h>

const int half_first_joint[HALF_COUNT + 1] = {JOINT_THUMB_DROP, JOINT_INDEX_KNUCKLE, JOINT_COUNT};

face_half half_of_value(int pose_index)
{
    const int layer = pose_layer(pose_index);
    return layer == LAYER_MOUTH ? HALF_MOUTH : layer == LAYER_BROWS ? HALF_UPPER : HALF_COUNT;
}

void joints_of(double out_deg[JOINT_COUNT], const reading *difference)
{
    /* in the order of the sensors, plugin.h */
    static const int sensor[JOINT_COUNT] = {
        [JOINT_THUMB_DROP] = 3,    [JOINT_THUMB_MIDDLE] = 1,    [JOINT_THUMB_TIP] = 2,
        [JOINT_INDEX_CURL] = 5,    [JOINT_MIDDLE_CURL] = 8,     [JOINT_RING_KNUCKLE] = 11,
        [JOINT_RING_CURL] = 12,    [JOINT_LITTLE_KNUCKLE] = 15, [JOINT_LITTLE_CURL] = 16,
        [JOINT_INDEX_KNUCKLE] = 4, [JOINT_MIDDLE_KNUCKLE] = 7,  [JOINT_THUMB_ROLL] = 0,
        [JOINT_ARCH] = 19};
    const double *angle = difference->value + READING_ANGLES;
    for (int i = 0; i < JOINT_COUNT; ++i)
        out_deg[i] = angle[sensor[i]];
    out_deg[JOINT_SPREAD] = (angle[10] + angle[14] + angle[18]) * (1.0 / 3.0);
}

/* Noise: a glove's sensors follow a joint within 1.4 degrees. For points the values follow from an
 * error of 2 mm, filtered at 30 Hz. Comfort: from a relaxed hand with a little spread and curl. */
#define SPREAD_NOISE(deg) (0.6 * (deg)) /* a mean of three */
const joint_traits joint_traits_of[DEVICE_KINDS][JOINT_COUNT] = {
    [DEVICE_JOINTS] = {[JOINT_THUMB_DROP] = {1.4, -14, 32},
                       [JOINT_THUMB_MIDDLE] = {1.4, -23, 26},
                       [JOINT_THUMB_TIP] = {1.4, -30, 42},
                       [JOINT_INDEX_CURL] = {1.4, -24, 52},
                       [JOINT_MIDDLE_CURL] = {1.4, -24, 52},
                       [JOINT_SPREAD] = {SPREAD_NOISE(1.4), -4, 12},
                       [JOINT_RING_KNUCKLE] = {1.4, -28, 28},
                       [JOINT_RING_CURL] = {1.4, -26, 48},
                       [JOINT_LITTLE_KNUCKLE] = {1.4, -28, 28},
                       [JOINT_LITTLE_CURL] = {1.4, -26, 48},
                       [JOINT_INDEX_KNUCKLE] = {1.4, -32, 32},
                       [JOINT_MIDDLE_KNUCKLE] = {1.4, -22, 32},
                       [JOINT_THUMB_ROLL] = {1.4, -22, 20},
                       [JOINT_ARCH] = {1.4, -5, 13}},
    [DEVICE_POINTS] = {[JOINT_THUMB_DROP] = {1.0, -14, 32},
                       [JOINT_THUMB_MIDDLE] = {2.2, -6, 26},
                       [JOINT_THUMB_TIP] = {2.6, -6, 42},
                       [JOINT_INDEX_CURL] = {2.3, -24, 52},
                       [JOINT_MIDDLE_CURL] = {2.4, -24, 52},
                       [JOINT_SPREAD] = {1.2, -4, 12},
                       [JOINT_RING_KNUCKLE] = {1.4, -28, 28},
                       [JOINT_RING_CURL] = {2.5, -26, 48},
                       [JOINT_LITTLE_KNUCKLE] = {1.7, -28, 28},
                       [JOINT_LITTLE_CURL] = {3.0, -26, 48},
                       [JOINT_INDEX_KNUCKLE] = {1.2, -32, 32},
                       [JOINT_MIDDLE_KNUCKLE] = {1.2, -22, 32},
                       [JOINT_THUMB_ROLL] = {2.4, -24, 12}},
    [DEVICE_CURLS] = {[JOINT_THUMB_MIDDLE] = {1.4, -23, 30},
                      [JOINT_RING_KNUCKLE] = {1.4, -35, 45},
                      [JOINT_LITTLE_KNUCKLE] = {1.4, -35, 45},
                      [JOINT_INDEX_KNUCKLE] = {1.4, -35, 40},
                      [JOINT_MIDDLE_KNUCKLE] = {1.4, -30, 40}},
};

/* Points measure the roll imprecisely, and only a small roll across the palm. */
const roll_switch roll_switch_of[DEVICE_KINDS] = {
    [DEVICE_JOINTS] = {8.0, 12.0, 16.0},
    [DEVICE_POINTS] = {5.0, 9.0, 12.0},
};

static double smooth_step(double x, double from, double to)
{
    const double t = x <= from ? 0.0 : x >= to ? 1.0 : (x - from) / (to - from);
    return t * t * (3.0 - 2.0 * t);
}

double eye_side(device_kind device, const double deg[JOINT_COUNT])
{
    static const double straight_deg = 10.0, bent_deg = 18.0;
    const roll_switch *with = &roll_switch_of[device];
    if (!(with->pose_deg > 0.0))
        return 0.0;
    const double roll = deg[JOINT_THUMB_ROLL];
    const double far = smooth_step(roll < 0.0 ? -roll : roll, with->least_deg, with->most_deg) *
                       (1.0 - smooth_step(deg[JOINT_INDEX_KNUCKLE], straight_deg, bent_deg));
    return roll < 0.0 ? -far : far;
}

static bool is_angle_of(const mrt_channel *channel, uint32_t side)
{
    return channel->hand == side && channel->semantic - MRT_CH_ANGLE < MRT_ANGLES;
}

bool device_measures(const mrt_channels *input, uint32_t side)
{
    for (uint32_t i = 0; i < input->count; ++i)
        if (is_angle_of(&input->channel[i], side))
            return true;
    return false;
}

static bool starts(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}

/* A device that measures the middle joints of the fingers measures every joint. The keyboard bends
 * whole fingers; only the name of its input shows that. */
device_kind device_of_input(const double *params, const mrt_channels *input, uint32_t side)
{
    static const uint32_t middle_joints[] = {5, 8, 12, 16}; /* sensors: index to little */
    const int chosen = (int)params[SET_DEVICE];
    if (chosen != DEVICE_AUTOMATIC)
        return (device_kind)(chosen - 1);
    if (!input)
        return DEVICE_JOINTS;
    bool has_middle_joints = false, is_of_points = false;
    for (uint32_t i = 0; i < input->count; ++i) {
        const mrt_channel *channel = &input->channel[i];
        if (!is_angle_of(channel, side))
            continue;
        is_of_points = is_of_points || strcmp(channel->unit, MRT_UNIT_LANDMARKS) == 0;
        for (int k = 0; k < 4; ++k)
            has_middle_joints =
                has_middle_joints || channel->semantic - MRT_CH_ANGLE == middle_joints[k];
    }
    if (!has_middle_joints || starts(input->name, "virtual"))
        return DEVICE_CURLS;
    return is_of_points ? DEVICE_POINTS : DEVICE_JOINTS;
}
