#include "stage/input/glove_channels.h"
#include "stage/input/channel_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static glove_channels_kind kind_of(const mrt_channel *channel)
{
    if (strcmp(channel->unit, "count") == 0)
        return GLOVE_CHANNELS_COUNT;
    const bool is_rad = strcmp(channel->unit, "rad") == 0 || channel_is_of_landmarks(channel);
    return is_rad ? GLOVE_CHANNELS_RAD : GLOVE_CHANNELS_NONE;
}

static bool has_side(const mrt_channel *channel, uint32_t count, uint32_t side,
                     glove_channels_kind kind)
{
    for (uint32_t i = 0; i < count; ++i)
        if (channel_is_angle(&channel[i]) && channel[i].hand == side &&
            kind_of(&channel[i]) == kind)
            return true;
    return false;
}

glove_channels_kind glove_channels_of(const mrt_channel *channel, uint32_t count, uint32_t side)
{
    if (has_side(channel, count, side, GLOVE_CHANNELS_COUNT))
        return GLOVE_CHANNELS_COUNT;
    return has_side(channel, count, side, GLOVE_CHANNELS_RAD) ? GLOVE_CHANNELS_RAD
                                                              : GLOVE_CHANNELS_NONE;
}

void glove_channels_input(char out[HAND_INPUT], const char *name)
{
    (void)snprintf(out, HAND_INPUT, "%.*s", (int)strcspn(name, " "), name);
}

static mrt_result choose_side(uint32_t *out, const mrt_channel *channel, uint32_t count,
                              uint32_t side, const char *name, error *err)
{
    static const char *const side_name[2] = {"left", "right"};
    bool has[2] = {glove_channels_of(channel, count, MRT_LEFT) != GLOVE_CHANNELS_NONE,
                   glove_channels_of(channel, count, MRT_RIGHT) != GLOVE_CHANNELS_NONE};
    if (!has[0] && !has[1])
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: does not measure a hand", name);
    if (side > MRT_RIGHT && has[0] && has[1])
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: measures both hands: add --hand left or --hand right", name);
    if (side <= MRT_RIGHT && !has[side])
        return error_set(err, MRT_ERR_ARGUMENT, "%s: measures the %s hand, not the %s hand", name,
                         side_name[1 - side], side_name[side]);
    *out = side <= MRT_RIGHT ? side : has[MRT_LEFT] ? MRT_LEFT : MRT_RIGHT;
    return MRT_OK;
}

mrt_result glove_channels_find(glove_channels *out, const mrt_channel *channel, uint32_t count,
                               uint32_t side, const char *name, error *err)
{
    *out = (glove_channels){.side = MRT_NO_HAND};
    mrt_result result = choose_side(&out->side, channel, count, side, name, err);
    if (result < 0)
        return result;
    const glove_channels_kind kind = glove_channels_of(channel, count, out->side);
    if (kind == GLOVE_CHANNELS_RAD)
        glove_channels_input(out->input, name);
    for (int i = 0; i < MRT_ANGLES; ++i)
        out->channel_of[i] = -1;
    for (uint32_t i = 0; i < count; ++i) {
        if (!channel_is_angle(&channel[i]) || channel[i].hand != out->side ||
            kind_of(&channel[i]) != kind)
            continue;
        out->low = out->sensors ? fminf(out->low, channel[i].min) : channel[i].min;
        out->high = out->sensors ? fmaxf(out->high, channel[i].max) : channel[i].max;
        out->channel_of[channel[i].semantic - MRT_CH_ANGLE] = (int)i;
        out->sensors |= 1u << (channel[i].semantic - MRT_CH_ANGLE);
    }
    return MRT_OK;
}

void glove_channels_read(const glove_channels *self, const mrt_sample *sample, float *raw)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (self->channel_of[i] >= 0 && (uint32_t)self->channel_of[i] < sample->count)
            raw[i] = sample->value[self->channel_of[i]];
}
