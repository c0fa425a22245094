/* Datagrams from anybody in the room. */
#include "phone_parse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    phone_frame frame;
    uint8_t *copy = malloc(size ? size : 1); /* its end is watched */
    if (!copy)
        return 0;
    if (size > 0)
        memcpy(copy, data, size);
    for (int i = 0; i < 2; ++i) {
        phone_protocol protocol =
            phone_parse(&frame, copy, size, i ? PHONE_RIGHT_FIRST : PHONE_LEFT_FIRST);
        if (protocol != PHONE_NONE && frame.has_time && !isfinite(frame.time_s))
            abort();
        for (int v = 0; v < PHONE_VALUES; ++v)
            if (!(frame.value[v] >= -4.0f && frame.value[v] <= 4.0f))
                abort();
    }
    free(copy);
    return 0;
}
