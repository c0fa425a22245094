/* stage/perform/patch_file.h - a patch as a JSON file that users can write by hand.
 * ui/patches/README.md explains each key. The parser is strict: it rejects unknown keys, duplicate
 * keys and numbers out of range, and reports the place. [main] Only patch_file_read and
 * patch_file_find access files. */
#ifndef MAROTTE_STAGE_PATCH_FILE_H
#define MAROTTE_STAGE_PATCH_FILE_H
#include "stage/perform/patch.h"

enum { PATCH_FILE_BYTES_MAX = 256 * 1024 };

/* name: used in messages, such as "faders.json". */
CHECKED mrt_result patch_file_parse(patch *out, const char *text, size_t size, const char *name,
                                    error *err);
CHECKED mrt_result patch_file_read(patch *out, const char *path, error *err);
/* Reads a file, or a patch that comes with marotte, by its name. */
CHECKED mrt_result patch_file_find(patch *out, const char *given, error *err);
/* Writes text that patch_file_parse reads as an equal patch. The caller frees it. */
CHECKED mrt_result patch_file_write(char **out, const patch *p, error *err);

#endif
