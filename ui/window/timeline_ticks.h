/* window/timeline_ticks.h - the time code along the axis: ticks as dense as can be read, from half
 * days over frames to fractions of a millisecond within one. Pure. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_TICKS_H
#define MAROTTE_UI_WINDOW_TIMELINE_TICKS_H
#include "take/take.h"
#include "take/timecode.h"
#include "window/timeline_axis.h"

typedef struct timeline_code { /* how instants are called */
    timecode_rate rate;
    int64_t first_frame; /* of timeline 0 */
} timeline_code;
/* A take without a rate is counted in 30 frames a second. NULL: no take. */
timeline_code timeline_code_of(const take *t);
/* "01:02:03:04" of the frame that is shown at an instant. */
void timeline_code_write(char out[TIMECODE_TEXT], const timeline_code *code, int64_t at_ns);

enum { TIMELINE_TICKS_MAX = 1024 };
typedef struct timeline_tick {
    int64_t at_ns;
    bool is_major;             /* has a label */
    char label[TIMECODE_TEXT]; /* "" */
} timeline_tick;
/* Labels are at least label_width apart, ticks some points. Within a frame the label says how far:
 * "+2.5 ms". Returns how many. */
uint32_t timeline_ticks(timeline_tick out[TIMELINE_TICKS_MAX], const timeline_axis *axis,
                        const timeline_code *code, float label_width);

#endif
