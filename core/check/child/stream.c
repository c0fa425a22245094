#include "check/child/stream.h"
#include "check/child/random.h"
#include "hand/hand.h"
#include "hand/sensor.h"

#include <math.h>
#include <string.h>

static const int64_t frame_ns = 6666667; /* 150 Hz */
static const double rad_per_deg = 0.017453292519943295;
static const double wrist_range_mm = 120.0;

static hand_skeleton *skeleton[2];

bool stream_begin(stream *out, stream_kind kind, uint64_t seed, const mrt_plugin_type *type)
{
    for (uint32_t side = 0; side < 2; ++side)
        if (!skeleton[side])
            skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM);
    memset(out, 0, sizeof *out);
    out->kind = kind;
    out->random = seed;
    out->type = type;
    out->time_ns = 1000000000;
    out->next_press = 40;
    for (uint32_t i = 0; i < type->param_count && i < STREAM_PARAMS_MAX; ++i)
        out->param[i] = type->params[i].initial;
    for (int side = 0; side < 2; ++side) {
        stream_hand *hand = &out->hand[side];
        hand->present = kind != STREAM_ABSENT && (kind != STREAM_ONE_HAND || side == MRT_RIGHT);
        hand->speed = 0.02;
        for (int i = 0; i < MRT_ANGLES; ++i)
            hand->angle[i] = hand->goal[i] = (double)sensor_table[i].neutral_rad;
    }
    return skeleton[0] && skeleton[1];
}

/* ---- parameters ---- */

static bool is_trigger(const mrt_param *p)
{
    return p->flags & MRT_PARAM_TRIGGER;
}

static double any_value(stream *self, const mrt_param *p)
{
    double value = random_between(&self->random, p->min, p->max);
    if (random_one_in(&self->random, 5))
        value = random_one_in(&self->random, 2) ? p->min : p->max;
    if (p->flags & MRT_PARAM_STEPPED)
        value = fmin(p->max, p->min + floor(random_between(&self->random, 0, p->max - p->min + 1)));
    return value;
}

void stream_shuffle_choices(stream *self)
{
    for (uint32_t i = 0; i < self->type->param_count; ++i) {
        const mrt_param *p = &self->type->params[i];
        if ((p->flags & MRT_PARAM_STEPPED) && !is_trigger(p))
            self->param[i] = any_value(self, p);
    }
}

static void let_triggers_go(stream *self)
{
    for (uint32_t i = 0; i < self->type->param_count; ++i)
        if (is_trigger(&self->type->params[i]))
            self->param[i] = self->type->params[i].initial;
}

static void change_one_param(stream *self)
{
    if (self->type->param_count == 0)
        return;
    uint32_t i = random_below(&self->random, self->type->param_count);
    const mrt_param *p = &self->type->params[i];
    self->param[i] = is_trigger(p) ? p->max : any_value(self, p);
}

static void press_one_trigger(stream *self)
{
    uint32_t count = self->type->param_count;
    uint32_t first = count ? random_below(&self->random, count) : 0;
    for (uint32_t k = 0; k < count; ++k) {
        uint32_t i = (first + k) % count;
        if (!is_trigger(&self->type->params[i]))
            continue;
        self->param[i] = self->type->params[i].max;
        return;
    }
}

static void move_one_pedal(stream *self)
{
    uint32_t i = random_below(&self->random, MRT_MAX_PEDALS);
    self->pedal[i] = self->pedal[i] > 0.5f ? 0.0f : 1.0f;
}

/* ---- hands ---- */

/* Beyond its clinical range too: calibrations are not perfect. */
static double any_angle(stream *self, int sensor)
{
    double low = (double)sensor_table[sensor].low_deg * rad_per_deg;
    double high = (double)sensor_table[sensor].high_deg * rad_per_deg;
    double margin = 0.2 * (high - low);
    if (self->kind != STREAM_EXTREMES)
        return random_between(&self->random, low - margin, high + margin);
    uint32_t end = random_below(&self->random, 5);
    if (end == 4)
        return random_one_in(&self->random, 2) ? -3.1415 : 3.1415; /* as far as a filter lets */
    return end == 0 ? low : end == 1 ? high : end == 2 ? low - margin : high + margin;
}

static void choose_goal(stream *self, stream_hand *hand)
{
    bool is_calm = self->kind == STREAM_CALM;
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (random_one_in(&self->random, 2))
            hand->goal[i] = any_angle(self, i);
    for (int i = 0; i < 3; ++i)
        hand->wrist_goal_mm[i] = random_between(&self->random, -wrist_range_mm, wrist_range_mm);
    hand->speed = is_calm ? 0.002 : random_between(&self->random, 0.005, 0.3);
    if (self->kind == STREAM_EXTREMES)
        hand->speed = 1.0;
}

static void move_hand(stream *self, stream_hand *hand)
{
    if (random_one_in(&self->random, self->kind == STREAM_EXTREMES ? 2 : 40))
        choose_goal(self, hand);
    for (int i = 0; i < MRT_ANGLES; ++i)
        hand->angle[i] += hand->speed * (hand->goal[i] - hand->angle[i]);
    for (int i = 0; i < 3; ++i)
        hand->wrist_mm[i] += hand->speed * (hand->wrist_goal_mm[i] - hand->wrist_mm[i]);
    hand->time_ns = self->time_ns;
}

static void come_and_go(stream *self)
{
    bool is_staying = self->kind == STREAM_CALM || self->kind == STREAM_ABSENT;
    if (is_staying || !random_one_in(&self->random, 150))
        return;
    uint32_t side = self->kind == STREAM_ONE_HAND ? MRT_RIGHT : random_below(&self->random, 2);
    self->hand[side].present = !self->hand[side].present;
}

static void write_hand(const stream_hand *from, int side, mrt_hand *out)
{
    if (!from->present) {
        out->present = false; /* the rest is the last known */
        return;
    }
    rigid wrist = rigid_identity();
    wrist.t = (vec3){from->wrist_mm[0], from->wrist_mm[1], from->wrist_mm[2]};
    out->present = true;
    out->time_ns = from->time_ns;
    for (int i = 0; i < MRT_ANGLES; ++i)
        out->angle[i] = (float)from->angle[i];
    hand_pose(skeleton[side], out->angle, &wrist, out->joint, out->palm);
}

/* ---- frames ---- */

static int64_t step_ns(stream *self)
{
    if (self->kind != STREAM_CALM && random_one_in(&self->random, 200))
        return random_one_in(&self->random, 2) ? 0 : 400000000; /* twice the same; a gap */
    return frame_ns + (int64_t)random_below(&self->random, 200000);
}

static void press(stream *self)
{
    let_triggers_go(self);
    if (self->kind == STREAM_RESTLESS && random_one_in(&self->random, 20))
        change_one_param(self);
    if (self->kind == STREAM_CALM && self->index < self->next_press)
        return;
    if (self->kind != STREAM_CALM && !random_one_in(&self->random, 60))
        return;
    self->next_press = self->index + 15 + random_below(&self->random, 60);
    if (random_one_in(&self->random, 2))
        press_one_trigger(self);
    else
        move_one_pedal(self);
}

void stream_next(stream *self, mrt_frame *out)
{
    int64_t passed_ns = self->index == 0 ? 0 : step_ns(self);
    self->time_ns += passed_ns;
    press(self);
    come_and_go(self);
    out->time_ns = self->time_ns;
    out->dt_s = fmin((double)passed_ns / 1e9, 0.1);
    for (int side = 0; side < 2; ++side) {
        move_hand(self, &self->hand[side]);
        write_hand(&self->hand[side], side, &out->hand[side]);
    }
    memcpy(out->pedal, self->pedal, sizeof out->pedal);
    out->near = self->index > 3 && !random_one_in(&self->random, 8);
    out->params = self->param;
    self->index += 1;
}

const char *stream_name(stream_kind kind)
{
    static const char *const names[] = {
        [STREAM_WALK] = "a random walk",
        [STREAM_RESTLESS] = "a random walk with changing parameters",
        [STREAM_EXTREMES] = "hands at the ends of their ranges",
        [STREAM_CALM] = "slow hands that take hold and let go",
        [STREAM_ABSENT] = "no hand at all",
        [STREAM_ONE_HAND] = "one hand that comes and goes",
    };
    return names[kind];
}
