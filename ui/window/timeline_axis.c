#include "window/timeline_axis.h"

#include <math.h>

#define AIR  0.02 /* of the width, on both sides of what is fitted */
#define PAGE 0.08 /* where on the next page the play head comes */
#define SEEN 0.1  /* of the width, that shows something */

static double within(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static int64_t rounded(double ns)
{
    return (int64_t)floor(ns + 0.5);
}

static void set_scale(timeline_axis *self, double ns_per_point)
{
    double width = (double)self->width;
    self->ns_per_point =
        within(ns_per_point, TIMELINE_SPAN_MIN_NS / width, TIMELINE_SPAN_MAX_NS / width);
}

void timeline_axis_fit(timeline_axis *self, int64_t from_ns, int64_t to_ns)
{
    double span_ns = to_ns > from_ns ? (double)(to_ns - from_ns) : 1e9;
    set_scale(self, span_ns / ((1.0 - 2.0 * AIR) * (double)self->width));
    double spare_ns = self->ns_per_point * (double)self->width - span_ns;
    double left_ns = within(self->ns_per_point * (double)self->width * AIR, 0.0, spare_ns);
    self->from_ns = from_ns - rounded(left_ns);
}

void timeline_axis_place(timeline_axis *self, float x, float width)
{
    self->x = x;
    self->width = width > 1.0f ? width : 1.0f;
    set_scale(self, self->ns_per_point);
}

float timeline_axis_x(const timeline_axis *self, int64_t at_ns)
{
    return self->x + (float)((double)(at_ns - self->from_ns) / self->ns_per_point);
}

int64_t timeline_axis_ns(const timeline_axis *self, float x)
{
    return self->from_ns + rounded((double)(x - self->x) * self->ns_per_point);
}

int64_t timeline_axis_until_ns(const timeline_axis *self)
{
    return timeline_axis_ns(self, self->x + self->width);
}

int64_t timeline_axis_span_ns(const timeline_axis *self, float points)
{
    return rounded((double)points * self->ns_per_point);
}

void timeline_axis_zoom(timeline_axis *self, float x, double factor)
{
    int64_t about_ns = timeline_axis_ns(self, x);
    set_scale(self, self->ns_per_point / factor);
    self->from_ns = about_ns - rounded((double)(x - self->x) * self->ns_per_point);
}

void timeline_axis_pan(timeline_axis *self, float points)
{
    self->from_ns -= rounded((double)points * self->ns_per_point);
}

void timeline_axis_hold(timeline_axis *self, int64_t low_ns, int64_t high_ns)
{
    double span_ns = self->ns_per_point * (double)self->width;
    int64_t least_ns = low_ns - rounded((1.0 - SEEN) * span_ns);
    int64_t most_ns = high_ns - rounded(SEEN * span_ns);
    if (most_ns < low_ns - rounded(AIR * span_ns))
        most_ns = low_ns - rounded(AIR * span_ns);
    if (self->from_ns > most_ns)
        self->from_ns = most_ns;
    if (self->from_ns < least_ns)
        self->from_ns = least_ns;
}

bool timeline_axis_follow(timeline_axis *self, int64_t at_ns)
{
    float x = timeline_axis_x(self, at_ns);
    if (x >= self->x && x <= self->x + self->width)
        return false;
    self->from_ns = at_ns - rounded(PAGE * (double)self->width * self->ns_per_point);
    return true;
}
