/* window/timeline_axis.h - the time axis of the timeline: which instant lies where across the
 * screen, zoom from a day to some samples, pan, following the play head by pages. Leaves out what
 * is written along it (timeline_ticks.h). Pure; x in points. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_AXIS_H
#define MAROTTE_UI_WINDOW_TIMELINE_AXIS_H
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
void timeline_axis_place(timeline_axis *self, float x, float width);

float timeline_axis_x(const timeline_axis *self, int64_t at_ns);
int64_t timeline_axis_ns(const timeline_axis *self, float x);
int64_t timeline_axis_until_ns(const timeline_axis *self); /* at its right end */
int64_t timeline_axis_span_ns(const timeline_axis *self, float points);

/* factor > 1: shows less. What is at x stays there. */
void timeline_axis_zoom(timeline_axis *self, float x, double factor);
/* Positive: what is shown moves to the right. */
void timeline_axis_pan(timeline_axis *self, float points);
/* Keeps something of low..high in sight. */
void timeline_axis_hold(timeline_axis *self, int64_t low_ns, int64_t high_ns);
/* Turns the page when an instant has left it; true: it did. */
bool timeline_axis_follow(timeline_axis *self, int64_t at_ns);

#endif
