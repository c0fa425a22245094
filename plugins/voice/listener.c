#include "listener.h"
#include "device_io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef VOICE_HAS_ALSA
#include <alsa/asoundlib.h>
#else
typedef void snd_pcm_t;
#endif

enum { MICROPHONE_REASON = 320 };

struct microphone {
    snd_pcm_t *pcm; /* NULL: a pipe */
    int pipe;
    unsigned char half; /* first byte of a split frame */
    bool has_half;
};

/* ---- a pipe ---- */

static bool open_pipe(microphone *self, const char *path, char out_reason[MICROPHONE_REASON])
{
    struct stat about;
    bool is_pipe = stat(path, &about) == 0 && S_ISFIFO(about.st_mode);
    /* write access too: so the pipe always has a writer and never ends */
    self->pipe = is_pipe ? open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
    if (self->pipe >= 0)
        return true;
    (void)snprintf(out_reason, MICROPHONE_REASON,
                   is_pipe ? "%.100s: you have no permission to open it"
                           : "%.100s is not a pipe: create one with mkfifo and write sound to it: "
                             "arecord -t raw -f S16_LE -r 48000 -c 1",
                   path);
    return false;
}

static int read_pipe(microphone *self, int16_t *out, uint32_t capacity)
{
    unsigned char bytes[4096];
    size_t kept = self->has_half, room = 2 * (size_t)capacity;
    bytes[0] = self->half;
    room = room < sizeof bytes ? room : sizeof bytes;
    ssize_t size = read(self->pipe, bytes + kept, room - kept);
    if (size <= 0)
        return size < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
    size_t all = kept + (size_t)size, count = all / 2;
    self->has_half = all % 2 > 0;
    self->half = bytes[all - 1];
    for (size_t i = 0; i < count; ++i)
        out[i] = (int16_t)(uint16_t)(bytes[2 * i] | bytes[2 * i + 1] << 8);
    return (int)count;
}

/* ---- ALSA ---- */

#ifdef VOICE_HAS_ALSA

enum { LATENCY_US = 40000 };

static void say_nothing(const char *file, int line, const char *function, int code,
                        const char *format, ...)
{
    (void)file;
    (void)line;
    (void)function;
    (void)code;
    (void)format;
}

static const char *advice(int error)
{
    switch (error) {
    case -ENOENT:
    case -ENODEV:
    case -ENXIO:
        return "no such microphone: plug it in, or list the devices with: marotte devices";
    case -EACCES:
    case -EPERM:
        return "you have no permission to open it: run sudo adduser $USER audio, then log in again";
    case -EBUSY:
        return "another program uses it exclusively: close that program, or leave the name out";
    default:
        return snd_strerror(error);
    }
}

static bool open_pcm(microphone *self, const char *name, char out_reason[MICROPHONE_REASON])
{
    (void)snd_lib_error_set_handler(say_nothing);
    int result = snd_pcm_open(&self->pcm, name, SND_PCM_STREAM_CAPTURE, SND_PCM_NONBLOCK);
    if (result < 0)
        self->pcm = NULL;
    else
        result = snd_pcm_set_params(self->pcm, SND_PCM_FORMAT_S16, SND_PCM_ACCESS_RW_INTERLEAVED, 1,
                                    MICROPHONE_RATE, 1, LATENCY_US);
    if (result >= 0)
        result = snd_pcm_start(self->pcm);
    if (result < 0)
        (void)snprintf(out_reason, MICROPHONE_REASON, "%.100s: %s", name, advice(result));
    return result >= 0;
}

/* Recovers after the computer was too busy or asleep; the sound of that time is lost. */
static bool recover(microphone *self, int error)
{
    return snd_pcm_recover(self->pcm, error, 1) >= 0 && snd_pcm_start(self->pcm) >= 0;
}

static bool wait_pcm(microphone *self, int64_t span_ns)
{
    int64_t span_ms = span_ns > 0 ? (span_ns + 999999) / 1000000 : 0;
    int result = snd_pcm_wait(self->pcm, (int)(span_ms < 1000 ? span_ms : 1000));
    return result >= 0 || result == -EINTR || recover(self, result);
}

static int read_pcm(microphone *self, int16_t *out, uint32_t capacity)
{
    snd_pcm_sframes_t count = snd_pcm_readi(self->pcm, out, capacity);
    if (count >= 0)
        return (int)count;
    return count == -EAGAIN || recover(self, (int)count) ? 0 : -1;
}

static void close_pcm(microphone *self)
{
    (void)snd_pcm_close(self->pcm);
}

/* "plughw:CARD=Mic,DEV=0": the first device of a card is also found without ",DEV=0". A ',' would
 * begin parameters. */
static bool is_microphone(void *hint, char out_name[64], char out_about[64])
{
    char *name = snd_device_name_get_hint(hint, "NAME");
    char *about = snd_device_name_get_hint(hint, "DESC");
    char *way = snd_device_name_get_hint(hint, "IOID"); /* NULL: both */
    char *first = name ? strstr(name, ",DEV=0") : NULL;
    if (first && first[6] == '\0')
        *first = '\0';
    bool is_one = name && (!way || strcmp(way, "Input") == 0) && strlen(name) < 64 &&
                  !strchr(name, ',') &&
                  (strcmp(name, "default") == 0 || strncmp(name, "plughw:", 7) == 0);
    (void)snprintf(out_name, 64, "%s", is_one ? name : "");
    (void)snprintf(out_about, 64, "%.63s", about ? about : out_name);
    for (char *c = out_about; *c; ++c)
        if ((unsigned char)*c < ' ' || *c == 0x7f)
            *c = ' ';
    free(name);
    free(about);
    free(way);
    return is_one;
}

/* Avoids that ALSA tries 32 cards every second. */
static bool has_sound(void)
{
    return access("/dev/snd", F_OK) == 0;
}

static uint32_t microphone_list(mrt_device *out, uint32_t capacity)
{
    void **hints = NULL;
    uint32_t count = 0;
    int card = -1;
    if (!has_sound() || snd_card_next(&card) < 0 || card < 0 ||
        snd_device_name_hint(-1, "pcm", &hints) < 0)
        return 0;
    for (void **hint = hints; *hint; ++hint) {
        char name[64], about[64];
        if (!is_microphone(*hint, name, about))
            continue;
        if (count < capacity) {
            out[count] = (mrt_device){.state = MRT_DEVICE_UNSURE};
            (void)snprintf(out[count].address, sizeof out[count].address, "%s", name);
            (void)snprintf(out[count].name, sizeof out[count].name, "%s", about);
        }
        count += 1;
    }
    (void)snd_device_name_free_hint(hints);
    return count;
}

#else

static bool open_pcm(microphone *self, const char *name, char out_reason[MICROPHONE_REASON])
{
    (void)self;
    (void)snprintf(out_reason, MICROPHONE_REASON,
                   "%.100s: marotte was built without libasound2-dev and can only read pipes",
                   name);
    return false;
}

static bool wait_pcm(microphone *self, int64_t span_ns)
{
    (void)self;
    (void)span_ns;
    return false;
}

static int read_pcm(microphone *self, int16_t *out, uint32_t capacity)
{
    (void)self;
    (void)out;
    (void)capacity;
    return -1;
}

static void close_pcm(microphone *self)
{
    (void)self;
}

static uint32_t microphone_list(mrt_device *out, uint32_t capacity)
{
    (void)out;
    (void)capacity;
    return 0;
}

#endif

/* ---- either ---- */

static void microphone_close(microphone *self)
{
    if (!self)
        return;
    if (self->pcm)
        close_pcm(self);
    if (self->pipe >= 0)
        close(self->pipe);
    free(self);
}

/* Returns NULL on failure, with the reason in out_reason. */
static microphone *microphone_open(const char *address, char out_reason[MICROPHONE_REASON])
{
    microphone *self = calloc(1, sizeof *self);
    out_reason[0] = '\0';
    if (!self)
        return NULL;
    self->pipe = -1;
    if (strchr(address, '/') ? open_pipe(self, address, out_reason)
                             : open_pcm(self, address[0] ? address : "default", out_reason))
        return self;
    microphone_close(self);
    return NULL;
}

/* Waits at most span_ns for sound. Returns false if the source was lost. */
static bool microphone_wait(microphone *self, int64_t span_ns)
{
    return self->pcm ? wait_pcm(self, span_ns) : device_wait(self->pipe, span_ns) >= 0;
}

/* Returns the number of frames read, without waiting; 0: none; -1: the source was lost. */
static int microphone_read(microphone *self, int16_t *out, uint32_t capacity)
{
    return self->pcm ? read_pcm(self, out, capacity) : read_pipe(self, out, capacity);
}

/* ---- reading in time ---- */

static void stop(listener *self)
{
    microphone_close(self->from);
    self->from = NULL;
}

mrt_result listener_open(listener *self, const char *address, const char *called)
{
    char reason[MICROPHONE_REASON];
    stop(self);
    self->from = microphone_open(address ? address : "", reason);
    if (!self->from) {
        if (!self->has_told_loss)
            device_log(self->host, MRT_LOG_ERROR, "%s", reason[0] ? reason : "no memory");
        return MRT_ERR_IO;
    }
    self->device = (mrt_device){.state = MRT_DEVICE_READY};
    (void)snprintf(self->device.address, sizeof self->device.address, "%s",
                   address && address[0] ? address : "default");
    (void)snprintf(self->device.name, sizeof self->device.name, "%.13s %.48s", called,
                   self->device.address);
    clock_map_reset(&self->clock);
    self->frames = 0;
    self->has_told_loss = false;
    return MRT_OK;
}

static mrt_result lose(listener *self)
{
    device_log(self->host, MRT_LOG_ERROR, "%.100s was disconnected: plug it in again",
               self->device.name);
    self->has_told_loss = true;
    stop(self);
    return MRT_ERR_IO;
}

mrt_result listener_read(listener *self, int64_t deadline_ns, int16_t *out, uint32_t capacity,
                         uint32_t *out_count)
{
    *out_count = 0;
    while (self->from) {
        const int count = microphone_read(self->from, out, capacity);
        const int64_t now_ns = self->host->now_ns(self->host);
        if (count > 0) {
            *out_count = (uint32_t)count;
            self->frames += count;
            self->time_ns = clock_map_to_host(&self->clock,
                                              self->frames * 1000000000 / MICROPHONE_RATE, now_ns);
            return MRT_OK;
        }
        if (count == 0 && now_ns >= deadline_ns)
            return MRT_TIMEOUT;
        if (count < 0 || !microphone_wait(self->from, deadline_ns - now_ns))
            return lose(self);
    }
    return MRT_ERR_IO;
}

uint32_t listener_list(const char *prefix, mrt_device *out, uint32_t capacity)
{
    const uint32_t count = microphone_list(out, capacity);
    for (uint32_t i = 0; i < count && i < capacity; ++i) {
        char name[sizeof out[i].name];
        (void)snprintf(name, sizeof name, "%s%.48s", prefix, out[i].name);
        (void)snprintf(out[i].name, sizeof out[i].name, "%s", name);
    }
    return count;
}

/* ---- for the tables of a plugin ---- */

static listener *listener_of(mrt_plugin *self)
{
    return (listener *)self;
}

void listener_close(mrt_plugin *self)
{
    stop(listener_of(self));
}

bool listener_current(mrt_plugin *self, mrt_device *out)
{
    *out = listener_of(self)->device;
    return listener_of(self)->from != NULL;
}

void listener_destroy(mrt_plugin *self)
{
    if (self)
        listener_close(self);
    free(self);
}
