#include "stage/input/channel_table.h"
#include "base/text.h"

#include <stdio.h>
#include <string.h>

static void copy_channel(channel_table *out, uint32_t i, const mrt_channel *from)
{
    snprintf(out->name[i], CHANNEL_NAME, "%s", from->name);
    snprintf(out->unit[i], CHANNEL_UNIT, "%s", from->unit);
    text_make_printable(out->name[i]); /* devices and senders also name channels */
    text_make_printable(out->unit[i]);
    out->channel[i] = *from;
    out->channel[i].name = out->name[i];
    out->channel[i].unit = out->unit[i];
}

void channel_table_copy(channel_table *out, const mrt_channel *channels, uint32_t count)
{
    *out = (channel_table){.count = count};
    for (uint32_t i = 0; i < count; ++i)
        copy_channel(out, i, &channels[i]);
}

mrt_result channel_table_init(channel_table *out, const mrt_channel *channels, uint32_t count,
                              const char *who, error *err)
{
    *out = (channel_table){0};
    if (!channels || count == 0 || count > MRT_MAX_CHANNELS)
        return error_set(err, MRT_ERR_FORMAT, "%s: has %u channels: the range is 1 to %d", who,
                         count, MRT_MAX_CHANNELS);
    for (uint32_t i = 0; i < count; ++i) {
        const mrt_channel *channel = &channels[i];
        if (!channel->name || !channel->unit || channel->hand > MRT_NO_HAND)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: channel %u lacks a name, a unit or a valid hand", who, i);
    }
    channel_table_copy(out, channels, count);
    return MRT_OK;
}

static const char *hand_name(uint32_t hand)
{
    return hand == MRT_LEFT ? "left" : hand == MRT_RIGHT ? "right" : "no";
}

static bool is_same(const mrt_channel *x, const mrt_channel *y)
{
    const bool is_named = x->semantic == MRT_CH_OTHER || x->semantic == MRT_CH_BUTTON;
    return x->semantic == y->semantic && x->hand == y->hand && strcmp(x->unit, y->unit) == 0 &&
           (!is_named || strcmp(x->name, y->name) == 0);
}

bool channel_table_equal(const channel_table *a, const channel_table *b, error *out_why)
{
    if (a->count != b->count) {
        (void)error_set(out_why, MRT_ERR_UNSUPPORTED, "%u channels instead of %u", b->count,
                        a->count);
        return false;
    }
    for (uint32_t i = 0; i < a->count; ++i) {
        const mrt_channel *x = &a->channel[i], *y = &b->channel[i];
        if (is_same(x, y))
            continue;
        (void)error_set(out_why, MRT_ERR_UNSUPPORTED,
                        "channel %u as \"%s\" (%s hand, \"%s\") instead of \"%s\" (%s hand, "
                        "\"%s\")",
                        i, y->name, hand_name(y->hand), y->unit, x->name, hand_name(x->hand),
                        x->unit);
        return false;
    }
    return true;
}

bool channel_is_pedal(const mrt_channel *channel)
{
    return channel->semantic >= MRT_CH_PEDAL && channel->semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS;
}

bool channel_is_angle(const mrt_channel *channel)
{
    return channel->hand <= MRT_RIGHT && channel->semantic >= MRT_CH_ANGLE &&
           channel->semantic < MRT_CH_ANGLE + MRT_ANGLES;
}

bool channel_is_of_landmarks(const mrt_channel *channel)
{
    return channel_is_angle(channel) && strcmp(channel->unit, MRT_UNIT_LANDMARKS) == 0;
}
