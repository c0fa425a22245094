/* take/hash.h - SHA-256 of bytes and of files: what rigs, meshes, plugins and calibrations are
 * known by. The only file that sees nettle is hash.c. Pure but for files; any thread that may
 * block. */
#ifndef MAROTTE_TAKE_HASH_H
#define MAROTTE_TAKE_HASH_H
#include "take/take.h"

/* Lower-case hex, 64 letters and a 0. */
void hash_bytes(char out[TAKE_HASH], const void *bytes, size_t size);
/* Of a regular file of any size. */
CHECKED mrt_result hash_file(char out[TAKE_HASH], const char *path, error *err);

#endif
