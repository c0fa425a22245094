#include "base/bytes.h"

#include <math.h>
#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "stored state is little-endian"
#endif

void bytes_put(bytes_out *out, const void *value, size_t size)
{
    if (out->data && size > 0 && out->size <= out->capacity && size <= out->capacity - out->size)
        memcpy(out->data + out->size, value, size);
    out->size += size;
}

void bytes_put_u32(bytes_out *out, uint32_t value)
{
    bytes_put(out, &value, sizeof value);
}

void bytes_put_f64(bytes_out *out, double value)
{
    bytes_put(out, &value, sizeof value);
}

void bytes_take(bytes_in *in, void *out, size_t size)
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

uint32_t bytes_take_u32(bytes_in *in)
{
    uint32_t value;
    bytes_take(in, &value, sizeof value);
    return value;
}

double bytes_take_f64(bytes_in *in)
{
    double value;
    bytes_take(in, &value, sizeof value);
    if (isfinite(value))
        return value;
    in->failed = true;
    return 0.0;
}

void bytes_put_vec3(bytes_out *out, vec3 v)
{
    bytes_put_f64(out, v.x);
    bytes_put_f64(out, v.y);
    bytes_put_f64(out, v.z);
}

vec3 bytes_take_vec3(bytes_in *in)
{
    vec3 out;
    out.x = bytes_take_f64(in);
    out.y = bytes_take_f64(in);
    out.z = bytes_take_f64(in);
    return out;
}
