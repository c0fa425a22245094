/* base/bytes.h - serialises values to bytes and back, for stored state. The writer counts bytes
 * that do not fit. The reader never reads past the end, and remembers an attempt. Byte order is
 * that of the machine (little-endian; others do not build). Pure. */
#ifndef MAROTTE_BASE_BYTES_H
#define MAROTTE_BASE_BYTES_H
#include "base/rigid.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct bytes_out {
    unsigned char *data;   /* NULL: only count */
    size_t capacity, size; /* size: of everything that was written, even if it did not fit */
} bytes_out;

void bytes_write(bytes_out *out, const void *value, size_t size);
void bytes_write_u32(bytes_out *out, uint32_t value);
void bytes_write_f64(bytes_out *out, double value);
void bytes_write_vec3(bytes_out *out, vec3 v);

typedef struct bytes_in {
    const unsigned char *at, *end;
    bool failed; /* read past the end, or read a value that is not finite */
} bytes_in;

/* If fewer bytes are left, fails and returns zeros. */
void bytes_read(bytes_in *in, void *out, size_t size);
uint32_t bytes_read_u32(bytes_in *in);
double bytes_read_f64(bytes_in *in); /* fails and returns 0 for a value that is not finite */
vec3 bytes_read_vec3(bytes_in *in);  /* the same, for each number */

#endif
