/* stage/perform/patch_file.h - a patch as JSON, to be written by hand: ui/patches/README.md says
 * what each key means. Read strictly: an unknown key, a key twice, a number out of its range are
 * refused, with their place. Pure but for patch_file_read; [main]. */
#ifndef MAROTTE_STAGE_PATCH_FILE_H
#define MAROTTE_STAGE_PATCH_FILE_H
#include "stage/perform/patch.h"

enum { PATCH_FILE_BYTES_MAX = 256 * 1024 };

/* name: for messages: "faders.json". */
CHECKED mrt_result patch_file_parse(patch *out, const char *text, size_t size, const char *name,
                                    error *err);
CHECKED mrt_result patch_file_read(patch *out, const char *path, error *err);
/* A file, or the name of a patch that comes with marotte. */
CHECKED mrt_result patch_file_find(patch *out, const char *given, error *err);
/* What patch_file_parse reads as an equal patch; to be freed. */
CHECKED mrt_result patch_file_write(char **out, const patch *p, error *err);

#endif
