#include "io/decode/decode.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The first bytes say what is asked for, the others are the stream. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    void *out;
    size_t out_size;
    error err = {""};
    if (size < 5)
        return 0;
    decode_order order = {.kind = DECODE_MESHOPT,
                          .count = data[0] + 256u * (data[1] % 8u),
                          .stride = data[2],
                          .mode = data[3] % 5u,
                          .filter = data[4] % 5u};
    mrt_result result = meshopt_decode(&out, &out_size, &order, data + 5, size - 5, &err);
    if ((result < 0) != !out || (result < 0 && !err.text[0]))
        abort();
    free(out);
    return 0;
}
