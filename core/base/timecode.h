/* base/timecode.h - frame rates and time code. Frame k begins at the first whole ns that is not
 * before k / rate. So frames and times convert exactly in both directions, without drift at any
 * length. Integer arithmetic. Pure. [any] */
#ifndef MAROTTE_BASE_TIMECODE_H
#define MAROTTE_BASE_TIMECODE_H
#include "base/error.h"

typedef struct timecode_rate { /* num / den frames a second, in lowest terms */
    uint32_t num, den;
    bool is_drop; /* labels skip frames to follow the clock: only 29.97 and 59.94 */
} timecode_rate;

#define TIMECODE_FPS_MIN 1.0
#define TIMECODE_FPS_MAX 1000.0
enum { TIMECODE_TEXT = 32 };

/* Converts a decimal rate. 23.976, 29.97, 47.95, 59.94 and 119.88 become 24000/1001 and so on;
 * other rates keep three decimals. Not drop-frame. */
CHECKED mrt_result timecode_rate_of(timecode_rate *out, double fps, error *err);
/* Parses "25", "29.97", "30000/1001", and "29.97df" for drop-frame. */
CHECKED mrt_result timecode_rate_parse(timecode_rate *out, const char *text, error *err);
double timecode_fps(timecode_rate rate);
/* Returns whether this rate has drop-frame labels. */
bool timecode_can_drop(timecode_rate rate);

/* Times within +-1e15 ns, frames within +-1e12. */
int64_t timecode_time_ns(timecode_rate rate, int64_t frame);
/* Returns the frame that is shown at a time: the last one that starts at or before it. */
int64_t timecode_frame(timecode_rate rate, int64_t time_ns);
/* Returns the frame with the closest start; of two the earlier. */
int64_t timecode_nearest_frame(timecode_rate rate, int64_t time_ns);

/* Writes "01:02:03:04", "01:02:03;04" for drop-frame, with "-" for negative frames. Hours are not
 * wrapped. */
void timecode_write(char out[TIMECODE_TEXT], timecode_rate rate, int64_t frame);
/* Parses a label. ';' is required for drop-frame, and an error otherwise. Skipped labels are
 * errors. */
CHECKED mrt_result timecode_parse(int64_t *out_frame, timecode_rate rate, const char *text,
                                  error *err);

#endif
