/* stream/stream.h - the picture of the face for other programs, live: a PipeWire camera, a
 * v4l2loopback device, ffmpeg to srt:// or udp://. Each target has a thread of its own, which
 * opens, gives and comes back when the other side was gone; the thread that draws hands pictures
 * over and never waits. Leaves out drawing and reading back. */
#ifndef MAROTTE_UI_STREAM_STREAM_H
#define MAROTTE_UI_STREAM_STREAM_H
#include "base/error.h"

enum { STREAM_TARGETS_MAX = 4, STREAM_TARGET = 256, STREAM_SAYS = 256 };

typedef struct stream_look {
    uint32_t width, height; /* even */
    uint32_t fps;
} stream_look;

/* A kind of target. [thread of the target] */
typedef struct stream_way {
    /* It is called again some seconds after an error, which the status shows once. target and stop
     * outlive what is opened. Once another thread sets *stop, nothing that was opened waits. */
    mrt_result (*open)(void **out, const char *target, const stream_look *look,
                       const _Atomic bool *stop, error *err);
    /* RGBA, straight alpha, rows from the top. Waits for a fraction of a second. MRT_TIMEOUT: not
     * all of the picture was taken; the same picture comes again. < 0: lost; it is opened again. */
    mrt_result (*give)(void *self, const uint8_t *rgba, error *err);
    /* Waits for two seconds at most. why: an error to show, or as it is. */
    void (*close)(void *self, error *why);
} stream_way;
#ifdef MAROTTE_HAS_PIPEWIRE
extern const stream_way stream_pipewire; /* "pipewire", or "pipewire:NAME" */
#endif

/* Pixels over the green of a key as YUYV, BT.601, two in four bytes; count even. */
void stream_yuyv(uint8_t *out, const uint8_t *rgba, size_t count);

typedef struct stream_target stream_target; /* [main] calls all of these */
/* An error: the text is not a target, or this build lacks its kind. */
CHECKED mrt_result stream_open(stream_target **out, const char *target, const stream_look *look,
                               error *err);
/* Ends it without waiting: within about two seconds stream_status_of says that it has ended, and
 * what went wrong. */
void stream_stop(stream_target *self);
/* Waits for that end. NULL is fine. */
void stream_close(stream_target *self);
/* Buffer for the next picture, look.width * look.height * 4; then stream_give hands it over. */
uint8_t *stream_picture(stream_target *self);
void stream_give(stream_target *self);

typedef struct stream_status {
    bool is_open, has_ended;
    char says[STREAM_SAYS]; /* a problem, one line; "" none */
    uint64_t given;         /* pictures */
} stream_status;
stream_status stream_status_of(stream_target *self);

#endif
