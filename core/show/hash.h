/* show/hash.h - SHA-256 of bytes and of files, which identifies rigs, meshes, plugins and
 * calibrations. Only hash.c uses nettle. Pure except for files; any thread that may block. */
#ifndef MAROTTE_TAKE_HASH_H
#define MAROTTE_TAKE_HASH_H
#include "show/take.h"

/* Writes 64 lower-case hex digits and a terminating 0. */
void hash_bytes(char out[TAKE_HASH], const void *bytes, size_t size);
/* Hashes a regular file of any size. */
CHECKED mrt_result hash_file(char out[TAKE_HASH], const char *path, error *err);

/* Hashes bytes in pieces. */
typedef struct hash_sum hash_sum;
hash_sum *hash_begin(void); /* NULL: no memory */
void hash_add(hash_sum *sum, const void *bytes, size_t size);
void hash_end(char out[TAKE_HASH], hash_sum *sum); /* frees the sum; a NULL sum gives "" */

#endif
