/* Point caches: positions of all vertices in every frame, .pc2 and .mdd. */
#include "base/file.h"
#include "io/write/export_stream.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef enum byte_order { LITTLE_ENDIAN_BYTES = 0, BIG_ENDIAN_BYTES } byte_order;

/* Writes four bytes. Returns the position of the next number. */
static uint8_t *pack_u32(uint8_t *out, uint32_t value, byte_order order)
{
    for (int i = 0; i < 4; ++i) {
        int shift = 8 * (order == BIG_ENDIAN_BYTES ? 3 - i : i);
        out[i] = (uint8_t)(value >> shift);
    }
    return out + 4;
}

static uint8_t *pack_float(uint8_t *out, float value, byte_order order)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return pack_u32(out, bits, order);
}

static mrt_result put(file_writer *writer, const void *data, size_t size, error *err)
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

typedef struct point_set { /* exported vertices and their unit */
    uint32_t *vertex;      /* count, ascending */
    uint32_t count;
    double per_mm;
} point_set;

static void points_finish(point_set *points)
{
    free(points->vertex);
    *points = (point_set){0};
}

static mrt_result points_choose(point_set *out, const clip *c, const cache_options *options,
                                error *err)
{
    const mesh *m = clip_mesh(c);
    const cache_options chosen = options ? *options : (cache_options){0};
    *out = (point_set){.per_mm = 1.0};
    if (chosen.mm_per_unit > 0.0)
        out->per_mm = 1.0 / chosen.mm_per_unit;
    uint8_t *is_used = calloc((size_t)m->vertex_count + 1, 1);
    out->vertex = calloc((size_t)m->vertex_count + 1, sizeof *out->vertex);
    if (!is_used || !out->vertex) {
        free(is_used);
        points_finish(out);
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

/* Writes the positions of the points in all frames, x y z per vertex. Non-finite ones are an error.
 */
static mrt_result write_frames(file_writer *writer, const clip *c, const point_set *points,
                               byte_order order, const export_progress *progress, error *err)
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
                out = pack_float(out, (float)(at * points->per_mm), order);
            }
        result = put(writer, packed, (size_t)points->count * 12, err);
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
    free(position);
    free(packed);
    if (result < 0)
        file_writer_abandon(writer);
    return result;
}

/* The header of a format, header_size bytes, before the frames. */
typedef struct cache_form {
    byte_order order;
    size_t (*header_size)(const clip *c);
    void (*write_header)(uint8_t *out, const clip *c, const point_set *points);
} cache_form;

static mrt_result write_cache(const char *path, const clip *c, const cache_options *options,
                              const cache_form *form, const export_progress *progress, error *err)
{
    point_set points = {0};
    file_writer writer;
    mrt_result result = export_check_size(c, path, err);
    if (result >= 0)
        result = points_choose(&points, c, options, err);
    if (result < 0)
        return result;
    const size_t size = form->header_size(c);
    uint8_t *header = malloc(size);
    if (header)
        form->write_header(header, c, &points);
    result = header ? file_writer_open(&writer, path, err)
                    : error_set(err, MRT_ERR_MEMORY, "%s: no memory for its header", path);
    if (result >= 0)
        result = put(&writer, header, size, err);
    if (result >= 0)
        result = write_frames(&writer, c, &points, form->order, progress, err);
    if (result >= 0)
        result = file_writer_commit(&writer, err);
    free(header);
    points_finish(&points);
    return result;
}

/* ---- PC2, little-endian: "POINTCACHE2\0", int32 version, int32 vertices, float32 start frame,
 * float32 frames per sample, int32 samples, then float32 x y z ---- */

static size_t pc2_header_size(const clip *c)
{
    (void)c;
    return 32;
}

static void write_pc2_header(uint8_t *out, const clip *c, const point_set *points)
{
    memcpy(out, "POINTCACHE2", 12);
    out = pack_u32(out + 12, 1, LITTLE_ENDIAN_BYTES);
    out = pack_u32(out, points->count, LITTLE_ENDIAN_BYTES);
    out = pack_float(out, (float)clip_start_of(c)->frame, LITTLE_ENDIAN_BYTES);
    out = pack_float(out, 1.0f, LITTLE_ENDIAN_BYTES);
    (void)pack_u32(out, clip_frame_count(c), LITTLE_ENDIAN_BYTES);
}

mrt_result pc2_write(const char *path, const clip *c, const cache_options *options,
                     const export_progress *progress, error *err)
{
    static const cache_form pc2 = {LITTLE_ENDIAN_BYTES, pc2_header_size, write_pc2_header};
    return write_cache(path, c, options, &pc2, progress, err);
}

/* ---- MDD, big-endian: int32 frames, int32 vertices, float32 time in s per frame, then float32
 * x y z ---- */

static size_t mdd_header_size(const clip *c)
{
    return 8 + (size_t)4 * clip_frame_count(c);
}

static void write_mdd_header(uint8_t *out, const clip *c, const point_set *points)
{
    out = pack_u32(out, clip_frame_count(c), BIG_ENDIAN_BYTES);
    out = pack_u32(out, points->count, BIG_ENDIAN_BYTES);
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame)
        out = pack_float(out, (float)((double)frame / clip_fps(c)), BIG_ENDIAN_BYTES);
}

mrt_result mdd_write(const char *path, const clip *c, const cache_options *options,
                     const export_progress *progress, error *err)
{
    static const cache_form mdd = {BIG_ENDIAN_BYTES, mdd_header_size, write_mdd_header};
    return write_cache(path, c, options, &mdd, progress, err);
}
