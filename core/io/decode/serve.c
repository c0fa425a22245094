/* The child process of decode.h: reads jobs and writes answers. */
#include "io/decode/decode.h"

#include <stdlib.h>
#include <string.h>

static mrt_result decode(void **out_data, size_t *out_size, const decode_order *order,
                         const void *data, size_t size, error *err)
{
    switch (order->kind) {
    case DECODE_DRACO:
        return draco_decode(out_data, out_size, order, data, size, err);
    case DECODE_MESHOPT:
        return meshopt_decode(out_data, out_size, order, data, size, err);
    case DECODE_IMAGE:
        return image_decode(out_data, out_size, order, data, size, err);
    case DECODE_NONE:
    case DECODE_KINDS:
        break;
    }
    return error_set(err, MRT_ERR_ARGUMENT, "unknown decoder %d", (int)order->kind);
}

/* Writes an answer: 1, the size and the bytes; or 0, the length and the text of a reason. */
static void write_answer(FILE *answer, uint64_t is_done, const void *data, uint64_t size)
{
    const uint64_t head[2] = {is_done, size};
    (void)fwrite(head, sizeof *head, 2, answer);
    (void)fwrite(data, 1, size, answer);
    (void)fflush(answer); /* a later job may crash */
}

bool decode_serve(FILE *request, FILE *answer)
{
    decode_order order;
    uint64_t size;
    while (fread(&order, sizeof order, 1, request) == 1) {
        if (fread(&size, sizeof size, 1, request) != 1 || size > SIZE_MAX - 1)
            return false;
        void *data = malloc((size_t)size + 1), *out = NULL;
        size_t out_size = 0;
        error failed = {"no memory for the data"};
        if (data && fread(data, 1, (size_t)size, request) != size) {
            free(data);
            return false;
        }
        if (data && decode(&out, &out_size, &order, data, (size_t)size, &failed) == MRT_OK)
            write_answer(answer, 1, out, out_size);
        else
            write_answer(answer, 0, failed.text, strlen(failed.text));
        free(out);
        free(data);
    }
    return true;
}
