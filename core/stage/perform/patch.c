#include "stage/perform/patch.h"
#include "base/angle.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const patch_kind_names[PATCH_KINDS] = {"",     "param",  "dof",  "contact",
                                                   "pose", "action", "shape"};
const char *const patch_action_names[PATCH_ACTIONS] = {"record", "stop", "mark"};

static const double smooth_max_s = 10.0, number_max = 1e6;
/* A connection picks its target up within this distance, as a share of its range. */
static const double near_share = 0.02;
static const double down_share = 0.5, up_share = 0.4;

patch_connection patch_connection_of(patch_kind kind)
{
    return (patch_connection){.kind = kind,
                              .way = {0.0f, kind == PATCH_CONTACT ? 1.0f : 0.0f, 0.0f},
                              .in = {NAN, NAN},
                              .out = {NAN, NAN}};
}

/* ---- validation ---- */

static bool is_between(double value, double low, double high)
{
    return value >= low && value <= high;
}

static bool is_span(const double span[2], bool ascends)
{
    if (isnan(span[0]) && isnan(span[1]))
        return true;
    return is_between(span[0], -number_max, number_max) &&
           is_between(span[1], -number_max, number_max) && (!ascends || span[0] < span[1]);
}

static bool is_action(const char *name)
{
    for (int i = 0; i < PATCH_ACTIONS; ++i)
        if (strcmp(name, patch_action_names[i]) == 0)
            return true;
    return false;
}

static bool is_unit(const float way[3])
{
    double length = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        length += (double)way[axis] * (double)way[axis];
    return fabs(length - 1.0) < 1e-5;
}

static const char *fault_of(const patch_connection *c)
{
    if (!c->channel[0])
        return "from.channel: is missing";
    if (c->kind <= PATCH_NOTHING || c->kind >= PATCH_KINDS || !c->target[0])
        return "to: has no param, dof, contact, pose, shape or action";
    if (c->kind == PATCH_ACTION && !is_action(c->target))
        return "to.action: is not record, stop or mark";
    if (c->kind == PATCH_CONTACT && !is_unit(c->way))
        return "to.way: is not a unit vector";
    if (!is_span(c->in, true))
        return "in: is not two ascending numbers within 1e6";
    if (!is_span(c->out, false))
        return "out: is not two numbers within 1e6";
    if (!is_between(c->bend, -1.0, 1.0))
        return "bend: is not within -1 and 1";
    if (!is_between(c->ease, -1.0, 1.0))
        return "ease: is not within -1 and 1";
    if (!is_between(c->smooth_s, 0.0, smooth_max_s))
        return "smooth_s: is not within 0 and 10";
    return NULL;
}

mrt_result patch_check(const patch *p, error *err)
{
    if (p->count > PATCH_CONNECTIONS_MAX)
        return error_set(err, MRT_ERR_FORMAT, "$.connections: has %u items; at most %d are allowed",
                         p->count, PATCH_CONNECTIONS_MAX);
    for (uint32_t i = 0; i < p->count; ++i) {
        const char *fault = fault_of(&p->connection[i]);
        if (fault)
            return error_set(err, MRT_ERR_FORMAT, "$.connections[%u].%s", i, fault);
    }
    return MRT_OK;
}

static bool is_same(double a, double b)
{
    return (isnan(a) && isnan(b)) || !(a < b || a > b || isnan(a) != isnan(b));
}

bool patch_connection_equal(const patch_connection *a, const patch_connection *b)
{
    bool is_equal = strcmp(a->input, b->input) == 0 && strcmp(a->channel, b->channel) == 0 &&
                    a->kind == b->kind && strcmp(a->target, b->target) == 0 &&
                    is_same(a->bend, b->bend) && is_same(a->ease, b->ease) &&
                    is_same(a->smooth_s, b->smooth_s) && a->adds == b->adds &&
                    a->picks_up == b->picks_up && a->is_muted == b->is_muted;
    for (int i = 0; i < 2; ++i)
        is_equal &= is_same(a->in[i], b->in[i]) && is_same(a->out[i], b->out[i]);
    for (int axis = 0; axis < 3; ++axis)
        is_equal &= is_same((double)a->way[axis], (double)b->way[axis]);
    return is_equal;
}

bool patch_equal(const patch *a, const patch *b)
{
    if (strcmp(a->name, b->name) != 0 || a->count != b->count)
        return false;
    for (uint32_t i = 0; i < a->count; ++i)
        if (!patch_connection_equal(&a->connection[i], &b->connection[i]))
            return false;
    return true;
}

void patch_connection_describe(const patch_connection *c, char *out, size_t capacity)
{
    (void)snprintf(out, capacity, "%s -> %s", c->channel[0] ? c->channel : "?",
                   c->target[0] ? c->target : "?");
}

/* ---- the value of a connection over time ---- */

/* Schlick's bias. bend 0 is straight; b is the output at 0.5. */
static double bent(double share, double bend)
{
    double b = 0.5 - 0.45 * bend;
    return share / ((1.0 / b - 2.0) * (1.0 - share) + 1.0);
}

/* Schlick's gain: one bias for each half. */
static double eased(double share, double ease)
{
    return share < 0.5 ? 0.5 * bent(2.0 * share, ease) : 1.0 - 0.5 * bent(2.0 - 2.0 * share, ease);
}

double patch_curve(double share, double bend, double ease)
{
    double at = fmin(fmax(share, 0.0), 1.0);
    return eased(bent(at, bend), ease);
}

/* Returns -1..1 if 0 is inside the range, else 0..1. */
static double share_of(const double in[2], double raw, bool *out_has_middle)
{
    *out_has_middle = in[0] < 0.0 && in[1] > 0.0;
    if (!(in[1] > in[0]))
        return 0.0;
    if (!*out_has_middle)
        return fmin(fmax((raw - in[0]) / (in[1] - in[0]), 0.0), 1.0);
    return raw < 0.0 ? -fmin(raw / in[0], 1.0) : fmin(raw / in[1], 1.0);
}

double patch_wanted(const patch_connection *c, const mrt_channel *channel, double raw,
                    const patch_range *of)
{
    double in[2] = {c->in[0], c->in[1]};
    bool has_middle;
    if (isnan(in[0])) {
        in[0] = (double)channel->min;
        in[1] = (double)channel->max;
    }
    double share = share_of(in, raw, &has_middle);
    double curved = patch_curve(fabs(share), c->bend, c->ease);
    bool has_out = !isnan(c->out[0]);
    double high = has_out ? c->out[1] : of->high;
    if (!has_middle) {
        double low = has_out ? c->out[0] : c->kind == PATCH_PARAM ? of->low : of->rest;
        return low + curved * (high - low);
    }
    double low = has_out ? c->out[0] : of->low;
    double rest = c->kind == PATCH_PARAM && has_out ? 0.5 * (low + high) : of->rest;
    return rest + curved * ((share < 0.0 ? low : high) - rest);
}

static bool passes(double before, double now, double at, double span)
{
    return fabs(now - at) <= near_share * span || (before < at) != (now < at);
}

bool patch_course_step(patch_course *course, const patch_connection *c, double wanted, double under,
                       const patch_range *of, double dt_s)
{
    double before = course->is_heard ? course->wanted : wanted;
    /* If the user moved the slider meanwhile, the target has a new value to pick up. */
    bool is_moved = course->is_heard && c->kind == PATCH_PARAM && !is_same(under, course->under);
    if (c->picks_up && is_moved)
        course->is_picked_up = false;
    if (!course->is_picked_up) {
        course->is_picked_up = !c->picks_up || passes(before, wanted, under, of->high - of->low);
        course->value = wanted;
    }
    course->is_heard = true;
    course->wanted = wanted;
    course->under = under;
    double share = c->smooth_s > 0.0 ? dt_s / (c->smooth_s + dt_s) : 1.0;
    course->value += share * (wanted - course->value);
    if (!(c->smooth_s > 0.0))
        course->value = wanted;
    return course->is_picked_up;
}

bool patch_course_press(patch_course *course, double share)
{
    bool was_heard = course->is_heard, was_down = course->was_down;
    course->is_heard = true;
    course->was_down = share >= (was_down ? up_share : down_share);
    return was_heard && course->was_down && !was_down;
}

/* ---- inputs ---- */

bool patch_is_input(const char *wanted, const char *name)
{
    size_t length = strlen(wanted);
    return length == 0 ||
           (strncmp(wanted, name, length) == 0 && (name[length] == '\0' || name[length] == ' '));
}

static bool read_pedal(const char *name, const mrt_frame *frame, mrt_channel *out_channel,
                       double *out_raw)
{
    if (strncmp(name, "pedal.", 6) != 0 || name[6] < '1' || name[6] > '0' + MRT_MAX_PEDALS ||
        name[7] != '\0')
        return false;
    *out_channel = (mrt_channel){name, "1", MRT_CH_PEDAL, MRT_NO_HAND, 0.0f, 1.0f};
    *out_raw = (double)frame->pedal[name[6] - '1'];
    return true;
}

static bool read_performer(const char *name, const mrt_frame *frame, mrt_channel *out_channel,
                           double *out_raw)
{
    uint32_t side = MRT_NO_HAND;
    if (strncmp(name, "left.", 5) == 0)
        side = MRT_LEFT;
    else if (strncmp(name, "right.", 6) == 0)
        side = MRT_RIGHT;
    else
        return read_pedal(name, frame, out_channel, out_raw);
    int sensor = sensor_find(name + (side == MRT_LEFT ? 5 : 6));
    if (sensor < 0 || !frame->hand[side].present)
        return false;
    const sensor_facts *facts = &sensor_table[sensor];
    *out_channel = (mrt_channel){name,
                                 "rad",
                                 MRT_CH_ANGLE + (uint32_t)sensor,
                                 side,
                                 facts->low_deg * (float)(ANGLE_PI / 180.0),
                                 facts->high_deg * (float)(ANGLE_PI / 180.0)};
    *out_raw = (double)frame->hand[side].angle[sensor];
    return true;
}

bool patch_read_channel(const patch_connection *c, const mrt_frame *frame, mrt_channel *out_channel,
                        double *out_raw)
{
    if (strcmp(c->input, PATCH_PERFORMER) == 0)
        return read_performer(c->channel, frame, out_channel, out_raw);
    for (uint32_t i = 0; i < frame->input_count; ++i) {
        const mrt_channels *in = &frame->inputs[i];
        for (uint32_t k = 0; patch_is_input(c->input, in->name) && k < in->count; ++k) {
            if (strcmp(in->channel[k].name, c->channel) != 0)
                continue;
            *out_channel = in->channel[k];
            *out_raw = (double)in->value[k];
            return true;
        }
    }
    return false;
}
