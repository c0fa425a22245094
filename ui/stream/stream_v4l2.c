/* A device of the kernel module v4l2loopback, which any program takes for a webcam. Without alpha:
 * what is behind the face is green. */
#include "stream/stream.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

typedef struct device {
    int fd;
    stream_look look;
    uint8_t *yuyv;
} device;

static const int green[3] = {0x00, 0xb1, 0x40};

/* BT.601, limited range; of colour c 0..255. */
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

static void v4l2_close(void *data)
{
    device *self = data;
    if (self->fd >= 0)
        close(self->fd);
    free(self->yuyv);
    free(self);
}

static mrt_result set_format(device *self, const char *path, error *err)
{
    struct v4l2_capability can = {.capabilities = 0};
    struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_OUTPUT};
    if (ioctl(self->fd, VIDIOC_QUERYCAP, &can) != 0 ||
        !((can.capabilities | can.device_caps) & V4L2_CAP_VIDEO_OUTPUT))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s takes no pictures: it must be one of v4l2loopback", path);
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
                     "%s does not take %u x %u pixels: somebody uses it at another size", path,
                     self->look.width, self->look.height);
}

static mrt_result v4l2_open(void **out, const char *target, const stream_look *look, error *err)
{
    device *self = calloc(1, sizeof *self);
    *out = NULL;
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %s", target);
    self->look = *look;
    self->fd = open(target, O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    self->yuyv = malloc((size_t)look->width * look->height * 2);
    mrt_result result = self->yuyv ? MRT_OK : MRT_ERR_MEMORY;
    if (self->fd < 0)
        result = error_set(err, MRT_ERR_IO,
                           "%s: %s; sudo modprobe v4l2loopback exclusive_caps=1 makes one", target,
                           strerror(errno));
    if (result >= 0)
        result = set_format(self, target, err);
    if (result < 0) {
        v4l2_close(self);
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
    return error_set(err, MRT_ERR_IO, "the video device has gone: %s", strerror(errno));
}

const stream_way stream_v4l2 = {v4l2_open, v4l2_give, v4l2_close};
