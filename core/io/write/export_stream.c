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

mrt_result export_points_choose(export_points *out, const clip *c, const cache_options *options,
                                error *err)
{
    const mesh *m = clip_mesh(c);
    const cache_options chosen = options ? *options : (cache_options){0};
    *out = (export_points){.per_mm = 1.0};
    if (chosen.mm_per_unit > 0.0)
        out->per_mm = 1.0 / chosen.mm_per_unit;
    uint8_t *is_used = calloc((size_t)m->vertex_count + 1, 1);
    out->vertex = calloc((size_t)m->vertex_count + 1, sizeof *out->vertex);
    if (!is_used || !out->vertex) {
        free(is_used);
        export_points_finish(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a list of the vertices");
    }
    for (uint32_t i = 0; i < chosen.part_count; ++i) {
        const mesh_part *part = &m->part[chosen.first_part + i];
        for (size_t k = 0; k < (size_t)part->triangle_count * 3; ++k)
            is_used[m->triangle[(size_t)part->first_triangle * 3 + k]] = 1;
    }
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        if (chosen.part_count == 0 || is_used[v])
            out->vertex[out->count++] = v;
    free(is_used);
    return MRT_OK;
}

void export_points_finish(export_points *points)
{
    free(points->vertex);
    *points = (export_points){0};
}

mrt_result export_put_frames(file_writer *writer, const clip *c, const export_points *points,
                             export_order order, const export_progress *progress, error *err)
{
    size_t count = (size_t)clip_mesh(c)->vertex_count * 3;
    float *position = malloc(count * sizeof *position);
    uint8_t *packed = malloc((size_t)points->count * 12 + 1);
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
        for (size_t i = 0; i < points->count; ++i)
            for (size_t axis = 0; axis < 3; ++axis) {
                double at = (double)position[(size_t)points->vertex[i] * 3 + axis];
                out = export_pack_float(out, (float)(at * points->per_mm), order);
            }
        result = export_put(writer, packed, (size_t)points->count * 12, err);
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

void export_timecode(timecode_rate *out_rate, int64_t *out_first, const clip *c)
{
    const clip_start *start = clip_start_of(c);
    error ignored;
    *out_rate = (timecode_rate){.num = start->rate_num,
                                .den = start->rate_den,
                                .is_drop = strchr(start->timecode, ';') != NULL};
    *out_first = start->frame;
    if (start->rate_num == 0 && timecode_rate_of(out_rate, clip_fps(c), &ignored) < 0)
        *out_rate = (timecode_rate){0};
}

void export_step(const export_progress *progress, double done)
{
    if (progress && progress->step)
        progress->step(progress->data, done);
}
