#include "coverage_device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double random_uniform(random_source *self) /* 0..1; splitmix64 */
{
    uint64_t z = (self->state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

double random_normal(random_source *self) /* Box and Muller */
{
    const double u = random_uniform(self), v = random_uniform(self);
    return sqrt(-2.0 * log(1.0 - u)) * cos(6.283185307179586 * v);
}

const device_facts device_table[DEVICES] = {
    [SENSORS22] = {"sensors22", "22 sensors", "glove", 100.0},
    [SENSORS18] = {"sensors18", "18 sensors", "glove", 100.0},
    [POINTS21] = {"points21", "21 points", "camera", 30.0},
    [CURLS5] = {"curls5", "5 curls", "curls", 100.0},
};
const double device_noise_deg = 1.4;      /* standard deviation, of each angle */
static const double noise_point_mm = 2.0; /* along each axis, of each point */

bool device_has(device_kind kind, int sensor)
{
    static const int curls[] = {SENSOR_THUMB_MPJ, SENSOR_INDEX_MPJ,  SENSOR_MIDDLE_MPJ,
                                SENSOR_RING_MPJ,  SENSOR_LITTLE_MPJ, SENSOR_WRIST_PITCH,
                                SENSOR_WRIST_YAW};
    if (kind == CURLS5) {
        for (uint32_t i = 0; i < sizeof curls / sizeof *curls; ++i)
            if (curls[i] == sensor)
                return true;
        return false;
    }
    for (int i = 0; kind == SENSORS18 && i < SENSOR_DISTAL_COUNT; ++i)
        if (sensor_distal[i] == sensor)
            return false;
    return true;
}

/* What a camera makes of a hand. noise NULL: of exact points. reading: the one before, or zeros;
 * it stays where a camera's input would not believe the new one. */
static void device_look(device *self, const float *angle_rad, random_source *noise,
                        hand_reading *reading)
{
    hand_landmarks seen = {.doubtful = 0};
    mrt_vec3 palm[MRT_PALM];
    const rigid still = rigid_identity();
    hand_pose(self->skeleton, angle_rad, &still, seen.at, palm);
    for (int i = 0; noise && i < MRT_JOINTS; ++i) {
        seen.at[i].x += (float)(noise_point_mm * random_normal(noise));
        seen.at[i].y += (float)(noise_point_mm * random_normal(noise));
        seen.at[i].z += (float)(noise_point_mm * random_normal(noise));
    }
    hand_reading now = *reading;
    hand_read(self->skeleton, &seen, &now);
    if (now.confidence >= (double)BARE_HAND_SURE)
        *reading = now;
}

static void device_read_points(device *self, hand_reading *reading, float *out_value)
{
    mrt_hand_reading now = {.size = 1.0f};
    double xyzw[4];
    memcpy(now.angle, reading->angle_rad, sizeof now.angle);
    rigid_to_quaternion(&reading->wrist, xyzw);
    for (int i = 0; i < 4; ++i)
        now.wrist[3 + i] = (float)xyzw[i];
    bare_hand_turn(&self->camera, MRT_RIGHT, &now);
    memcpy(out_value, now.angle, sizeof now.angle);
}

void device_measure(device *self, const float *angle_rad, random_source *noise,
                    hand_reading *reading, float *out_value)
{
    if (self->kind == POINTS21) {
        device_look(self, angle_rad, noise, reading);
        device_read_points(self, reading, out_value);
        return;
    }
    for (uint32_t i = 0; i < self->count; ++i) {
        out_value[i] = angle_rad[self->channel[i].semantic - MRT_CH_ANGLE];
        if (noise)
            out_value[i] += human_rad((float)(device_noise_deg * random_normal(noise)));
    }
}

void device_angles(const device *self, const float *value, float *out_angle_rad)
{
    float raw[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i)
        raw[i] = NAN;
    for (uint32_t i = 0; i < self->count; ++i)
        raw[self->channel[i].semantic - MRT_CH_ANGLE] = value[i];
    hand_calibrate(&self->route.calibration[MRT_RIGHT], raw, out_angle_rad);
}

void device_init(device *out, device_kind kind, const float *neutral_rad)
{
    *out = (device){.kind = kind, .skeleton = hand_skeleton_create(MRT_RIGHT, HAND_LENGTH_MM)};
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (device_has(kind, i))
            out->channel[out->count++] = (mrt_channel){
                sensor_table[i].name, "rad", MRT_CH_ANGLE + (uint32_t)i, MRT_RIGHT, -0.7f, 2.2f};
    channel_route_init(&out->route, out->channel, out->count);
    channel_route_call(&out->route, device_table[kind].input);
    if (!out->skeleton) {
        (void)fprintf(stderr, "coverage: no memory for the hand\n");
        exit(1);
    }
    if (kind == POINTS21) {
        float ignored[MRT_ANGLES];
        out->camera.follows_wrist = true;
        device_look(out, neutral_rad, NULL, &out->neutral);
        device_read_points(out, &out->neutral, ignored); /* from here on wrists count */
    }
}

void device_finish(device *self)
{
    hand_skeleton_destroy(self->skeleton);
}
