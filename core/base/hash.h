/* base/hash.h - FNV-1a, 64 bits: detects changes. It does not protect against deliberate
 * collisions. Pure. [any] */
#ifndef MAROTTE_BASE_HASH_H
#define MAROTTE_BASE_HASH_H
#include <stddef.h>
#include <stdint.h>

#define HASH_START UINT64_C(0xcbf29ce484222325)

static inline uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; ++i)
        hash = (hash ^ at[i]) * UINT64_C(0x100000001b3);
    return hash;
}

#endif
