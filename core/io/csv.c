#include "io/export_stream.h"

#include <locale.h>

/* Where the controls were in the frame before: of an anchored one start + displacement. */
typedef struct csv_places {
    const double *start, *displacement; /* anchored */
    const double *tip;                  /* free */
    uint32_t count;
} csv_places;

static csv_places places_of(const clip *c, uint32_t frame)
{
    int32_t segment = clip_frame_segment(c, frame);
    csv_places places = {0};
    if (segment < 0) {
        places.tip = clip_tips(c, frame, &places.count);
        return places;
    }
    const clip_segment *s = clip_segment_at(c, (uint32_t)segment);
    places.start = s->start;
    places.displacement = clip_displacement(c, frame);
    places.count = s->control_count;
    return places;
}

static double place(const csv_places *places, uint32_t control, int axis)
{
    size_t at = (size_t)control * 3 + (size_t)axis;
    return places->tip ? places->tip[at] : places->start[at] + places->displacement[at];
}

static bool put_frame(FILE *stream, const clip *c, uint32_t frame)
{
    csv_places now = places_of(c, frame);
    csv_places before = frame ? places_of(c, frame - 1) : now;
    int32_t segment = clip_frame_segment(c, frame);
    for (uint32_t k = 0; k < now.count; ++k) {
        int written = fprintf(stream, "%u,%.9g,%s,", frame, (double)frame / clip_fps(c),
                              segment < 0 ? "free" : "anchored");
        if (written > 0 && segment >= 0)
            written = fprintf(stream, "%d", segment + 1);
        if (written > 0)
            written = fprintf(stream, ",%u", k + 1);
        const csv_places *from = k < before.count ? &before : &now;
        for (int axis = 0; written > 0 && axis < 3; ++axis)
            written = fprintf(stream, ",%.9g",
                              segment < 0 ? place(from, k, axis) : now.start[k * 3 + (size_t)axis]);
        for (int axis = 0; written > 0 && axis < 3; ++axis)
            written = fprintf(stream, ",%.9g", place(&now, k, axis));
        if (written < 0 || fputc('\n', stream) == EOF)
            return false;
    }
    return true;
}

static bool put_all(FILE *stream, const clip *c, const export_progress *progress)
{
    bool good = fputs("frame,time_s,mode,segment,control,start_x,start_y,start_z,end_x,end_y,"
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
