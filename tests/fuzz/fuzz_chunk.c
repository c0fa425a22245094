/* Any bytes are a chunk of samples or are refused with a reason; what was read can be packed again
 * and is the same. The CRC is made right first, so that what is behind it is reached. */
#include "show/chunk.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { BEHIND_CRC = 5 };

static void make_crc_right(uint8_t *bytes, size_t size)
{
    if (size < BEHIND_CRC)
        return;
    uLong crc = crc32(0, bytes + BEHIND_CRC, (uInt)(size - BEHIND_CRC));
    for (int i = 0; i < 4; ++i)
        bytes[1 + i] = (uint8_t)(crc >> (8 * i));
}

static void check_samples(const mrt_sample *samples, const chunk_head *head)
{
    assert(head->sample_count >= 1 && head->sample_count <= CHUNK_SAMPLES_MAX);
    assert(head->channel_count >= 1 && head->channel_count <= MRT_MAX_CHANNELS);
    assert(samples[0].time_ns == head->from_ns);
    for (uint32_t i = 0; i < head->sample_count; ++i) {
        assert(samples[i].count == head->channel_count);
        assert(i == 0 || samples[i].time_ns >= samples[i - 1].time_ns);
        for (uint32_t c = 0; c < MRT_MAX_CHANNELS; ++c)
            assert(isfinite(samples[i].value[c]));
    }
}

static void check_round_trip(const mrt_sample *samples, const chunk_head *head)
{
    static mrt_sample again[CHUNK_SAMPLES_MAX];
    size_t size;
    chunk_head head_again;
    uint8_t *bytes = malloc(chunk_bound(head->sample_count, head->channel_count));
    assert(bytes);
    mrt_result result =
        chunk_encode(bytes, &size, head->track, head->ordinal, samples, head->sample_count, NULL);
    assert(result >= 0 && size <= chunk_bound(head->sample_count, head->channel_count));
    result = chunk_decode(again, &head_again, bytes, size, NULL);
    assert(result >= 0);
    assert(memcmp(again, samples, head->sample_count * sizeof *samples) == 0);
    free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static mrt_sample samples[CHUNK_SAMPLES_MAX];
    chunk_head head;
    error err = {""};
    uint8_t *copy = malloc(size ? size : 1);
    assert(copy);
    memcpy(copy, bytes, size);
    make_crc_right(copy, size);
    if (chunk_decode(samples, &head, copy, size, &err) < 0) {
        assert(strlen(err.text) > 0);
    } else {
        check_samples(samples, &head);
        check_round_trip(samples, &head);
    }
    free(copy);
    return 0;
}
