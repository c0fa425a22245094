/* log_parse.h - a recorded performance out of the bytes of a file: records in time order, one value
 * per channel. Two formats (README.md): the log table (log_table.c) and the recordings of
 * GraspDB14 (log_recording.c). Damaged lines are skipped and counted; what cannot be a log is
 * refused. Reads no file and keeps no time. Pure but for malloc; [main]. */
#ifndef MAROTTE_LOG_PARSE_H
#define MAROTTE_LOG_PARSE_H
#include <marotte/plugin.h>

#include "log_text.h"

enum { LOG_NAME = 40 };

/* Not to be copied: the channels point at the names within. */
typedef struct log_data {
    uint32_t channel_count;
    bool is_hand_assumed; /* the file does not say whose hand it shows */
    mrt_channel channel[MRT_MAX_CHANNELS];
    char name[MRT_MAX_CHANNELS][LOG_NAME + 1]; /* "left.": a letter more when it is mirrored */
    char unit[MRT_MAX_CHANNELS][LOG_NAME];
    size_t record_count;
    int64_t *time_ns; /* of the record, from the first one on; never decreasing; owned */
    float *value;     /* record_count by channel_count; owned */
    size_t damaged_count;
    size_t first_damaged_line;     /* counted from 1; 0: none is damaged */
    char first_damage[LOG_REASON]; /* what is wrong with it */
} log_data;

/* `hand` (MRT_LEFT or MRT_RIGHT) is whose hand a recording without a name for it shows. On failure
 * `out` is zeroed and `out_reason` (LOG_REASON bytes) says what was expected. Either way,
 * log_data_finish may be called. */
mrt_result log_parse(log_data *out, const void *bytes, size_t size, uint32_t hand,
                     char *out_reason);
/* The recording as the other hand's, in a mirror at x = 0: sides change and so does a tracked
 * wrist; the angles of joints are the same in both hands. Twice gives it back, bit for bit. */
void log_mirror(log_data *data);
void log_data_finish(log_data *data);

#endif
