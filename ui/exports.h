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
    const char *title; /* of pictures */
} exports_settings;

/* All but the videos. Tells each file that was written, and the memory that was used. frames: may
 * be NULL where no clip is needed. */
CHECKED mrt_result exports_write(const exports_file *file, uint32_t count, const clip *frames,
                                 const exports_settings *settings, progress *shown, facts *told,
                                 error *err);

#endif
