/* org.marotte.voice: what the voice of the performer does, as channels that a patch connects to a
 * mouth: its loudness, and how a mouth moves that speaks so (mouth.h). The sound comes from a
 * microphone, a pipe or a WAV file. It is not stored here: a take records it with --sound.
 * level = (20 log10(r) + 60) / 60, limited to 0..1, where r is the root mean square of the last
 * 20 ms, full scale being 1: 0 at -60 dB or less, 1 at full scale. Speech close to a microphone is
 * about 0.5 to 0.8, with pauses below 0.3. */
#include "listener.h"
#include "mouth.h"
#include "wav.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { HOPS_A_SECOND = 100, HOPS = 2, READ_MOST = MICROPHONE_RATE / HOPS_A_SECOND };
static const double full_scale = 32768.0, floor_db = -60.0;

typedef struct loudness { /* of one hop */
    double square;        /* sum */
    uint32_t count;       /* frames */
} loudness;

struct mrt_plugin {
    listener from; /* first: listener.h */
    wav file;      /* open: the sound comes from it */
    bool is_started;
    int64_t start_ns; /* host clock: the first frame of the file */
    mouth speaker;
    double rate_hz;
    int64_t frames;     /* since open */
    loudness hop[HOPS]; /* newest last; the newest is not complete */
    uint32_t sequence;
};

/* ---- from the sound to a sample ---- */

static void begin(mrt_plugin *self, double rate_hz)
{
    self->rate_hz = rate_hz;
    self->frames = 0;
    self->is_started = false;
    memset(self->hop, 0, sizeof self->hop);
    mouth_init(&self->speaker, rate_hz);
}

/* Returns the number of frames of the first `count` hops. */
static int64_t frames_of(const mrt_plugin *self, int64_t count)
{
    return (int64_t)(self->rate_hz * (double)count / HOPS_A_SECOND);
}

/* Returns the number of frames until the current hop is complete. */
static uint32_t missing(const mrt_plugin *self)
{
    return (uint32_t)(frames_of(self, self->sequence + 1) - self->frames);
}

static void add(mrt_plugin *self, float frame)
{
    loudness *now = &self->hop[HOPS - 1];
    now->square += (double)frame * (double)frame;
    now->count += 1;
    self->frames += 1;
    (void)mouth_add(&self->speaker, frame);
}

static float level_of(const mrt_plugin *self)
{
    double sum = 0.0, mean = 0.0;
    uint32_t count = 0;
    for (int i = 0; i < HOPS; ++i) {
        sum += self->hop[i].square;
        count += self->hop[i].count;
    }
    mean = count > 0 ? sum / count : 0.0;
    double db = mean > 0.0 ? 10.0 * log10(mean) : floor_db;
    return (float)fmin(fmax(1.0 - db / floor_db, 0.0), 1.0);
}

static void give(mrt_plugin *self, int64_t time_ns, mrt_sample *out)
{
    memset(out, 0, sizeof *out);
    out->time_ns = time_ns;
    out->sequence = self->sequence++;
    out->count = 1 + MOUTH_CHANNELS;
    out->value[0] = level_of(self);
    for (int i = 0; i < MOUTH_CHANNELS; ++i)
        out->value[1 + i] = (float)self->speaker.value[i];
    memmove(self->hop, self->hop + 1, (HOPS - 1) * sizeof *self->hop);
    self->hop[HOPS - 1] = (loudness){0};
}

/* ---- input ---- */

/* As MRT_INPUT_FILES promises. */
static bool is_file(const char *address)
{
    struct stat about;
    return address && stat(address, &about) == 0 && S_ISREG(about.st_mode);
}

static mrt_result open_file(mrt_plugin *self, const char *path)
{
    char reason[WAV_REASON];
    if (!wav_open(&self->file, path, reason)) {
        device_log(self->from.host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_FORMAT;
    }
    begin(self, self->file.rate_hz);
    return MRT_OK;
}

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    (void)params;
    wav_close(&self->file);
    self->sequence = 0;
    if (is_file(address))
        return open_file(self, address);
    begin(self, MICROPHONE_RATE);
    return listener_open(&self->from, address, "Microphone");
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    static const mrt_channel channel[1 + MOUTH_CHANNELS] = {
        {"level", "0..1", MRT_CH_OTHER, MRT_NO_HAND, 0.0f, 1.0f},
        {"openness", "0..1", MRT_CH_OTHER, MRT_NO_HAND, 0.0f, 1.0f},
        {"wide", "0..1", MRT_CH_OTHER, MRT_NO_HAND, 0.0f, 1.0f},
        {"round", "0..1", MRT_CH_OTHER, MRT_NO_HAND, 0.0f, 1.0f},
        {"closure", "0..1", MRT_CH_OTHER, MRT_NO_HAND, 0.0f, 1.0f},
        {"hiss", "0..1", MRT_CH_OTHER, MRT_NO_HAND, 0.0f, 1.0f}};
    (void)self;
    *out_count = 1 + MOUTH_CHANNELS;
    return channel;
}

static mrt_result read_file(mrt_plugin *self, int64_t deadline_ns, mrt_sample *out)
{
    const mrt_host *host = self->from.host;
    if (!self->is_started)
        self->start_ns = host->now_ns(host);
    self->is_started = true;
    const int64_t end = frames_of(self, self->sequence + 1);
    const int64_t due_ns = self->start_ns + (int64_t)(1e9 * (double)end / self->rate_hz);
    if (due_ns > deadline_ns) {
        (void)host->wait_until_ns(host, deadline_ns);
        return MRT_TIMEOUT;
    }
    (void)host->wait_until_ns(host, due_ns);
    while (missing(self) > 0) {
        float frame;
        if (!wav_read(&self->file, &frame))
            return MRT_END;
        add(self, frame);
    }
    give(self, due_ns, out);
    return MRT_OK;
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out)
{
    mrt_result result = MRT_OK;
    (void)params;
    if (self->file.file)
        return read_file(self, deadline_ns, out);
    while (result == MRT_OK && missing(self) > 0) {
        int16_t frame[READ_MOST];
        uint32_t count;
        result = listener_read(&self->from, deadline_ns, frame, missing(self), &count);
        for (uint32_t i = 0; i < count; ++i)
            add(self, (float)(frame[i] / full_scale));
    }
    if (result == MRT_OK)
        give(self, self->from.time_ns, out);
    return result;
}

static void input_close(mrt_plugin *self)
{
    wav_close(&self->file);
    listener_close(self);
}

static int64_t get_duration_ns(mrt_plugin *self, const double *params)
{
    (void)params;
    if (!self->file.file)
        return -1;
    const double hops = floor((double)self->file.frame_count * HOPS_A_SECOND / self->rate_hz);
    return hops > 1.0 ? (int64_t)((hops - 1.0) * 1e9 / HOPS_A_SECOND) : 0;
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

static void destroy(mrt_plugin *self)
{
    if (self)
        wav_close(&self->file);
    listener_destroy(self);
}

static const mrt_input input = {input_open, input_channels, input_read, input_close,
                                MRT_INPUT_FILES};
static const mrt_devices devices = {list_devices, listener_current};
static const mrt_duration duration = {get_duration_ns};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {MRT_DURATION, &duration}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    0,
    NULL,
    interfaces,
    "org.marotte.voice",
    "Voice",
    MAROTTE_VERSION,
    "Loudness and mouth of your voice, from a microphone (voice, voice:hw:1), a pipe with sound "
    "(voice:./pipe) or a file (voice:hello.wav)",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
