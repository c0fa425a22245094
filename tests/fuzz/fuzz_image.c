#include "io/decode/decode.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A PNG, JPEG or WebP, made smaller until its sides fit the first byte. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    void *out;
    size_t out_size;
    error err = {""};
    decode_image_size image;
    if (size < 1)
        return 0;
    decode_order order = {.kind = DECODE_IMAGE, .side_max = data[0]};
    mrt_result result = image_decode(&out, &out_size, &order, data + 1, size - 1, &err);
    if ((result < 0) != !out || (result < 0 && !err.text[0]))
        abort();
    if (out) {
        memcpy(&image, out, sizeof image);
        if (out_size != sizeof image + (size_t)image.width * image.height * 4 ||
            (order.side_max && (image.width > order.side_max || image.height > order.side_max)))
            abort();
    }
    free(out);
    return 0;
}
