/* show/chunk.h - a run of samples of one track as few bytes, and back: exactly. Leaves out where
 * the bytes are kept (show.h). Reading takes any bytes: they are a chunk or are refused with a
 * reason.
 *
 * Bytes of version 1; integers little-endian, "varint" = 7 bits a byte, lowest first:
 *   u8 version; u32 CRC-32 of all that follows; varint track, ordinal; u64 from_ns; varint
 *   sample_count, channel_count, plain_size; raw deflate of plain_size bytes:
 *     the times after the first: zigzag varints of how their steps differ from the step before;
 *     the sequence numbers: the first as a varint, then zigzag varints of step - 1;
 *     per channel one byte and the column of its values:
 *       0: whole numbers below 2^24: zigzag varints of steps, the first from 0;
 *       1: any finite floats: their bits, XOR those before, lowest bytes of all first, then the
 * next. Pure; any thread. */
#ifndef MAROTTE_TAKE_CHUNK_H
#define MAROTTE_TAKE_CHUNK_H
#include "base/error.h"

enum { CHUNK_VERSION = 1, CHUNK_SAMPLES_MAX = 4096 };

typedef struct chunk_head {
    int64_t track;
    uint32_t ordinal; /* of the chunk in its track, from 0: a gap says that one is missing */
    int64_t from_ns;  /* of the first sample */
    uint32_t sample_count, channel_count;
} chunk_head;

/* Bytes that any chunk of that size fits into. */
size_t chunk_bound(uint32_t sample_count, uint32_t channel_count);

/* samples: count of them, 1..CHUNK_SAMPLES_MAX, times not descending, each of as many channels as
 * the first, values finite. out: chunk_bound() bytes. */
CHECKED mrt_result chunk_encode(uint8_t *out, size_t *out_size, int64_t track, uint32_t ordinal,
                                const mrt_sample *samples, uint32_t count, error *err);
/* The same with memory that is kept between chunks: compressing takes a quarter of a megabyte, and
 * a recording is written ten times a second. One thread at a time. */
typedef struct chunk_packer chunk_packer;
chunk_packer *chunk_packer_create(void);       /* NULL: no memory */
void chunk_packer_destroy(chunk_packer *self); /* NULL is fine */
CHECKED mrt_result chunk_pack(chunk_packer *by, uint8_t *out, size_t *out_size, int64_t track,
                              uint32_t ordinal, const mrt_sample *samples, uint32_t count,
                              error *err);

/* Checks everything but the compressed part. */
CHECKED mrt_result chunk_read_head(chunk_head *out, const uint8_t *bytes, size_t size, error *err);

/* out: CHUNK_SAMPLES_MAX samples, or as many as the head says. Values beyond the channels are 0. */
CHECKED mrt_result chunk_decode(mrt_sample *out, chunk_head *out_head, const uint8_t *bytes,
                                size_t size, error *err);

#endif
