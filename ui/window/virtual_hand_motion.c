#include "window/virtual_hand_motion.h"
#include "hand/sensor.h"

#include <math.h>

const uint32_t virtual_hand_key_code[VIRTUAL_KEYS] = {
    [VIRTUAL_THUMB_DOWN] = ' ',
    [VIRTUAL_THUMB_UP] = 'B',
    [VIRTUAL_INDEX_DOWN] = 'J',
    [VIRTUAL_MIDDLE_DOWN] = 'K',
    [VIRTUAL_RING_DOWN] = 'L',
    [VIRTUAL_LITTLE_DOWN] = ';',
    [VIRTUAL_INDEX_UP] = 'U',
    [VIRTUAL_MIDDLE_UP] = 'I',
    [VIRTUAL_RING_UP] = 'O',
    [VIRTUAL_LITTLE_UP] = 'P',
    [VIRTUAL_SPREAD] = 'N',
    [VIRTUAL_NARROW] = 'M',
    [VIRTUAL_WRIST_UP] = UI_KEY_UP,
    [VIRTUAL_WRIST_DOWN] = UI_KEY_DOWN,
    [VIRTUAL_WRIST_LEFT] = UI_KEY_LEFT,
    [VIRTUAL_WRIST_RIGHT] = UI_KEY_RIGHT,
};

enum { PAD_LEFT_X, PAD_LEFT_Y, PAD_RIGHT_X, PAD_RIGHT_Y, PAD_LEFT_TRIGGER, PAD_RIGHT_TRIGGER };
enum { PAD_LEFT_BUMPER = 4, PAD_RIGHT_BUMPER = 5 };
static const float dead_zone = 0.14f;

static void add(float *wish, float more)
{
    *wish = fminf(fmaxf(*wish + more, -1.0f), 1.0f);
}

static float between(const bool is_down[VIRTUAL_KEYS], virtual_hand_key more, virtual_hand_key less)
{
    return (is_down[more] ? 1.0f : 0.0f) - (is_down[less] ? 1.0f : 0.0f);
}

void virtual_hand_wish_keys(virtual_hand_wish *wish, const bool is_down[VIRTUAL_KEYS])
{
    add(&wish->finger[0], between(is_down, VIRTUAL_THUMB_DOWN, VIRTUAL_THUMB_UP));
    for (int finger = 0; finger < 4; ++finger)
        add(&wish->finger[1 + finger],
            between(is_down, (virtual_hand_key)(VIRTUAL_INDEX_DOWN + finger),
                    (virtual_hand_key)(VIRTUAL_INDEX_UP + finger)));
    add(&wish->spread, between(is_down, VIRTUAL_SPREAD, VIRTUAL_NARROW));
    add(&wish->pitch, between(is_down, VIRTUAL_WRIST_DOWN, VIRTUAL_WRIST_UP));
    add(&wish->yaw, between(is_down, VIRTUAL_WRIST_RIGHT, VIRTUAL_WRIST_LEFT));
}

/* -1..1 without the middle, where worn sticks rest. */
static float stick(const front_gamepad *pad, int axis)
{
    float value = pad->axis[axis];
    if (!(fabsf(value) > dead_zone))
        return 0.0f;
    return copysignf(fminf((fabsf(value) - dead_zone) / (1.0f - dead_zone), 1.0f), value);
}

/* 0..1 */
static float trigger(const front_gamepad *pad, int axis)
{
    float value = 0.5f * (pad->axis[axis] + 1.0f);
    return value > dead_zone ? fminf((value - dead_zone) / (1.0f - dead_zone), 1.0f) : 0.0f;
}

void virtual_hand_wish_pad(virtual_hand_wish *wish, const front_gamepad *pad)
{
    add(&wish->finger[0], trigger(pad, PAD_RIGHT_TRIGGER));
    add(&wish->finger[3], -trigger(pad, PAD_LEFT_TRIGGER));
    add(&wish->finger[4], -trigger(pad, PAD_LEFT_TRIGGER));
    float up = -stick(pad, PAD_LEFT_Y);
    add(&wish->finger[1], -up);
    add(&wish->finger[2], -0.6f * up);
    if (pad->button[PAD_LEFT_BUMPER] || pad->button[PAD_RIGHT_BUMPER])
        add(&wish->finger[2], 1.0f);
    add(&wish->spread, stick(pad, PAD_LEFT_X));
    add(&wish->pitch, stick(pad, PAD_RIGHT_Y));
    add(&wish->yaw, stick(pad, PAD_RIGHT_X));
    for (int pedal = 0; pedal < MRT_MAX_PEDALS; ++pedal)
        wish->pedal[pedal] = wish->pedal[pedal] || pad->button[pedal];
}

bool virtual_hand_pad_is_used(const front_gamepad *pad)
{
    for (int axis = PAD_LEFT_X; axis <= PAD_RIGHT_Y; ++axis)
        if (stick(pad, axis) != 0.0f)
            return true;
    for (int button = 0; button <= PAD_RIGHT_BUMPER; ++button)
        if (pad->button[button])
            return true;
    return trigger(pad, PAD_LEFT_TRIGGER) > 0.0f || trigger(pad, PAD_RIGHT_TRIGGER) > 0.0f;
}

/* How far a joint goes from rest when the finger is wholly down, and wholly up, rad. */
typedef struct way {
    int sensor;
    float down_rad, up_rad;
} way;
static const way thumb_ways[] = {{SENSOR_THUMB_ROLL, 0.06f, -0.04f},
                                 {SENSOR_THUMB_MPJ, -0.45f, 0.30f},
                                 {SENSOR_THUMB_IJ, -0.25f, 0.45f},
                                 {SENSOR_THUMB_ABDUCTION, 0.24f, -0.12f}};
static const way finger_ways[] = {{0, 0.75f, -0.52f}, {1, 0.55f, -0.22f}, {2, 0.30f, -0.05f}};
static const int finger_first[4] = {SENSOR_INDEX_MPJ, SENSOR_MIDDLE_MPJ, SENSOR_RING_MPJ,
                                    SENSOR_LITTLE_MPJ};
static const way spread_ways[] = {{SENSOR_MIDDLE_INDEX_SPREAD, 0.15f, -0.06f},
                                  {SENSOR_RING_MIDDLE_SPREAD, 0.13f, -0.06f},
                                  {SENSOR_LITTLE_RING_SPREAD, 0.20f, -0.08f}};
static const way pitch_way = {SENSOR_WRIST_PITCH, 0.55f, -0.50f};
static const float yaw_rad = 0.35f;

static void bend(float *angle_rad, const way *w, int first, float wish)
{
    angle_rad[first + w->sensor] += wish > 0.0f ? wish * w->down_rad : -wish * w->up_rad;
}

void virtual_hand_rest(float out_rad[MRT_ANGLES])
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        out_rad[i] = sensor_table[i].neutral_rad;
}

void virtual_hand_goal(float out_rad[MRT_ANGLES], const virtual_hand_wish *wish, float to_radial)
{
    virtual_hand_rest(out_rad);
    for (size_t i = 0; i < sizeof thumb_ways / sizeof *thumb_ways; ++i)
        bend(out_rad, &thumb_ways[i], 0, wish->finger[0]);
    for (int finger = 0; finger < 4; ++finger)
        for (size_t i = 0; i < sizeof finger_ways / sizeof *finger_ways; ++i)
            bend(out_rad, &finger_ways[i], finger_first[finger], wish->finger[1 + finger]);
    for (size_t i = 0; i < sizeof spread_ways / sizeof *spread_ways; ++i)
        bend(out_rad, &spread_ways[i], 0, wish->spread);
    bend(out_rad, &pitch_way, 0, wish->pitch);
    out_rad[SENSOR_WRIST_YAW] += wish->yaw * to_radial * yaw_rad;
}

/* ---- easing ---- */

static const double bend_s = 0.080, lift_s = 0.120;
static const float still_rad = 0.002f, still_rad_s = 0.02f;

void virtual_hand_motion_begin(virtual_hand_motion *out)
{
    *out = (virtual_hand_motion){{0}, {0}};
    virtual_hand_rest(out->angle_rad);
}

/* A critically damped spring, solved exactly: x = (a + (v + w a) t) e^(-w t), which has done 63 %
 * of its way after 2.146 / w. */
static void ease(float *angle_rad, float *speed_rad_s, float goal_rad, double dt_s)
{
    bool is_bending = goal_rad > *angle_rad;
    double w = 2.146 / (is_bending ? bend_s : lift_s);
    double away = (double)*angle_rad - (double)goal_rad, speed = (double)*speed_rad_s;
    double drive = speed + w * away, left = exp(-w * dt_s);
    *angle_rad = (float)((double)goal_rad + (away + drive * dt_s) * left);
    *speed_rad_s = (float)((speed - w * drive * dt_s) * left);
}

void virtual_hand_motion_step(virtual_hand_motion *self, const float goal_rad[MRT_ANGLES],
                              double dt_s)
{
    if (!(dt_s > 0.0))
        return;
    for (int i = 0; i < MRT_ANGLES; ++i)
        ease(&self->angle_rad[i], &self->speed_rad_s[i], goal_rad[i], dt_s);
}

bool virtual_hand_motion_is_still(const virtual_hand_motion *self, const float goal_rad[MRT_ANGLES])
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (fabsf(self->angle_rad[i] - goal_rad[i]) > still_rad ||
            fabsf(self->speed_rad_s[i]) > still_rad_s)
            return false;
    return true;
}
