/* video_ffmpeg.h - the ffmpeg program as an encoder: pictures go in by a pipe, an .mp4 of H.264 and
 * AAC comes out, complete or absent. Leaves out where pictures come from (video.h). One thread;
 * what it starts has signals as usual, and does not hear the terminal's. */
#ifndef MAROTTE_UI_VIDEO_FFMPEG_H
#define MAROTTE_UI_VIDEO_FFMPEG_H
#include "take/timecode.h"

typedef struct video_ffmpeg video_ffmpeg;

typedef struct video_ffmpeg_about {
    uint32_t width, height; /* even */
    timecode_rate rate;
    const char *timecode; /* of the first frame; "" none */
    const char *sound;    /* a WAV whose first sample belongs to the first picture; NULL: silent */
} video_ffmpeg_about;

/* Whether there is an ffmpeg in $PATH; `path` is what it is needed for. */
CHECKED mrt_result video_ffmpeg_check(const char *path, error *err);
CHECKED mrt_result video_ffmpeg_open(video_ffmpeg **out, const char *path,
                                     const video_ffmpeg_about *about, error *err);
/* Waits while ffmpeg is busy. rgba: rows from the top. */
CHECKED mrt_result video_ffmpeg_add(video_ffmpeg *self, const uint8_t *rgba, error *err);
/* Waits until the file is there. Freed whatever the result. */
CHECKED mrt_result video_ffmpeg_commit(video_ffmpeg *self, error *err);
void video_ffmpeg_abandon(video_ffmpeg *self); /* NULL is fine */

/* The .mp4 gets this sound in place of what it has, its pictures stay as they are. */
CHECKED mrt_result video_ffmpeg_add_sound(const char *path, const char *sound, error *err);

#endif
