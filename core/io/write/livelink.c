#include "io/arkit.h"

#include "base/file.h"
#include "io/write/export_stream.h"

#include <locale.h>
#include <math.h>
#include <string.h>

static void put_frame(FILE *stream, const clip *c, uint32_t frame, const char *timecode)
{
    const double *value = clip_arkit_values(c, frame);
    (void)fprintf(stream, "%s.000,%d", timecode, ARKIT_CHANNELS);
    for (int i = 0; i < ARKIT_CHANNELS; ++i)
        (void)fprintf(stream, ",%.9g", value ? value[i] + 0.0 : 0.0); /* no -0 */
    (void)fputc('\n', stream);
}

static void put_all(FILE *stream, const clip *c, const export_progress *progress)
{
    timecode_rate rate;
    int64_t first;
    char timecode[TIMECODE_TEXT] = "00:00:00:00";
    export_timecode(&rate, &first, c);
    (void)fputs("Timecode,BlendShapeCount", stream);
    for (int i = 0; i < ARKIT_CHANNELS; ++i)
        (void)fprintf(stream, ",%s", arkit_name[i]);
    (void)fputc('\n', stream);
    for (uint32_t frame = 0; frame < clip_frame_count(c) && !ferror(stream); ++frame) {
        if (rate.num > 0)
            timecode_write(timecode, rate, first + frame);
        for (char *at = timecode; *at; ++at)
            *at = *at == ';' ? ':' : *at;
        put_frame(stream, c, frame, timecode);
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
}

mrt_result livelink_write(const char *path, const clip *c, const export_progress *progress,
                          error *err)
{
    locale_t plain = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!plain)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    file_writer writer;
    mrt_result result = file_writer_open(&writer, path, err);
    if (result == MRT_OK) {
        locale_t kept = uselocale(plain);
        put_all(writer.stream, c, progress); /* what failed is found by commit */
        (void)uselocale(kept);
        result = file_writer_commit(&writer, err);
    }
    freelocale(plain);
    return result;
}
