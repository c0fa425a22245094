#include "stage/hands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct one_hand {
    hand_skeleton *skeleton;
    hand_filter filter;
    float raw[MRT_ANGLES];
    float wrist[7]; /* mm, quaternion */
    bool has_wrist;
} one_hand;

struct hands {
    one_hand hand[2]; /* left, right */
};

/* Sensor numbers of the distal joints, index to little: what an 18-sensor glove lacks. */
static const uint32_t distal_sensor[4] = {6, 9, 13, 17};

static double to_double(float v)
{
    return (double)v;
}

mrt_result hands_create(hands **out, double length_mm, error *err)
{
    *out = NULL;
    hands *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the hands");
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        one_hand *hand = &self->hand[side];
        hand->skeleton = hand_skeleton_create(side, length_mm);
        if (!hand->skeleton) {
            hands_destroy(self);
            return error_set(err, MRT_ERR_MEMORY, "no memory for the hands");
        }
        hand_filter_init(&hand->filter);
        for (int i = 0; i < MRT_ANGLES; ++i)
            hand->raw[i] = NAN; /* until a channel says otherwise: the sensor's middle value */
    }
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

void channel_route_init(channel_route *out, const mrt_channel *channel, uint32_t count)
{
    *out = (channel_route){.count = count};
    bool in_counts[2] = {false, false};
    bool distal[2][4] = {{false}};
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t semantic = channel[i].semantic, hand = channel[i].hand;
        out->semantic[i] = semantic;
        out->hand[i] = hand;
        if (hand > MRT_RIGHT || semantic < MRT_CH_ANGLE || semantic >= MRT_CH_ANGLE + MRT_ANGLES)
            continue;
        if (strcmp(channel[i].unit, "count") == 0)
            in_counts[hand] = true;
        uint32_t sensor = semantic - MRT_CH_ANGLE;
        for (uint32_t finger = 0; finger < 4; ++finger)
            if (sensor == distal_sensor[finger])
                distal[hand][finger] = true;
    }
    for (int side = 0; side < 2; ++side) {
        hand_calibration *calibration = &out->calibration[side];
        if (in_counts[side])
            hand_calibration_default(calibration);
        else
            hand_calibration_identity(calibration);
        memcpy(calibration->has_distal, distal[side], sizeof distal[side]);
    }
}

static void pose_hand(one_hand *stage, const hand_calibration *calibration, int64_t time_ns,
                      mrt_hand *out)
{
    hand_calibrate(calibration, stage->raw, out->angle);
    hand_filter_apply(&stage->filter, out->angle, time_ns);
    rigid wrist = rigid_identity();
    if (stage->has_wrist) {
        double quaternion[4] = {to_double(stage->wrist[3]), to_double(stage->wrist[4]),
                                to_double(stage->wrist[5]), to_double(stage->wrist[6])};
        vec3 position = {to_double(stage->wrist[0]), to_double(stage->wrist[1]),
                         to_double(stage->wrist[2])};
        wrist = rigid_from_quaternion(quaternion, position);
    }
    hand_pose(stage->skeleton, out->angle, &wrist, out->joint, out->palm);
    out->present = true;
    out->time_ns = time_ns;
}

void hands_read(hands *self, const channel_route *route, const mrt_sample *sample, mrt_frame *frame)
{
    bool touched[2] = {false, false};
    for (uint32_t i = 0; i < route->count && i < sample->count; ++i) {
        uint32_t semantic = route->semantic[i], hand = route->hand[i];
        float value = sample->value[i];
        if (semantic >= MRT_CH_PEDAL && semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS) {
            frame->pedal[semantic - MRT_CH_PEDAL] = fminf(fmaxf(value, 0.0f), 1.0f);
        } else if (hand <= MRT_RIGHT && semantic >= MRT_CH_WRIST && semantic < MRT_CH_WRIST + 7) {
            self->hand[hand].wrist[semantic - MRT_CH_WRIST] = value;
            self->hand[hand].has_wrist = true;
            touched[hand] = true;
        } else if (hand <= MRT_RIGHT && semantic >= MRT_CH_ANGLE &&
                   semantic < MRT_CH_ANGLE + MRT_ANGLES) {
            self->hand[hand].raw[semantic - MRT_CH_ANGLE] = value;
            touched[hand] = true;
        }
    }
    for (int side = 0; side < 2; ++side)
        if (touched[side])
            pose_hand(&self->hand[side], &route->calibration[side], frame->time_ns,
                      &frame->hand[side]);
}
