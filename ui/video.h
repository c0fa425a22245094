/* video.h - a performance as moving pictures: frames come in one by one and are drawn, encoded and
 * forgotten in a thread of their own, so that memory stays the same at any length. The same
 * renderer as everywhere, without a window. Leaves out the formats of video (video_folder.h,
 * video_ffmpeg.h) and of meshes (exports.h). [main] */
#ifndef MAROTTE_UI_VIDEO_H
#define MAROTTE_UI_VIDEO_H
#include "csrbf/points.h"
#include "mesh/mesh.h"
#include "take/timecode.h"
#include "video_look.h"

enum { VIDEO_FILES_MAX = 16 };

typedef enum video_pace {
    VIDEO_EVERY_FRAME = 0, /* whoever is performed waits for the pictures */
    VIDEO_LIVE             /* nobody waits: what cannot be drawn in time shows the one before */
} video_pace;

typedef struct video_file { /* a folder ("frames/"), or an .mp4 */
    const char *path;
    bool is_folder;
} video_file;

typedef struct video_settings {
    const mesh *mesh; /* must outlive it */
    video_look look;
    video_pace pace;
    timecode_rate rate;
    const char *timecode; /* of the first frame; "" none */
    const char *sound;    /* a WAV for the .mp4; NULL: silent */
} video_settings;

typedef struct video video;

/* Better known before an hour of performing. */
CHECKED mrt_result video_check(const video_file *file, uint32_t count, const video_look *look,
                               error *err);
CHECKED mrt_result video_create(video **out, const video_file *file, uint32_t count,
                                const video_settings *settings, error *err);
/* Without video_finish all that was written is removed. NULL is fine. */
void video_destroy(video *self);

/* The next frame. VIDEO_EVERY_FRAME: < 0 as soon as the pictures have failed. VIDEO_LIVE: goes on
 * whatever becomes of them: video_finish says it, and video_has_failed. */
CHECKED mrt_result video_add(video *self, const points *shape, const points_order *order,
                             error *err);
bool video_has_failed(video *self, error *out_why);
/* Waits for the last picture; the files are there. */
CHECKED mrt_result video_finish(video *self, error *err);

typedef struct video_report {
    uint64_t picture_count;
    uint64_t repeated_count; /* VIDEO_LIVE: pictures that show the one before */
} video_report;
video_report video_reported(const video *self); /* after video_finish */

#endif
