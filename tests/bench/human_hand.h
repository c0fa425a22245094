/* What an adult's hand can do without a device: limits of each joint, and how joints pull each
 * other. Leaves out time, strength and the thumb's reach to the fingers. Pure; any thread.
 *
 * Angles are in the sensor order of hand/hand.h, rad. Limits are of movements that a hand does by
 * itself: narrower than the clinical ranges of hand/sensor.h. Couplings are round numbers for what
 * anatomy describes: one tendon bends the middle and the end joint of a finger, the tendons of
 * middle, ring and little finger are linked, and bent knuckles lock the fingers side by side. */
#ifndef MAROTTE_TESTS_BENCH_HUMAN_HAND_H
#define MAROTTE_TESTS_BENCH_HUMAN_HAND_H
#include "hand/sensor.h"

#include <math.h>

typedef struct human_joint {
    float low_deg, high_deg;
} human_joint;

static const human_joint human_joints[MRT_ANGLES] = {
    {30, 105}, {-15, 50}, {-20, 75}, {0, 53},   /* thumb: roll, knuckle, end joint, abduction */
    {-25, 85}, {0, 105},  {-5, 75},             /* index: knuckle, middle joint, end joint */
    {-25, 85}, {0, 105},  {-5, 75},  {-11, 20}, /* middle, and its spread from the index finger */
    {-25, 85}, {0, 105},  {-5, 75},  {-11, 17}, /* ring, and its spread from the middle finger */
    {-25, 85}, {0, 105},  {-5, 75},  {-11, 30}, /* little, and its spread from the ring finger */
    {-5, 35},  {-60, 60}, {-30, 20},            /* palm arch, wrist pitch, wrist yaw */
};

/* Relaxed, palm down, ready to talk: the neutral hand of the tests of mappings. */
static const float human_neutral_rad[MRT_ANGLES] = {
    1.45f, 0.15f, 0.20f, 0.34f,  0.62f, 0.52f, 0.25f, 0.68f,  0.60f, 0.3f,   -0.04f,
    0.72f, 0.64f, 0.3f,  -0.05f, 0.70f, 0.60f, 0.3f,  -0.04f, 0.12f, -0.08f, 0.0f};

/* How far neighbours may differ, degrees: index and middle, middle and ring, ring and little. */
static const float human_knuckles_apart_deg[3] = {60, 45, 40};
static const float human_middle_joints_apart_deg[3] = {75, 55, 50};
/* The end joint follows the middle joint by this share, and is free by so many degrees. */
static const float human_end_joint_share = 2.0f / 3.0f, human_end_joint_free_deg = 12.0f;
/* A spread's upper limit falls linearly, to 0 where both knuckles are bent so far. */
static const float human_spread_locked_deg = 90.0f;

enum { HUMAN_FINGERS = 4 };
static const int human_knuckle[HUMAN_FINGERS] = {SENSOR_INDEX_MPJ, SENSOR_MIDDLE_MPJ,
                                                 SENSOR_RING_MPJ, SENSOR_LITTLE_MPJ};
static const int human_spread[HUMAN_FINGERS - 1] = {
    SENSOR_MIDDLE_INDEX_SPREAD, SENSOR_RING_MIDDLE_SPREAD, SENSOR_LITTLE_RING_SPREAD};

static inline float human_rad(float deg)
{
    return deg * 0.017453292519943295f;
}

static inline float human_clamp(float value, float low, float high)
{
    return value < low ? low : (value > high ? high : value);
}

/* Neighbours that differ by more than `apart_deg` first meet half way, which takes several rounds
 * along a row of four; what is left the outer finger gives. */
static inline void human_couple(float *angle_rad, const int *sensor, const float *apart_deg)
{
    for (int round = 0; round < 4; ++round)
        for (int i = 0; i + 1 < HUMAN_FINGERS; ++i) {
            float *a = &angle_rad[sensor[i]], *b = &angle_rad[sensor[i + 1]];
            const float most = human_rad(apart_deg[i]), apart = *a - *b;
            const float excess = apart - human_clamp(apart, -most, most);
            *a -= 0.5f * excess;
            *b += 0.5f * excess;
        }
    for (int i = 0; i + 1 < HUMAN_FINGERS; ++i) {
        const float inner = angle_rad[sensor[i]], most = human_rad(apart_deg[i]);
        float *outer = &angle_rad[sensor[i + 1]];
        *outer = human_clamp(*outer, inner - most, inner + most);
    }
}

static inline float human_spread_limit(const float *angle_rad, int i)
{
    const float bent = 0.5f * (angle_rad[human_knuckle[i]] + angle_rad[human_knuckle[i + 1]]);
    const float locked = human_clamp(bent / human_rad(human_spread_locked_deg), 0.0f, 1.0f);
    return human_rad(human_joints[human_spread[i]].high_deg) * (1.0f - locked);
}

/* Changes the angles (MRT_ANGLES) to a hand near them that a person can hold. Limits first, then
 * couplings; a hand that a person can hold stays as it is. */
static inline void human_hand_limit(float *angle_rad)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        angle_rad[i] = human_clamp(angle_rad[i], human_rad(human_joints[i].low_deg),
                                   human_rad(human_joints[i].high_deg));
    human_couple(angle_rad, human_knuckle, human_knuckles_apart_deg);
    human_couple(angle_rad, sensor_middle, human_middle_joints_apart_deg);
    for (int i = 0; i < SENSOR_DISTAL_COUNT; ++i) {
        const float follows = human_end_joint_share * angle_rad[sensor_middle[i]];
        const float free_rad = human_rad(human_end_joint_free_deg);
        float *end = &angle_rad[sensor_distal[i]];
        *end = human_clamp(*end, follows - free_rad, follows + free_rad);
        *end = human_clamp(*end, human_rad(human_joints[sensor_distal[i]].low_deg),
                           human_rad(human_joints[sensor_distal[i]].high_deg));
    }
    for (int i = 0; i + 1 < HUMAN_FINGERS; ++i) {
        float *spread = &angle_rad[human_spread[i]];
        *spread = fminf(*spread, human_spread_limit(angle_rad, i));
    }
}

/* The share of a bend by which the other fingers follow one that bends alone: row by row which
 * finger bends, index to little. Round numbers. */
static const float human_follows[HUMAN_FINGERS][HUMAN_FINGERS] = {
    {1.0f, 0.15f, 0.05f, 0.0f},
    {0.15f, 1.0f, 0.3f, 0.1f},
    {0.05f, 0.25f, 1.0f, 0.35f},
    {0.0f, 0.1f, 0.3f, 1.0f},
};

static inline void human_bend_row(float *angle_rad, const int *sensor, int bent, float by_rad)
{
    for (int finger = 0; finger < HUMAN_FINGERS; ++finger)
        angle_rad[sensor[finger]] += human_follows[bent][finger] * by_rad;
}

/* Bends one joint as a person does who thinks of no other: neighbours follow, and end joints follow
 * middle joints. To a hand that a person can hold. */
static inline void human_hand_bend(float *angle_rad, int sensor, float by_rad)
{
    for (int finger = 0; finger < HUMAN_FINGERS; ++finger) {
        if (sensor == human_knuckle[finger]) {
            human_bend_row(angle_rad, human_knuckle, finger, by_rad);
            human_hand_limit(angle_rad);
            return;
        }
        if (sensor == sensor_middle[finger]) {
            human_bend_row(angle_rad, sensor_middle, finger, by_rad);
            human_bend_row(angle_rad, sensor_distal, finger, human_end_joint_share * by_rad);
            human_hand_limit(angle_rad);
            return;
        }
    }
    angle_rad[sensor] += by_rad;
    human_hand_limit(angle_rad);
}

/* Whether a person can hold that hand (MRT_ANGLES), within a hundredth of a degree. */
static inline bool human_hand_can(const float *angle_rad)
{
    float limited[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i)
        limited[i] = angle_rad[i];
    human_hand_limit(limited);
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (!(fabsf(limited[i] - angle_rad[i]) <= human_rad(0.01f)))
            return false;
    return true;
}

#endif
