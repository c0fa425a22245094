#include "stream/stream.h"

#include "base/clock.h"
#include "base/slot.h"
#include "stream/video.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- srt:// and udp://: sent by the program ffmpeg, in the same way as video files (video.h).
 * Without alpha. ---- */

typedef struct encoder {
    video_ffmpeg *ffmpeg;
    const char *target;
} encoder;

static mrt_result ffmpeg_open(void **out, const char *target, const stream_look *look,
                              const _Atomic bool *stop, error *err)
{
    const video_ffmpeg_about about = {.width = look->width,
                                      .height = look->height,
                                      .rate = {look->fps, 1},
                                      .timecode = "",
                                      .is_live = true,
                                      .gives_up = stop};
    encoder *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %s", target);
    self->target = target;
    const mrt_result result = video_ffmpeg_open(&self->ffmpeg, target, &about, err);
    if (result < 0)
        free(self);
    else
        *out = self;
    return result;
}

static mrt_result ffmpeg_give(void *data, const uint8_t *rgba, error *err)
{
    encoder *self = data;
    return video_ffmpeg_offer(self->ffmpeg, rgba, err);
}

static void ffmpeg_close(void *data, error *why)
{
    encoder *self = data;
    if (!video_ffmpeg_abandon(self->ffmpeg))
        error_set(why, MRT_ERR_IO, "%s: ffmpeg did not end in time, and was killed", self->target);
    free(self);
}

static const stream_way stream_ffmpeg = {ffmpeg_open, ffmpeg_give, ffmpeg_close};

/* ---- /dev/videoN of the kernel module v4l2loopback: other programs see a webcam. Without alpha:
 * the background is green. ---- */

typedef struct device {
    int fd;
    const char *path;
    stream_look look;
    uint8_t *yuyv;
} device;

static const int green[3] = {0x00, 0xb1, 0x40};

/* Returns the luma of colour c, 0..255: BT.601, limited range. */
static uint8_t luma(const int c[3])
{
    return (uint8_t)(16 + ((66 * c[0] + 129 * c[1] + 25 * c[2] + 128) >> 8));
}

void stream_yuyv(uint8_t *out, const uint8_t *rgba, size_t count)
{
    for (size_t i = 0; i + 1 < count; i += 2) {
        int c[2][3], mean[3];
        for (int k = 0; k < 3; ++k) {
            for (size_t p = 0; p < 2; ++p) {
                const uint8_t *at = rgba + 4 * (i + p);
                c[p][k] = (at[k] * at[3] + green[k] * (255 - at[3]) + 127) / 255;
            }
            mean[k] = (c[0][k] + c[1][k] + 1) / 2;
        }
        out[2 * i] = luma(c[0]);
        out[2 * i + 1] =
            (uint8_t)((-38 * mean[0] - 74 * mean[1] + 112 * mean[2] + 32768 + 128) >> 8);
        out[2 * i + 2] = luma(c[1]);
        out[2 * i + 3] =
            (uint8_t)((112 * mean[0] - 94 * mean[1] - 18 * mean[2] + 32768 + 128) >> 8);
    }
}

static void v4l2_close(void *data, error *why)
{
    device *self = data;
    (void)why;
    if (self->fd >= 0)
        close(self->fd);
    free(self->yuyv);
    free(self);
}

static mrt_result set_format(device *self, error *err)
{
    struct stat status;
    struct v4l2_capability can = {.capabilities = 0};
    struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_OUTPUT};
    if (fstat(self->fd, &status) != 0 || !S_ISCHR(status.st_mode) ||
        ioctl(self->fd, VIDIOC_QUERYCAP, &can) != 0 ||
        !((can.capabilities | can.device_caps) & V4L2_CAP_VIDEO_OUTPUT))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s cannot show pictures to other programs: choose a v4l2loopback device",
                         self->path);
    format.fmt.pix = (struct v4l2_pix_format){.width = self->look.width,
                                              .height = self->look.height,
                                              .pixelformat = V4L2_PIX_FMT_YUYV,
                                              .field = V4L2_FIELD_NONE,
                                              .bytesperline = self->look.width * 2,
                                              .sizeimage = self->look.width * self->look.height * 2,
                                              .colorspace = V4L2_COLORSPACE_SRGB};
    if (ioctl(self->fd, VIDIOC_S_FMT, &format) == 0 && format.fmt.pix.width == self->look.width &&
        format.fmt.pix.height == self->look.height &&
        format.fmt.pix.pixelformat == V4L2_PIX_FMT_YUYV)
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "%s refuses %u x %u pixels: close the programs that use it at another size",
                     self->path, self->look.width, self->look.height);
}

static mrt_result v4l2_open(void **out, const char *target, const stream_look *look,
                            const _Atomic bool *stop, error *err)
{
    device *self = calloc(1, sizeof *self);
    (void)stop; /* this target never waits */
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %s", target);
    self->path = target;
    self->look = *look;
    self->fd = open(target, O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    self->yuyv = malloc((size_t)look->width * look->height * 2);
    mrt_result result = self->yuyv ? MRT_OK : MRT_ERR_MEMORY;
    if (self->fd < 0)
        result = error_set(err, MRT_ERR_IO,
                           "%s: %s. Create one: sudo modprobe v4l2loopback exclusive_caps=1",
                           target, strerror(errno));
    if (result >= 0)
        result = set_format(self, err);
    if (result < 0) {
        v4l2_close(self, NULL);
        return result;
    }
    *out = self;
    return MRT_OK;
}

static mrt_result v4l2_give(void *data, const uint8_t *rgba, error *err)
{
    device *self = data;
    const size_t size = (size_t)self->look.width * self->look.height * 2;
    stream_yuyv(self->yuyv, rgba, (size_t)self->look.width * self->look.height);
    if (write(self->fd, self->yuyv, size) >= 0 || errno == EAGAIN || errno == EINTR)
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "%s: the video device was lost: %s", self->path,
                     strerror(errno));
}

static const stream_way stream_v4l2 = {v4l2_open, v4l2_give, v4l2_close};

/* ---- a target: its thread, and the pictures that are handed to it ---- */

enum { PICTURES = 3 };
static const int64_t retry_ns = 2 * NS_PER_S;
static const int64_t stall_ns = 3 * NS_PER_S; /* without progress: reported in the status */

struct stream_target {
    const stream_way *way;
    char target[STREAM_TARGET];
    stream_look look;
    publish_slot slot;
    uint8_t *picture[PICTURES];
    pthread_t thread;
    bool has_thread, has_mutex;
    _Atomic bool stop; /* set under the mutex, which also guards the members below */
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    bool is_new;
    stream_status status;
};

/* ---- the thread ---- */

static bool wait_for_picture(stream_target *self)
{
    pthread_mutex_lock(&self->mutex);
    while (!self->is_new && !atomic_load(&self->stop))
        pthread_cond_wait(&self->wake, &self->mutex);
    self->is_new = false;
    const bool goes_on = !atomic_load(&self->stop);
    pthread_mutex_unlock(&self->mutex);
    return goes_on;
}

/* given: 1 if a picture was delivered */
static void note(stream_target *self, bool is_open, uint64_t given, const char *says)
{
    pthread_mutex_lock(&self->mutex);
    self->status.is_open = is_open;
    self->status.given += given;
    (void)snprintf(self->status.says, sizeof self->status.says, "%.*s", STREAM_MESSAGE - 1, says);
    pthread_mutex_unlock(&self->mutex);
}

/* Delivers one picture, and waits for that: a listener may wait hours for its first caller.
 * MRT_TIMEOUT: the stream was stopped during the wait. */
static mrt_result give(stream_target *self, void *way, error *err)
{
    const uint8_t *rgba = self->picture[slot_front(&self->slot)];
    const int64_t began_ns = clock_now_ns();
    mrt_result result;
    while ((result = self->way->give(way, rgba, err)) == MRT_TIMEOUT && !atomic_load(&self->stop)) {
        if (clock_now_ns() - began_ns < stall_ns)
            continue;
        (void)error_set(err, MRT_OK, "%s: no picture was taken for %d s: waiting for a receiver",
                        self->target, (int)(stall_ns / NS_PER_S));
        note(self, false, 0, err->text);
    }
    return result;
}

static void *run(void *data)
{
    stream_target *self = data;
    void *way = NULL;
    int64_t again_ns = 0;
    error left = {""};
    while (wait_for_picture(self)) {
        error err = {""};
        if (!slot_receive(&self->slot) || (!way && clock_now_ns() < again_ns))
            continue;
        mrt_result result =
            way ? MRT_OK : self->way->open(&way, self->target, &self->look, &self->stop, &err);
        if (result >= 0)
            result = give(self, way, &err);
        if (result != MRT_TIMEOUT)
            note(self, result >= 0, result >= 0, result < 0 ? err.text : "");
        if (result >= 0)
            continue;
        if (way)
            self->way->close(way, &left);
        way = NULL;
        again_ns = clock_now_ns() + retry_ns;
    }
    left.text[0] = '\0';
    if (way)
        self->way->close(way, &left);
    note(self, false, 0, left.text);
    pthread_mutex_lock(&self->mutex);
    self->status.has_ended = true;
    pthread_mutex_unlock(&self->mutex);
    return NULL;
}

/* ---- [main] ---- */

/* Accepts exactly /dev/videoN: any other name could lead to another file. */
static bool is_video_device(const char *target)
{
    static const char prefix[] = "/dev/video";
    const size_t length = sizeof prefix - 1;
    return strncmp(target, prefix, length) == 0 && target[length] != '\0' &&
           target[length + strspn(target + length, "0123456789")] == '\0';
}

static const stream_way *way_of(const char *target, error *err)
{
    if (strncmp(target, "srt://", 6) == 0 || strncmp(target, "udp://", 6) == 0)
        return &stream_ffmpeg;
    if (is_video_device(target))
        return &stream_v4l2;
    if (strcmp(target, "pipewire") == 0 || strncmp(target, "pipewire:", 9) == 0) {
#ifdef MAROTTE_HAS_PIPEWIRE
        return &stream_pipewire;
#else
        error_set(err, MRT_ERR_UNSUPPORTED,
                  "marotte was built without PipeWire (libpipewire-0.3-dev): use srt://, udp:// or "
                  "/dev/videoN");
        return NULL;
#endif
    }
    error_set(err, MRT_ERR_ARGUMENT,
              "cannot stream to \"%.80s\": expected pipewire, /dev/videoN, "
              "srt://HOST:PORT or udp://HOST:PORT",
              target);
    return NULL;
}

static bool has_pictures(stream_target *self)
{
    bool has_all = true;
    for (int i = 0; i < PICTURES; ++i) {
        self->picture[i] = calloc((size_t)self->look.width * self->look.height, 4);
        has_all &= self->picture[i] != NULL;
    }
    return has_all;
}

mrt_result stream_open(stream_target **out, const char *target, const stream_look *look, error *err)
{
    const stream_way *way = way_of(target, err);
    *out = NULL;
    if (!way)
        return MRT_ERR_ARGUMENT;
    if (strlen(target) >= STREAM_TARGET)
        return error_set(err, MRT_ERR_ARGUMENT, "the address of a stream is too long");
    stream_target *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a stream");
    self->way = way;
    self->look = *look;
    (void)snprintf(self->target, sizeof self->target, "%s", target);
    slot_init(&self->slot);
    self->has_mutex = has_pictures(self) && pthread_mutex_init(&self->mutex, NULL) == 0 &&
                      pthread_cond_init(&self->wake, NULL) == 0;
    self->has_thread = self->has_mutex && pthread_create(&self->thread, NULL, run, self) == 0;
    if (!self->has_thread) {
        stream_close(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory, or no thread, for a stream");
    }
    *out = self;
    return MRT_OK;
}

void stream_stop(stream_target *self)
{
    pthread_mutex_lock(&self->mutex);
    atomic_store(&self->stop, true);
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->mutex);
}

void stream_close(stream_target *self)
{
    if (!self)
        return;
    if (self->has_thread) {
        stream_stop(self);
        (void)pthread_join(self->thread, NULL);
    }
    if (self->has_mutex) {
        pthread_cond_destroy(&self->wake);
        pthread_mutex_destroy(&self->mutex);
    }
    for (int i = 0; i < PICTURES; ++i)
        free(self->picture[i]);
    free(self);
}

uint8_t *stream_picture(stream_target *self)
{
    return self->picture[slot_back(&self->slot)];
}

void stream_give(stream_target *self)
{
    slot_publish(&self->slot);
    pthread_mutex_lock(&self->mutex);
    self->is_new = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->mutex);
}

stream_status stream_status_of(stream_target *self)
{
    pthread_mutex_lock(&self->mutex);
    const stream_status out = self->status;
    pthread_mutex_unlock(&self->mutex);
    return out;
}
