/* voice/listener.h - sound input from an ALSA microphone, by name, or from a pipe of samples:
 * opening, reading in time, and loss. 16 bit, one channel, MICROPHONE_RATE frames per second. The
 * only file that uses libasound's PCM; without libasound only pipes are available. Leaves out the
 * analysis of the sound. Shared by the inputs of this folder. One thread at a time. */
#ifndef PLUGINS_VOICE_LISTENER_H
#define PLUGINS_VOICE_LISTENER_H
#include "device_io.h"

#include <marotte/plugin.h>

enum { MICROPHONE_RATE = 48000 };
typedef struct microphone microphone;

typedef struct listener {
    const mrt_host *host;
    microphone *from;  /* NULL: closed */
    mrt_device device; /* the opened device */
    clock_map clock;   /* from frames to the host's clock */
    int64_t frames;    /* since open */
    int64_t time_ns;   /* host clock: time of the last frame read */
    bool has_told_loss;
} listener;

/* Opens a source. address: "": the system's default; with a '/': a pipe (mkfifo); else an ALSA name
 * ("hw:1"), which another program may use exclusively. called: "Microphone", prefix of the name.
 * Logs a failure once. */
mrt_result listener_open(listener *self, const char *address, const char *called);
/* Reads at most `capacity` frames. Returns MRT_TIMEOUT if none arrived before the deadline;
 * MRT_ERR_IO if the source is not open or was lost, which is logged. */
mrt_result listener_read(listener *self, int64_t deadline_ns, int16_t *out, uint32_t capacity,
                         uint32_t *out_count);
/* Like mrt_devices.list; prefix: put before each name. */
uint32_t listener_list(const char *prefix, mrt_device *out, uint32_t capacity);

/* ---- functions for the tables of a plugin whose instance is one block of memory that begins with
 * a listener ---- */

void listener_close(mrt_plugin *self);
bool listener_current(mrt_plugin *self, mrt_device *out);
void listener_destroy(mrt_plugin *self);

#endif
