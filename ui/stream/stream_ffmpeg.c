/* srt:// and udp:// by the program ffmpeg, as video files are written (video.h). Without alpha. */
#include "stream/stream.h"
#include "stream/video.h"

static mrt_result ffmpeg_open(void **out, const char *target, const stream_look *look, error *err)
{
    const video_ffmpeg_about about = {.width = look->width,
                                      .height = look->height,
                                      .rate = {look->fps, 1},
                                      .timecode = "",
                                      .is_live = true};
    video_ffmpeg *made = NULL;
    const mrt_result result = video_ffmpeg_open(&made, target, &about, err);
    *out = made;
    return result;
}

static mrt_result ffmpeg_give(void *self, const uint8_t *rgba, error *err)
{
    return video_ffmpeg_add(self, rgba, err);
}

static void ffmpeg_close(void *self)
{
    video_ffmpeg_abandon(self);
}

const stream_way stream_ffmpeg = {ffmpeg_open, ffmpeg_give, ffmpeg_close};
