#include "stage/sound/sound_click.h"

#include <math.h>

static const double click_s = 0.03, beat_hz = 1000.0, bar_hz = 1600.0, loudness = 0.5;
/* A beat that is farther behind than that was passed over: by a jump, or the end of a loop. */
static const double late_ns = 5e6;

void sound_click_reset(sound_click *self, uint32_t rate_hz)
{
    sound_clock_init(&self->clock, (double)rate_hz);
    self->rate_hz = rate_hz;
    self->device_frame = 0;
    self->left = 0;
    self->beat = INT64_MIN;
}

static void look_for_motion(sound_click *self)
{
    sound_motion newest;
    if (!sound_board_read(self->board, &newest) || newest.revision == self->motion.revision)
        return;
    self->motion = newest;
    self->beat = INT64_MIN;
}

static bool is_heard(const sound_motion *motion, double since_ns)
{
    const uint32_t when = since_ns < 0.0 ? SOUND_BEATS_BEFORE : SOUND_BEATS_AFTER;
    return motion->revision != 0 && motion->speed == 1.0 && motion->beat_ns > 0.0 &&
           (motion->beats & when) != 0;
}

/* Of the timeline, when so much of the host's time has passed since the motion began. */
static double at_of(const sound_motion *motion, double since_ns)
{
    const double at_ns = (double)motion->at_ns + since_ns;
    const double lap_ns = (double)(motion->loop_to_ns - motion->loop_from_ns);
    if (lap_ns <= 0.0 || motion->at_ns >= motion->loop_to_ns || at_ns < (double)motion->loop_to_ns)
        return at_ns;
    return (double)motion->loop_from_ns + fmod(at_ns - (double)motion->loop_to_ns, lap_ns);
}

static void begin(sound_click *self)
{
    const int64_t bar = self->motion.bar > 0 ? self->motion.bar : 1;
    const double hz = self->beat % bar == 0 ? bar_hz : beat_hz;
    self->left = (uint32_t)(click_s * (double)self->rate_hz);
    self->phase = 0.0;
    self->step = 2.0 * 3.14159265358979323846 * hz / (double)self->rate_hz;
    atomic_fetch_add_explicit(&self->count, 1, memory_order_relaxed);
}

/* Each beat once, also where the device's clock is set a little. */
static void look_for_beat(sound_click *self, double since_ns)
{
    const double at_ns = at_of(&self->motion, since_ns);
    const int64_t beat = (int64_t)floor(at_ns / self->motion.beat_ns);
    const bool is_another = beat != self->beat || at_ns < self->at_ns - late_ns;
    self->at_ns = at_ns;
    self->beat = beat;
    if (is_another && self->left == 0 && at_ns - (double)beat * self->motion.beat_ns < late_ns)
        begin(self);
}

static void put(sound_click *self, float *out, uint32_t channels)
{
    const double fades = (double)self->left / (click_s * (double)self->rate_hz);
    const float sample = (float)(loudness * fades * fades * sin(self->phase));
    for (uint32_t c = 0; c < channels && c < 2; ++c)
        out[c] = fminf(1.0f, fmaxf(-1.0f, out[c] + sample));
    self->phase += self->step;
    self->left -= 1;
}

void sound_click_add(sound_click *self, float *out, uint32_t count, uint32_t channels,
                     int64_t time_ns, sound_break is_broken)
{
    if (is_broken == SOUND_BROKEN)
        sound_clock_break(&self->clock, self->device_frame, time_ns);
    else
        (void)sound_clock_block(&self->clock, self->device_frame, time_ns);
    look_for_motion(self);
    const int64_t first_ns = sound_clock_time_ns(&self->clock, self->device_frame);
    const double step_ns = (1.0 + self->clock.stretch) * 1e9 / (double)self->rate_hz;
    double since_ns = (double)(first_ns - self->motion.host_ns);
    for (uint32_t i = 0; i < count; ++i, since_ns += step_ns) {
        if (is_heard(&self->motion, since_ns))
            look_for_beat(self, since_ns);
        if (self->left > 0)
            put(self, out + (size_t)i * channels, channels);
    }
    self->device_frame += count;
}
