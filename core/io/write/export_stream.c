#include "io/write/export_stream.h"

#include <string.h>

mrt_result export_check_size(const clip *c, const char *path, error *err)
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
