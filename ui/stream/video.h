/* stream/video.h - a performance as moving pictures. A thread draws and encodes frame by frame, so
 * that memory does not grow with the length. It uses the same renderer as the stage, without a
 * window. Outputs: a folder of PNG, and an .mp4 by the program ffmpeg.
 * A folder has FOLDER/00001.png and so on, and FOLDER/frames.json with number and rate. Pictures
 * are moved into it when all are written. They replace only a sequence that marotte wrote.
 * ffmpeg receives pictures through a pipe and writes H.264 and AAC; the .mp4 is complete or absent.
 * ffmpeg has default signal handlers and its own process group, so that Ctrl-C does not reach it.
 * Leaves out the formats of meshes (cli/exports.h). [main]; each encoder on one thread. */
#ifndef MAROTTE_UI_VIDEO_H
#define MAROTTE_UI_VIDEO_H
#include "draw/scenery.h"

#include "csrbf/points.h"
#include "mesh/mesh.h"
#include "base/log.h"
#include "base/timecode.h"

typedef enum video_view { VIDEO_FRONT = 0, VIDEO_SIDE, VIDEO_THREE_QUARTER } video_view;
typedef enum video_ground {
    VIDEO_SCENE = 0, /* the wall, or the picture in front of it */
    VIDEO_COLOUR,
    VIDEO_NOTHING /* alpha is the coverage of the face */
} video_ground;

typedef struct video_look {
    uint32_t width, height; /* pixels */
    bool is_sized;          /* size was chosen by the user; otherwise a contact sheet has its own */
    video_view view;
    uint32_t kept_view;        /* number of a camera view of the scene, from 1; 0: `view` */
    draw_camera_view own_view; /* if has_own_view: used instead of both */
    bool has_own_view;
    bool is_mirrored;
    video_ground ground;
    float rgba[4];            /* for VIDEO_COLOUR and VIDEO_NOTHING: sRGB-coded */
    const char *scene_of;     /* a show, or a look's name for lights and wall; NULL: not given */
    const char *picture_path; /* picture behind the face instead of the scene's; NULL: none */
    scenery scene;
    scenery_picture picture; /* of the scene; the caller of video_look_open owns it */
} video_look;

/* Returns the default look: 1280 by 720, from the front, the studio's wall. */
video_look video_look_default(void);

/* Parse the value of an option. Size: "1920x1080". View: "front", "side", "three-quarter", "2" (a
 * camera view), or six numbers with commas (draw_camera_view). Background: "#00b140",
 * "transparent", or the path of a picture. Scene: "theatre", or the path of a show. Return false if
 * the value is invalid; the texts below describe the valid ones. Paths are not copied. */
bool video_look_size(video_look *self, const char *text);
bool video_look_view(video_look *self, const char *text);
bool video_look_ground(video_look *self, const char *text);
extern const char video_look_sizes[], video_look_grounds[];
/* Parses by the name of the option: "size", "view", "background", "look". Returns NULL, or the text
 * that describes the valid values. */
const char *video_look_read(video_look *self, const char *name, const char *text);

/* Reads the scene and the picture: those that options named, else the scene of `from` (NULL: none).
 * Returns an error if one that an option named cannot be read, or if the camera view does not
 * exist. Problems in the scene of `from` are logged as warnings. */
CHECKED mrt_result video_look_open(video_look *self, show *from, log_queue *log, error *err);
void video_look_close(video_look *self);

/* Checks that H.264 can show it. The error suggests what to write instead. */
CHECKED mrt_result video_look_check_mp4(const video_look *self, const char *path, error *err);

/* Returns a camera that shows a face with these bounds at rest, with room for a jaw that opens. */
draw_camera video_look_camera(const video_look *self, const float low[3], const float high[3]);
/* Swaps left and right in rows of width pixels, in place. */
void video_look_mirror(uint8_t *rgba, uint32_t width, uint32_t height);

typedef struct video_folder video_folder;

typedef struct video_folder_about {
    uint32_t width, height;
    bool has_alpha;
    timecode_rate rate;
    const char *timecode; /* of the first frame; "": none */
} video_folder_about;

/* Checks that a sequence may be written there: the folder does not exist, is empty, or has a
 * sequence of marotte. */
CHECKED mrt_result video_folder_check(const char *path, error *err);
CHECKED mrt_result video_folder_open(video_folder **out, const char *path,
                                     const video_folder_about *about, error *err);
CHECKED mrt_result video_folder_add(video_folder *self, const uint8_t *rgba, error *err);
/* Frees self, whatever the result. */
CHECKED mrt_result video_folder_commit(video_folder *self, error *err);
void video_folder_abandon(video_folder *self); /* accepts NULL */

typedef struct video_ffmpeg video_ffmpeg;

typedef struct video_ffmpeg_about {
    uint32_t width, height; /* even */
    timecode_rate rate;
    const char *timecode; /* of the first frame; "": none */
    const char *sound;    /* a WAV that starts with the first picture; NULL: silent */
    bool is_live;         /* a stream: pictures are timed by their arrival, not by the rate */
    const _Atomic bool
        *gives_up;       /* any thread sets it to make waits for ffmpeg fail; NULL: never */
    int64_t patience_ns; /* with an ffmpeg that makes no progress; 0: the default, 30 s */
} video_ffmpeg_about;

/* Returns whether this is "srt://..." or "udp://...": ffmpeg sends MPEG-TS there, at the rate of
 * the video. */
bool video_is_stream(const char *path);

/* Checks that $PATH has ffmpeg; `path` is the file that needs it. */
CHECKED mrt_result video_ffmpeg_check(const char *path, error *err);
CHECKED mrt_result video_ffmpeg_open(video_ffmpeg **out, const char *path,
                                     const video_ffmpeg_about *about, error *err);
/* Writes a picture; waits while ffmpeg is busy. Fails if ffmpeg made no progress for the patience,
 * or if the caller cancels. rgba: rows from the top. */
CHECKED mrt_result video_ffmpeg_add(video_ffmpeg *self, const uint8_t *rgba, error *err);
/* The same, but MRT_TIMEOUT if ffmpeg did not read the whole picture within 100 ms. The next call
 * must pass the same picture. */
CHECKED mrt_result video_ffmpeg_offer(video_ffmpeg *self, const uint8_t *rgba, error *err);
/* Waits until ffmpeg has ended, with the same patience. On success the file is complete and in
 * place. On failure an earlier file is kept. Frees self, whatever the result. */
CHECKED mrt_result video_ffmpeg_commit(video_ffmpeg *self, error *err);
/* Ends ffmpeg; a live one has a second to end by itself. Returns false if it was killed. Accepts
 * NULL. */
bool video_ffmpeg_abandon(video_ffmpeg *self);

/* Replaces the sound of the .mp4. Its pictures are copied unchanged. */
CHECKED mrt_result video_ffmpeg_add_sound(const char *path, const char *sound, error *err);

enum { VIDEO_FILES_MAX = 16 };

typedef enum video_pace {
    VIDEO_EVERY_FRAME = 0, /* video_add waits for the encoder */
    VIDEO_LIVE             /* video_add never waits: a late frame repeats the previous picture */
} video_pace;

typedef struct video_file { /* a folder ("frames/") or an .mp4 */
    const char *path;
    bool is_folder;
} video_file;

typedef struct video_settings {
    const mesh *mesh; /* must outlive the video */
    video_look look;
    video_pace pace;
    timecode_rate rate;
    const char *timecode;       /* of the first frame; "": none */
    const char *sound;          /* a WAV for the .mp4; NULL: silent */
    const _Atomic bool *cancel; /* set it to abandon the files immediately; NULL: never */
} video_settings;

typedef struct video video;

/* Checks that the files can be written, before an hour of performing. */
CHECKED mrt_result video_check(const video_file *file, uint32_t count, const video_look *look,
                               error *err);
CHECKED mrt_result video_create(video **out, const video_file *file, uint32_t count,
                                const video_settings *settings, error *err);
/* Removes everything that was written, unless video_finish succeeded. Accepts NULL. */
void video_destroy(video *self);

/* Adds the next frame. VIDEO_EVERY_FRAME: < 0 if the video has failed or was cancelled. VIDEO_LIVE:
 * never an error; video_finish and video_has_failed report it. */
CHECKED mrt_result video_add(video *self, const points *shape, const points_order *order,
                             error *err);
bool video_has_failed(video *self, error *out_why);
/* Waits for the last picture. On success the files are complete. */
CHECKED mrt_result video_finish(video *self, error *err);

typedef struct video_report {
    uint64_t picture_count;
    uint64_t repeated_count; /* VIDEO_LIVE: pictures that repeat the previous one */
} video_report;
video_report video_reported(const video *self); /* after video_finish */

#endif
