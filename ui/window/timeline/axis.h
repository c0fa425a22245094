/* window/timeline/axis.h - the time axis of the timeline: conversion between time and x, zoom from
 * a day to a few samples, pan, paging with the playhead, timecode labels, and snapping of drags.
 * Pure; x in points. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_AXIS_H
#define MAROTTE_UI_WINDOW_TIMELINE_AXIS_H
#include "show/take.h"
#include "base/timecode.h"

#include <stdbool.h>
#include <stdint.h>

#define TIMELINE_SPAN_MIN_NS 200000.0         /* 10 samples of a sound */
#define TIMELINE_SPAN_MAX_NS 86400000000000.0 /* a day */

typedef struct timeline_axis {
    float x, width;  /* position and width on the screen; width > 0 */
    int64_t from_ns; /* time at x */
    double ns_per_point;
} timeline_axis;

/* Shows from..to, with a small margin on both sides. */
void timeline_axis_fit(timeline_axis *self, int64_t from_ns, int64_t to_ns);
/* Moves the axis to another part of the screen and keeps the time at its left end. */
void timeline_axis_set_extent(timeline_axis *self, float x, float width);

float timeline_axis_x(const timeline_axis *self, int64_t at_ns);
int64_t timeline_axis_ns(const timeline_axis *self, float x);
int64_t timeline_axis_until_ns(const timeline_axis *self); /* time at the right end */
int64_t timeline_axis_span_ns(const timeline_axis *self, float points);
float timeline_axis_points(const timeline_axis *self, int64_t span_ns);

/* Zooms around x, whose time stays in place. factor > 1: zooms in. */
void timeline_axis_zoom(timeline_axis *self, float x, double factor);
/* Pans. Positive: moves the content to the right. */
void timeline_axis_pan(timeline_axis *self, float points);
/* Keeps a part of low..high visible. */
void timeline_axis_hold(timeline_axis *self, int64_t low_ns, int64_t high_ns);
/* Scrolls by a page if the time is outside the axis. Returns true if it scrolled. */
bool timeline_axis_follow(timeline_axis *self, int64_t at_ns);

typedef struct timeline_code { /* timecode for labels */
    timecode_rate rate;
    int64_t first_frame; /* frame number at timeline 0 */
} timeline_code;
/* Returns the timecode of a take. A take without a rate uses 30 frames per second. NULL: no take.
 */
timeline_code timeline_code_of(const take *t);
/* Writes the timecode of the frame at a time: "01:02:03:04". */
void timeline_code_write(char out[TIMECODE_TEXT], const timeline_code *code, int64_t at_ns);

enum { TIMELINE_TICKS_MAX = 1024 };
typedef struct timeline_tick {
    int64_t at_ns;
    bool is_major;             /* has a label */
    char label[TIMECODE_TEXT]; /* "" */
} timeline_tick;
/* Computes the ticks. Labels are at least label_width apart. A label within a frame is the offset
 * from the frame: "+2.5 ms". Returns the number of ticks. */
uint32_t timeline_ticks(timeline_tick out[TIMELINE_TICKS_MAX], const timeline_axis *axis,
                        const timeline_code *code, float label_width);

typedef struct timeline_snap {
    const take *take;
    timeline_code code;
    int64_t head_ns;        /* INT64_MIN: none */
    int64_t in_ns, out_ns;  /* selected range; in >= out: none */
    int64_t reach_ns;       /* snap distance; <= 0: snapping is off, also to frames */
    int64_t beat_ns;        /* time between beats, or NS_PER_S: seconds; 0: neither */
    bool is_beat;           /* beat_ns is that of the click */
    uint32_t without_clip;  /* clip whose ends are ignored; 0: none */
    int32_t without_marker; /* -1: none */
} timeline_snap;

typedef enum timeline_target_kind {
    TIMELINE_TARGET_NONE = 0,
    TIMELINE_TARGET_FRAME,
    TIMELINE_TARGET_SECOND,
    TIMELINE_TARGET_BEAT,
    TIMELINE_TARGET_TAKE_START,
    TIMELINE_TARGET_TAKE_END,
    TIMELINE_TARGET_RANGE,
    TIMELINE_TARGET_CLIP_START,
    TIMELINE_TARGET_CLIP_END,
    TIMELINE_TARGET_MARKER,
    TIMELINE_TARGET_HEAD
} timeline_target_kind;
typedef struct timeline_target { /* what a drag has snapped to */
    timeline_target_kind kind;
    int64_t at_ns;
    uint32_t index; /* of the marker, or of the clip's layer */
} timeline_target;

/* Returns the snapped time. *out_to may be NULL. Seconds and beats are targets only where they are
 * several snap distances apart. */
int64_t timeline_snap_to(const timeline_snap *snap, int64_t at_ns, timeline_target *out_to);
/* Snaps a span of constant length by the end that is nearer to a target. Returns its new start. */
int64_t timeline_snap_span(const timeline_snap *snap, int64_t start_ns, int64_t length_ns,
                           timeline_target *out_to);
/* Writes "Snaps to marker 'cue'"; "" for none. */
void timeline_target_words(char out[128], const timeline_target *target, const take *t);

#endif
