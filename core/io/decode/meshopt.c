/* meshoptimizer's decoders (EXT_meshopt_compression): this is their only user. */
#include "io/decode/decode.h"

#include <meshoptimizer.h>
#include <stdlib.h>

/* Checks the combination of mode and filter, which the library checks only with assert. */
static bool is_sensible(const decode_order *order)
{
    uint32_t stride = order->stride;
    bool is_index = order->mode == DECODE_MODE_TRIANGLES || order->mode == DECODE_MODE_INDICES;
    if (is_index)
        return (stride == 2 || stride == 4) && order->filter == DECODE_FILTER_NONE &&
               (order->mode == DECODE_MODE_INDICES || order->count % 3 == 0);
    if (order->mode != DECODE_MODE_ATTRIBUTES || stride % 4 != 0 || stride > 256)
        return false;
    switch ((decode_filter)order->filter) {
    case DECODE_FILTER_NONE:
    case DECODE_FILTER_EXPONENTIAL:
        return true;
    case DECODE_FILTER_OCTAHEDRAL:
        return stride == 4 || stride == 8;
    case DECODE_FILTER_QUATERNION:
        return stride == 8;
    }
    return false;
}

static int decode(void *out, const decode_order *order, const void *data, size_t size)
{
    switch ((decode_mode)order->mode) {
    case DECODE_MODE_TRIANGLES:
        return meshopt_decodeIndexBuffer(out, order->count, order->stride, data, size);
    case DECODE_MODE_INDICES:
        return meshopt_decodeIndexSequence(out, order->count, order->stride, data, size);
    case DECODE_MODE_ATTRIBUTES:
        return meshopt_decodeVertexBuffer(out, order->count, order->stride, data, size);
    case DECODE_MODE_NONE:
        break;
    }
    return -1;
}

static void filter(void *out, const decode_order *order)
{
    switch ((decode_filter)order->filter) {
    case DECODE_FILTER_OCTAHEDRAL:
        meshopt_decodeFilterOct(out, order->count, order->stride);
        break;
    case DECODE_FILTER_QUATERNION:
        meshopt_decodeFilterQuat(out, order->count, order->stride);
        break;
    case DECODE_FILTER_EXPONENTIAL:
        meshopt_decodeFilterExp(out, order->count, order->stride);
        break;
    case DECODE_FILTER_NONE:
        break;
    }
}

mrt_result meshopt_decode(void **out_data, size_t *out_size, const decode_order *order,
                          const void *data, size_t size, error *err)
{
    *out_data = NULL;
    *out_size = decode_answer_size(order);
    if (*out_size == 0 || !is_sensible(order))
        return error_set(err, MRT_ERR_FORMAT, "its mode, filter and byteStride %u do not match",
                         order->stride);
    void *out = calloc(*out_size, 1);
    if (!out)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the buffer");
    if (decode(out, order, data, size) != 0) {
        free(out);
        return error_set(err, MRT_ERR_FORMAT, "the meshopt data is damaged");
    }
    filter(out, order);
    *out_data = out;
    return MRT_OK;
}
