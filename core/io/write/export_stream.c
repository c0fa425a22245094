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

mrt_result export_text_open(export_text *out, const char *path, error *err)
{
    *out = (export_text){.plain = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0)};
    if (!out->plain)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    mrt_result result = file_writer_open(&out->writer, path, err);
    if (result < 0)
        freelocale(out->plain);
    else
        out->kept = uselocale(out->plain);
    return result;
}

mrt_result export_text_close(export_text *self, mrt_result result, error *err)
{
    (void)uselocale(self->kept);
    freelocale(self->plain);
    if (result >= 0)
        return file_writer_commit(&self->writer, err);
    file_writer_abandon(&self->writer);
    return result;
}
