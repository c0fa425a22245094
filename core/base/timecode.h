/* base/timecode.h - frame rates and time code. Frame k begins at the first whole ns that is not
 * before k / rate, so that frames and times convert exactly, both ways, without drift at any
 * length. Integer arithmetic. Pure functions; any thread. */
#ifndef MAROTTE_BASE_TIMECODE_H
#define MAROTTE_BASE_TIMECODE_H
#include "base/error.h"

typedef struct timecode_rate { /* num / den frames a second, in lowest terms */
    uint32_t num, den;
    bool is_drop; /* labels leave out frames to keep up with the clock: 29.97 and 59.94 only */
} timecode_rate;

#define TIMECODE_FPS_MIN 1.0
#define TIMECODE_FPS_MAX 1000.0
enum { TIMECODE_TEXT = 32 };

/* 23.976, 29.97, 47.95, 59.94, 119.88 are meant as 24000/1001 ...; other rates are taken to three
 * decimals. Not drop-frame. */
CHECKED mrt_result timecode_rate_of(timecode_rate *out, double fps, error *err);
/* "25", "29.97", "30000/1001", and "29.97df" for drop-frame. */
CHECKED mrt_result timecode_rate_parse(timecode_rate *out, const char *text, error *err);
double timecode_fps(timecode_rate rate);
/* Whether there are drop-frame labels at this rate. */
bool timecode_can_drop(timecode_rate rate);

/* Times within +-1e15 ns, frames within +-1e12. */
int64_t timecode_time_ns(timecode_rate rate, int64_t frame);
/* The frame that is shown at a time: its start is not after it. */
int64_t timecode_frame(timecode_rate rate, int64_t time_ns);
/* The frame whose start is closest; of two the earlier. */
int64_t timecode_nearest_frame(timecode_rate rate, int64_t time_ns);

/* "01:02:03:04", "01:02:03;04" for drop-frame, "-" before negative ones; hours are not wrapped. */
void timecode_write(char out[TIMECODE_TEXT], timecode_rate rate, int64_t frame);
/* The ';' must be there for drop-frame and only then; labels that are left out are refused. */
CHECKED mrt_result timecode_parse(int64_t *out_frame, timecode_rate rate, const char *text,
                                  error *err);

#endif
