/* stage/input/channel_table.h - a copy of the description of an input's channels. It stays valid
 * while the device is closed, when the plugin's own description does not exist. Pure functions; any
 * thread. */
#ifndef MAROTTE_STAGE_CHANNEL_TABLE_H
#define MAROTTE_STAGE_CHANNEL_TABLE_H
#include "base/error.h"

enum { CHANNEL_NAME = 48, CHANNEL_UNIT = 16 };
typedef struct channel_table {
    uint32_t count;
    mrt_channel channel[MRT_MAX_CHANNELS]; /* names and units point into the two arrays below */
    char name[MRT_MAX_CHANNELS][CHANNEL_NAME], unit[MRT_MAX_CHANNELS][CHANNEL_UNIT];
} channel_table;

/* Copies and checks the channels of a plugin. Refuses invalid ones. `who` is the start of the error
 * text. The table must not move in memory. */
CHECKED mrt_result channel_table_init(channel_table *out, const mrt_channel *channels,
                                      uint32_t count, const char *who, error *err);
/* Copies channels that are already checked. */
void channel_table_copy(channel_table *out, const mrt_channel *channels, uint32_t count);
/* Compares number, semantic, hand and unit of all channels, and the names of buttons and other
 * channels. If they differ, out_why (may be NULL) describes `b`, such as "18 channels instead of
 * 22". */
bool channel_table_equal(const channel_table *a, const channel_table *b, error *out_why);
bool channel_is_pedal(const mrt_channel *channel);
bool channel_is_angle(const mrt_channel *channel); /* a joint of one hand */
/* Returns whether an angle was computed from landmarks (MRT_UNIT_LANDMARKS). The unit is recorded
 * with a track, so that a take is replayed with the same filter. */
bool channel_is_of_landmarks(const mrt_channel *channel);

#endif
