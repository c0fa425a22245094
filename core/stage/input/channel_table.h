/* stage/input/channel_table.h - what an input's channels mean, as a copy that outlives the device:
 * the plugin's own description is gone while it is closed. Pure functions; any thread. */
#ifndef MAROTTE_STAGE_CHANNEL_TABLE_H
#define MAROTTE_STAGE_CHANNEL_TABLE_H
#include "base/error.h"

enum { CHANNEL_NAME = 48, CHANNEL_UNIT = 16 };
typedef struct channel_table {
    uint32_t count;
    mrt_channel channel[MRT_MAX_CHANNELS]; /* names and units lie in the two arrays below */
    char name[MRT_MAX_CHANNELS][CHANNEL_NAME], unit[MRT_MAX_CHANNELS][CHANNEL_UNIT];
} channel_table;

/* Refuses what a plugin may not say; `who` begins the error's text. The table must not move. */
CHECKED mrt_result channel_table_init(channel_table *out, const mrt_channel *channels,
                                      uint32_t count, const char *who, error *err);
/* Of channels that were checked already. */
void channel_table_copy(channel_table *out, const mrt_channel *channels, uint32_t count);
/* Same number and meaning: semantic, hand and unit of each, and the names of those that are told
 * apart by name. If not, out_why (may be NULL) says what
 * `b` has: "18 channels instead of 22". */
bool channel_table_equal(const channel_table *a, const channel_table *b, error *out_why);
bool channel_is_pedal(const mrt_channel *channel);
bool channel_is_angle(const mrt_channel *channel); /* of a joint of one hand */
/* Of an angle: it was read from landmarks (MRT_UNIT_LANDMARKS). The unit is recorded with a track,
 * so a take is replayed through the filter that it was performed with. */
bool channel_is_of_landmarks(const mrt_channel *channel);

#endif
