/* voice/listener.h - sound as an input hears it: a microphone of ALSA's, by name, or a pipe with
 * samples in it, opened, read in time, and lost. 16 bit, one channel, MICROPHONE_RATE frames a
 * second. The one place that knows libasound's PCM; where marotte was built without it only pipes
 * are there. Leaves out what is heard. Shared by the inputs of this folder. One thread at a time.
 */
#ifndef PLUGINS_VOICE_LISTENER_H
#define PLUGINS_VOICE_LISTENER_H
#include "device_io.h"

#include <marotte/plugin.h>

enum { MICROPHONE_RATE = 48000 };
typedef struct microphone microphone;

typedef struct listener {
    const mrt_host *host;
    microphone *from;  /* NULL: it is closed */
    mrt_device device; /* what was opened */
    clock_map clock;   /* from frames to the host's clock */
    int64_t frames;    /* since it was opened */
    int64_t time_ns;   /* host clock: of the end of what was read last */
    bool has_told_loss;
} listener;

/* address: "" what the system calls default; with a '/' a pipe (mkfifo), else a name of ALSA's
 * ("hw:1"), of which others may hold what is not shared. called: "Microphone", before the address.
 * What is wrong is said, once. */
mrt_result listener_open(listener *self, const char *address, const char *called);
/* Some frames, capacity at most. MRT_TIMEOUT: none until the deadline; MRT_ERR_IO: it went away,
 * which is said, or is not open. */
mrt_result listener_read(listener *self, int64_t deadline_ns, int16_t *out, uint32_t capacity,
                         uint32_t *out_count);
/* As mrt_devices.list; prefix: before the name of each. */
uint32_t listener_list(const char *prefix, mrt_device *out, uint32_t capacity);

/* ---- for the tables of a plugin whose instance is one block of memory that begins with a listener
 * ---- */

void listener_close(mrt_plugin *self);
bool listener_current(mrt_plugin *self, mrt_device *out);
void listener_destroy(mrt_plugin *self);

#endif
