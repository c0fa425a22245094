#include "take/sound_render.h"
#include "take/sound_pcm.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HELD_FRAMES = 8192, BEHIND_FRAMES = 1024, CHANNELS_MAX = 64 };
/* Behind what is damaged it is tried again so much later. */
enum { DAMAGE_FRAMES = 256 };
static const double fade_s = 0.005;
static const double time_max_ns = 1e15;

struct sound_render {
    show *show;
    show_audio audio;
    sound_map map;
    sound_pcm format;
    double offset_ns;
    float gain;
    int64_t fade_frames;
    /* frames of the sound in memory */
    int64_t held_first, held_count;
    float *held;
    unsigned char *bytes;
    mrt_result trouble; /* of this call */
    error *err;
    /* where it is */
    int64_t next; /* frame of the timeline */
    bool is_sounding;
    int64_t piece_first;         /* of the piece that sounds */
    int64_t shift, shift_before; /* frame of the sound = frame of the timeline + shift */
    int64_t fade_left;
    uint64_t splice_count;
};

int64_t sound_render_frame(uint32_t rate_hz, int64_t at_ns)
{
    int64_t s = at_ns / 1000000000, ns = at_ns % 1000000000;
    return s * (int64_t)rate_hz + (int64_t)floor((double)ns * (double)rate_hz / 1e9 + 0.5);
}

/* ---- frames of the sound ---- */

static void hold(sound_render *self, int64_t frame)
{
    size_t channels = self->audio.channel_count, size = 0;
    size_t frame_size = channels * sound_pcm_bytes(self->format);
    self->held_first = frame > BEHIND_FRAMES ? frame - BEHIND_FRAMES : 0;
    self->held_count = HELD_FRAMES;
    for (size_t at = 0; at < HELD_FRAMES;) {
        error why = {""};
        mrt_result result = show_audio_read(
            self->show, self->audio.id, self->held_first + (int64_t)at,
            self->bytes + at * frame_size, (HELD_FRAMES - at) * frame_size, &size, &why);
        size_t got = size / frame_size;
        sound_pcm_unpack(self->held + at * channels, self->bytes + at * frame_size, got * channels,
                         self->format);
        at += got;
        if (result < 0 && self->trouble >= 0)
            self->trouble = error_set(self->err, result, "%s", why.text);
        size_t silent = result < 0 ? DAMAGE_FRAMES : HELD_FRAMES;
        silent = silent < HELD_FRAMES - at ? silent : HELD_FRAMES - at;
        memset(self->held + at * channels, 0, silent * channels * sizeof *self->held);
        at += silent;
    }
}

static const float *frame_at(sound_render *self, int64_t frame)
{
    static const float silence[CHANNELS_MAX] = {0};
    if (frame < 0 || frame >= self->map.frame_count)
        return silence;
    if (frame < self->held_first || frame >= self->held_first + self->held_count)
        hold(self, frame);
    return self->held + (size_t)(frame - self->held_first) * self->audio.channel_count;
}

/* Where frames were lost the sound fades out before and in behind; at its own ends it does not. */
static float edge(const sound_render *self, const sound_knot *knot, int64_t frame)
{
    int64_t into = frame - knot->piece_first + 1, left = knot->piece_end - frame;
    float gain = 1.0f, length = (float)self->fade_frames;
    if (frame < knot->piece_first || frame >= knot->piece_end)
        return 0.0f;
    if (knot->piece_first > 0 && into < self->fade_frames)
        gain = (float)into / length;
    if (knot->piece_end < self->map.frame_count && left < self->fade_frames)
        gain = fminf(gain, (float)left / length);
    return gain;
}

/* ---- frames of the timeline ---- */

/* Of frame n; `stretch` is exactly 0 for a sound that runs at its rate, so the shift is constant
 * then, and monotone in n otherwise: rounding it never goes to and fro. */
static int64_t shift_at(const sound_render *self, const sound_knot *knot, int64_t n)
{
    double nominal_ns = 1e9 / (double)self->audio.rate_hz;
    double stretch = nominal_ns / knot->ns_per_frame - 1.0;
    double start = (double)knot->frame - (self->offset_ns + knot->time_ns) / knot->ns_per_frame;
    return (int64_t)floor(start + (double)n * stretch + 0.5);
}

static void follow(sound_render *self, const sound_knot *knot, int64_t shift)
{
    if (!self->is_sounding || self->piece_first != knot->piece_first) {
        self->fade_left = 0;
    } else if (shift != self->shift) {
        self->shift_before = self->shift;
        self->fade_left = self->fade_frames;
        self->splice_count += (uint64_t)llabs(shift - self->shift);
    }
    self->shift = shift;
    self->piece_first = knot->piece_first;
    self->is_sounding = true;
}

static void mix(sound_render *self, const sound_knot *knot, int64_t n, float *out)
{
    uint32_t channels = self->audio.channel_count;
    float before = 0.0f;
    if (self->fade_left > 0) {
        before = (float)self->fade_left / (float)(self->fade_frames + 1);
        const float *old = frame_at(self, n + self->shift_before);
        float old_gain = self->gain * before * edge(self, knot, n + self->shift_before);
        for (uint32_t c = 0; c < channels; ++c)
            out[c] = old_gain * old[c];
        self->fade_left -= 1;
    }
    const float *now = frame_at(self, n + self->shift);
    float gain = self->gain * (1.0f - before) * edge(self, knot, n + self->shift);
    for (uint32_t c = 0; c < channels; ++c)
        out[c] += gain * now[c];
}

/* `out` NULL: only to come to know where it is. */
static void render_frame(sound_render *self, int64_t n, float *out)
{
    double time_ns = (double)n * (1e9 / (double)self->audio.rate_hz) - self->offset_ns;
    const sound_knot *knot = sound_map_knot_at(&self->map, time_ns);
    int64_t shift = shift_at(self, knot, n);
    if (n + shift < knot->piece_first || n + shift >= knot->piece_end) {
        self->is_sounding = false;
        return;
    }
    follow(self, knot, shift);
    if (out)
        mix(self, knot, n, out);
    else if (self->fade_left > 0)
        self->fade_left -= 1;
}

/* A cross-fade may be going on at n: it began at most its length ago. */
static void come_to(sound_render *self, int64_t n)
{
    uint64_t count = self->splice_count;
    self->is_sounding = false;
    for (int64_t i = n - self->fade_frames - 1; i < n; ++i)
        render_frame(self, i, NULL);
    self->splice_count = count;
}

mrt_result sound_render_frames(sound_render *self, int64_t first, float *out, size_t count,
                               error *err)
{
    memset(out, 0, count * self->audio.channel_count * sizeof *out);
    self->trouble = MRT_OK;
    self->err = err;
    if (fabs((double)first) / (double)self->audio.rate_hz * 1e9 > time_max_ns)
        return MRT_OK;
    if (first != self->next && !sound_map_is_plain(&self->map))
        come_to(self, first);
    else if (first != self->next)
        self->is_sounding = false;
    for (size_t i = 0; i < count; ++i)
        render_frame(self, first + (int64_t)i, out + i * self->audio.channel_count);
    self->next = first + (int64_t)count;
    self->err = NULL;
    return self->trouble;
}

/* ---- life ---- */

static mrt_result check(const sound_render *self, const take_audio *audio, error *err)
{
    if (!isfinite(audio->gain) || fabs(audio->gain) > 1000.0 ||
        fabs((double)audio->offset_ns) > time_max_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: sound %lld with a gain of %g at %g s: nonsense",
                         show_path(self->show), (long long)audio->audio, audio->gain,
                         (double)audio->offset_ns / 1e9);
    return MRT_OK;
}

mrt_result sound_render_create(sound_render **out, show *s, const take_audio *audio, error *err)
{
    *out = NULL;
    sound_render *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a sound");
    self->show = s;
    self->offset_ns = (double)audio->offset_ns;
    self->gain = (float)audio->gain;
    mrt_result result = check(self, audio, err);
    if (result >= 0)
        result = show_audio_info(s, audio->audio, &self->audio, err);
    if (result >= 0)
        result = sound_map_read(&self->map, s, &self->audio, err);
    if (result < 0)
        goto fail;
    self->format = sound_pcm_of(self->audio.format);
    self->fade_frames = (int64_t)(fade_s * (double)self->audio.rate_hz) + 1;
    self->next = INT64_MIN;
    size_t samples = (size_t)HELD_FRAMES * self->audio.channel_count;
    self->held = malloc(samples * sizeof *self->held);
    self->bytes = malloc(samples * sound_pcm_bytes(self->format));
    if (!self->held || !self->bytes) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a sound");
        goto fail;
    }
    *out = self;
    return MRT_OK;
fail:
    sound_render_destroy(self);
    return result;
}

void sound_render_destroy(sound_render *self)
{
    if (!self)
        return;
    sound_map_finish(&self->map);
    free(self->held);
    free(self->bytes);
    free(self);
}

const show_audio *sound_render_audio(const sound_render *self)
{
    return &self->audio;
}

const sound_map *sound_render_map(const sound_render *self)
{
    return &self->map;
}

uint64_t sound_render_splice_count(const sound_render *self)
{
    return self->splice_count;
}
