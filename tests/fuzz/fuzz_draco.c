#include "io/decode/decode.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The first bytes say what is asked for, the others are the stream. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    void *out;
    size_t out_size;
    error err = {""};
    if (size < 4)
        return 0;
    decode_order order = {.kind = DECODE_DRACO,
                          .count = data[0],
                          .index_count = data[1] * 3u,
                          .attribute_count = data[2] % (DECODE_ATTRIBUTES_MAX + 1)};
    for (uint32_t i = 0; i < order.attribute_count; ++i)
        order.attribute[i] =
            (decode_attribute){i, 5120u + (data[3] + i) % 7u, 1u + (data[3] + i) % 4u};
    mrt_result result = draco_decode(&out, &out_size, &order, data + 4, size - 4, &err);
    if ((result < 0) != !out || (result < 0 && !err.text[0]))
        abort();
    free(out);
    return 0;
}
