#include "io/write/export_stream.h"

#include <locale.h>

static bool put_frame(FILE *stream, const clip *c, uint32_t frame)
{
    uint32_t count;
    const double *controls = clip_controls(c, frame, &count);
    int32_t segment = clip_frame_segment(c, frame);
    for (uint32_t k = 0; k < count; ++k) {
        int written = fprintf(stream, "%u,%.9g,%s,", frame, (double)frame / clip_fps(c),
                              segment < 0 ? "free" : "anchored");
        if (written > 0 && segment >= 0)
            written = fprintf(stream, "%d", segment + 1);
        if (written > 0)
            written = fprintf(stream, ",%u", k + 1);
        for (size_t i = 0; written > 0 && i < 6; ++i)
            written = fprintf(stream, ",%.9g", controls[(size_t)k * 6 + i]);
        if (written < 0 || fputc('\n', stream) == EOF)
            return false;
    }
    return true;
}

static bool put_all(FILE *stream, const clip *c, const export_progress *progress)
{
    const clip_start *start = clip_start_of(c);
    bool good = true;
    if (start->rate_num > 0)
        good = fprintf(stream, "# first frame %s (%lld), %u/%u frames a second\n", start->timecode,
                       (long long)start->frame, start->rate_num, start->rate_den) > 0;
    good = good && fputs("frame,time_s,mode,segment,control,start_x,start_y,start_z,end_x,end_y,"
                         "end_z\n",
                         stream) >= 0;
    for (uint32_t frame = 0; good && frame < clip_frame_count(c); ++frame) {
        good = put_frame(stream, c, frame);
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
    return good;
}

mrt_result csv_write(const char *path, const clip *c, const export_progress *progress, error *err)
{
    /* Decimal points, whatever the person's locale. */
    locale_t plain = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!plain)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    file_writer writer;
    mrt_result result = file_writer_open(&writer, path, err);
    if (result == MRT_OK) {
        locale_t kept = uselocale(plain);
        (void)put_all(writer.stream, c, progress); /* what failed is found by commit */
        (void)uselocale(kept);
        result = file_writer_commit(&writer, err);
    }
    freelocale(plain);
    return result;
}
