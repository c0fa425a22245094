#define _GNU_SOURCE /* RTLD_DEFAULT of older C libraries */
#include "stage/sound/sound_device.h"
#include "base/clock.h"

#include <ctype.h>
#include <dlfcn.h>
#include <portaudio.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Longer reported latencies are ignored. */
static const double latency_max_s = 2.0;
/* Playback follows a clock, so a short latency is not worth the risk of an underrun. */
static const double latency_least_s = 0.03;

typedef struct host { /* the one PortAudio of the process */
    pthread_mutex_t lock;
    uint32_t stream_count; /* while it is not 0, newly connected devices cannot be found */
} host;

typedef struct stream {
    PaStream *pa;
    sound_direction direction;
    sound_callback *callback;
    void *data;
    int64_t latency_ns; /* reported when it was opened */
} stream;

/* ---- suppress messages ---- */

static void ignore_message(const char *text)
{
    (void)text;
}

static void ignore_alsa_error(const char *file, int line, const char *function, int code,
                              const char *format, ...)
{
    (void)file;
    (void)line;
    (void)function;
    (void)code;
    (void)format;
}

/* Finds the functions by name, because PortAudio may be built without ALSA or JACK. */
static void silence_libraries(void)
{
    int (*set_alsa)(void (*)(const char *, int, const char *, int, const char *, ...));
    void (*set_jack)(void (*)(const char *));
    void *alsa = dlsym(RTLD_DEFAULT, "snd_lib_error_set_handler");
    void *jack[2] = {dlsym(RTLD_DEFAULT, "jack_set_error_function"),
                     dlsym(RTLD_DEFAULT, "jack_set_info_function")};
    memcpy(&set_alsa, &alsa, sizeof set_alsa);
    if (alsa)
        (void)set_alsa(ignore_alsa_error);
    for (int i = 0; i < 2; ++i) {
        memcpy(&set_jack, &jack[i], sizeof set_jack);
        if (jack[i])
            set_jack(ignore_message);
    }
}

/* ---- blocks [device] ---- */

static double seconds_of(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

/* Returns the age of `time_s` on the host clock that it belongs to. 0: unknown clock. */
static double age_of(double time_s)
{
    double monotonic_s = seconds_of(CLOCK_MONOTONIC) - time_s;
    double real_s = seconds_of(CLOCK_REALTIME) - time_s;
    if (monotonic_s >= 0.0 && monotonic_s < 0.5)
        return monotonic_s;
    return real_s >= 0.0 && real_s < 0.5 ? real_s : 0.0;
}

/* Returns the time from the callback to the sound of its first frame: > 0 for output, < 0 for
 * input. */
static double way_of(const stream *self, const PaStreamCallbackTimeInfo *info)
{
    bool is_out = self->direction == SOUND_OUT;
    double far_s = is_out ? info->outputBufferDacTime : info->inputBufferAdcTime;
    double way_s = far_s - info->currentTime, length_s = is_out ? way_s : -way_s;
    if (info->currentTime > 0.0 && length_s > 0.0 && length_s < latency_max_s)
        return way_s - age_of(info->currentTime);
    return (is_out ? 1.0 : -1.0) * (double)self->latency_ns * 1e-9;
}

static int pass_block(const void *in, void *out, unsigned long frame_count,
                      const PaStreamCallbackTimeInfo *info, PaStreamCallbackFlags flags, void *data)
{
    const stream *self = data;
    bool is_out = self->direction == SOUND_OUT;
    sound_block block = {.out = is_out ? out : NULL,
                         .in = is_out ? NULL : in,
                         .frame_count = (uint32_t)frame_count,
                         .time_ns = clock_now_ns()};
    if (is_out ? !out : !in)
        return paContinue;
    if (info)
        block.time_ns += (int64_t)(way_of(self, info) * 1e9);
    block.is_broken =
        (flags & (is_out ? paOutputUnderflow : paInputOverflow | paInputUnderflow)) != 0;
    self->callback(self->data, &block);
    return paContinue;
}

/* ---- open ---- */

static const char *kind_of(sound_direction direction)
{
    return direction == SOUND_OUT ? "loudspeaker" : "microphone";
}

static int channels_of(const PaDeviceInfo *info, sound_direction direction)
{
    return direction == SOUND_OUT ? info->maxOutputChannels : info->maxInputChannels;
}

static bool has_part(const char *name, const char *part)
{
    size_t length = strlen(part);
    for (; *name; ++name) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)name[i]) == tolower((unsigned char)part[i]) &&
               name[i])
            ++i;
        if (i == length)
            return true;
    }
    return false;
}

static PaDeviceIndex named_device(sound_direction direction, const char *name)
{
    PaDeviceIndex count = Pa_GetDeviceCount();
    for (PaDeviceIndex i = 0; i < count; ++i) {
        const PaDeviceInfo *info = Pa_GetDeviceInfo(i);
        if (info && info->name && channels_of(info, direction) > 0 && has_part(info->name, name))
            return i;
    }
    return paNoDevice;
}

static mrt_result find_device(PaDeviceIndex *out, sound_direction direction, const char *name,
                              error *err)
{
    if (name[0])
        *out = named_device(direction, name);
    else if (direction == SOUND_OUT)
        *out = Pa_GetDefaultOutputDevice();
    else
        *out = Pa_GetDefaultInputDevice();
    if (*out != paNoDevice && Pa_GetDeviceInfo(*out))
        return MRT_OK;
    if (name[0])
        return error_set(err, MRT_ERR_IO, "sound: no %s is called '%s': choose another one",
                         kind_of(direction), name);
    return error_set(err, MRT_ERR_IO,
                     "sound: no %s was found: connect one, or check that the sound server runs and "
                     "that you are in the group 'audio'",
                     kind_of(direction));
}

static mrt_result explain(PaError code, sound_direction direction, const char *name, double rate_hz,
                          error *err)
{
    const PaHostErrorInfo *info =
        code == paUnanticipatedHostError ? Pa_GetLastHostErrorInfo() : NULL;
    const char *why =
        info && info->errorText && info->errorText[0] ? info->errorText : Pa_GetErrorText(code);
    switch (code) {
    case paInvalidSampleRate:
        return error_set(
            err, MRT_ERR_UNSUPPORTED,
            "sound: %s '%.80s' does not run at %.0f Hz, although it reports this rate: "
            "choose another one",
            kind_of(direction), name, rate_hz);
    case paDeviceUnavailable:
        return error_set(
            err, MRT_ERR_IO,
            "sound: %s '%.80s' is busy or disconnected: close other programs that use it",
            kind_of(direction), name);
    default:
        return error_set(err, MRT_ERR_IO, "sound: %s '%.80s' cannot be opened: %.120s",
                         kind_of(direction), name, why);
    }
}

static mrt_result open_device(stream *self, PaDeviceIndex device, const sound_request *request,
                              sound_stream *out, error *err)
{
    const PaDeviceInfo *info = Pa_GetDeviceInfo(device);
    bool is_out = self->direction == SOUND_OUT;
    int channels = request->channel_count ? (int)request->channel_count : 2;
    int most = channels_of(info, self->direction);
    double latency_s = is_out ? info->defaultLowOutputLatency : info->defaultHighInputLatency;
    double rate_hz = request->rate_hz ? (double)request->rate_hz : info->defaultSampleRate;
    PaStreamParameters parameters = {.device = device,
                                     .channelCount = channels < most ? channels : most,
                                     .sampleFormat = paFloat32,
                                     .suggestedLatency =
                                         latency_s > latency_least_s ? latency_s : latency_least_s};
    const PaStreamParameters *in = is_out ? NULL : &parameters, *to = is_out ? &parameters : NULL;
    PaError code = Pa_OpenStream(&self->pa, in, to, rate_hz, paFramesPerBufferUnspecified,
                                 paClipOff, pass_block, self);
    if (code == paInvalidSampleRate && rate_hz != info->defaultSampleRate) {
        rate_hz = info->defaultSampleRate;
        code = Pa_OpenStream(&self->pa, in, to, rate_hz, paFramesPerBufferUnspecified, paClipOff,
                             pass_block, self);
    }
    if (code != paNoError)
        return explain(code, self->direction, info->name, rate_hz, err);
    const PaStreamInfo *opened = Pa_GetStreamInfo(self->pa);
    if (opened) {
        self->latency_ns = (int64_t)((is_out ? opened->outputLatency : opened->inputLatency) * 1e9);
        /* A small difference is the drift of the device's clock. A larger one is another rate. */
        if (opened->sampleRate < rate_hz * 0.99 || opened->sampleRate > rate_hz * 1.01)
            rate_hz = opened->sampleRate;
    }
    *out = (sound_stream){.handle = self,
                          .rate_hz = (uint32_t)(rate_hz + 0.5),
                          .channel_count = (uint32_t)parameters.channelCount,
                          .latency_ns = self->latency_ns};
    snprintf(out->name, sizeof out->name, "%.95s", info->name ? info->name : "");
    return MRT_OK;
}

/* Initialises PortAudio again when no stream is open, so that it finds new devices. */
static mrt_result initialise(host *self, error *err)
{
    if (self->stream_count > 0)
        return MRT_OK;
    silence_libraries();
    PaError code = Pa_Initialize();
    if (code == paNoError)
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "sound: cannot start the sound system: %.120s",
                     Pa_GetErrorText(code));
}

static void terminate_if_idle(const host *self)
{
    if (self->stream_count == 0)
        (void)Pa_Terminate();
}

static mrt_result open_locked(host *self, stream *of, const sound_request *request,
                              sound_stream *out, error *err)
{
    PaDeviceIndex device;
    mrt_result result = initialise(self, err);
    if (result < 0)
        return result;
    result = find_device(&device, of->direction, request->name, err);
    if (result >= 0)
        result = open_device(of, device, request, out, err);
    if (result < 0)
        terminate_if_idle(self);
    else
        self->stream_count += 1;
    return result;
}

/* ---- backend ---- */

static mrt_result open_stream(void *data, sound_direction direction, const sound_request *request,
                              sound_callback *callback, void *user, sound_stream *out, error *err)
{
    host *self = data;
    stream *of = calloc(1, sizeof *of);
    if (!of)
        return error_set(err, MRT_ERR_MEMORY, "no memory for sound");
    *of = (stream){.direction = direction, .callback = callback, .data = user};
    pthread_mutex_lock(&self->lock);
    mrt_result result = open_locked(self, of, request, out, err);
    pthread_mutex_unlock(&self->lock);
    if (result < 0)
        free(of);
    return result;
}

static mrt_result start_stream(void *data, void *handle, error *err)
{
    host *self = data;
    stream *of = handle;
    pthread_mutex_lock(&self->lock);
    PaError code = Pa_StartStream(of->pa);
    mrt_result result =
        code == paNoError ? MRT_OK : explain(code, of->direction, "chosen", 0.0, err);
    pthread_mutex_unlock(&self->lock);
    return result;
}

static bool is_alive(void *data, void *handle)
{
    host *self = data;
    const stream *of = handle;
    pthread_mutex_lock(&self->lock);
    bool is = Pa_IsStreamActive(of->pa) == 1;
    pthread_mutex_unlock(&self->lock);
    return is;
}

static void close_stream(void *data, void *handle)
{
    host *self = data;
    stream *of = handle;
    pthread_mutex_lock(&self->lock);
    (void)Pa_AbortStream(of->pa);
    (void)Pa_CloseStream(of->pa);
    self->stream_count -= 1;
    terminate_if_idle(self);
    pthread_mutex_unlock(&self->lock);
    free(of);
}

mrt_result sound_portaudio_create(sound_backend *out, error *err)
{
    *out = (sound_backend){0};
    host *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for sound");
    pthread_mutex_init(&self->lock, NULL);
    *out = (sound_backend){.self = self,
                           .open = open_stream,
                           .start = start_stream,
                           .is_alive = is_alive,
                           .close = close_stream};
    return MRT_OK;
}

void sound_portaudio_destroy(sound_backend *backend)
{
    if (!backend || !backend->self)
        return;
    host *self = backend->self;
    pthread_mutex_destroy(&self->lock);
    free(self);
    *backend = (sound_backend){0};
}
