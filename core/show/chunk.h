/* show/chunk.h - lossless compression of consecutive samples of one track. Leaves out where the
 * bytes are stored (show.h). Reading accepts any bytes: it decodes a chunk or returns an error with
 * a reason.
 *
 * Bytes of version 1; integers little-endian, "varint" = 7 bits a byte, lowest first:
 *   u8 version; u32 CRC-32 of all that follows; varint track, ordinal; u64 from_ns; varint
 *   sample_count, channel_count, plain_size; raw deflate of plain_size bytes:
 *     the times after the first: zigzag varints, each the difference between two successive steps;
 *     the sequence numbers: the first as a varint, then zigzag varints of step - 1;
 *     per channel one byte and the column of its values:
 *       0: whole numbers below 2^24: zigzag varints of the differences, the first from 0;
 *       1: any finite floats: their bits XOR the bits before; the lowest bytes of all values first,
 *          then the next bytes.
 * Pure; any thread. */
#ifndef MAROTTE_TAKE_CHUNK_H
#define MAROTTE_TAKE_CHUNK_H
#include "base/error.h"

enum { CHUNK_VERSION = 1, CHUNK_SAMPLES_MAX = 4096 };

typedef struct chunk_head {
    int64_t track;
    uint32_t
        ordinal; /* index of the chunk in its track, from 0; a gap means that a chunk is missing */
    int64_t from_ns; /* time of the first sample */
    uint32_t sample_count, channel_count;
} chunk_head;

/* Returns the maximum size of an encoded chunk, in bytes. */
size_t chunk_bound(uint32_t sample_count, uint32_t channel_count);

/* Encodes `count` samples, 1..CHUNK_SAMPLES_MAX. Times do not descend, all samples have as many
 * channels as the first, and values are finite. out: chunk_bound() bytes. */
CHECKED mrt_result chunk_encode(uint8_t *out, size_t *out_size, int64_t track, uint32_t ordinal,
                                const mrt_sample *samples, uint32_t count, error *err);
/* Does the same with memory that is reused between chunks: compression needs 256 KiB, and the
 * writer encodes a recording ten times a second. One thread at a time. */
typedef struct chunk_packer chunk_packer;
chunk_packer *chunk_packer_create(void);       /* NULL: no memory */
void chunk_packer_destroy(chunk_packer *self); /* NULL is fine */
CHECKED mrt_result chunk_pack(chunk_packer *by, uint8_t *out, size_t *out_size, int64_t track,
                              uint32_t ordinal, const mrt_sample *samples, uint32_t count,
                              error *err);

/* Checks everything except the compressed part. */
CHECKED mrt_result chunk_read_head(chunk_head *out, const uint8_t *bytes, size_t size, error *err);

/* Decodes a chunk. out: CHUNK_SAMPLES_MAX samples, or head.sample_count of them. Values beyond the
 * channel count are 0. */
CHECKED mrt_result chunk_decode(mrt_sample *out, chunk_head *out_head, const uint8_t *bytes,
                                size_t size, error *err);

#endif
