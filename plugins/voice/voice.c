/* org.marotte.voice: the loudness of the performer's voice, as a channel that a patch connects to a
 * jaw. The sound itself is not stored here: a take records it with --sound.
 * level = (20 log10(r) + 60) / 60, limited to 0..1, where r is the root mean square of the last
 * WINDOW, full scale being 1: 0 at -60 dB or less, 1 at full scale. Speech close to a microphone is
 * about 0.5 to 0.8, with pauses below 0.3. */
#include "listener.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HOP = MICROPHONE_RATE / 100, HOPS = 2 }; /* a sample each 10 ms, of the last 20 ms */
static const double full_scale = 32768.0, floor_db = -60.0;

struct mrt_plugin {
    listener from; /* first: listener.h */
    int16_t frame[HOP];
    uint32_t frame_count;
    double square[HOPS]; /* sums of the last hops, newest last */
    uint32_t sequence;
};

/* ---- the level ---- */

static float level_of(const double square[HOPS])
{
    double sum = 0.0;
    for (int i = 0; i < HOPS; ++i)
        sum += square[i];
    double mean = sum / ((double)HOPS * HOP * full_scale * full_scale);
    double db = mean > 0.0 ? 10.0 * log10(mean) : floor_db;
    return (float)fmin(fmax(1.0 - db / floor_db, 0.0), 1.0);
}

static void give(mrt_plugin *self, mrt_sample *out)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < HOP; ++i)
        sum += (double)self->frame[i] * (double)self->frame[i];
    memmove(self->square, self->square + 1, (HOPS - 1) * sizeof *self->square);
    self->square[HOPS - 1] = sum;
    self->frame_count = 0;
    memset(out, 0, sizeof *out);
    out->time_ns = self->from.time_ns;
    out->sequence = self->sequence++;
    out->count = 1;
    out->value[0] = level_of(self->square);
}

/* ---- input ---- */

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    (void)params;
    self->frame_count = 0;
    memset(self->square, 0, sizeof self->square);
    return listener_open(&self->from, address, "Microphone");
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    static const mrt_channel level = {"level", "0..1", MRT_CH_OTHER, MRT_NO_HAND, 0.0f, 1.0f};
    (void)self;
    *out_count = 1;
    return &level;
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out)
{
    mrt_result result = MRT_OK;
    (void)params;
    while (result == MRT_OK && self->frame_count < HOP) {
        uint32_t count;
        result = listener_read(&self->from, deadline_ns, self->frame + self->frame_count,
                               HOP - self->frame_count, &count);
        self->frame_count += count;
    }
    if (result == MRT_OK)
        give(self, out);
    return result;
}

/* ---- devices ---- */

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    (void)self;
    return listener_list("", out, capacity);
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->from.host = host;
    return self;
}

static const mrt_input input = {input_open, input_channels, input_read, listener_close, 0};
static const mrt_devices devices = {list_devices, listener_current};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    0,
    NULL,
    interfaces,
    "org.marotte.voice",
    "Voice",
    MAROTTE_VERSION,
    "Loudness of your voice, from a microphone (voice, voice:hw:1) or a pipe with sound "
    "(voice:./pipe)",
    create,
    listener_destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
