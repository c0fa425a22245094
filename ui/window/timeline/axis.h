/* window/timeline/axis.h - the time axis of the timeline: which instant lies where across the
 * screen, zoom from a day to some samples, pan, following the play head by pages; the time code
 * that is written along it; and to which instant a drag snaps. Pure; x in points. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_AXIS_H
#define MAROTTE_UI_WINDOW_TIMELINE_AXIS_H
#include "show/take.h"
#include "base/timecode.h"

#include <stdbool.h>
#include <stdint.h>

#define TIMELINE_SPAN_MIN_NS 200000.0         /* 10 samples of a sound */
#define TIMELINE_SPAN_MAX_NS 86400000000000.0 /* a day */

typedef struct timeline_axis {
    float x, width;  /* where it lies; width > 0 */
    int64_t from_ns; /* at x */
    double ns_per_point;
} timeline_axis;

/* Shows from..to, with a little air on both sides. */
void timeline_axis_fit(timeline_axis *self, int64_t from_ns, int64_t to_ns);
/* The same instants on another part of the screen: those at its left stay. */
void timeline_axis_set_extent(timeline_axis *self, float x, float width);

float timeline_axis_x(const timeline_axis *self, int64_t at_ns);
int64_t timeline_axis_ns(const timeline_axis *self, float x);
int64_t timeline_axis_until_ns(const timeline_axis *self); /* at its right end */
int64_t timeline_axis_span_ns(const timeline_axis *self, float points);
float timeline_axis_points(const timeline_axis *self, int64_t span_ns);

/* factor > 1: shows less. What is at x stays there. */
void timeline_axis_zoom(timeline_axis *self, float x, double factor);
/* Positive: what is shown moves to the right. */
void timeline_axis_pan(timeline_axis *self, float points);
/* Keeps something of low..high in sight. */
void timeline_axis_hold(timeline_axis *self, int64_t low_ns, int64_t high_ns);
/* Scrolls by a page when the instant has left the axis; true: it did. */
bool timeline_axis_follow(timeline_axis *self, int64_t at_ns);

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

typedef struct timeline_snap {
    const take *take;
    timeline_code code;
    int64_t head_ns;        /* INT64_MIN: none */
    int64_t in_ns, out_ns;  /* the range; in >= out: none */
    int64_t reach_ns;       /* how near things are that draw; <= 0: nothing does, nor the grid */
    uint32_t without_clip;  /* its ends do not draw; 0 */
    int32_t without_marker; /* -1 */
} timeline_snap;

/* *out_to (may be NULL): the thing that it was drawn to, to be shown; INT64_MIN: none or the grid.
 */
int64_t timeline_snap_to(const timeline_snap *snap, int64_t at_ns, int64_t *out_to);
/* A span that keeps its length: by whichever end is nearer to something. The start comes back. */
int64_t timeline_snap_span(const timeline_snap *snap, int64_t start_ns, int64_t length_ns,
                           int64_t *out_to);

#endif
