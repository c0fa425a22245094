#include "show/chunk.h"

#include "base/bytes.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#define ZLIB_CONST /* input is only read */
#include <zlib.h>

enum {
    VARINT_MAX = 10,     /* bytes of 64 bits */
    PREFIX_BYTES = 1 + 4 /* size of version and CRC */
};
enum { COLUMN_WHOLE = 0, COLUMN_FLOAT = 1 };
static const float whole_limit = 16777216.0f; /* each whole number below it is an exact float */

/* ---- writing bytes ---- */

static uint8_t *put_varint(uint8_t *at, uint64_t value)
{
    while (value >= 128) {
        *at++ = (uint8_t)(value | 128);
        value >>= 7;
    }
    *at++ = (uint8_t)value;
    return at;
}

static uint64_t zigzag(int64_t value)
{
    return ((uint64_t)value << 1) ^ (value < 0 ? UINT64_MAX : 0);
}

static uint8_t *put_fixed(uint8_t *at, const void *value, size_t size)
{
    memcpy(at, value, size);
    return at + size;
}

/* ---- reading bytes: a missing byte reads as 0 and sets `failed` ---- */

static uint64_t get_varint(bytes_in *in)
{
    uint64_t value = 0;
    for (int shift = 0; shift < 64 && in->at < in->end; shift += 7) {
        uint64_t byte = *in->at++;
        if (shift == 63 && byte > 1)
            break;
        value |= (byte & 127) << shift;
        if (byte < 128)
            return value;
    }
    in->failed = true;
    return 0;
}

static uint64_t get_zigzag(bytes_in *in)
{
    uint64_t value = get_varint(in);
    return (value >> 1) ^ (value & 1 ? UINT64_MAX : 0);
}

/* ---- columns: differences are taken modulo 2^64 or 2^32, so nothing overflows ---- */

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static float float_of(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint8_t *put_times(uint8_t *at, const mrt_sample *samples, uint32_t count)
{
    uint64_t last_step = 0;
    for (uint32_t i = 1; i < count; ++i) {
        uint64_t step = (uint64_t)samples[i].time_ns - (uint64_t)samples[i - 1].time_ns;
        at = put_varint(at, zigzag((int64_t)(step - last_step)));
        last_step = step;
    }
    return at;
}

static void get_times(mrt_sample *out, bytes_in *in, uint32_t count, int64_t from_ns)
{
    uint64_t step = 0;
    out[0].time_ns = from_ns;
    for (uint32_t i = 1; i < count; ++i) {
        step += get_zigzag(in);
        out[i].time_ns = (int64_t)((uint64_t)out[i - 1].time_ns + step);
        in->failed |= out[i].time_ns < out[i - 1].time_ns;
    }
}

static uint8_t *put_sequences(uint8_t *at, const mrt_sample *samples, uint32_t count)
{
    at = put_varint(at, samples[0].sequence);
    for (uint32_t i = 1; i < count; ++i) {
        uint32_t step = samples[i].sequence - samples[i - 1].sequence - 1;
        at = put_varint(at, zigzag((int64_t)(int32_t)step));
    }
    return at;
}

static void get_sequences(mrt_sample *out, bytes_in *in, uint32_t count)
{
    uint64_t first = get_varint(in);
    in->failed |= first > UINT32_MAX;
    out[0].sequence = (uint32_t)first;
    for (uint32_t i = 1; i < count; ++i)
        out[i].sequence = out[i - 1].sequence + 1 + (uint32_t)get_zigzag(in);
}

static bool is_whole(const mrt_sample *samples, uint32_t count, uint32_t channel)
{
    for (uint32_t i = 0; i < count; ++i) {
        float value = samples[i].value[channel];
        if (!(fabsf(value) < whole_limit) || bits_of((float)(int32_t)value) != bits_of(value))
            return false;
    }
    return true;
}

static uint8_t *put_whole(uint8_t *at, const mrt_sample *samples, uint32_t count, uint32_t channel)
{
    int32_t last = 0;
    for (uint32_t i = 0; i < count; ++i) {
        int32_t value = (int32_t)samples[i].value[channel];
        at = put_varint(at, zigzag(value - last));
        last = value;
    }
    return at;
}

static void get_whole(mrt_sample *out, bytes_in *in, uint32_t count, uint32_t channel)
{
    int64_t value = 0;
    for (uint32_t i = 0; i < count && !in->failed; ++i) {
        int64_t step = (int64_t)get_zigzag(in);
        in->failed |= llabs(step / 2) >= (int64_t)whole_limit;
        value = in->failed ? 0 : value + step;
        in->failed |= llabs(value) >= (int64_t)whole_limit;
        out[i].value[channel] = (float)value;
    }
}

static uint8_t *put_floats(uint8_t *at, const mrt_sample *samples, uint32_t count, uint32_t channel)
{
    uint32_t last = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t bits = bits_of(samples[i].value[channel]);
        for (uint32_t plane = 0; plane < 4; ++plane)
            at[plane * count + i] = (uint8_t)((bits ^ last) >> (8 * plane));
        last = bits;
    }
    return at + 4 * (size_t)count;
}

static void get_floats(mrt_sample *out, bytes_in *in, uint32_t count, uint32_t channel)
{
    if ((size_t)(in->end - in->at) < 4 * (size_t)count) {
        in->failed = true;
        return;
    }
    uint32_t bits = 0;
    for (uint32_t i = 0; i < count; ++i) {
        for (uint32_t plane = 0; plane < 4; ++plane)
            bits ^= (uint32_t)in->at[plane * count + i] << (8 * plane);
        out[i].value[channel] = float_of(bits);
        in->failed |= !isfinite(out[i].value[channel]);
    }
    in->at += 4 * (size_t)count;
}

/* ---- the plain bytes, before compression ---- */

static size_t plain_bound(uint32_t sample_count, uint32_t channel_count)
{
    return (size_t)sample_count * (VARINT_MAX + 5 + 4 * (size_t)channel_count) + channel_count;
}

static size_t put_plain(uint8_t *out, const mrt_sample *samples, uint32_t count)
{
    uint8_t *at = put_times(out, samples, count);
    at = put_sequences(at, samples, count);
    for (uint32_t c = 0; c < samples[0].count; ++c) {
        bool whole = is_whole(samples, count, c);
        *at++ = whole ? COLUMN_WHOLE : COLUMN_FLOAT;
        at = whole ? put_whole(at, samples, count, c) : put_floats(at, samples, count, c);
    }
    return (size_t)(at - out);
}

static bool get_plain(mrt_sample *out, const chunk_head *head, const uint8_t *plain, size_t size)
{
    bytes_in in = {plain, plain + size, false};
    memset(out, 0, head->sample_count * sizeof *out);
    for (uint32_t i = 0; i < head->sample_count; ++i)
        out[i].count = head->channel_count;
    get_times(out, &in, head->sample_count, head->from_ns);
    get_sequences(out, &in, head->sample_count);
    for (uint32_t c = 0; c < head->channel_count && !in.failed; ++c) {
        uint8_t kind;
        bytes_read(&in, &kind, sizeof kind);
        if (kind == COLUMN_WHOLE)
            get_whole(out, &in, head->sample_count, c);
        else if (kind == COLUMN_FLOAT)
            get_floats(out, &in, head->sample_count, c);
        else
            in.failed = true;
    }
    return !in.failed && in.at == in.end;
}

/* ---- compression ---- */

struct chunk_packer {
    z_stream stream;
};

chunk_packer *chunk_packer_create(void)
{
    chunk_packer *self = calloc(1, sizeof *self);
    if (!self || deflateInit2(&self->stream, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) == Z_OK)
        return self;
    free(self);
    return NULL;
}

void chunk_packer_destroy(chunk_packer *self)
{
    if (self)
        deflateEnd(&self->stream);
    free(self);
}

static mrt_result deflate_plain(chunk_packer *by, uint8_t *out, size_t capacity, size_t *out_size,
                                const uint8_t *plain, size_t size, error *err)
{
    z_stream *stream = &by->stream;
    if (deflateReset(stream) != Z_OK)
        return error_set(err, MRT_ERR_MEMORY, "samples could not be compressed");
    stream->next_in = plain;
    stream->avail_in = (uInt)size;
    stream->next_out = out;
    stream->avail_out = (uInt)capacity;
    int status = deflate(stream, Z_FINISH);
    *out_size = stream->total_out;
    if (status != Z_STREAM_END)
        return error_set(err, MRT_ERR_MEMORY, "samples could not be compressed");
    return MRT_OK;
}

static bool inflate_plain(uint8_t *out, size_t size, const uint8_t *bytes, size_t bytes_size)
{
    z_stream stream = {.next_in = bytes, .avail_in = (uInt)bytes_size, .avail_out = (uInt)size};
    stream.next_out = out;
    if (inflateInit2(&stream, -15) != Z_OK)
        return false;
    int status = inflate(&stream, Z_FINISH);
    bool whole = status == Z_STREAM_END && stream.total_out == size && stream.avail_in == 0;
    inflateEnd(&stream);
    return whole;
}

/* ---- complete chunks ---- */

size_t chunk_bound(uint32_t sample_count, uint32_t channel_count)
{
    size_t head = PREFIX_BYTES + 8 + 5 * VARINT_MAX;
    return head + compressBound((uLong)plain_bound(sample_count, channel_count));
}

static mrt_result check_samples(const mrt_sample *samples, uint32_t count, error *err)
{
    if (count == 0 || count > CHUNK_SAMPLES_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "a chunk of %u samples; expected 1 to %d", count,
                         CHUNK_SAMPLES_MAX);
    uint32_t channel_count = samples[0].count;
    if (channel_count == 0 || channel_count > MRT_MAX_CHANNELS)
        return error_set(err, MRT_ERR_ARGUMENT, "a sample of %u values; expected 1 to %d",
                         channel_count, MRT_MAX_CHANNELS);
    for (uint32_t i = 0; i < count; ++i) {
        if (samples[i].count != channel_count)
            return error_set(err, MRT_ERR_ARGUMENT, "sample %u has %u values, %u were expected", i,
                             samples[i].count, channel_count);
        if (i > 0 && samples[i].time_ns < samples[i - 1].time_ns)
            return error_set(
                err, MRT_ERR_ARGUMENT,
                "the samples cannot be stored: sample %u has an earlier time than the one before",
                i);
        for (uint32_t c = 0; c < channel_count; ++c)
            if (!isfinite(samples[i].value[c]))
                return error_set(err, MRT_ERR_ARGUMENT, "value %u of sample %u is not finite", c,
                                 i);
    }
    return MRT_OK;
}

mrt_result chunk_encode(uint8_t *out, size_t *out_size, int64_t track, uint32_t ordinal,
                        const mrt_sample *samples, uint32_t count, error *err)
{
    chunk_packer *by = chunk_packer_create();
    mrt_result result = by ? chunk_pack(by, out, out_size, track, ordinal, samples, count, err)
                           : error_set(err, MRT_ERR_MEMORY, "no memory to compress samples");
    chunk_packer_destroy(by);
    return result;
}

mrt_result chunk_pack(chunk_packer *by, uint8_t *out, size_t *out_size, int64_t track,
                      uint32_t ordinal, const mrt_sample *samples, uint32_t count, error *err)
{
    *out_size = 0;
    mrt_result result = check_samples(samples, count, err);
    if (result < 0)
        return result;
    uint32_t channel_count = samples[0].count;
    uint8_t *plain = malloc(plain_bound(count, channel_count));
    if (!plain)
        return error_set(err, MRT_ERR_MEMORY, "no memory to pack %u samples", count);
    size_t plain_size = put_plain(plain, samples, count);
    assert(plain_size <= plain_bound(count, channel_count));

    uint8_t *at = out + PREFIX_BYTES;
    at = put_varint(at, (uint64_t)track);
    at = put_varint(at, ordinal);
    at = put_fixed(at, &samples[0].time_ns, sizeof samples[0].time_ns);
    at = put_varint(at, count);
    at = put_varint(at, channel_count);
    at = put_varint(at, plain_size);
    size_t head_size = (size_t)(at - out);
    size_t packed_size = 0;
    result = deflate_plain(by, at, chunk_bound(count, channel_count) - head_size, &packed_size,
                           plain, plain_size, err);
    free(plain);
    if (result < 0)
        return result;
    *out_size = head_size + packed_size;
    out[0] = CHUNK_VERSION;
    uint32_t crc = (uint32_t)crc32(0, out + PREFIX_BYTES, (uInt)(*out_size - PREFIX_BYTES));
    (void)put_fixed(out + 1, &crc, sizeof crc);
    return MRT_OK;
}

/* Reads the head; `in` is then at the bytes after it. */
static mrt_result get_head(chunk_head *out, size_t *out_plain_size, bytes_in *in, error *err)
{
    static const char damaged[] = "a chunk of samples is damaged";
    if (in->at < in->end && *in->at != CHUNK_VERSION)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s or has a newer version (%u; this marotte reads %d)", damaged, *in->at,
                         CHUNK_VERSION);
    uint8_t version;
    int64_t from_ns = 0;
    bytes_read(in, &version, sizeof version);
    uint32_t crc = bytes_read_u32(in);
    if (in->failed || in->end - in->at > INT32_MAX)
        return error_set(err, MRT_ERR_FORMAT, "%s: its size is invalid", damaged);
    if (crc32(0, in->at, (uInt)(in->end - in->at)) != crc)
        return error_set(err, MRT_ERR_FORMAT, "%s: its checksum (CRC-32) is wrong", damaged);
    uint64_t track = get_varint(in), ordinal = get_varint(in);
    bytes_read(in, &from_ns, sizeof from_ns);
    uint64_t sample_count = get_varint(in), channel_count = get_varint(in);
    uint64_t plain_size = get_varint(in);
    if (in->failed || track > INT64_MAX || ordinal > UINT32_MAX || sample_count == 0 ||
        sample_count > CHUNK_SAMPLES_MAX || channel_count == 0 || channel_count > MRT_MAX_CHANNELS)
        return error_set(err, MRT_ERR_FORMAT, "%s: its header is invalid", damaged);
    *out = (chunk_head){.track = (int64_t)track,
                        .ordinal = (uint32_t)ordinal,
                        .from_ns = from_ns,
                        .sample_count = (uint32_t)sample_count,
                        .channel_count = (uint32_t)channel_count};
    if (plain_size > plain_bound(out->sample_count, out->channel_count))
        return error_set(err, MRT_ERR_FORMAT, "%s: it would unpack to %ju bytes", damaged,
                         (uintmax_t)plain_size);
    *out_plain_size = (size_t)plain_size;
    return MRT_OK;
}

mrt_result chunk_read_head(chunk_head *out, const uint8_t *bytes, size_t size, error *err)
{
    bytes_in in = {bytes, bytes + size, false};
    size_t plain_size = 0;
    *out = (chunk_head){0};
    return get_head(out, &plain_size, &in, err);
}

mrt_result chunk_decode(mrt_sample *out, chunk_head *out_head, const uint8_t *bytes, size_t size,
                        error *err)
{
    bytes_in in = {bytes, bytes + size, false};
    size_t plain_size = 0;
    *out_head = (chunk_head){0};
    mrt_result result = get_head(out_head, &plain_size, &in, err);
    if (result < 0)
        return result;
    uint8_t *plain = malloc(plain_size + 1);
    if (!plain)
        return error_set(err, MRT_ERR_MEMORY, "no memory to unpack %zu bytes", plain_size);
    bool good = inflate_plain(plain, plain_size, in.at, (size_t)(in.end - in.at)) &&
                get_plain(out, out_head, plain, plain_size);
    free(plain);
    if (!good)
        return error_set(err, MRT_ERR_FORMAT,
                         "a chunk of samples is damaged: its unpacked data is invalid");
    return MRT_OK;
}
