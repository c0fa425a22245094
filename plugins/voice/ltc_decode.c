#include "ltc_decode.h"

#include <math.h>
#include <string.h>

enum { BITS = 80, SYNC = 0xbffc /* bits 64 to 79, the first one lowest */ };
/* Consecutive frames before their rate is reported, and maximum number of frames in the mean
 * length. */
enum { RATE_AFTER = 8, MEAN_OF = 50 };
static const double slowest_fps = 12.0, fastest_fps = 60.0;
static const double rates[] = {24000.0 / 1001.0, 24.0, 25.0, 30000.0 / 1001.0, 30.0};

void ltc_decoder_init(ltc_decoder *self, double sample_rate_hz)
{
    *self = (ltc_decoder){.sample_rate_hz = sample_rate_hz, .frame_end = -1.0};
}

/* ---- from sound to zero crossings ---- */

/* The threshold is the middle of the sound's recent range, with a hysteresis of a tenth of the
 * range. */
static bool find_crossing(ltc_decoder *self, double sample, double *out_at)
{
    const double decay = 1.0 - 60.0 / self->sample_rate_hz;
    self->high = sample > self->high ? sample : sample + (self->high - sample) * decay;
    self->low = sample < self->low ? sample : sample + (self->low - sample) * decay;
    const double middle = 0.5 * (self->high + self->low), swing = self->high - self->low;
    const double before = self->last;
    const bool is_high = sample > middle + (self->is_high ? -0.1 : 0.1) * swing;
    const bool crosses = is_high != self->is_high && swing > 1e-3;
    self->last = sample;
    self->is_high = is_high;
    if (!crosses)
        return false;
    const double part = sample != before ? (middle - before) / (sample - before) : 1.0;
    *out_at = (double)self->sample - 1.0 + fmin(fmax(part, 0.0), 1.0);
    return true;
}

/* ---- from crossings to bits ---- */

static void forget(ltc_decoder *self)
{
    self->count = 0;
    self->has_half = false;
    self->frame_end = -1.0;
    self->length_count = 0;
}

static void push(ltc_decoder *self, bool bit)
{
    for (int i = 0; i < 9; ++i)
        self->bits[i] = (uint8_t)(self->bits[i] >> 1 | self->bits[i + 1] << 7);
    self->bits[9] = (uint8_t)(self->bits[9] >> 1 | bit << 7);
    self->count += self->count < BITS;
    self->has_half = false;
}

/* A cell without a crossing inside is 0, a cell with one is 1. Returns true if a bit is
 * complete. */
static bool take_span(ltc_decoder *self, double span)
{
    const double longest = self->sample_rate_hz / (slowest_fps * BITS);
    const double shortest = 0.5 * self->sample_rate_hz / (fastest_fps * BITS);
    if (span > 1.5 * longest || span < 0.5 * shortest) {
        self->cell = 0.0;
        forget(self);
        return false;
    }
    if (self->cell == 0.0)
        self->cell = span;
    /* The first span may have been half a cell. */
    if (span > 1.5 * self->cell) {
        self->cell = span;
        forget(self);
    }
    const bool is_half = span < 0.75 * self->cell;
    self->cell += 0.1 * ((is_half ? 2.0 * span : span) - self->cell);
    if (is_half && !self->has_half) {
        self->has_half = true;
        return false;
    }
    if (!is_half && self->has_half) { /* out of step */
        forget(self);
        return false;
    }
    push(self, is_half);
    return true;
}

/* ---- from bits to frames ---- */

static uint32_t field(const ltc_decoder *self, uint32_t first, uint32_t count)
{
    uint32_t out = 0;
    for (uint32_t i = 0; i < count; ++i)
        out |= (uint32_t)(self->bits[(first + i) / 8] >> (first + i) % 8 & 1) << i;
    return out;
}

static bool has_sync(const ltc_decoder *self)
{
    return self->count == BITS && (self->bits[8] | self->bits[9] << 8) == SYNC;
}

static void measure(ltc_decoder *self, double end, int32_t label)
{
    const bool follows = self->frame_end >= 0.0 && label != self->label;
    const double length = end - self->frame_end;
    self->label = label;
    if (!follows) {
        self->length_count = 0;
        return;
    }
    self->length_count += self->length_count < MEAN_OF;
    const double weight = 1.0 / (double)self->length_count;
    self->length =
        self->length_count == 1 ? length : self->length + weight * (length - self->length);
}

static double nearest_rate(double fps)
{
    double best = rates[0];
    for (size_t i = 1; i < sizeof rates / sizeof *rates; ++i)
        if (fabs(rates[i] - fps) < fabs(best - fps))
            best = rates[i];
    return best;
}

static bool read_frame(ltc_decoder *self, double end, ltc_frame *out)
{
    const uint32_t frame = field(self, 0, 4) + 10 * field(self, 8, 2);
    const uint32_t second = field(self, 16, 4) + 10 * field(self, 24, 3);
    const uint32_t minute = field(self, 32, 4) + 10 * field(self, 40, 3);
    const uint32_t hour = field(self, 48, 4) + 10 * field(self, 56, 2);
    const bool is_drop = field(self, 10, 1) != 0;
    const double start = self->frame_end;
    if (frame > 29 || second > 59 || minute > 59 || hour > 23) {
        forget(self);
        return false;
    }
    const int32_t label = (int32_t)(((hour * 60 + minute) * 60 + second) * 30 + frame);
    measure(self, end, label);
    self->frame_end = end;
    if (self->length_count < RATE_AFTER)
        return false;
    const double fps = nearest_rate(self->sample_rate_hz / self->length);
    const uint32_t nominal = (uint32_t)ceil(fps), minutes = hour * 60 + minute;
    *out =
        (ltc_frame){.rate = is_drop ? rates[3] : fps,
                    .is_drop = is_drop,
                    .start_sample = start,
                    .length = self->length,
                    .frame = (int32_t)((minutes * 60 + second) * (is_drop ? 30 : nominal) + frame)};
    if (is_drop)
        out->frame -= (int32_t)(2 * (minutes - minutes / 10));
    return true;
}

bool ltc_decoder_add_sample(ltc_decoder *self, double sample, ltc_frame *out)
{
    double at;
    bool is_whole = false;
    self->sample += 1;
    if (find_crossing(self, sample, &at)) {
        if (take_span(self, at - self->crossing) && has_sync(self))
            is_whole = read_frame(self, at, out);
        self->crossing = at;
    }
    return is_whole;
}
