#include "show/sound_rate.h"

#include <samplerate.h>
#include <stdlib.h>

/* PIECE_FRAMES: frames that are read or discarded in one call. REACH_FRAMES: more than the filter
 * needs on each side at the lower of the two rates. */
enum { PIECE_FRAMES = 512, REACH_FRAMES = 128 };

struct sound_rate {
    uint32_t from_hz, to_hz, channel_count;
    int64_t period_in, period_out; /* frames after which both rates are aligned again */
    sound_rate_source *source;
    void *data;
    SRC_STATE *filter;
    int64_t next_in, next_out;
    float *piece, *thrown_away; /* PIECE_FRAMES */
};

static long give_piece(void *data, float **out)
{
    sound_rate *self = data;
    self->source(self->data, self->next_in, self->piece, PIECE_FRAMES);
    self->next_in += PIECE_FRAMES;
    *out = self->piece;
    return PIECE_FRAMES;
}

static int64_t common_divisor(int64_t a, int64_t b)
{
    while (b != 0) {
        int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

mrt_result sound_rate_create(sound_rate **out, uint32_t from_hz, uint32_t to_hz,
                             uint32_t channel_count, sound_rate_source *source, void *data,
                             error *err)
{
    *out = NULL;
    if (from_hz == 0 || to_hz == 0 || !src_is_valid_ratio((double)to_hz / (double)from_hz))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "sound from %u Hz to %u Hz: at most 256 to 1 can be resampled", from_hz,
                         to_hz);
    sound_rate *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to resample sound");
    int64_t divisor = common_divisor(from_hz, to_hz);
    int failed = 0;
    *self = (sound_rate){.from_hz = from_hz,
                         .to_hz = to_hz,
                         .channel_count = channel_count,
                         .period_in = from_hz / divisor,
                         .period_out = to_hz / divisor,
                         .source = source,
                         .data = data,
                         .next_out = INT64_MIN};
    self->piece = calloc((size_t)PIECE_FRAMES * channel_count, sizeof *self->piece);
    self->thrown_away = calloc((size_t)PIECE_FRAMES * channel_count, sizeof *self->piece);
    self->filter =
        src_callback_new(give_piece, SRC_SINC_MEDIUM_QUALITY, (int)channel_count, &failed, self);
    if (self->piece && self->thrown_away && self->filter) {
        *out = self;
        return MRT_OK;
    }
    sound_rate_destroy(self);
    return error_set(err, MRT_ERR_MEMORY, "sound of %u channels cannot be resampled: %s",
                     channel_count, failed ? src_strerror(failed) : "no memory");
}

void sound_rate_destroy(sound_rate *self)
{
    if (!self)
        return;
    if (self->filter)
        src_delete(self->filter);
    free(self->piece);
    free(self->thrown_away);
    free(self);
}

/* Converts frames. The output is silent if the library fails, which happens only without memory. */
static void convert(sound_rate *self, float *out, size_t count)
{
    double ratio = (double)self->to_hz / (double)self->from_hz;
    size_t done = 0;
    while (done < count) {
        long got = src_callback_read(self->filter, ratio, (long)(count - done),
                                     out + done * self->channel_count);
        if (got <= 0)
            break;
        done += (size_t)got;
    }
    for (size_t i = done * self->channel_count; i < count * self->channel_count; ++i)
        out[i] = 0.0f;
    self->next_out += (int64_t)count;
}

/* Restarts the filter at a frame that exists at both rates, far enough before `frame` that earlier
 * frames have no effect. */
static void begin_before(sound_rate *self, int64_t frame)
{
    int64_t reach = REACH_FRAMES;
    if (self->to_hz > self->from_hz)
        reach = reach * self->to_hz / self->from_hz + 1;
    int64_t from = frame - reach, period = from / self->period_out;
    if (period * self->period_out > from)
        period -= 1;
    (void)src_reset(self->filter);
    self->next_in = period * self->period_in;
    self->next_out = period * self->period_out;
    while (self->next_out < frame) {
        int64_t left = frame - self->next_out;
        convert(self, self->thrown_away, left < PIECE_FRAMES ? (size_t)left : PIECE_FRAMES);
    }
}

void sound_rate_frames(sound_rate *self, int64_t first, float *out, size_t count)
{
    if (first != self->next_out)
        begin_before(self, first);
    convert(self, out, count);
}
