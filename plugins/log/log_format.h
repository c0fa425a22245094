/* log_format.h - what the two formats share: the record being read, and how a line is refused.
 * Private to the parser. */
#ifndef MAROTTE_LOG_FORMAT_H
#define MAROTTE_LOG_FORMAT_H
#include "log_parse.h"
#include "log_text.h"

typedef struct log_record {
    int64_t time_ns; /* of the file's own clock */
    float value[MRT_MAX_CHANNELS];
} log_record;

/* Radians beyond a whole turn are no joint's angle. */
#define LOG_ANGLE_MAX 6.2831853071795865

/* Adds a channel; `name` and `unit` are copied. */
void log_add_channel(log_data *data, const char *name, const char *unit, uint32_t semantic,
                     uint32_t hand);

/* Writes the reason and returns MRT_ERR_FORMAT. */
__attribute__((format(printf, 2, 3))) mrt_result log_refuse(char *out_reason, const char *format,
                                                            ...);

extern const char *const log_sensor_name[MRT_ANGLES]; /* "thumb.roll", in sensor order */

/* ---- log_table.c ---- */
typedef struct log_table {
    bool time_in_ns;
    double scale[MRT_MAX_CHANNELS]; /* from the file's unit to the channel's */
    double limit[MRT_MAX_CHANNELS]; /* largest magnitude, in the channel's unit */
    bool may_have_units;            /* no record has been seen yet */
} log_table;
mrt_result log_table_header(log_table *table, log_data *data, log_text line, char *out_reason);
/* A line that says the units. 0: it does not, it is a record. > 0: it did. < 0: refused. */
mrt_result log_table_units(log_table *table, log_data *data, log_text line, char *out_reason);
mrt_result log_table_record(log_table *table, const log_data *data, log_text line, log_record *out,
                            char *out_reason);

/* ---- log_recording.c ---- */
void log_recording_channels(log_data *data, uint32_t hand);
mrt_result log_recording_record(log_text line, log_record *out, char *out_reason);

#endif
