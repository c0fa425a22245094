#include "base/bytes.h"

#include <math.h>
#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "stored state is little-endian"
#endif

void bytes_write(bytes_out *out, const void *value, size_t size)
{
    if (out->data && size > 0 && out->size <= out->capacity && size <= out->capacity - out->size)
        memcpy(out->data + out->size, value, size);
    out->size += size;
}

void bytes_write_u32(bytes_out *out, uint32_t value)
{
    bytes_write(out, &value, sizeof value);
}

void bytes_write_f64(bytes_out *out, double value)
{
    bytes_write(out, &value, sizeof value);
}

void bytes_read(bytes_in *in, void *out, size_t size)
{
    if (size == 0)
        return;
    if (in->failed || size > (size_t)(in->end - in->at)) {
        in->failed = true;
        memset(out, 0, size);
        return;
    }
    memcpy(out, in->at, size);
    in->at += size;
}

uint32_t bytes_read_u32(bytes_in *in)
{
    uint32_t value;
    bytes_read(in, &value, sizeof value);
    return value;
}

double bytes_read_f64(bytes_in *in)
{
    double value;
    bytes_read(in, &value, sizeof value);
    if (isfinite(value))
        return value;
    in->failed = true;
    return 0.0;
}

void bytes_write_vec3(bytes_out *out, vec3 v)
{
    bytes_write_f64(out, v.x);
    bytes_write_f64(out, v.y);
    bytes_write_f64(out, v.z);
}

vec3 bytes_read_vec3(bytes_in *in)
{
    vec3 out;
    out.x = bytes_read_f64(in);
    out.y = bytes_read_f64(in);
    out.z = bytes_read_f64(in);
    return out;
}
