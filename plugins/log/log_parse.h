/* log/log_parse.h - parser of recorded hands: text in marotte's table format or in the format of
 * GraspDB14, read line by line into samples. One thread. */
#ifndef PLUGINS_LOG_PARSE_H
#define PLUGINS_LOG_PARSE_H
#include <marotte/plugin.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LOG_REASON = 200 }; /* bytes of a reason for a rejection */

typedef struct log_text {
    const char *at, *end;
} log_text;

/* The whole text must be one decimal number of fewer than LOG_NUMBER letters:
 * [+-]digits[.digits][e[+-]digits]. Its magnitude must be below 1e30. */
enum { LOG_NUMBER = 128 };
bool log_text_number(log_text text, double *out);

/* ---- a log ---- */

enum { LOG_NAME = 40 };

/* Must not be copied: the channels point to the names inside. */
typedef struct log_data {
    uint32_t channel_count;
    bool is_hand_assumed; /* the file does not name the hand */
    mrt_channel channel[MRT_MAX_CHANNELS];
    char name[MRT_MAX_CHANNELS]
             [LOG_NAME + 1]; /* + 1: "left." has one letter more than "right." after mirroring */
    char unit[MRT_MAX_CHANNELS][LOG_NAME];
    size_t record_count;
    int64_t *time_ns; /* time of each record since the first one; never decreasing; owned */
    float *value;     /* record_count by channel_count; owned */
    size_t damaged_count;
    size_t first_damaged_line;     /* counted from 1; 0: none is damaged */
    char first_damage[LOG_REASON]; /* reason */
} log_data;

/* Parses a log. `hand` (MRT_LEFT or MRT_RIGHT): the hand of a recording that does not name it. On
 * failure `out` is zeroed and `out_reason` (LOG_REASON bytes) names what was expected.
 * log_data_finish may be called in both cases. */
mrt_result log_parse(log_data *out, const void *bytes, size_t size, uint32_t hand,
                     char *out_reason);
/* Mirrors the recording at x = 0: swaps the sides and mirrors a tracked wrist; joint angles are the
 * same in both hands. Mirroring twice restores the recording bit for bit. */
void log_mirror(log_data *data);
void log_data_finish(log_data *data);

/* ---- reading a file ---- */

enum { LOG_FILE_MAX_MIB = 128 };

typedef struct log_file {
    unsigned char *data; /* owned: free() it */
    size_t size;
} log_file;

/* Reads a file. Rejects pipes, devices and other files that are not regular, so it never waits for
 * one. out_reason: LOG_REASON bytes. */
mrt_result log_file_read(log_file *out, const char *path, char *out_reason);

#endif
