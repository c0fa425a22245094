/* show/hash.h - SHA-256 of bytes and of files: what rigs, meshes, plugins and calibrations are
 * known by. The only file that sees nettle is hash.c. Pure but for files; any thread that may
 * block. */
#ifndef MAROTTE_TAKE_HASH_H
#define MAROTTE_TAKE_HASH_H
#include "show/take.h"

/* Lower-case hex, 64 letters and a 0. */
void hash_bytes(char out[TAKE_HASH], const void *bytes, size_t size);
/* Of a regular file of any size. */
CHECKED mrt_result hash_file(char out[TAKE_HASH], const char *path, error *err);

/* Of bytes that come in pieces. */
typedef struct hash_sum hash_sum;
hash_sum *hash_begin(void); /* NULL: no memory */
void hash_add(hash_sum *sum, const void *bytes, size_t size);
void hash_end(char out[TAKE_HASH], hash_sum *sum); /* and frees it; NULL: "" */

#endif
