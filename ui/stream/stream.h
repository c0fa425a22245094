/* stream/stream.h - live pictures of the face for other programs: a PipeWire camera, a v4l2loopback
 * device, ffmpeg to srt:// or udp://. Each target has its own thread, which opens the target,
 * delivers pictures, and reconnects after a loss. The drawing thread hands over pictures and never
 * waits. Leaves out drawing and reading back. */
#ifndef MAROTTE_UI_STREAM_STREAM_H
#define MAROTTE_UI_STREAM_STREAM_H
#include "base/error.h"

enum { STREAM_TARGETS_MAX = 4, STREAM_TARGET = 256, STREAM_MESSAGE = 256 };

typedef struct stream_look {
    uint32_t width, height; /* even */
    uint32_t fps;
} stream_look;

/* A kind of target. [thread of the target] */
typedef struct stream_way {
    /* Opens a target. After an error it is called again some seconds later; the status shows the
     * error once. target and stop outlive the opened object. After another thread has set *stop, no
     * function of the object waits. */
    mrt_result (*open)(void **out, const char *target, const stream_look *look,
                       const _Atomic bool *stop, error *err);
    /* Delivers a picture: RGBA, straight alpha, rows from the top. Waits for a fraction of a
     * second. MRT_TIMEOUT: incomplete, so the same picture is passed again. < 0: the target was
     * lost and will be opened again. */
    mrt_result (*give)(void *self, const uint8_t *rgba, error *err);
    /* Waits at most two seconds. why: receives an error to show, or stays unchanged. */
    void (*close)(void *self, error *why);
} stream_way;
#ifdef MAROTTE_HAS_PIPEWIRE
extern const stream_way stream_pipewire; /* "pipewire", or "pipewire:NAME" */
#endif

/* Converts pixels over key green to YUYV, BT.601, two pixels in four bytes; count even. */
void stream_yuyv(uint8_t *out, const uint8_t *rgba, size_t count);

typedef struct stream_target stream_target; /* [main] for all functions below */
/* Fails if the text is not a target, or if this build lacks its kind. */
CHECKED mrt_result stream_open(stream_target **out, const char *target, const stream_look *look,
                               error *err);
/* Requests the end, without waiting. Within about two seconds stream_status_of reports that it has
 * ended, and any error. */
void stream_stop(stream_target *self);
/* Waits for the end. Accepts NULL. */
void stream_close(stream_target *self);
/* Returns the buffer for the next picture, look.width * look.height * 4. stream_give then hands it
 * over. */
uint8_t *stream_picture(stream_target *self);
void stream_give(stream_target *self);

typedef struct stream_status {
    bool is_open, has_ended;
    char says[STREAM_MESSAGE]; /* a problem, one line; "": none */
    uint64_t given;            /* number of delivered pictures */
} stream_status;
stream_status stream_status_of(stream_target *self);

#endif
