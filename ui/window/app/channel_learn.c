#include "window/app/channel_learn.h"
#include "window/app/app.h"

#include "hand/sensor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double least_way = 0.2, rad_per_deg = 0.017453292519943295;

void channels_read(channels_now *out, app *of)
{
    live *stage = app_live(of);
    const live_view *view = app_view(of);
    *out = (channels_now){.frame.inputs = out->inputs};
    const uint32_t count = live_input_count(stage);
    for (uint32_t i = 0; i < count && i < CHANNELS_INPUTS; ++i) {
        const uint32_t at = out->frame.input_count++;
        mrt_channels *in = &out->inputs[at];
        mrt_sample *sample = &out->sample[at];
        health_report health;
        const bool is_heard = live_input_sample(stage, i, sample);
        input_health(live_input(stage, i), &health);
        out->is_lost[at] = health.state == INPUT_LOST || health.state == INPUT_FAILED;
        in->name = input_name(live_input(stage, i));
        in->channel = input_channels(live_input(stage, i), &in->count);
        in->value = sample->value;
        const bool is_hosts_own = in->count > 0 && in->channel[0].semantic >= POINTER_SEMANTIC;
        if (!is_heard || in->count != sample->count || is_hosts_own)
            in->count = 0; /* the channels are changing, or no mapping receives them */
    }
    memcpy(out->frame.hand, view->hand, sizeof out->frame.hand);
    memcpy(out->frame.pedal, view->pedal, sizeof out->frame.pedal);
}

/* Writes the first word of the input's name, or the whole name if the word is not unique. */
static void name_input(const channels_now *now, uint32_t which, char out[PATCH_NAME])
{
    const char *name = now->inputs[which].name;
    int length = (int)strcspn(name, " ");
    uint32_t alike = 0;
    (void)snprintf(out, PATCH_NAME, "%.*s", length, name);
    for (uint32_t i = 0; i < now->frame.input_count; ++i)
        alike += patch_is_input(out, now->inputs[i].name);
    if (alike > 1)
        (void)snprintf(out, PATCH_NAME, "%.63s", name);
}

void channels_name(const channels_now *now, uint32_t which, uint32_t c, patch_connection *out)
{
    const mrt_channel *channel = &now->inputs[which].channel[c];
    uint32_t angle = channel->semantic - MRT_CH_ANGLE, pedal = channel->semantic - MRT_CH_PEDAL;
    if (channel->semantic >= MRT_CH_ANGLE && angle < MRT_ANGLES && channel->hand <= MRT_RIGHT) {
        (void)snprintf(out->input, sizeof out->input, "%s", PATCH_PERFORMER);
        (void)snprintf(out->channel, sizeof out->channel, "%s.%.50s",
                       channel->hand == MRT_LEFT ? "left" : "right", sensor_table[angle].name);
    } else if (channel->semantic >= MRT_CH_PEDAL && pedal < MRT_MAX_PEDALS) {
        (void)snprintf(out->input, sizeof out->input, "%s", PATCH_PERFORMER);
        (void)snprintf(out->channel, sizeof out->channel, "pedal.%u", pedal + 1);
    } else {
        name_input(now, which, out->input);
        (void)snprintf(out->channel, sizeof out->channel, "%.63s", channel->name);
    }
}

/* The range of a channel. Inputs give angles in rad a range of a whole turn, and no joint moves
 * that far, so the range of the joint counts. */
static double range_of(const mrt_channel *channel)
{
    const uint32_t angle = channel->semantic - MRT_CH_ANGLE;
    if (channel->semantic >= MRT_CH_ANGLE && angle < MRT_ANGLES &&
        strncmp(channel->unit, "rad", 3) == 0)
        return rad_per_deg * (double)(sensor_table[angle].high_deg - sensor_table[angle].low_deg);
    return fmax((double)channel->max - (double)channel->min, 1e-9);
}

bool channel_learn(channel_learner *self, const channels_now *now, patch_connection *out)
{
    double most = least_way;
    bool is_found = false;
    for (uint32_t i = 0; i < now->frame.input_count; ++i) {
        const mrt_channels *in = &now->inputs[i];
        if (in->count > 0 && !self->is_known[i]) {
            memcpy(self->was[i], in->value, in->count * sizeof *in->value);
            memcpy(self->last[i], in->value, in->count * sizeof *in->value);
            self->is_known[i] = true;
        }
        for (uint32_t c = 0; c < in->count; ++c) {
            const double way = range_of(&in->channel[c]);
            const double moved = fabs((double)in->value[c] - (double)self->was[i][c]) / way;
            const double step = fabs((double)in->value[c] - (double)self->last[i][c]) / way;
            self->last[i][c] = in->value[c];
            if (!(moved > most))
                continue;
            most = moved;
            *out = patch_connection_of(PATCH_NOTHING);
            channels_name(now, i, c, out);
            self->has_jumped = step > 0.9 * least_way;
            is_found = true;
        }
    }
    self->count += 1;
    return is_found;
}
