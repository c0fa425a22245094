#include "io/write/export_stream.h"

static mrt_result put_times(file_writer *writer, const clip *c, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t frame = 0; result == MRT_OK && frame < clip_frame_count(c); ++frame) {
        uint8_t time_s[4];
        (void)export_pack_float(time_s, (float)((double)frame / clip_fps(c)), EXPORT_BIG_ENDIAN);
        result = export_put(writer, time_s, sizeof time_s, err);
    }
    return result;
}

/* MDD, big-endian: int32 frames, int32 vertices, float32 time in s per frame, then float32 x y z.
 */
mrt_result mdd_write(const char *path, const clip *c, const cache_options *options,
                     const export_progress *progress, error *err)
{
    export_points points = {0};
    mrt_result result = export_check_cache(c, path, err);
    if (result == MRT_OK)
        result = export_points_choose(&points, c, options, err);
    if (result < 0)
        return result;
    uint8_t numbers[8], *out = numbers;
    out = export_pack_u32(out, clip_frame_count(c), EXPORT_BIG_ENDIAN);
    (void)export_pack_u32(out, points.count, EXPORT_BIG_ENDIAN);
    file_writer writer;
    result = file_writer_open(&writer, path, err);
    if (result == MRT_OK)
        result = export_put(&writer, numbers, sizeof numbers, err);
    if (result == MRT_OK)
        result = put_times(&writer, c, err);
    if (result == MRT_OK)
        result = export_put_frames(&writer, c, &points, EXPORT_BIG_ENDIAN, progress, err);
    if (result == MRT_OK)
        result = file_writer_commit(&writer, err);
    export_points_finish(&points);
    return result;
}
