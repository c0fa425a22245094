/* Tables: the curves of a clip for users, and the table of Live Link Face. */
#include "io/curves.h"

#include "io/write/export_stream.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct table {
    FILE *stream;
    const clip *clip;
    timecode_rate rate; /* num 0: no time code */
    int64_t first;      /* frame, in time code */
    uint32_t control_count;
    float *position; /* positions of one frame: scratch */
} table;

/* Returns the segment of a frame, or the segment that its remainder is relative to; -1: none.
 */
static int32_t segment_of(const clip *c, uint32_t frame)
{
    uint32_t segment;
    if (clip_frame_segment(c, frame) >= 0)
        return clip_frame_segment(c, frame);
    return clip_pulled(c, frame, &segment) ? (int32_t)segment : -1;
}

static bool is_rest(const table *t, const float *position)
{
    const mesh *m = clip_mesh(t->clip);
    return memcmp(position, m->position, (size_t)m->vertex_count * 3 * sizeof *position) == 0;
}

static const char *shape_of(const table *t, uint32_t frame)
{
    int32_t segment = segment_of(t->clip, frame);
    error ignored;
    if (segment >= 0)
        return is_rest(t, clip_segment_at(t->clip, (uint32_t)segment)->base) ? "anchored"
                                                                             : "committed";
    bool still = clip_read(t->clip, frame, t->position, &ignored) >= 0 && is_rest(t, t->position);
    return still ? "anchored" : "free";
}

/* Writes a name without separators, quotes and control characters, which names from files may
 * contain. */
static void write_name(FILE *stream, const char *name)
{
    (void)fputc(',', stream);
    for (; *name; ++name) {
        bool is_plain = *name != ',' && *name != ';' && *name != '"' && (unsigned char)*name >= ' ';
        (void)fputc(is_plain ? *name : '_', stream);
    }
}

static void write_head(const table *t)
{
    (void)fputs("frame,timecode,time_s,shape", t->stream);
    for (uint32_t i = 0; i < clip_curve_count(t->clip); ++i)
        write_name(t->stream, clip_curve_at(t->clip, i)->name);
    for (uint32_t k = 0; k < t->control_count; ++k)
        for (int i = 0; i < 6; ++i)
            (void)fprintf(t->stream, ",control%u.%s.%c", k + 1, i < 3 ? "start" : "end",
                          "xyz"[i % 3]);
    (void)fputc('\n', t->stream);
}

/* Writes a number; pure rounding is written as 0. */
static void write_number(FILE *stream, double value)
{
    (void)fprintf(stream, ",%.9g", fabs(value) < 1e-9 ? 0.0 : value);
}

static void write_curves_of(const table *t, uint32_t frame)
{
    char timecode[TIMECODE_TEXT] = "";
    const double *value = clip_values(t->clip, frame);
    uint32_t count;
    const double *control = clip_controls(t->clip, frame, &count);
    if (t->rate.num > 0)
        timecode_write(timecode, t->rate, t->first + frame);
    (void)fprintf(t->stream, "%u,%s,%.9g,%s", frame, timecode, (double)frame / clip_fps(t->clip),
                  shape_of(t, frame));
    for (uint32_t i = 0; i < clip_curve_count(t->clip); ++i)
        if (value && !isnan(value[i]))
            write_number(t->stream, value[i]);
        else
            (void)fputc(',', t->stream);
    for (uint32_t i = 0; i < t->control_count * 6; ++i)
        if (i < count * 6)
            write_number(t->stream, control[i]);
        else
            (void)fputc(',', t->stream);
    (void)fputc('\n', t->stream);
}

static void write_curves(table *t, const export_progress *progress)
{
    const clip_start *start = clip_start_of(t->clip);
    uint32_t frame_count = clip_frame_count(t->clip), count;
    for (uint32_t frame = 0; frame < frame_count; ++frame) {
        (void)clip_controls(t->clip, frame, &count);
        t->control_count = count > t->control_count ? count : t->control_count;
    }
    if (start->rate_num > 0)
        (void)fprintf(t->stream, "# first frame %s (%lld), %u/%u frames a second\n",
                      start->timecode, (long long)start->frame, start->rate_num, start->rate_den);
    write_head(t);
    for (uint32_t frame = 0; frame < frame_count && !ferror(t->stream); ++frame) {
        write_curves_of(t, frame);
        export_step(progress, (double)(frame + 1) / (double)frame_count);
    }
}

mrt_result csv_write(const char *path, const clip *c, const export_progress *progress, error *err)
{
    table t = {.clip = c};
    export_text text;
    export_timecode(&t.rate, &t.first, c);
    t.position = malloc((size_t)clip_mesh(c)->vertex_count * 3 * sizeof *t.position);
    mrt_result result = t.position ? export_text_open(&text, path, err)
                                   : error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    if (result >= 0) {
        t.stream = text.writer.stream;
        write_curves(&t, progress);
        result = export_text_close(&text, MRT_OK, err);
    }
    free(t.position);
    return result;
}

/* ---- Live Link Face ---- */

static void write_shapes_of(FILE *stream, const clip *c, uint32_t frame, const char *timecode)
{
    const double *value = clip_arkit_values(c, frame);
    (void)fprintf(stream, "%s.000,%d", timecode, ARKIT_CHANNELS);
    for (int i = 0; i < ARKIT_CHANNELS; ++i)
        (void)fprintf(stream, ",%.9g", value ? value[i] + 0.0 : 0.0); /* no -0 */
    (void)fputc('\n', stream);
}

static void write_shapes(FILE *stream, const clip *c, const export_progress *progress)
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
        write_shapes_of(stream, c, frame, timecode);
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
}

mrt_result livelink_write(const char *path, const clip *c, const export_progress *progress,
                          error *err)
{
    export_text text;
    mrt_result result = export_text_open(&text, path, err);
    if (result < 0)
        return result;
    write_shapes(text.writer.stream, c, progress);
    return export_text_close(&text, MRT_OK, err);
}
