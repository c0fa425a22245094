/* Any bytes are an .mp4 that is complete or is not; reading them ends. */
#include "stream/mp4.h"

#include <assert.h>
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static FILE *file;
    mp4_facts of;
    if (!file)
        file = tmpfile();
    if (!file || ftruncate(fileno(file), 0) != 0 ||
        pwrite(fileno(file), data, size, 0) != (ssize_t)size)
        return 0;
    mp4_read(&of, fileno(file));
    assert(!of.is_complete || size >= 8);
    assert(of.picture_count <= UINT32_MAX * (uint64_t)size);
    return 0;
}
