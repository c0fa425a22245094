/* stage/sound/sound_device.h - one direction of sound: a loudspeaker or a microphone. It may be
 * absent, busy or unplugged at any time, which stops nothing: the status has a state and an
 * explanation for the user. An own thread opens the device, watches it and opens it again. The
 * devices come from a backend: PortAudio (sound_portaudio.c) or a test. Leaves out playback and
 * recording. [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_DEVICE_H
#define MAROTTE_STAGE_SOUND_DEVICE_H
#include "base/error.h"
#include "base/log.h"

typedef enum sound_direction { SOUND_OUT = 0, SOUND_IN } sound_direction;

typedef struct sound_block { /* of one direction; interleaved, with the channels of the open stream
                              */
    float *out;
    const float *in;
    uint32_t frame_count;
    int64_t time_ns; /* host clock: time of the first frame at the loudspeaker or microphone */
    bool is_broken;  /* frames were lost before this block: underrun or overrun */
} sound_block;
/* [device] Must not wait, allocate or make system calls. */
typedef void sound_callback(void *data, const sound_block *block);

typedef struct sound_request {
    uint32_t rate_hz;       /* a loudspeaker without this rate uses its own; 0: the device's rate */
    uint32_t channel_count; /* maximum; 0: channels of the device, at most 2 */
    char name[96];          /* part of the device's name; "": the default device */
    uint32_t number;        /* a different number opens the device again */
} sound_request;

typedef struct sound_stream { /* an open stream */
    void *handle;             /* of the backend */
    uint32_t rate_hz, channel_count;
    int64_t latency_ns;
    char name[96];
} sound_stream;

typedef struct sound_backend {
    void *self;
    /* Opens the stream without starting it. Errors tell the user what to do. */
    mrt_result (*open)(void *self, sound_direction direction, const sound_request *request,
                       sound_callback *callback, void *data, sound_stream *out, error *err);
    mrt_result (*start)(void *self, void *handle, error *err);
    /* Returns false if the stream has stopped. */
    bool (*is_alive)(void *self, void *handle);
    void (*close)(void *self, void *handle); /* no callback comes after it */
} sound_backend;

typedef enum sound_device_state {
    SOUND_DEVICE_OFF = 0, /* not wanted */
    SOUND_DEVICE_RUNNING,
    SOUND_DEVICE_AWAY /* cannot be opened, or has stopped; opened again every two seconds */
} sound_device_state;

typedef struct sound_device_status {
    sound_device_state state;
    sound_stream stream; /* if it is running; without its handle */
    uint32_t lost_count; /* number of times that it stopped unexpectedly */
    char text[256];      /* reason and advice in state AWAY; "": none */
} sound_device_status;

typedef struct sound_user {
    void *data;
    /* [opener] Called before the first block of each opening. < 0: the device cannot be used; err
     * has the reason. */
    mrt_result (*opened)(void *data, const sound_stream *stream, error *err);
    sound_callback *block; /* [device] */
} sound_user;

typedef enum sound_threads {
    SOUND_OWN_THREADS = 0,
    SOUND_BY_CALLER /* for tests: sound_device_work() does the work of the thread */
} sound_threads;

typedef struct sound_device sound_device;

/* backend->self and the log (NULL: no log) must outlive the device. */
CHECKED mrt_result sound_device_create(sound_device **out, sound_direction direction,
                                       const sound_backend *backend, const sound_user *user,
                                       log_queue *log, sound_threads threads, error *err);
/* Returns false if the device does not answer. Its thread then continues to wait inside the
 * backend, so the backend must not be freed. The user is not called any more. */
bool sound_device_destroy(sound_device *self); /* accepts NULL */

/* Sets the wanted stream. Never waits. */
void sound_device_want(sound_device *self, const sound_request *request);
/* Closes the device permanently, without waiting. After that no block comes, and destroy does not
 * wait. */
void sound_device_leave(sound_device *self);
bool sound_device_has_left(sound_device *self);
/* Valid until the next call. */
const sound_device_status *sound_device_read_status(sound_device *self);
/* [opener] Does one round. Returns the latest time of the next one. */
int64_t sound_device_work(sound_device *self, int64_t now_ns);

/* ---- sound devices of this computer through PortAudio. All times are converted to the host's
 * clock. Messages of ALSA and JACK are suppressed. Any thread; openers wait for each other ---- */

CHECKED mrt_result sound_portaudio_create(sound_backend *out, error *err);
void sound_portaudio_destroy(sound_backend *backend); /* accepts zeroed; close its streams first */

#endif
