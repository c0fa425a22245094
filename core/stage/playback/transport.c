#include "stage/playback/transport.h"

#include <math.h>

static int64_t within(int64_t value, int64_t low, int64_t high)
{
    if (value < low)
        return low;
    return value > high ? high : value;
}

void transport_init(transport *out, int64_t end_ns)
{
    *out = (transport){.speed = 1.0, .stops_at_end = true, .end_ns = end_ns};
}

/* At speed 1 the time stays exact for any length. */
static int64_t scaled(int64_t ns, double factor)
{
    if (!(fabs(factor - 1.0) > 0.0))
        return ns;
    return (int64_t)llround((double)ns * factor);
}

static bool loops_from(const transport *self, int64_t at_ns)
{
    return self->is_looping && at_ns < self->loop_out_ns;
}

transport_position transport_at(const transport *self, int64_t clock_ns)
{
    transport_position out = {self->at_ns, self->passes, false};
    int64_t passed_ns = clock_ns > self->clock_ns ? clock_ns - self->clock_ns : 0;
    if (!self->is_playing)
        return out;
    out.at_ns += scaled(passed_ns, self->speed);
    if (loops_from(self, self->at_ns) && out.at_ns >= self->loop_out_ns) {
        int64_t length_ns = self->loop_out_ns - self->loop_in_ns;
        int64_t beyond_ns = out.at_ns - self->loop_out_ns;
        out.pass += (uint32_t)(1 + beyond_ns / length_ns);
        out.at_ns = self->loop_in_ns + beyond_ns % length_ns;
    } else if (self->stops_at_end && out.at_ns >= self->end_ns && !loops_from(self, self->at_ns)) {
        out.at_ns = self->end_ns;
        out.has_stopped = true;
    }
    return out;
}

/* Makes the current position the new start of counting. */
static void hold(transport *self, int64_t clock_ns)
{
    transport_position now = transport_at(self, clock_ns);
    if (clock_ns > self->clock_ns)
        self->clock_ns = clock_ns;
    self->at_ns = now.at_ns;
    self->passes = now.pass;
}

void transport_play(transport *self, int64_t clock_ns)
{
    hold(self, clock_ns);
    if (self->is_looping && self->at_ns >= self->loop_out_ns)
        self->at_ns = self->loop_in_ns;
    else if (self->stops_at_end && self->at_ns >= self->end_ns)
        self->at_ns = 0;
    self->is_playing = true;
}

void transport_pause(transport *self, int64_t clock_ns)
{
    hold(self, clock_ns);
    self->is_playing = false;
}

void transport_seek(transport *self, int64_t clock_ns, int64_t at_ns)
{
    hold(self, clock_ns);
    self->at_ns = within(at_ns, 0, self->end_ns);
}

bool transport_set_speed(transport *self, int64_t clock_ns, double speed)
{
    if (!(speed >= TRANSPORT_SPEED_MIN && speed <= TRANSPORT_SPEED_MAX))
        return false;
    hold(self, clock_ns);
    self->speed = speed;
    return true;
}

bool transport_set_loop(transport *self, int64_t clock_ns, int64_t in_ns, int64_t out_ns)
{
    if (in_ns < 0 || in_ns >= out_ns)
        return false;
    hold(self, clock_ns);
    self->is_looping = true;
    self->loop_in_ns = in_ns;
    self->loop_out_ns = out_ns;
    return true;
}

void transport_end_loop(transport *self, int64_t clock_ns)
{
    hold(self, clock_ns);
    self->is_looping = false;
}

void transport_step_frames(transport *self, int64_t clock_ns, timecode_rate rate, int64_t frames)
{
    transport_pause(self, clock_ns);
    int64_t frame = timecode_frame(rate, self->at_ns) + frames;
    self->at_ns = within(timecode_time_ns(rate, frame), 0, self->end_ns);
}
