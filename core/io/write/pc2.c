#include "io/write/export_stream.h"

/* PC2, little-endian: "POINTCACHE2\0", int32 version, int32 vertices, float32 start frame, float32
 * frames per sample, int32 samples, then float32 x y z. */
mrt_result pc2_write(const char *path, const clip *c, const cache_options *options,
                     const export_progress *progress, error *err)
{
    static const char magic[12] = "POINTCACHE2";
    export_points points = {0};
    mrt_result result = export_check_cache(c, path, err);
    if (result == MRT_OK)
        result = export_points_choose(&points, c, options, err);
    if (result < 0)
        return result;
    uint8_t numbers[20], *out = numbers;
    out = export_pack_u32(out, 1, EXPORT_LITTLE_ENDIAN);
    out = export_pack_u32(out, points.count, EXPORT_LITTLE_ENDIAN);
    out = export_pack_float(out, (float)clip_start_of(c)->frame, EXPORT_LITTLE_ENDIAN);
    out = export_pack_float(out, 1.0f, EXPORT_LITTLE_ENDIAN);
    (void)export_pack_u32(out, clip_frame_count(c), EXPORT_LITTLE_ENDIAN);
    file_writer writer;
    result = file_writer_open(&writer, path, err);
    if (result == MRT_OK)
        result = export_put(&writer, magic, sizeof magic, err);
    if (result == MRT_OK)
        result = export_put(&writer, numbers, sizeof numbers, err);
    if (result == MRT_OK)
        result = export_put_frames(&writer, c, &points, EXPORT_LITTLE_ENDIAN, progress, err);
    if (result == MRT_OK)
        result = file_writer_commit(&writer, err);
    export_points_finish(&points);
    return result;
}
