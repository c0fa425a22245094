/* stream/video.h - a performance as moving pictures: a thread draws and encodes frame by frame, so
 * that memory stays the same at any length. The same renderer as everywhere, without a window.
 * Encoders: a folder of PNG (FOLDER/00001.png and on; FOLDER/frames.json has their number and rate;
 * they are moved into the folder when all are written, and replace only a sequence that marotte
 * wrote), and the program ffmpeg (pictures by a pipe, an .mp4 of H.264 and AAC, complete or
 * absent). Leaves out the formats of meshes (exports.h). [main]; one encoder on one thread. ffmpeg
 * gets default signal handlers and a process group of its own: Ctrl-C does not reach it. */
#ifndef MAROTTE_UI_VIDEO_H
#define MAROTTE_UI_VIDEO_H
#include "draw/scenery.h"

#include "csrbf/points.h"
#include "mesh/mesh.h"
#include "base/log.h"
#include "base/timecode.h"

typedef enum video_view { VIDEO_FRONT = 0, VIDEO_SIDE, VIDEO_THREE_QUARTER } video_view;
typedef enum video_ground {
    VIDEO_SCENE = 0, /* the wall, or the picture before it */
    VIDEO_COLOUR,
    VIDEO_NOTHING /* alpha is the face's coverage */
} video_ground;

typedef struct video_look {
    uint32_t width, height; /* pixels */
    bool is_sized;          /* by the person; else a contact sheet has a size of its own */
    video_view view;
    uint32_t kept_view;        /* of the scene's camera views, from 1; 0: `view` */
    draw_camera_view own_view; /* while has_own_view: in place of both */
    bool has_own_view;
    bool is_mirrored;
    video_ground ground;
    float rgba[4];        /* of VIDEO_COLOUR and VIDEO_NOTHING: sRGB-coded */
    const char *scene_of; /* a show; or a look's name, for the lights and the wall alone; NULL: as
                             it comes */
    const char *picture_path; /* behind the face in place of the scene's; NULL: that */
    scenery scene;
    scenery_picture picture; /* of the scene; owned by who calls video_look_open */
} video_look;

/* 1280 by 720, from the front, before the studio's wall. */
video_look video_look_usual(void);

/* What an option says: "1920x1080"; "front", "side", "three-quarter", "2" (of the views that are
 * kept), six numbers with commas (draw_camera_view); "#00b140", "transparent", a picture's path;
 * "theatre", a show's path. false: it is none, and the text below says what is. Paths are not
 * copied. */
bool video_look_size(video_look *self, const char *text);
bool video_look_view(video_look *self, const char *text);
bool video_look_ground(video_look *self, const char *text);
extern const char video_look_sizes[], video_look_grounds[];
/* The same by the option's name: "size", "view", "background", "look". NULL: read; else what it
 * says that is possible. */
const char *video_look_read(video_look *self, const char *name, const char *text);

/* Reads the scene and the picture: those that options named, else the scene of `from` (NULL:
 * none). An error is of what was named, or a view that is not kept; what is wrong with the scene of
 * `from` is a warning. */
CHECKED mrt_result video_look_open(video_look *self, show *from, log_queue *log, error *err);
void video_look_close(video_look *self);

/* Whether H.264 can show it; the error says what to write instead. */
CHECKED mrt_result video_look_check_mp4(const video_look *self, const char *path, error *err);

/* Shows a face with these bounds at rest, with room for a jaw that opens. */
draw_camera video_look_camera(const video_look *self, const float low[3], const float high[3]);
/* Left and right change places; rows of width pixels, in place. */
void video_look_mirror(uint8_t *rgba, uint32_t width, uint32_t height);

typedef struct video_folder video_folder;

typedef struct video_folder_about {
    uint32_t width, height;
    bool has_alpha;
    timecode_rate rate;
    const char *timecode; /* of the first frame; "" none */
} video_folder_about;

/* Whether a sequence may be written there: the folder is not there yet, empty, or has one of ours.
 */
CHECKED mrt_result video_folder_check(const char *path, error *err);
CHECKED mrt_result video_folder_open(video_folder **out, const char *path,
                                     const video_folder_about *about, error *err);
CHECKED mrt_result video_folder_add(video_folder *self, const uint8_t *rgba, error *err);
/* Freed whatever the result. */
CHECKED mrt_result video_folder_commit(video_folder *self, error *err);
void video_folder_abandon(video_folder *self); /* NULL is fine */

typedef struct video_ffmpeg video_ffmpeg;

typedef struct video_ffmpeg_about {
    uint32_t width, height; /* even */
    timecode_rate rate;
    const char *timecode; /* of the first frame; "" none */
    const char *sound;    /* a WAV whose first sample belongs to the first picture; NULL: silent */
    bool is_live;         /* of a stream: pictures count when they come, not by the rate */
    const _Atomic bool
        *gives_up;       /* set by any thread: whatever waits for ffmpeg fails; NULL: never */
    int64_t patience_ns; /* with an ffmpeg that stands still; 0: the usual 30 s */
} video_ffmpeg_about;

/* "srt://..." or "udp://...": ffmpeg sends MPEG-TS there, in the time that the rate says. */
bool video_is_stream(const char *path);

/* Whether there is an ffmpeg in $PATH; `path` is what it is needed for. */
CHECKED mrt_result video_ffmpeg_check(const char *path, error *err);
CHECKED mrt_result video_ffmpeg_open(video_ffmpeg **out, const char *path,
                                     const video_ffmpeg_about *about, error *err);
/* Waits while ffmpeg is busy. An error: ffmpeg stood still for the patience, or the caller gives
 * up. rgba: rows from the top. */
CHECKED mrt_result video_ffmpeg_add(video_ffmpeg *self, const uint8_t *rgba, error *err);
/* The same without patience: MRT_TIMEOUT when ffmpeg did not take the whole picture within 100 ms.
 * The next call must pass the same picture. */
CHECKED mrt_result video_ffmpeg_offer(video_ffmpeg *self, const uint8_t *rgba, error *err);
/* Waits until ffmpeg has ended, with the same patience. Success: the file is complete and in place.
 * Failure: an earlier file is still there. Freed whatever the result. */
CHECKED mrt_result video_ffmpeg_commit(video_ffmpeg *self, error *err);
/* Ends ffmpeg: a live one has a second to end by itself. False: it had to be killed. NULL is fine.
 */
bool video_ffmpeg_abandon(video_ffmpeg *self);

/* The .mp4 gets this sound in place of what it has, its pictures stay as they are. */
CHECKED mrt_result video_ffmpeg_add_sound(const char *path, const char *sound, error *err);

enum { VIDEO_FILES_MAX = 16 };

typedef enum video_pace {
    VIDEO_EVERY_FRAME = 0, /* video_add waits for the encoder */
    VIDEO_LIVE             /* video_add never waits: a late frame repeats the picture before it */
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
    const char *timecode;       /* of the first frame; "" none */
    const char *sound;          /* a WAV for the .mp4; NULL: silent */
    const _Atomic bool *cancel; /* set: the files are given up at once; NULL: never */
} video_settings;

typedef struct video video;

/* Whether the files can be written, before an hour of performing. */
CHECKED mrt_result video_check(const video_file *file, uint32_t count, const video_look *look,
                               error *err);
CHECKED mrt_result video_create(video **out, const video_file *file, uint32_t count,
                                const video_settings *settings, error *err);
/* Without video_finish everything that was written is removed. NULL is fine. */
void video_destroy(video *self);

/* The next frame. VIDEO_EVERY_FRAME: < 0 once the video has failed or is cancelled. VIDEO_LIVE: no
 * error; video_finish and video_has_failed report it. */
CHECKED mrt_result video_add(video *self, const points *shape, const points_order *order,
                             error *err);
bool video_has_failed(video *self, error *out_why);
/* Waits for the last picture. Success: the files are complete. */
CHECKED mrt_result video_finish(video *self, error *err);

typedef struct video_report {
    uint64_t picture_count;
    uint64_t repeated_count; /* VIDEO_LIVE: pictures that show the one before */
} video_report;
video_report video_reported(const video *self); /* after video_finish */

#endif
