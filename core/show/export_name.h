/* show/export_name.h - the file that a take is exported to, from a pattern: "out/{slate}.glb".
 * Pure. [any] */
#ifndef MAROTTE_TAKE_EXPORT_NAME_H
#define MAROTTE_TAKE_EXPORT_NAME_H
#include "show/take.h"

typedef struct take_name {
    char text[2 * TAKE_NAME + 32];
} take_name;
take_name take_slate_text(const char *scene, const char *shot,
                          uint32_t number); /* "1/a/2"; without what is "" */

typedef struct export_name_of {
    const char *show; /* its path */
    int64_t take;
    const char *scene, *shot, *name;
    uint32_t number;
} export_name_of;

/* What a take is called cannot leave the folder of the pattern, nor hide the file. */
CHECKED mrt_result export_name(char *out, size_t capacity, const char *pattern,
                               const export_name_of *of, error *err);

#endif
