#include "stage/perform/hands_state.h"

#include "base/angle.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int64_t REZERO_SPAN_NS = 500000000;
static const double REZERO_DEVIATION_DEG = 1.0;
static const double DEGREES_PER_RADIAN = 180.0 / ANGLE_PI;

static double to_double(float v)
{
    return (double)v;
}

/* As it is before its first sample. */
static void forget(one_hand *hand)
{
    *hand = (one_hand){.skeleton = hand->skeleton};
    hand_filter_init(&hand->filter);
    still_init(&hand->window, REZERO_SPAN_NS, (1u << MRT_ANGLES) - 1);
    for (int i = 0; i < MRT_ANGLES; ++i)
        hand->raw[i] = NAN; /* until a channel says otherwise: the sensor's middle value */
}

static mrt_result init_hand(one_hand *hand, uint32_t side, double length_mm, error *err)
{
    hand->skeleton = hand_skeleton_create(side, length_mm > 0 ? length_mm : HAND_LENGTH_MM);
    return hand->skeleton ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the hands");
}

static void tune(one_hand *hand, const hands_settings *settings)
{
    filter_settings *const group[3] = {&hand->filter.jaw, &hand->filter.finger,
                                       &hand->filter.wrist};
    for (int i = 0; i < 3; ++i) {
        if (settings->min_cutoff_hz > 0.0)
            group[i]->min_cutoff_hz = (float)settings->min_cutoff_hz;
        if (settings->has_beta)
            group[i]->beta = (float)settings->beta;
    }
}

void hands_reset(hands *self)
{
    for (int side = 0; side < 2; ++side) {
        forget(&self->hand[side]);
        tune(&self->hand[side], &self->settings);
    }
    self->is_rezero_down = self->is_rezero_pressed = false;
}

mrt_result hands_create(hands **out, const hands_settings *settings, error *err)
{
    *out = NULL;
    if (settings->rezero_pedal > MRT_MAX_PEDALS)
        return error_set(err, MRT_ERR_ARGUMENT, "pedal %u cannot re-zero, 1 to %d can",
                         settings->rezero_pedal, MRT_MAX_PEDALS);
    hands *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the hands");
    self->settings = *settings;
    self->rezero_pedal = settings->rezero_pedal;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        mrt_result result = init_hand(&self->hand[side], side, settings->length_mm[side], err);
        if (result < 0) {
            hands_destroy(self);
            return result;
        }
    }
    hands_reset(self);
    *out = self;
    return MRT_OK;
}

void hands_destroy(hands *self)
{
    if (!self)
        return;
    for (int side = 0; side < 2; ++side)
        hand_skeleton_destroy(self->hand[side].skeleton);
    free(self);
}

/* ---- routes ---- */

static bool is_angle(uint32_t semantic)
{
    return semantic >= MRT_CH_ANGLE && semantic < MRT_CH_ANGLE + MRT_ANGLES;
}

static bool is_wrist(uint32_t semantic)
{
    return semantic >= MRT_CH_WRIST && semantic < MRT_CH_WRIST + EASE_WRIST;
}

static bool is_pedal(uint32_t semantic)
{
    return semantic >= MRT_CH_PEDAL && semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS;
}

static void note_sensor(channel_route *route, uint32_t side, uint32_t semantic, const char *unit)
{
    if (strcmp(unit, "count") == 0)
        route->in_counts[side] = true;
    for (int finger = 0; finger < SENSOR_DISTAL_COUNT; ++finger)
        if (semantic - MRT_CH_ANGLE == (uint32_t)sensor_distal[finger])
            route->has_distal[side][finger] = true;
}

void channel_route_init(channel_route *out, const mrt_channel *channel, uint32_t count)
{
    *out = (channel_route){.count = count};
    for (uint32_t i = 0; i < count; ++i) {
        out->semantic[i] = channel[i].semantic;
        out->hand[i] = channel[i].hand;
        if (channel[i].hand <= MRT_RIGHT && is_angle(channel[i].semantic))
            note_sensor(out, channel[i].hand, channel[i].semantic, channel[i].unit);
    }
    for (int side = 0; side < 2; ++side) {
        hand_calibration *calibration = &out->calibration[side];
        if (out->in_counts[side])
            hand_calibration_default(calibration);
        else
            hand_calibration_identity(calibration);
        memcpy(calibration->has_distal, out->has_distal[side], sizeof out->has_distal[side]);
    }
}

void channel_route_calibrate(channel_route *route, uint32_t side,
                             const hand_calibration *calibration)
{
    if (!calibration || side > MRT_RIGHT || !route->in_counts[side])
        return;
    route->calibration[side] = *calibration;
    /* What neither the glove measures nor the calibration knows is estimated. */
    for (int finger = 0; finger < SENSOR_DISTAL_COUNT; ++finger)
        route->calibration[side].has_distal[finger] =
            calibration->has_distal[finger] && route->has_distal[side][finger];
}

/* ---- re-zero ---- */

static mrt_result refuse(hands *self, error *why)
{
    self->counts.refused += 1;
    self->counts.refusal = *why;
    return MRT_HOLD;
}

static bool is_late(const one_hand *hand, int64_t time_ns)
{
    const ease_clock *clock = &hand->eased.clock;
    return !clock->has_shown || time_ns < clock->last_ns ||
           (uint64_t)time_ns - (uint64_t)clock->last_ns > (uint64_t)EASE_GAP_NS;
}

mrt_result hands_rezero(hands *self, uint32_t side, int64_t time_ns, error *why)
{
    static const char *const side_name[2] = {"left", "right"};
    error reason = {""};
    if (!why)
        why = &reason;
    if (side > MRT_RIGHT)
        return error_set(why, MRT_ERR_ARGUMENT, "there is no hand %u", side);
    one_hand *hand = &self->hand[side];
    still_state still = still_measure(&hand->window);
    double worst_deg = still.worst * DEGREES_PER_RADIAN;
    if (is_late(hand, time_ns)) {
        (void)error_set(why, MRT_HOLD, "the %s hand gives no samples", side_name[side]);
        return refuse(self, why);
    }
    if (!still.is_full) {
        (void)error_set(why, MRT_HOLD, "the %s hand has been there for less than half a second",
                        side_name[side]);
        return refuse(self, why);
    }
    if (worst_deg > REZERO_DEVIATION_DEG) {
        (void)error_set(why, MRT_HOLD,
                        "the %s hand is not still: its %s moves by %.1f degrees, %.1f are allowed",
                        side_name[side], sensor_table[still.worst_channel].label, worst_deg,
                        REZERO_DEVIATION_DEG);
        return refuse(self, why);
    }
    float offset_rad[MRT_ANGLES];
    still_mean(&hand->window, offset_rad);
    for (int i = 0; i < MRT_ANGLES; ++i)
        offset_rad[i] = hand->neutral_rad[i] - offset_rad[i];
    ease_offset_set(&hand->offset, offset_rad, time_ns);
    self->counts.done += 1;
    return MRT_OK;
}

const rezero_counts *hands_rezeros(const hands *self)
{
    return &self->counts;
}

/* As after a gap. */
hand_skeleton *hands_change(hands *self, uint32_t side, hand_skeleton *skeleton)
{
    one_hand *hand = &self->hand[side];
    hand_skeleton *old = skeleton ? hand->skeleton : NULL;
    if (skeleton)
        hand->skeleton = skeleton;
    hand->eased.clock.last_ns -= 2 * EASE_GAP_NS;
    return old;
}

void hands_set_rezero_pedal(hands *self, uint32_t pedal)
{
    self->rezero_pedal = pedal;
    self->is_rezero_down = self->is_rezero_pressed = false;
}

static void read_pedal(hands *self, uint32_t pedal, float value, mrt_frame *frame)
{
    if (pedal + 1 != self->rezero_pedal) {
        frame->pedal[pedal] = fminf(fmaxf(value, 0.0f), 1.0f);
        return;
    }
    bool is_down = value >= 0.5f;
    self->is_rezero_pressed = is_down && !self->is_rezero_down;
    self->is_rezero_down = is_down;
}

/* The pedal's press is in the samples, so a replay re-zeroes at the same one. */
static void follow_rezero_pedal(hands *self, int64_t time_ns)
{
    if (!self->is_rezero_pressed)
        return;
    self->is_rezero_pressed = false;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        if (self->hand[side].eased.clock.has_shown &&
            hands_rezero(self, side, time_ns, NULL) != MRT_OK)
            continue; /* counted there */
}

/* ---- samples ---- */

static void read_angles(one_hand *hand, const hand_calibration *calibration, int64_t time_ns)
{
    float *angle_rad = hand->angle_rad;
    hand_calibrate(calibration, hand->raw, angle_rad);
    hand_filter_apply(&hand->filter, angle_rad, time_ns);
    still_add(&hand->window, angle_rad, time_ns);
    memcpy(hand->neutral_rad, calibration->neutral_rad, sizeof hand->neutral_rad);
    ease_offset_add(&hand->offset, angle_rad, time_ns);
    ease_angles_apply(&hand->eased, angle_rad, time_ns);
}

static rigid wrist_of(one_hand *hand)
{
    if (!hand->has_wrist)
        return rigid_identity();
    const float *at = hand->eased_wrist.last;
    double quaternion[4] = {to_double(at[3]), to_double(at[4]), to_double(at[5]), to_double(at[6])};
    vec3 position = {to_double(at[0]), to_double(at[1]), to_double(at[2])};
    return rigid_from_quaternion(quaternion, position);
}

static void read_wrist(one_hand *hand, int64_t time_ns)
{
    float wrist[EASE_WRIST];
    memcpy(wrist, hand->wrist_raw, sizeof wrist);
    ease_wrist_apply(&hand->eased_wrist, wrist, time_ns);
    hand->has_wrist = true;
}

static void show_hand(one_hand *hand, int64_t time_ns, mrt_hand *out)
{
    rigid wrist = wrist_of(hand);
    memcpy(out->angle, hand->angle_rad, sizeof out->angle);
    hand_pose(hand->skeleton, out->angle, &wrist, out->joint, out->palm);
    out->present = true;
    out->time_ns = time_ns;
}

sample_step sample_step_of(const channel_route *route, const mrt_sample *sample)
{
    sample_step out = {.time_ns = sample->time_ns, .count = 1};
    out.of[0] = (step_sample){.route = route, .sample = *sample};
    return out;
}

static void read_sample(hands *self, const channel_route *route, const mrt_sample *sample,
                        mrt_frame *frame)
{
    bool has_angles[2] = {false, false}, has_wrist[2] = {false, false};
    for (uint32_t i = 0; i < route->count && i < sample->count; ++i) {
        uint32_t semantic = route->semantic[i], side = route->hand[i];
        float value = sample->value[i];
        if (is_pedal(semantic)) {
            read_pedal(self, semantic - MRT_CH_PEDAL, value, frame);
        } else if (side <= MRT_RIGHT && is_wrist(semantic)) {
            self->hand[side].wrist_raw[semantic - MRT_CH_WRIST] = value;
            has_wrist[side] = true;
        } else if (side <= MRT_RIGHT && is_angle(semantic)) {
            self->hand[side].raw[semantic - MRT_CH_ANGLE] = value;
            has_angles[side] = true;
        }
    }
    for (int side = 0; side < 2; ++side) {
        one_hand *hand = &self->hand[side];
        if (has_angles[side])
            read_angles(hand, &route->calibration[side], frame->time_ns);
        if (has_wrist[side])
            read_wrist(hand, frame->time_ns);
        if (has_angles[side] || has_wrist[side])
            show_hand(hand, frame->time_ns, &frame->hand[side]);
    }
    follow_rezero_pedal(self, frame->time_ns);
}

void hands_read(hands *self, const sample_step *s, mrt_frame *frame)
{
    for (uint32_t i = 0; i < s->count; ++i)
        read_sample(self, s->of[i].route, &s->of[i].sample, frame);
}
