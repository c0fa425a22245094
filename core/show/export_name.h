/* show/export_name.h - the file name for the export of a take, from a pattern such as
 * "out/{slate}.glb". Leaves out the export itself (io/export.h). Pure. [any] */
#ifndef MAROTTE_TAKE_EXPORT_NAME_H
#define MAROTTE_TAKE_EXPORT_NAME_H
#include "show/take.h"

typedef struct take_name {
    char text[2 * TAKE_NAME + 32];
} take_name;
take_name take_slate_text(const char *scene, const char *shot,
                          uint32_t number); /* "1/a/2"; empty parts are left out */

typedef struct export_name_of {
    const char *show; /* path of the show */
    int64_t take;
    const char *scene, *shot, *name;
    uint32_t number;
} export_name_of;

/* Builds the file name. Names of a take cannot lead out of the folder of the pattern, nor make a
 * hidden file. */
CHECKED mrt_result export_name(char *out, size_t capacity, const char *pattern,
                               const export_name_of *of, error *err);

#endif
