#include "window/learn.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

static const double span_s = 1.0, step_s = 1.0 / 36.0; /* less than LEARN_MOMENTS in the span */
static const float least_rad = 0.4f, clearly = 1.3f;

enum { JOINTS = 3 };
/* Of a hand, from thumb to little finger: roll, MPJ, IJ; then MPJ and PIJ. DIJ is not measured by
 * every glove. */
static const int joint_of[5][JOINTS] = {
    {0, 1, 2}, {4, 5, -1}, {7, 8, -1}, {11, 12, -1}, {15, 16, -1}};

const char *const learn_finger_name[LEARN_FINGERS] = {
    "right thumb", "right index", "right middle", "right ring", "right little",
    "left thumb",  "left index",  "left middle",  "left ring",  "left little"};

void learn_begin(learn *self)
{
    *self = (learn){.finger = LEARN_NONE};
}

static uint32_t side_of(int finger)
{
    return finger < 5 ? MRT_RIGHT : MRT_LEFT;
}

static float travel_of_joint(const learn *self, uint32_t side, int joint)
{
    float low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < self->count; ++i) {
        const struct learn_moment *at = &self->moment[i];
        if (!at->is_present[side] || self->time_s - at->time_s > span_s)
            continue;
        low = fminf(low, at->angle[side][joint]);
        high = fmaxf(high, at->angle[side][joint]);
    }
    return high > low ? high - low : 0.0f;
}

static void measure(learn *self)
{
    for (int finger = 0; finger < LEARN_FINGERS; ++finger) {
        self->travel_rad[finger] = 0.0f;
        for (int i = 0; i < JOINTS && joint_of[finger % 5][i] >= 0; ++i)
            self->travel_rad[finger] +=
                travel_of_joint(self, side_of(finger), joint_of[finger % 5][i]);
    }
}

static void decide(learn *self)
{
    int most = 0;
    for (int finger = 1; finger < LEARN_FINGERS; ++finger)
        if (self->travel_rad[finger] > self->travel_rad[most])
            most = finger;
    float second = 0.0f;
    for (int finger = 0; finger < LEARN_FINGERS; ++finger)
        if (finger != most)
            second = fmaxf(second, self->travel_rad[finger]);
    if (self->travel_rad[most] >= least_rad && self->travel_rad[most] >= clearly * second)
        self->finger = most;
}

static void remember(learn *self, const mrt_hand hand[2])
{
    struct learn_moment *at = &self->moment[self->next];
    at->time_s = self->time_s;
    for (int side = 0; side < 2; ++side) {
        at->is_present[side] = hand[side].present;
        for (int i = 0; i < MRT_ANGLES; ++i)
            at->angle[side][i] = isfinite(hand[side].angle[i]) ? hand[side].angle[i] : 0.0f;
    }
    self->next = (self->next + 1) % LEARN_MOMENTS;
    if (self->count < LEARN_MOMENTS)
        self->count += 1;
}

void learn_look(learn *self, const mrt_hand hand[2], double dt_s)
{
    self->time_s += dt_s > 0.0 ? dt_s : 0.0;
    if (self->count > 0 && self->time_s - self->last_s < step_s)
        return;
    self->last_s = self->time_s;
    remember(self, hand);
    measure(self);
    decide(self);
}

static bool is_name_of(const char *name, const char *finger)
{
    size_t i = 0;
    for (; name[i] && finger[i]; ++i)
        if (tolower((unsigned char)name[i]) != finger[i])
            return false;
    return name[i] == finger[i];
}

int learn_finger_of(const mrt_param *param)
{
    if (!(param->flags & MRT_PARAM_STEPPED) || strcmp(param->group, "Contacts") != 0 ||
        param->min > 0.0 || param->max < 1.0 || param->labels)
        return LEARN_NONE;
    for (int finger = 0; finger < LEARN_FINGERS; ++finger)
        if (is_name_of(param->name, learn_finger_name[finger]))
            return finger;
    return LEARN_NONE;
}

uint32_t learn_param_of(const mrt_plugin_type *type, int finger)
{
    for (uint32_t i = 0; i < type->param_count && finger != LEARN_NONE; ++i)
        if (learn_finger_of(&type->params[i]) == finger)
            return i;
    return type->param_count;
}

bool learn_can(const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (learn_finger_of(&type->params[i]) != LEARN_NONE)
            return true;
    return false;
}
