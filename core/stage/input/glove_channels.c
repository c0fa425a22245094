#include "stage/input/glove_channels.h"

#include <math.h>
#include <string.h>

static bool is_angle(const mrt_channel *channel)
{
    return channel->hand <= MRT_RIGHT && channel->semantic >= MRT_CH_ANGLE &&
           channel->semantic < MRT_CH_ANGLE + MRT_ANGLES;
}

static bool has_side(const mrt_channel *channel, uint32_t count, uint32_t side, const char *unit)
{
    for (uint32_t i = 0; i < count; ++i)
        if (is_angle(&channel[i]) && channel[i].hand == side &&
            (!unit || strcmp(channel[i].unit, unit) == 0))
            return true;
    return false;
}

bool glove_channels_has(const mrt_channel *channel, uint32_t count, uint32_t side)
{
    return has_side(channel, count, side, "count");
}

static mrt_result choose_side(uint32_t *out, const mrt_channel *channel, uint32_t count,
                              uint32_t side, const char *name, error *err)
{
    static const char *const side_name[2] = {"left", "right"};
    bool has[2] = {has_side(channel, count, MRT_LEFT, NULL),
                   has_side(channel, count, MRT_RIGHT, NULL)};
    if (!has[0] && !has[1])
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: measures no hand", name);
    if (side > MRT_RIGHT && has[0] && has[1])
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: gives both hands: say --hand left or --hand right", name);
    if (side <= MRT_RIGHT && !has[side])
        return error_set(err, MRT_ERR_ARGUMENT, "%s: is of a %s hand, not of a %s one", name,
                         side_name[1 - side], side_name[side]);
    *out = side <= MRT_RIGHT ? side : has[MRT_LEFT] ? MRT_LEFT : MRT_RIGHT;
    if (!has_side(channel, count, *out, "count"))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: gives angles in rad: it is calibrated already. A calibration is made "
                         "from a glove, or from a log in counts",
                         name);
    return MRT_OK;
}

mrt_result glove_channels_find(glove_channels *out, const mrt_channel *channel, uint32_t count,
                               uint32_t side, const char *name, error *err)
{
    *out = (glove_channels){.side = MRT_NO_HAND};
    mrt_result result = choose_side(&out->side, channel, count, side, name, err);
    if (result < 0)
        return result;
    for (int i = 0; i < MRT_ANGLES; ++i)
        out->channel_of[i] = -1;
    for (uint32_t i = 0; i < count; ++i) {
        if (!is_angle(&channel[i]) || channel[i].hand != out->side ||
            strcmp(channel[i].unit, "count") != 0)
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
