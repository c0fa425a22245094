#include "stage/perform/hands.h"
#include "base/angle.h"
#include "base/bytes.h"
#include "hand/ease.h"
#include "hand/landmark_filter.h"
#include "hand/sensor.h"
#include "hand/still.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct one_hand {
    hand_skeleton *skeleton;
    hand_filter filter;
    landmark_filter landmarks;
    float raw[MRT_ANGLES];
    float wrist_raw[EASE_WRIST];
    bool has_wrist;
    still_window window; /* filtered, calibrated angles, before the re-zero offset */
    float neutral_rad[MRT_ANGLES];
    ease_offset offset;
    ease_angles eased;
    ease_wrist eased_wrist;
    float angle_rad[MRT_ANGLES]; /* final angles, as the frame shows them */
} one_hand;

struct hands {
    one_hand hand[2]; /* left, right */
    hands_settings settings;
    uint32_t rezero_pedal; /* 0: none */
    bool is_rezero_down, is_rezero_pressed;
    rezero_counts counts;
};

static const int64_t REZERO_SPAN_NS = 500000000;
static const double REZERO_DEVIATION_DEG = 1.0;
static const double DEGREES_PER_RADIAN = 180.0 / ANGLE_PI;

static double to_double(float v)
{
    return (double)v;
}

/* Sets the hand to its state before the first sample. */
static void clear_hand(one_hand *hand)
{
    *hand = (one_hand){.skeleton = hand->skeleton};
    hand_filter_init(&hand->filter);
    still_init(&hand->window, REZERO_SPAN_NS, (1u << MRT_ANGLES) - 1);
    for (int i = 0; i < MRT_ANGLES; ++i)
        hand->raw[i] = NAN; /* NaN until a channel has a value: the sensor's middle value is used */
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
        clear_hand(&self->hand[side]);
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

static bool is_wrist(uint32_t semantic)
{
    return semantic >= MRT_CH_WRIST && semantic < MRT_CH_WRIST + EASE_WRIST;
}

static void note_sensor(channel_route *route, const mrt_channel *channel)
{
    const uint32_t side = channel->hand;
    if (strcmp(channel->unit, "count") == 0)
        route->in_counts[side] = true;
    if (channel_is_of_landmarks(channel))
        route->is_of_landmarks[side] = true;
    for (int finger = 0; finger < SENSOR_DISTAL_COUNT; ++finger)
        if (channel->semantic - MRT_CH_ANGLE == (uint32_t)sensor_distal[finger])
            route->has_distal[side][finger] = true;
}

void channel_route_init(channel_route *out, const mrt_channel *channel, uint32_t count)
{
    *out = (channel_route){.name = ""};
    channel_table_copy(&out->table, channel, count);
    for (uint32_t i = 0; i < count; ++i)
        if (channel_is_angle(&channel[i]))
            note_sensor(out, &channel[i]);
    for (int side = 0; side < 2; ++side) {
        hand_calibration *calibration = &out->calibration[side];
        if (out->in_counts[side])
            hand_calibration_default(calibration);
        else
            hand_calibration_identity(calibration);
        memcpy(calibration->has_distal, out->has_distal[side], sizeof out->has_distal[side]);
    }
}

void channel_route_call(channel_route *route, const char *name)
{
    snprintf(route->name, sizeof route->name, "%s", name ? name : "");
}

/* Returns whether a calibration fits the input. Counts need one of a glove; rad needs one of that
 * kind of input. */
static bool is_made_for(const channel_route *route, uint32_t side, const hand_calibration *of)
{
    const size_t length = strlen(of->input);
    if (route->in_counts[side] || length == 0)
        return route->in_counts[side] && length == 0;
    return strncmp(route->name, of->input, length) == 0 &&
           (route->name[length] == '\0' || route->name[length] == ' ');
}

void channel_route_calibrate(channel_route *route, uint32_t side,
                             const hand_calibration *calibration)
{
    if (!calibration || side > MRT_RIGHT || !is_made_for(route, side, calibration))
        return;
    route->calibration[side] = *calibration;
    /* A distal joint is estimated unless both the input and the calibration have it. */
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
    return !clock->has_shown || hand_is_gap(clock->last_ns, time_ns);
}

mrt_result hands_rezero(hands *self, uint32_t side, int64_t time_ns, error *why)
{
    static const char *const side_name[2] = {"left", "right"};
    error reason = {""};
    if (!why)
        why = &reason;
    if (side > MRT_RIGHT)
        return error_set(why, MRT_ERR_ARGUMENT,
                         "hand %u does not exist: 0 is the left hand, 1 the right", side);
    one_hand *hand = &self->hand[side];
    still_state still = still_measure(&hand->window);
    double worst_deg = still.worst * DEGREES_PER_RADIAN;
    if (is_late(hand, time_ns)) {
        (void)error_set(why, MRT_HOLD, "the %s hand gives no samples", side_name[side]);
        return refuse(self, why);
    }
    if (!still.is_full) {
        (void)error_set(why, MRT_HOLD, "the %s hand has been visible for less than half a second",
                        side_name[side]);
        return refuse(self, why);
    }
    if (worst_deg > REZERO_DEVIATION_DEG) {
        (void)error_set(why, MRT_HOLD,
                        "the %s hand is not still: its %s moves by %.1f degrees; at most %.1f. "
                        "Hold it still and try again",
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

/* Restarts the easing as after a gap. */
hand_skeleton *hands_change(hands *self, uint32_t side, hand_skeleton *skeleton)
{
    one_hand *hand = &self->hand[side];
    hand_skeleton *old = skeleton ? hand->skeleton : NULL;
    if (skeleton)
        hand->skeleton = skeleton;
    hand->eased.clock.last_ns -= 2 * HAND_GAP_NS;
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

/* The press of the pedal is recorded in the samples, so a replay re-zeroes at the same sample. */
static void follow_rezero_pedal(hands *self, int64_t time_ns)
{
    if (!self->is_rezero_pressed)
        return;
    self->is_rezero_pressed = false;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        if (self->hand[side].eased.clock.has_shown &&
            hands_rezero(self, side, time_ns, NULL) != MRT_OK)
            continue; /* hands_rezero counts the refusal */
}

/* ---- samples ---- */

static bool has_filter(const hands_settings *settings)
{
    return settings->min_cutoff_hz > 0.0 || settings->has_beta;
}

/* Returns whether a tracker lost the hand and found it in another pose. Such a jump is larger and
 * faster than fingers can move (20 joints at 400 degrees/s are 1 800). Compares with the previous
 * measurement. */
static bool is_jump(const landmark_filter *before, const float *angle_rad, int64_t time_ns)
{
    static const double jump_deg = 45.0, jump_deg_s = 3000.0;
    if (before->count == 0 || time_ns <= before->last_ns)
        return false;
    double way2 = 0.0;
    for (int i = 0; i < SENSOR_WRIST_PITCH; ++i) {
        const double by = to_double(angle_rad[i]) - to_double(before->channel[i].measured[0]);
        way2 += isfinite(by) ? by * by : 0.0;
    }
    const double way_deg = DEGREES_PER_RADIAN * sqrt(way2);
    return way_deg > jump_deg && way_deg > 1e-9 * jump_deg_s * (double)(time_ns - before->last_ns);
}

/* Resets the landmark filter after a jump. The pose eases from its last value, as after a gap. */
static void restart_after_jump(one_hand *hand)
{
    landmark_filter_reset(&hand->landmarks);
    hand->eased.clock.last_ns -= 2 * HAND_GAP_NS;
}

static void read_angles(hands *self, const channel_route *route, int side, int64_t time_ns)
{
    one_hand *hand = &self->hand[side];
    const hand_calibration *calibration = &route->calibration[side];
    float *angle_rad = hand->angle_rad;
    hand_calibrate(calibration, hand->raw, angle_rad);
    if (route->is_of_landmarks[side] && !has_filter(&self->settings)) {
        if (is_jump(&hand->landmarks, angle_rad, time_ns))
            restart_after_jump(hand);
        landmark_filter_apply(&hand->landmarks, angle_rad, time_ns);
    } else {
        hand_filter_apply(&hand->filter, angle_rad, time_ns);
    }
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
    sample_step out = {.time_ns = sample->time_ns, .due_ns = sample->time_ns, .count = 1};
    out.of[0] = (step_sample){.route = route, .sample = *sample};
    return out;
}

static void read_sample(hands *self, const channel_route *route, const mrt_sample *sample,
                        mrt_frame *frame)
{
    bool has_angles[2] = {false, false}, has_wrist[2] = {false, false};
    for (uint32_t i = 0; i < route->table.count && i < sample->count; ++i) {
        const mrt_channel *channel = &route->table.channel[i];
        uint32_t semantic = channel->semantic, side = channel->hand;
        float value = sample->value[i];
        if (channel_is_pedal(channel)) {
            read_pedal(self, semantic - MRT_CH_PEDAL, value, frame);
        } else if (side <= MRT_RIGHT && is_wrist(semantic)) {
            self->hand[side].wrist_raw[semantic - MRT_CH_WRIST] = value;
            has_wrist[side] = true;
        } else if (channel_is_angle(channel)) {
            self->hand[side].raw[semantic - MRT_CH_ANGLE] = value;
            has_angles[side] = true;
        }
    }
    for (int side = 0; side < 2; ++side) {
        one_hand *hand = &self->hand[side];
        if (has_angles[side])
            read_angles(self, route, side, frame->time_ns);
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

/* ---- the state of the hands as bytes ---- */

/* Without landmarks the format is STORE_VERSION, which older versions can read. */
enum { STORE_VERSION = 1, STORE_WITH_LANDMARKS = 2 };

static void read_finite(bytes_in *in, float *out, size_t count)
{
    bytes_read(in, out, count * sizeof *out);
    for (size_t i = 0; i < count; ++i)
        in->failed |= !isfinite(out[i]);
}

/* ---- filter and window ---- */

static void write_filter(bytes_out *out, const hand_filter *filter)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        bytes_write(out, &filter->state[i].value, sizeof filter->state[i].value);
        bytes_write(out, &filter->state[i].derivative, sizeof filter->state[i].derivative);
        bytes_write_u32(out, filter->state[i].running);
    }
    bytes_write(out, &filter->last_ns, sizeof filter->last_ns);
    bytes_write_u32(out, filter->running);
}

static void read_filter(bytes_in *in, hand_filter *filter)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        read_finite(in, &filter->state[i].value, 1);
        read_finite(in, &filter->state[i].derivative, 1);
        filter->state[i].running = bytes_read_u32(in) != 0;
    }
    bytes_read(in, &filter->last_ns, sizeof filter->last_ns);
    filter->running = bytes_read_u32(in) != 0;
}

static void write_landmarks(bytes_out *out, const landmark_filter *filter)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const landmark_channel *c = &filter->channel[i];
        bytes_write(out, &c->value, sizeof c->value);
        bytes_write(out, &c->deviation, sizeof c->deviation);
        bytes_write(out, &c->variance, sizeof c->variance);
        bytes_write(out, c->measured, sizeof c->measured);
    }
    bytes_write_u32(out, filter->count);
    bytes_write(out, &filter->last_ns, sizeof filter->last_ns);
    bytes_write(out, &filter->last_dt_s, sizeof filter->last_dt_s);
}

static void read_landmarks(bytes_in *in, landmark_filter *filter)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        landmark_channel *c = &filter->channel[i];
        read_finite(in, &c->value, 1);
        read_finite(in, &c->deviation, 1);
        read_finite(in, &c->variance, 1);
        read_finite(in, c->measured, 2);
        in->failed |= c->variance < 0.0f;
    }
    filter->count = bytes_read_u32(in);
    bytes_read(in, &filter->last_ns, sizeof filter->last_ns);
    bytes_read(in, &filter->last_dt_s, sizeof filter->last_dt_s);
    in->failed |= filter->count > LANDMARK_FILTER_SETTLED ||
                  !(filter->last_dt_s >= 0.0 && filter->last_dt_s < 1.0);
}

/* Writes the rows in use, oldest first. */
static void write_window(bytes_out *out, const still_window *window)
{
    bytes_write_u32(out, window->count);
    for (uint32_t i = 0; i < window->count; ++i) {
        uint32_t row = (window->first + i) % STILL_SAMPLES;
        bytes_write(out, &window->time_ns[row], sizeof window->time_ns[row]);
        bytes_write(out, window->value[row], sizeof window->value[row]);
    }
}

static void read_window(bytes_in *in, still_window *window)
{
    window->first = 0;
    window->count = bytes_read_u32(in);
    if (window->count > STILL_SAMPLES) {
        in->failed = true;
        window->count = 0;
    }
    for (uint32_t row = 0; row < window->count; ++row) {
        int64_t *time_ns = &window->time_ns[row];
        bytes_read(in, time_ns, sizeof *time_ns);
        read_finite(in, window->value[row], MRT_ANGLES);
        uint64_t since_ns = (uint64_t)*time_ns - (uint64_t)window->time_ns[0];
        in->failed |= since_ns > (uint64_t)window->span_ns || (row > 0 && *time_ns <= time_ns[-1]);
    }
}

/* ---- eases ---- */

static void write_clock(bytes_out *out, const ease_clock *clock)
{
    bytes_write_u32(out, clock->has_shown);
    bytes_write_u32(out, clock->is_easing);
    bytes_write(out, &clock->last_ns, sizeof clock->last_ns);
    bytes_write(out, &clock->start_ns, sizeof clock->start_ns);
}

static void read_clock(bytes_in *in, ease_clock *clock)
{
    clock->has_shown = bytes_read_u32(in) != 0;
    clock->is_easing = bytes_read_u32(in) != 0;
    bytes_read(in, &clock->last_ns, sizeof clock->last_ns);
    bytes_read(in, &clock->start_ns, sizeof clock->start_ns);
}

static void write_hand(bytes_out *out, const one_hand *hand)
{
    write_filter(out, &hand->filter);
    bytes_write(out, hand->raw, sizeof hand->raw);
    bytes_write(out, hand->wrist_raw, sizeof hand->wrist_raw);
    bytes_write_u32(out, hand->has_wrist);
    write_window(out, &hand->window);
    bytes_write(out, hand->neutral_rad, sizeof hand->neutral_rad);
    bytes_write(out, &hand->offset.start_ns, sizeof hand->offset.start_ns);
    bytes_write(out, hand->offset.from_rad, sizeof hand->offset.from_rad);
    bytes_write(out, hand->offset.to_rad, sizeof hand->offset.to_rad);
    write_clock(out, &hand->eased.clock);
    bytes_write(out, hand->eased.last, sizeof hand->eased.last);
    bytes_write(out, hand->eased.from, sizeof hand->eased.from);
    write_clock(out, &hand->eased_wrist.clock);
    bytes_write(out, hand->eased_wrist.last, sizeof hand->eased_wrist.last);
    bytes_write(out, hand->eased_wrist.from, sizeof hand->eased_wrist.from);
    bytes_write(out, hand->angle_rad, sizeof hand->angle_rad);
}

static void read_hand(bytes_in *in, one_hand *hand)
{
    read_filter(in, &hand->filter);
    bytes_read(in, hand->raw, sizeof hand->raw);
    read_finite(in, hand->wrist_raw, EASE_WRIST);
    hand->has_wrist = bytes_read_u32(in) != 0;
    read_window(in, &hand->window);
    read_finite(in, hand->neutral_rad, MRT_ANGLES);
    bytes_read(in, &hand->offset.start_ns, sizeof hand->offset.start_ns);
    read_finite(in, hand->offset.from_rad, MRT_ANGLES);
    read_finite(in, hand->offset.to_rad, MRT_ANGLES);
    read_clock(in, &hand->eased.clock);
    read_finite(in, hand->eased.last, MRT_ANGLES);
    read_finite(in, hand->eased.from, MRT_ANGLES);
    read_clock(in, &hand->eased_wrist.clock);
    read_finite(in, hand->eased_wrist.last, EASE_WRIST);
    read_finite(in, hand->eased_wrist.from, EASE_WRIST);
    read_finite(in, hand->angle_rad, MRT_ANGLES);
}

static bool has_landmarks(const hands *self)
{
    return self->hand[MRT_LEFT].landmarks.count > 0 || self->hand[MRT_RIGHT].landmarks.count > 0;
}

size_t hands_save(const hands *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write_u32(&out, has_landmarks(self) ? STORE_WITH_LANDMARKS : STORE_VERSION);
    bytes_write_u32(&out, self->is_rezero_down);
    for (int side = 0; side < 2; ++side)
        write_hand(&out, &self->hand[side]);
    for (int side = 0; side < 2 && has_landmarks(self); ++side)
        write_landmarks(&out, &self->hand[side].landmarks);
    return out.size;
}

bool hands_load(hands *self, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    hands_reset(self);
    const uint32_t version = bytes_read_u32(&in);
    in.failed |= version != STORE_VERSION && version != STORE_WITH_LANDMARKS;
    self->is_rezero_down = bytes_read_u32(&in) != 0;
    for (int side = 0; side < 2; ++side)
        read_hand(&in, &self->hand[side]);
    for (int side = 0; side < 2 && version == STORE_WITH_LANDMARKS; ++side)
        read_landmarks(&in, &self->hand[side].landmarks);
    if (!in.failed && in.at == in.end)
        return true;
    hands_reset(self);
    return false;
}

/* ---- shift to another clock ---- */

static void shift(int64_t *time_ns, int64_t by_ns)
{
    *time_ns = (int64_t)((uint64_t)*time_ns + (uint64_t)by_ns);
}

static void shift_clock(ease_clock *clock, int64_t by_ns)
{
    shift(&clock->last_ns, by_ns);
    shift(&clock->start_ns, by_ns);
}

void hands_shift_time(hands *self, int64_t by_ns)
{
    for (int side = 0; side < 2; ++side) {
        one_hand *hand = &self->hand[side];
        shift(&hand->filter.last_ns, by_ns);
        shift(&hand->landmarks.last_ns, by_ns);
        for (int row = 0; row < STILL_SAMPLES; ++row)
            shift(&hand->window.time_ns[row], by_ns);
        shift(&hand->offset.start_ns, by_ns);
        shift_clock(&hand->eased.clock, by_ns);
        shift_clock(&hand->eased_wrist.clock, by_ns);
    }
}
