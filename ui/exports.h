/* exports.h - frames out of the program, in the format that a file's name asks for. [main] */
#ifndef MAROTTE_UI_EXPORTS_H
#define MAROTTE_UI_EXPORTS_H
#include "facts.h"
#include "io/export.h"
#include "progress.h"

enum { EXPORTS_MAX = 16 };

typedef enum exports_format {
    EXPORTS_NONE = 0,
    EXPORTS_GLB,
    EXPORTS_PC2,
    EXPORTS_MDD,
    EXPORTS_CSV,
    EXPORTS_PNG,
    EXPORTS_MP4,
    EXPORTS_FOLDER /* of pictures: a name that ends in '/' */
} exports_format;

typedef struct exports_file {
    const char *path;
    exports_format format;
} exports_file;

/* What exports_format_of knows: ".glb, .pc2 ...". */
extern const char exports_names[];
/* By the name's end; EXPORTS_NONE: none of ours. */
exports_format exports_format_of(const char *path);
/* Written frame by frame while it is performed (exports_video.h); all others from a clip. */
bool exports_is_video(exports_format format);
bool exports_need_clip(const exports_file *file, uint32_t count);

/* A file that cannot be written is better known before an hour of performing. */
CHECKED mrt_result exports_check(const exports_file *file, uint32_t count, error *err);

typedef struct exports_settings {
    double tolerance_mm; /* of glTF; 0: its default */
    uint32_t max_targets;
    /* of contact sheets (draw/sheet.h) */
    const char *title, *made_from;
    uint32_t width, height; /* 0: as usual */
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

#endif
