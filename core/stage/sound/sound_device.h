/* stage/sound/sound_device.h - one direction of sound: a loudspeaker or a microphone that may be
 * absent, busy, or unplugged at any moment, none of which stops anything: there is
 * a state, and a sentence for the person in front of it. It is opened, watched and tried again by a
 * thread of its own. What devices there are is a backend's: PortAudio (sound_portaudio.c), or a
 * test's. Leaves out what is played or recorded. [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_DEVICE_H
#define MAROTTE_STAGE_SOUND_DEVICE_H
#include "base/error.h"
#include "base/log.h"

typedef enum sound_direction { SOUND_OUT = 0, SOUND_IN } sound_direction;

typedef struct sound_block { /* of one direction: interleaved, as many channels as it was opened
                                with */
    float *out;
    const float *in;
    uint32_t frame_count;
    int64_t time_ns; /* host clock: when the first frame is heard, or was at the microphone */
    bool is_broken;  /* frames were lost before it: the device ran dry, or over */
} sound_block;
/* [device] Never waits, allocates or calls the system. */
typedef void sound_callback(void *data, const sound_block *block);

typedef struct sound_request {
    uint32_t rate_hz;       /* a loudspeaker that cannot gets its own; 0: the device's own */
    uint32_t channel_count; /* at most so many; 0: the device's own, at most 2 */
    char name[96];          /* a part of the device's name; "": the default one */
    uint32_t number;        /* another one: it is opened anew */
} sound_request;

typedef struct sound_stream { /* that is open */
    void *handle;             /* the backend's */
    uint32_t rate_hz, channel_count;
    int64_t latency_ns;
    char name[96];
} sound_stream;

typedef struct sound_backend {
    void *self;
    /* Opens and does not start. Errors say what to do. */
    mrt_result (*open)(void *self, sound_direction direction, const sound_request *request,
                       sound_callback *callback, void *data, sound_stream *out, error *err);
    mrt_result (*start)(void *self, void *handle, error *err);
    /* False: it has stopped by itself. */
    bool (*is_alive)(void *self, void *handle);
    void (*close)(void *self, void *handle); /* no callback after it */
} sound_backend;

typedef enum sound_device_state {
    SOUND_DEVICE_OFF = 0, /* nobody wants it */
    SOUND_DEVICE_RUNNING,
    SOUND_DEVICE_AWAY /* it could not be opened, or stopped: tried again every other second */
} sound_device_state;

typedef struct sound_device_status {
    sound_device_state state;
    sound_stream stream; /* running: without its handle */
    uint32_t lost_count; /* times that it stopped by itself */
    char text[256];      /* away: why, and what to do; "" nothing is wrong */
} sound_device_status;

typedef struct sound_user {
    void *data;
    /* [opener] Before the first block of each opening; < 0: this device is of no use, and why. */
    mrt_result (*opened)(void *data, const sound_stream *stream, error *err);
    sound_callback *block; /* [device] */
} sound_user;

typedef enum sound_threads {
    SOUND_OWN_THREADS = 0,
    SOUND_BY_CALLER /* for tests: sound_device_work() does what the thread would */
} sound_threads;

typedef struct sound_device sound_device;

/* What the backend is of and the log (NULL: nobody is told) must outlive it. */
CHECKED mrt_result sound_device_create(sound_device **out, sound_direction direction,
                                       const sound_backend *backend, const sound_user *user,
                                       log_queue *log, sound_threads threads, error *err);
/* False: the device does not answer, and the thread that waits for it, and the backend that it is
 * in, had to be left behind: the backend must not be freed. Its user hears nothing more of it. */
bool sound_device_destroy(sound_device *self); /* NULL is fine */

/* What is wanted from now on. Never waits. */
void sound_device_want(sound_device *self, const sound_request *request);
/* Closes it for good, sooner or later; then no block comes any more, and destroy does not wait. */
void sound_device_leave(sound_device *self);
bool sound_device_has_left(sound_device *self);
/* Until the next call. */
const sound_device_status *sound_device_look(sound_device *self);
/* [opener] One round; returns when the next is due at the latest. */
int64_t sound_device_work(sound_device *self, int64_t now_ns);

/* ---- the sound devices of this computer, by PortAudio. Times are of the host's clock whatever
 * clock PortAudio's own are of. What ALSA and JACK have to say on their way is not printed. Any
 * thread; openers wait for each other ---- */

CHECKED mrt_result sound_portaudio_create(sound_backend *out, error *err);
void sound_portaudio_destroy(sound_backend *backend); /* accepts zeroed; its streams first */

#endif
