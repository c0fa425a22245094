/* coverage_device.h - hands before a device, for coverage.c: which channels each kind of device
 * has, what it measures of a hand, with its noise or without, and what the stage makes of that.
 * Leaves out the stage's filter. Random numbers with a seed. One thread. */
#ifndef MAROTTE_TESTS_BENCH_COVERAGE_DEVICE_H
#define MAROTTE_TESTS_BENCH_COVERAGE_DEVICE_H
#include "bare_hand.h"
#include "hand/hand.h"
#include "human_hand.h"
#include "stage/perform/hands.h"

typedef struct random_source {
    uint64_t state;
} random_source;

double random_uniform(random_source *self); /* 0..1 */
double random_normal(random_source *self);  /* of deviation 1 */

enum { DEVICES = 4 };
typedef enum device_kind { SENSORS22 = 0, SENSORS18, POINTS21, CURLS5 } device_kind;

typedef struct device_facts {
    const char *name, *about;
    const char *input; /* as the stage calls it: what it is filtered as */
    double rate_hz;
} device_facts;
extern const device_facts device_table[DEVICES];
/* Of each angle; of points mm instead. */
extern const double device_noise_deg;

typedef struct device {
    device_kind kind;
    mrt_channel channel[MRT_ANGLES];
    uint32_t count;
    channel_route route; /* calibrated as the stage does it: absent channels, estimated joints */
    hand_skeleton *skeleton;
    bare_hand camera; /* the neutral hand's turn */
    hand_reading neutral;
} device;

bool device_has(device_kind kind, int sensor);
/* Neutral: the hand whose wrist counts as straight. */
void device_init(device *out, device_kind kind, const float *neutral_rad);
void device_finish(device *self); /* accepts zeroed */
/* The values of its channels (count) while the hand is held so. noise NULL: none. reading: of
 * points what was read before, at first the device's neutral one; it follows. */
void device_measure(device *self, const float *angle_rad, random_source *noise,
                    hand_reading *reading, float *out_value);
/* The angles of such values, as core/stage/perform/hands.c finds them before its filter: absent
 * channels, estimated joints. MRT_ANGLES. */
void device_angles(const device *self, const float *value, float *out_angle_rad);

#endif
