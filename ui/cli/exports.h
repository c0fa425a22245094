/* ui/cli/exports.h - frames out of the program, in the format that a file's name asks for: meshes from
 * a clip when the performance is over, videos opened before it, fed with each frame, and the sound
 * that belongs to them. [main] */
#ifndef MAROTTE_UI_EXPORTS_H
#define MAROTTE_UI_EXPORTS_H
#include "io/export_formats.h"
#include "cli/facts.h"
#include "io/export.h"
#include "cli/terminal.h"
#include "stage/perform/composer.h"
#include "show/show.h"
#include "show/sound_file.h"
#include "stream/video.h"

enum { EXPORTS_MAX = 16 };

typedef enum exports_format {
    EXPORTS_NONE = 0,
#define X(format, ending, name, holds, lacks) EXPORTS_##format,
    EXPORTS_FORMATS(X)
#undef X
        EXPORTS_END
} exports_format;

typedef struct exports_file {
    const char *path;
    exports_format format;
} exports_file;

/* What exports_format_of knows, for a sentence: "one of .glb .mp4 ...". */
extern const char exports_names[];
/* What opens a file of that format: "Blender: File > Import > glTF 2.0". */
const char *exports_opener(exports_format format);
/* By the name's end; EXPORTS_NONE: none of ours. */
exports_format exports_format_of(const char *path);
bool exports_need_clip(const exports_file *file, uint32_t count);
/* And what moves which vertex: all but tables and hands. */
bool exports_need_shapes(const exports_file *file, uint32_t count);
/* What the frames are in ARKit's names. */
bool exports_need_names(const exports_file *file, uint32_t count);

/* Creates the missing folders of the files, and checks that each file can be written: before an
 * hour of performing. */
CHECKED mrt_result exports_check(const exports_file *file, uint32_t count, error *err);

/* Likewise, once the face is known: what a format wants of it. */
CHECKED mrt_result exports_check_face(const exports_file *file, uint32_t count, const mesh *m,
                                      error *err);

/* And how many frames: whether the disk has room for what they are sure to take. */
CHECKED mrt_result exports_check_room(const exports_file *file, uint32_t count, const mesh *m,
                                      int64_t frame_count, error *err);

typedef struct exports_settings {
    double tolerance_mm; /* of glTF; 0: its default */
    uint32_t max_targets;
    bool is_bare;       /* glTF: the mesh alone */
    double mm_per_unit; /* of caches, USD and hands; 0: mm, of hands cm */
    bool is_by_part;    /* caches: a file for each part, NAME.1.PART.pc2 */
    /* of contact sheets (draw/sheet.h) */
    const char *title, *made_from;
    const video_look *look; /* its size, if it was chosen, and its scene */
} exports_settings;

/* A line on what a mapping was set to, "anchored 1.0: Hands Both, Size 90 %, ...": all that it
 * has but triggers, and what is off unless somebody sets it. */
void exports_tell_params(char *out, size_t capacity, const mrt_plugin_type *type,
                         const double *value);

/* All but the videos. Tells each file that was written, and the memory that was used. frames: may
 * be NULL where no clip is needed. */
CHECKED mrt_result exports_write(const exports_file *file, uint32_t count, const clip *frames,
                                 const exports_settings *settings, progress *shown, facts *told,
                                 error *err);

typedef struct exports_video {
    video *video; /* NULL: no video is wanted */
    video_file file[VIDEO_FILES_MAX];
    uint32_t count;
    video_look look;
    bool is_told; /* that it has failed */
} exports_video;

/* Chooses the videos among the files, and checks all that can be known before an hour of
 * performing: that each file can be written, and that there is what videos need. To be closed
 * whatever the result. */
CHECKED mrt_result exports_prepare(exports_video *out, const exports_file *file, uint32_t count,
                                   const video_look *look, error *err);
const char *exports_video_mp4(const exports_video *self); /* the first one; NULL: none */
CHECKED mrt_result exports_video_open(exports_video *self, const video_settings *settings,
                                      error *err);
/* The face as drawn. Live, a failure is said once on stderr, and the performance goes on. */
CHECKED mrt_result exports_video_add(exports_video *self, composer *from, error *err);
CHECKED mrt_result exports_video_finish(exports_video *self, facts *told, error *err);
/* Removes what is not finished, and lets go of the look. */
void exports_video_close(exports_video *self);

/* The sound of a range of a take as a WAV; damaged pieces of it are said. */
CHECKED mrt_result exports_sound(const char *path, show *s, const sound_file_export *what,
                                 sound_file_report *out, progress *shown, error *err);
/* The same without a name of its own; to be removed. */
CHECKED mrt_result exports_video_sound(char **out_path, show *s, const take *t, int64_t from_ns,
                                       int64_t to_ns, const char *beside, progress *shown,
                                       error *err);
/* Likewise of a sound file. */
CHECKED mrt_result exports_video_sound_file(char **out_path, const char *sound, double start_s,
                                            double length_s, const char *beside, error *err);
void exports_video_sound_remove(char *path); /* NULL is fine */
/* Into the .mp4 files that are there already. */
CHECKED mrt_result exports_video_add_sound(const exports_video *self, const char *sound,
                                           error *err);

#endif
