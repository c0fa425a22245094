/* log/log_parse.h - recordings of hands as text: a table of ours or a recording of others, read
 * line by line into samples. One thread. */
#ifndef PLUGINS_LOG_PARSE_H
#define PLUGINS_LOG_PARSE_H
#include <marotte/plugin.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LOG_REASON = 200 }; /* bytes of a text that says why something is refused */

typedef struct log_text {
    const char *at, *end;
} log_text;

/* The whole text must be one decimal number of fewer than LOG_NUMBER letters:
 * [+-]digits[.digits][e[+-]digits]. Its magnitude must be below 1e30. */
enum { LOG_NUMBER = 128 };
bool log_text_number(log_text text, double *out);

/* ---- a log ---- */

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

/* ---- as a file ---- */

enum { LOG_FILE_MAX_MIB = 128 };

typedef struct log_file {
    unsigned char *data; /* owned: free() it */
    size_t size;
} log_file;

/* Never waits for a pipe or a device: what is no regular file is refused. out_reason:
 * LOG_REASON bytes. */
mrt_result log_file_read(log_file *out, const char *path, char *out_reason);

#endif
