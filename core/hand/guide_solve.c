#include "hand/guide_solve.h"

#include "hand/calibration_line.h"
#include "hand/sensor.h"

#include <math.h>

/* Less than that is noise: no driver of cross-talk, no cross-talk. */
static const double DRIVEN_RAD = 0.3, CROSS_TALK_LEAST = 0.02;

/* ---- tables ---- */

static void solve_table(const guide_poses *poses, int sensor, calibration_sensor *out)
{
    double zero = (double)poses->raw[GUIDE_FLAT][sensor];
    double gain = (double)sensor_table[sensor].gain;
    guide_step end = guide_pose_end(sensor);
    out->source = CALIBRATION_ZEROED;
    if (end < GUIDE_STEPS && poses->has[end] &&
        guide_pose_has_moved(poses, sensor, GUIDE_FLAT, end)) {
        out->source = CALIBRATION_MEASURED;
        gain = guide_pose_end_rad(sensor) / ((double)poses->raw[end][sensor] - zero);
    }
    out->table = calibration_line(sensor, gain, zero, 0.0);
}

static double angle_in(const guide_poses *poses, guide_step step, int sensor,
                       const calibration_file *file)
{
    return hand_table_value(&file->sensor[sensor].table, (double)poses->raw[step][sensor]);
}

/* ---- how well it fits ---- */

/* RMS of what the sensor reads wherever it should be back at 0. */
static void solve_residual(const guide_poses *poses, int sensor, calibration_file *file)
{
    double sum = 0;
    int count = 0;
    for (guide_step step = GUIDE_FIST; step < GUIDE_STEPS; ++step) {
        if (!poses->has[step] || !guide_pose_is_zero(step, sensor))
            continue;
        double angle_rad = angle_in(poses, step, sensor, file);
        sum += angle_rad * angle_rad;
        count += 1;
    }
    calibration_sensor *out = &file->sensor[sensor];
    out->has_residual = count > 0;
    out->residual_rad = count > 0 ? (float)sqrt(sum / count) : 0.0f;
}

/* ---- cross-talk ---- */

static int joint_of(int finger, sensor_kind kind)
{
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
        if (sensor_table[sensor].finger == finger && sensor_table[sensor].kind == kind)
            return sensor;
    return SENSOR_NONE;
}

/* Which joint of the bent finger is held to move this one: the same joint; the thumb has no middle
 * joint; spreads, roll and arch go with the knuckle. */
static int driver_of(int finger, int sensor)
{
    sensor_kind kind = sensor_table[sensor].kind;
    if (kind == SENSOR_WRIST || sensor_table[sensor].finger == finger)
        return SENSOR_NONE;
    if (kind == SENSOR_END_JOINT && sensor_table[sensor].finger == 0)
        return joint_of(finger, SENSOR_MIDDLE_JOINT);
    if (kind == SENSOR_MIDDLE_JOINT || kind == SENSOR_END_JOINT)
        return joint_of(finger, finger == 0 ? SENSOR_END_JOINT : kind);
    return joint_of(finger, SENSOR_KNUCKLE);
}

static double moved_rad(const guide_poses *poses, guide_step step, int sensor,
                        const calibration_file *file)
{
    return angle_in(poses, step, sensor, file) - angle_in(poses, GUIDE_FLAT, sensor, file);
}

static void solve_cross_talk(const guide_poses *poses, guide_step step, calibration_file *file)
{
    int finger = guide_pose_finger(step);
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        int driver = driver_of(finger, sensor);
        if (driver < 0 || !guide_poses_has_sensor(poses, sensor) ||
            !guide_poses_has_sensor(poses, driver))
            continue;
        double driven_rad = moved_rad(poses, step, driver, file);
        if (!(driven_rad >= DRIVEN_RAD))
            continue;
        double share = moved_rad(poses, step, sensor, file) / driven_rad;
        if (fabs(share) >= CROSS_TALK_LEAST)
            file->sensor[driver].cross_talk[sensor] = (float)share;
    }
}

/* ---- all ---- */

static void solve_sensor(const guide_poses *poses, int sensor, const float *low, const float *high,
                         calibration_file *file)
{
    calibration_sensor *out = &file->sensor[sensor];
    solve_table(poses, sensor, out);
    out->neutral_rad = poses->has[GUIDE_RELAXED]
                           ? (float)angle_in(poses, GUIDE_RELAXED, sensor, file)
                           : sensor_table[sensor].neutral_rad;
    out->has_range = true;
    out->raw_range[0] = low[sensor];
    out->raw_range[1] = high[sensor];
    double first = hand_table_value(&out->table, (double)low[sensor]);
    double last = hand_table_value(&out->table, (double)high[sensor]);
    out->rad_range[0] = (float)fmin(first, last);
    out->rad_range[1] = (float)fmax(first, last);
    solve_residual(poses, sensor, file);
}

void guide_solve(const guide_poses *poses, uint32_t side, const float *low, const float *high,
                 calibration_file *out)
{
    calibration_file_init(out, side);
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
        if (guide_poses_has_sensor(poses, sensor))
            solve_sensor(poses, sensor, low, high, out);
    for (guide_step step = GUIDE_THUMB_ALONE; step < GUIDE_STEPS; ++step)
        if (poses->has[step])
            solve_cross_talk(poses, step, out);
}
