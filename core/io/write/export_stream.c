#include "io/write/export_stream.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

uint8_t *export_pack_u32(uint8_t *out, uint32_t value, export_order order)
{
    for (int i = 0; i < 4; ++i) {
        int shift = 8 * (order == EXPORT_BIG_ENDIAN ? 3 - i : i);
        out[i] = (uint8_t)(value >> shift);
    }
    return out + 4;
}

uint8_t *export_pack_float(uint8_t *out, float value, export_order order)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return export_pack_u32(out, bits, order);
}

mrt_result export_put(file_writer *writer, const void *data, size_t size, error *err)
{
    errno = 0;
    if (fwrite(data, 1, size, writer->stream) == size)
        return MRT_OK;
    int reason = errno;
    mrt_result result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", writer->path,
                                  reason ? strerror(reason) : "write error");
    file_writer_abandon(writer);
    return result;
}

static mrt_result check_finite(const float *position, size_t count, uint32_t frame, error *err)
{
    for (size_t i = 0; i < count; ++i)
        if (!isfinite(position[i]))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "frame %u: vertex %zu is not finite, nothing was written", frame,
                             i / 3);
    return MRT_OK;
}

mrt_result export_put_frames(file_writer *writer, const clip *c, export_order order,
                             const export_progress *progress, error *err)
{
    size_t count = (size_t)clip_mesh(c)->vertex_count * 3;
    float *position = malloc(count * sizeof *position);
    uint8_t *packed = malloc(count * 4);
    mrt_result result = MRT_OK;
    if (!position || !packed)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory for a frame", writer->path);
    for (uint32_t frame = 0; result == MRT_OK && frame < clip_frame_count(c); ++frame) {
        result = clip_read(c, frame, position, err);
        if (result == MRT_OK)
            result = check_finite(position, count, frame, err);
        if (result < 0) {
            error_prefix(err, writer->path);
            break;
        }
        uint8_t *out = packed;
        for (size_t i = 0; i < count; ++i)
            out = export_pack_float(out, position[i], order);
        result = export_put(writer, packed, count * 4, err);
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
    free(position);
    free(packed);
    if (result < 0)
        file_writer_abandon(writer);
    return result;
}

mrt_result export_check_cache(const clip *c, const char *path, error *err)
{
    if (clip_frame_count(c) == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the performance has no frames to write", path);
    if (clip_frame_count(c) > INT32_MAX || clip_mesh(c)->vertex_count > INT32_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: %u frames of %u vertices are more than the format can count", path,
                         clip_frame_count(c), clip_mesh(c)->vertex_count);
    return MRT_OK;
}

void export_step(const export_progress *progress, double done)
{
    if (progress && progress->step)
        progress->step(progress->data, done);
}
