#include "video_look.h"

#include "base/text.h"

#include <ctype.h>
#include <string.h>

enum { SIDE_MIN = 16, SIDE_MAX = 16384 };

const char video_look_sizes[] = "WIDTHxHEIGHT in pixels, 16 to 16384 each, such as 1920x1080";
const char video_look_views[] = "front, side or three-quarter";
const char video_look_grounds[] = "transparent, or a colour such as #00b140";

static const struct {
    const char *name;
    float yaw_rad, pitch_rad;
} views[] = {[VIDEO_FRONT] = {"front", 0.0f, 0.0f},
             [VIDEO_SIDE] = {"side", 1.5708f, 0.0f},
             [VIDEO_THREE_QUARTER] = {"three-quarter", 0.6109f, 0.0873f}}; /* 35 and 5 degrees */

video_look video_look_usual(void)
{
    return (video_look){.width = 1280, .height = 720};
}

static bool read_side(text_view word, uint32_t *out)
{
    int64_t value;
    if (!text_int(word, &value) || value < SIDE_MIN || value > SIDE_MAX)
        return false;
    *out = (uint32_t)value;
    return true;
}

bool video_look_size(video_look *self, const char *text)
{
    const char *cross = strchr(text, 'x');
    uint32_t width, height;
    if (!cross || !read_side(text_view_of(text, (size_t)(cross - text)), &width) ||
        !read_side(text_view_of(cross + 1, strlen(cross + 1)), &height))
        return false;
    self->width = width;
    self->height = height;
    self->is_sized = true;
    return true;
}

bool video_look_view(video_look *self, const char *text)
{
    for (size_t i = 0; i < sizeof views / sizeof *views; ++i) {
        if (strcmp(views[i].name, text) != 0)
            continue;
        self->view = (video_view)i;
        return true;
    }
    return false;
}

static int digit_of(char letter)
{
    static const char digits[] = "0123456789abcdef";
    const char *at = memchr(digits, tolower((unsigned char)letter), 16);
    return at ? (int)(at - digits) : -1;
}

bool video_look_ground(video_look *self, const char *text)
{
    if (strcmp(text, "transparent") == 0) {
        self->ground = VIDEO_NOTHING;
        memset(self->rgba, 0, sizeof self->rgba);
        return true;
    }
    if (text[0] != '#' || strlen(text) != 7)
        return false;
    float rgba[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    for (int i = 0; i < 3; ++i) {
        int high = digit_of(text[1 + 2 * i]), low = digit_of(text[2 + 2 * i]);
        if (high < 0 || low < 0)
            return false;
        rgba[i] = (float)(16 * high + low) / 255.0f;
    }
    self->ground = VIDEO_COLOUR;
    memcpy(self->rgba, rgba, sizeof rgba);
    return true;
}

mrt_result video_look_check_mp4(const video_look *self, const char *path, error *err)
{
    uint32_t width = self->width + self->width % 2, height = self->height + self->height % 2;
    if (self->ground == VIDEO_NOTHING)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: an .mp4 cannot be transparent: --export FOLDER/ writes pictures that "
                         "can, or choose --background #rrggbb",
                         path);
    if (width != self->width || height != self->height)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: an .mp4 has an even number of pixels a side: --size %ux%u", path,
                         width, height);
    return MRT_OK;
}

draw_camera video_look_camera(const video_look *self, const float low[3], const float high[3])
{
    const float chin = 0.03f, nearer = 0.92f; /* the face is the picture, and nothing turns */
    const float lowest[3] = {low[0], low[1] - chin * (high[1] - low[1]), low[2]};
    draw_camera camera =
        draw_camera_framing(lowest, high, (float)self->width / (float)self->height);
    camera.distance_mm *= nearer;
    camera.yaw_rad = views[self->view].yaw_rad;
    camera.pitch_rad = views[self->view].pitch_rad;
    return camera;
}

void video_look_mirror(uint8_t *rgba, uint32_t width, uint32_t height)
{
    for (uint32_t y = 0; y < height; ++y) {
        uint8_t *row = rgba + (size_t)y * width * 4;
        for (uint32_t x = 0; x < width / 2; ++x) {
            uint8_t kept[4], *left = row + (size_t)x * 4,
                             *right = row + (size_t)(width - 1 - x) * 4;
            memcpy(kept, left, 4);
            memcpy(left, right, 4);
            memcpy(right, kept, 4);
        }
    }
}
