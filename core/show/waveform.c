#include "show/waveform.h"
#include "show/sound_pcm.h"

#include <stdlib.h>
#include <string.h>

/* Each kept pair covers 2^bits frames. If there are too many pairs, each covers twice as many
 * frames. */
enum { FINEST_BITS = 8, PAIRS_MAX = 1 << 20, READ_SAMPLES = 32768, SKIPPED_FRAMES = 256 };

struct waveform {
    show_audio audio;
    sound_pcm format;
    uint32_t bits;
    waveform_pair *pair;
    size_t count, room;
    int64_t known;
    size_t pairs_max, read_frames;
    unsigned char *bytes;
    float *samples;
};

/* ---- pairs ---- */

static void widen(waveform_pair *pair, const waveform_pair *by)
{
    if (by->least < pair->least)
        pair->least = by->least;
    if (by->greatest > pair->greatest)
        pair->greatest = by->greatest;
}

static waveform_pair pair_of(const float *samples, size_t count)
{
    waveform_pair pair = {samples[0], samples[0]};
    for (size_t i = 1; i < count; ++i)
        widen(&pair, &(waveform_pair){samples[i], samples[i]});
    return pair;
}

/* Appends to a list. */
static void put(waveform_pair *list, size_t *count, size_t at, const waveform_pair *pair)
{
    if (at < *count) {
        widen(&list[at], pair);
    } else {
        list[at] = *pair;
        *count = at + 1;
    }
}

static void coarsen(waveform *self)
{
    size_t count = 0;
    for (size_t i = 0; i < self->count; ++i)
        put(self->pair, &count, i / 2, &self->pair[i]);
    self->count = count;
    self->bits += 1;
}

static mrt_result fit(waveform *self, int64_t frames, error *err)
{
    while ((frames >> self->bits) >= (int64_t)self->pairs_max)
        coarsen(self);
    size_t count = (size_t)((frames - 1) >> self->bits) + 1;
    if (count <= self->room)
        return MRT_OK;
    size_t room = self->room ? 2 * self->room : 64;
    while (room < count)
        room *= 2;
    waveform_pair *larger = realloc(self->pair, room * sizeof *larger);
    if (!larger)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the outline of a sound");
    self->pair = larger;
    self->room = room;
    return MRT_OK;
}

/* ---- growing ---- */

static void add(waveform *self, const float *samples, size_t frames)
{
    size_t channels = self->audio.channel_count;
    int64_t step = (int64_t)1 << self->bits;
    for (size_t at = 0; at < frames;) {
        int64_t frame = self->known + (int64_t)at;
        size_t count = (size_t)(step - frame % step);
        count = count < frames - at ? count : frames - at;
        waveform_pair pair = pair_of(samples + at * channels, count * channels);
        put(self->pair, &self->count, (size_t)(frame >> self->bits), &pair);
        at += count;
    }
    self->known += (int64_t)frames;
}

static mrt_result read_frames(waveform *self, show *s, int64_t first, size_t count,
                              size_t *out_count, error *err)
{
    size_t frame_size = self->audio.channel_count * sound_pcm_bytes(self->format), size = 0;
    mrt_result result =
        show_audio_read(s, self->audio.id, first, self->bytes, count * frame_size, &size, err);
    *out_count = size / frame_size;
    sound_pcm_unpack(self->samples, self->bytes, *out_count * self->audio.channel_count,
                     self->format);
    return result;
}

static mrt_result step_once(waveform *self, show *s, size_t count, error *err)
{
    size_t got;
    mrt_result read = read_frames(self, s, self->known, count, &got, err);
    if (read < 0 && got == 0) {
        got = count < SKIPPED_FRAMES ? count : SKIPPED_FRAMES;
        memset(self->samples, 0, got * self->audio.channel_count * sizeof *self->samples);
    } else if (read < 0) {
        read = MRT_OK; /* the failure concerns later frames; the next call reports it */
    }
    if (got == 0)
        return MRT_END;
    error why;
    mrt_result result = fit(self, self->known + (int64_t)got, &why);
    if (result < 0)
        return error_set(err, result, "%s", why.text);
    add(self, self->samples, got);
    return read;
}

mrt_result waveform_step(waveform *self, show *s, int64_t frames_max, error *err)
{
    show_audio audio;
    mrt_result result = show_audio_info(s, self->audio.id, &audio, err);
    if (result < 0)
        return result;
    self->audio.frame_count = audio.frame_count;
    int64_t step = (int64_t)self->read_frames;
    for (int64_t done = 0; done < frames_max && result == MRT_OK; done += step) {
        int64_t left = audio.frame_count - self->known;
        left = left < frames_max - done ? left : frames_max - done;
        if (self->known >= audio.frame_count)
            return MRT_END;
        result = step_once(self, s, (size_t)(left < step ? left : step), err);
    }
    if (result == MRT_OK && self->known >= audio.frame_count)
        return MRT_END;
    return result;
}

int64_t waveform_known_frames(const waveform *self)
{
    return self->known;
}

/* ---- reading ---- */

static uint32_t bits_for(int64_t from, int64_t to, size_t pairs_max)
{
    uint32_t bits = 0;
    while (((to - 1) >> bits) - (from >> bits) + 1 > (int64_t)pairs_max)
        bits += 1;
    return bits;
}

/* Reads kept pairs. A kept pair covers at most as many frames as a requested one. */
static void read_kept(const waveform *self, uint32_t bits, int64_t to, waveform_view *out)
{
    uint32_t further = bits - self->bits;
    size_t first = (size_t)(out->first_frame >> self->bits);
    size_t end = (size_t)(((to - 1) >> bits) + 1) << further;
    for (size_t i = first; i < end && i < self->count; ++i)
        put(out->pair, &out->count, (i - first) >> further, &self->pair[i]);
}

static mrt_result read_sound(waveform *self, show *s, uint32_t bits, int64_t to, waveform_view *out,
                             error *err)
{
    size_t channels = self->audio.channel_count;
    /* Ends at the last pair, limited to the processed frames. */
    int64_t end = (((to - 1) >> bits) + 1) << bits;
    end = end < self->known ? end : self->known;
    for (int64_t at = out->first_frame; at < end;) {
        size_t got;
        size_t wanted =
            (size_t)(end - at) < self->read_frames ? (size_t)(end - at) : self->read_frames;
        mrt_result result = read_frames(self, s, at, wanted, &got, err);
        if (result < 0)
            return result;
        if (got == 0)
            return error_set(err, MRT_ERR_FORMAT, "audio %lld: frame %lld is missing",
                             (long long)self->audio.id, (long long)at);
        for (size_t i = 0; i < got; ++i) {
            waveform_pair pair = pair_of(self->samples + i * channels, channels);
            put(out->pair, &out->count, (size_t)((at + (int64_t)i - out->first_frame) >> bits),
                &pair);
        }
        at += (int64_t)got;
    }
    return MRT_OK;
}

mrt_result waveform_read(waveform *self, show *s, int64_t from, int64_t to, size_t pairs_max,
                         waveform_view *out, error *err)
{
    out->count = 0;
    out->first_frame = 0;
    out->frames_per_pair = 1;
    if (pairs_max < 1 || pairs_max > WAVEFORM_PAIRS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "an outline of %zu pairs: expected 1 to %d",
                         pairs_max, WAVEFORM_PAIRS_MAX);
    from = from > 0 ? from : 0;
    to = to < self->known ? to : self->known;
    if (from >= to)
        return MRT_OK;
    uint32_t bits = bits_for(from, to, pairs_max);
    out->frames_per_pair = (int64_t)1 << bits;
    out->first_frame = from >> bits << bits;
    if (bits < self->bits)
        return read_sound(self, s, bits, to, out, err);
    read_kept(self, bits, to, out);
    return MRT_OK;
}

/* ---- lifetime ---- */

void waveform_limit(waveform *self, size_t pairs_max)
{
    if (self->known == 0)
        self->pairs_max = pairs_max < 2 ? 2 : pairs_max < PAIRS_MAX ? pairs_max : PAIRS_MAX;
}

mrt_result waveform_create(waveform **out, show *s, int64_t audio, error *err)
{
    *out = NULL;
    waveform *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the outline of a sound");
    mrt_result result = show_audio_info(s, audio, &self->audio, err);
    if (result < 0)
        goto fail;
    self->bits = FINEST_BITS;
    self->format = sound_pcm_of(self->audio.format);
    self->pairs_max = PAIRS_MAX;
    self->read_frames = READ_SAMPLES / self->audio.channel_count;
    size_t samples = READ_SAMPLES;
    self->bytes = malloc(samples * sound_pcm_bytes(self->format));
    self->samples = malloc(samples * sizeof *self->samples);
    if (!self->bytes || !self->samples) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the outline of a sound");
        goto fail;
    }
    *out = self;
    return MRT_OK;
fail:
    waveform_destroy(self);
    return result;
}

void waveform_destroy(waveform *self)
{
    if (!self)
        return;
    free(self->pair);
    free(self->bytes);
    free(self->samples);
    free(self);
}
