/* base/bytes.h - values to bytes and back, for state that is kept: a writer that counts what does
 * not fit, and a reader that never goes past the end and remembers that it would have. In the
 * machine's order (little-endian; others do not build). Pure. */
#ifndef MAROTTE_BASE_BYTES_H
#define MAROTTE_BASE_BYTES_H
#include "base/rigid.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct bytes_out {
    unsigned char *data;   /* NULL: only counts */
    size_t capacity, size; /* size: of all that was put, whether it fitted or not */
} bytes_out;

void bytes_put(bytes_out *out, const void *value, size_t size);
void bytes_put_u32(bytes_out *out, uint32_t value);
void bytes_put_f64(bytes_out *out, double value);
void bytes_put_vec3(bytes_out *out, vec3 v);

typedef struct bytes_in {
    const unsigned char *at, *end;
    bool failed; /* something was asked for that was not there */
} bytes_in;

/* When fewer are left: fails, and gives zeros. */
void bytes_take(bytes_in *in, void *out, size_t size);
uint32_t bytes_take_u32(bytes_in *in);
double bytes_take_f64(bytes_in *in); /* fails, and gives 0, when not finite */
vec3 bytes_take_vec3(bytes_in *in);  /* likewise, each number */

#endif
