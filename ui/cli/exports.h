/* ui/cli/exports.h - frames as files, in the format that the end of the file name selects. Meshes
 * are written from a clip after the performance. Videos are opened before it and receive each
 * frame. Also writes the sound of both. [main] */
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

/* The known endings, for a message: "one of .glb .mp4 ...". */
extern const char exports_names[];
/* Returns how to open a file of that format: "Blender: File > Import > glTF 2.0". */
const char *exports_opener(exports_format format);
/* Returns the format for the end of the name; EXPORTS_NONE: unknown. */
exports_format exports_format_of(const char *path);
bool exports_need_clip(const exports_file *file, uint32_t count);
/* Returns whether the files need the offsets of vertices: all but tables and hands do. */
bool exports_need_shapes(const exports_file *file, uint32_t count);
/* Returns whether the files need weights with ARKit names. */
bool exports_need_names(const exports_file *file, uint32_t count);

/* Creates the missing folders of the files, and checks that each file can be written. A problem is
 * then found before an hour of performing. */
CHECKED mrt_result exports_check(const exports_file *file, uint32_t count, error *err);

/* Checks that the face has what the formats need. */
CHECKED mrt_result exports_check_face(const exports_file *file, uint32_t count, const mesh *m,
                                      error *err);

/* Checks that the disk has room for the size that is known in advance. */
CHECKED mrt_result exports_check_room(const exports_file *file, uint32_t count, const mesh *m,
                                      int64_t frame_count, error *err);

typedef struct exports_settings {
    double tolerance_mm; /* of glTF; 0: default */
    uint32_t max_targets;
    bool is_bare;       /* glTF: only the mesh */
    double mm_per_unit; /* unit of caches, USD and hands; 0: mm, for hands cm */
    bool is_by_part;    /* caches: one file for each part, NAME.1.PART.pc2 */
    /* texts of contact sheets (draw/sheet.h) */
    const char *title, *made_from;
    const video_look *look; /* scene, and size if one was chosen */
} exports_settings;

/* Writes a line with the parameters of a mapping, "anchored 1.0: Hands Both, Size 90 %, ...".
 * Leaves out triggers, and parameters that are off by default and still off. */
void exports_describe_params(char *out, size_t capacity, const mrt_plugin_type *type,
                             const double *value);

/* Writes all files but the videos. Reports each written file and the peak memory. frames: may be
 * NULL if no file needs a clip. */
CHECKED mrt_result exports_write(const exports_file *file, uint32_t count, const clip *frames,
                                 const exports_settings *settings, progress *shown, facts *told,
                                 error *err);

typedef struct exports_video {
    video *video; /* NULL: no video was asked for */
    video_file file[VIDEO_FILES_MAX];
    uint32_t count;
    video_look look;
    bool is_told; /* the failure was reported */
} exports_video;

/* Selects the videos among the files, and checks before the performance that each can be written
 * and that its encoder exists. Close it, whatever the result. */
CHECKED mrt_result exports_prepare(exports_video *out, const exports_file *file, uint32_t count,
                                   const video_look *look, error *err);
const char *exports_video_mp4(const exports_video *self); /* the first .mp4; NULL: none */
CHECKED mrt_result exports_video_open(exports_video *self, const video_settings *settings,
                                      error *err);
/* Adds the drawn face as a frame. In a live performance a failure is reported once on stderr, and
 * the performance continues. */
CHECKED mrt_result exports_video_add(exports_video *self, composer *from, error *err);
CHECKED mrt_result exports_video_finish(exports_video *self, facts *told, error *err);
/* Removes unfinished videos, and releases the look. */
void exports_video_close(exports_video *self);

/* Writes the sound of a range of a take as a WAV. Reports damaged pieces. */
CHECKED mrt_result exports_sound(const char *path, show *s, const sound_file_export *what,
                                 sound_file_report *out, progress *shown, error *err);
/* Writes the sound into a temporary file; remove it with exports_video_sound_remove. */
CHECKED mrt_result exports_video_sound(char **out_path, show *s, const take *t, int64_t from_ns,
                                       int64_t to_ns, const char *beside, progress *shown,
                                       error *err);
/* The same for a sound file. */
CHECKED mrt_result exports_video_sound_file(char **out_path, const char *sound, double start_s,
                                            double length_s, const char *beside, error *err);
void exports_video_sound_remove(char *path); /* accepts NULL */
/* Adds the sound to the finished .mp4 files. */
CHECKED mrt_result exports_video_add_sound(const exports_video *self, const char *sound,
                                           error *err);

#endif
