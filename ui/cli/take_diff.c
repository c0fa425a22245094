/* marotte take diff: performs two takes side by side and measures their difference. */
#include "base/file.h"
#include "stage/playback/diff.h"
#include "cli/take.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORST_COUNT = 5, FRAMES_MAX = 2000000 };
static const int64_t worst_apart_ns = 500000000;

typedef struct comparison {
    take_stage a, b;
    take_frames frames;
    diff *by;
    diff_frame *frame; /* frames.count elements */
    int64_t at;
    float *rows[2]; /* vertex_count by 3 */
    uint32_t parts; /* bits: regions to report */
} comparison;

static mrt_result check_meshes(const take_stage *a, const take_stage *b, error *err)
{
    const mesh *m = &a->face.mesh, *n = &b->face.mesh;
    if (m->vertex_count == n->vertex_count && m->triangle_count == n->triangle_count &&
        memcmp(m->triangle, n->triangle, (size_t)m->triangle_count * 3 * sizeof *m->triangle) == 0)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s (%u vertices) and %s (%u) are not one mesh, so their vertices cannot be "
                     "compared; --face FILE performs both takes on one face",
                     a->face_path, m->vertex_count, b->face_path, n->vertex_count);
}

static mrt_result choose_parts(comparison *self, take_call *call, error *err)
{
    self->parts = (1u << DIFF_PART_COUNT) - 1;
    if (!call->text[TAKE_REGION])
        return MRT_OK;
    return take_read_regions(call, call->text[TAKE_REGION], &self->parts, err);
}

static void to_rows(float *out, take_stage *stage)
{
    const face *f = composer_face(sequencer_performer(stage->sequencer)->composer);
    points_to_rows(out, face_shown(f), face_order(f));
}

static mrt_result make(comparison *self, error *err)
{
    const mesh *m = &self->a.face.mesh;
    composer *shown = sequencer_performer(self->a.sequencer)->composer;
    for (int i = 0; i < 2; ++i)
        self->rows[i] = malloc((size_t)m->vertex_count * 3 * sizeof(float));
    self->frame = calloc((size_t)self->frames.count, sizeof *self->frame);
    if (!self->rows[0] || !self->rows[1] || !self->frame)
        return error_set(err, MRT_ERR_MEMORY, "no memory to compare two takes");
    return diff_create(&self->by, m->position, m->vertex_count, composer_about(shown),
                       composer_solver(shown).radius, err);
}

/* Chooses the frames that both takes have. */
static mrt_result choose_frames(comparison *self, take_call *call, error *err)
{
    take shorter = self->a.take;
    if (self->b.take.duration_ns < shorter.duration_ns)
        shorter.duration_ns = self->b.take.duration_ns;
    if (self->a.take.duration_ns != self->b.take.duration_ns)
        fprintf(stderr,
                "note: the takes are %.6g and %.6g s long. Only their common time is compared\n",
                (double)self->a.take.duration_ns / 1e9, (double)self->b.take.duration_ns / 1e9);
    mrt_result result = take_frames_of(&self->frames, call, &shorter, err);
    if (result >= 0 && self->frames.count > FRAMES_MAX)
        result = error_set(
            err, MRT_ERR_ARGUMENT,
            "%lld frames are too many to compare, at most %d. Use a lower --fps, or --in and --out",
            (long long)self->frames.count, FRAMES_MAX);
    return result;
}

static mrt_result each(void *data, const stage_frame *f, error *err)
{
    (void)f;
    comparison *self = data;
    int64_t at_ns = timecode_time_ns(self->frames.rate, self->frames.first + self->at);
    mrt_result result = sequencer_play_to(self->b.sequencer, at_ns, err);
    if (result >= 0)
        result = sequencer_check(self->b.sequencer, err);
    if (result < 0)
        return result;
    composer_draw(sequencer_performer(self->b.sequencer)->composer);
    to_rows(self->rows[0], &self->a);
    to_rows(self->rows[1], &self->b);
    diff_measure(self->by, self->rows[0], self->rows[1], &self->frame[self->at++]);
    return MRT_OK;
}

/* ---- report ---- */

static void label(char out[TIMECODE_TEXT], const comparison *self, uint32_t frame)
{
    timecode_write(
        out, self->frames.rate,
        take_label_frame(&self->a.take, self->frames.rate, self->frames.first + (int64_t)frame));
}

static double time_s(const comparison *self, uint32_t frame)
{
    return (double)timecode_time_ns(self->frames.rate, self->frames.first + frame) / 1e9;
}

static void report_part(take_call *call, const comparison *self, uint32_t part)
{
    diff_total sum;
    char line[160], at[TIMECODE_TEXT];
    uint32_t vertices = diff_vertex_count(self->by, part);
    if (vertices == 0 || !(self->parts & 1u << part))
        return;
    diff_sum(part, self->frame, (uint32_t)self->frames.count, &sum);
    label(at, self, sum.worst);
    (void)snprintf(line, sizeof line, "max %.3f mm at %s, RMS %.3f mm, %u vertices", sum.max_mm, at,
                   sum.rms_mm, vertices);
    const facts_cell cells[] = {
        {"region", diff_part_name(part), 0, 0}, {"max_mm", NULL, sum.max_mm, 6},
        {"rms_mm", NULL, sum.rms_mm, 6},        {"worst_s", NULL, time_s(self, sum.worst), 9},
        {"worst_timecode", at, 0, 0},           {"vertices", NULL, vertices, 0}};
    facts_row(call->told, "regions", diff_part_name(part), line, cells, 6);
}

static void report_worst(take_call *call, const comparison *self)
{
    uint32_t worst[WORST_COUNT];
    uint32_t apart = (uint32_t)timecode_frame(self->frames.rate, worst_apart_ns) + 1;
    uint32_t count =
        diff_worst(self->frame, (uint32_t)self->frames.count, apart, worst, WORST_COUNT);
    for (uint32_t i = 0; i < count; ++i) {
        char line[96], at[TIMECODE_TEXT];
        double max_mm = self->frame[worst[i]].max_mm[DIFF_FACE];
        label(at, self, worst[i]);
        (void)snprintf(line, sizeof line, "%s (%.3f s): %.3f mm", at, time_s(self, worst[i]),
                       max_mm);
        const facts_cell cells[] = {{"timecode", at, 0, 0},
                                    {"time_s", NULL, time_s(self, worst[i]), 9},
                                    {"max_mm", NULL, max_mm, 6}};
        facts_row(call->told, "worst", "worst moment", line, cells, 3);
    }
}

static mrt_result write_csv(const comparison *self, const char *path, error *err)
{
    file_writer file;
    mrt_result result = file_writer_open(&file, path, err);
    if (result < 0)
        return result;
    fprintf(file.stream, "frame,time_s,timecode");
    for (uint32_t part = 0; part < DIFF_PART_COUNT; ++part)
        if (diff_vertex_count(self->by, part) > 0)
            fprintf(file.stream, ",%s_max_mm,%s_rms_mm", diff_part_name(part),
                    diff_part_name(part));
    fputc('\n', file.stream);
    for (uint32_t i = 0; i < (uint32_t)self->frames.count; ++i) {
        char at[TIMECODE_TEXT];
        label(at, self, i);
        fprintf(file.stream, "%lld,%.9f,%s", (long long)self->frames.first + i, time_s(self, i),
                at);
        for (uint32_t part = 0; part < DIFF_PART_COUNT; ++part)
            if (diff_vertex_count(self->by, part) > 0)
                fprintf(file.stream, ",%.6f,%.6f", self->frame[i].max_mm[part],
                        self->frame[i].rms_mm[part]);
        fputc('\n', file.stream);
    }
    return file_writer_commit(&file, err);
}

static mrt_result tell(take_call *call, const comparison *self, error *err)
{
    facts_number(call->told, "frames", "frames compared", (double)self->frames.count, 0, "");
    for (uint32_t part = 0; part < DIFF_PART_COUNT; ++part)
        report_part(call, self, part);
    report_worst(call, self);
    if (!call->text[TAKE_CSV])
        return MRT_OK;
    mrt_result result = write_csv(self, call->text[TAKE_CSV], err);
    if (result >= 0)
        facts_file(call->told, call->text[TAKE_CSV], "");
    return result;
}

mrt_result take_diff_report(take_call *call, const char *a, const char *b, error *err)
{
    comparison self = {.at = 0};
    mrt_result result = choose_parts(&self, call, err);
    if (result >= 0)
        result = take_stage_open(&self.a, call, a, call->text[TAKE_FACE], err);
    if (result >= 0)
        result = take_stage_open(&self.b, call, b, call->text[TAKE_FACE], err);
    if (result >= 0)
        result = check_meshes(&self.a, &self.b, err);
    if (result >= 0)
        result = choose_frames(&self, call, err);
    if (result >= 0)
        result = make(&self, err);
    if (result >= 0)
        result = take_stage_play(&self.a, call, &self.frames, each, &self, err);
    if (result >= 0) {
        take_stage_report(&self.b);
        result = tell(call, &self, err);
    }
    diff_destroy(self.by);
    free(self.frame);
    free(self.rows[0]);
    free(self.rows[1]);
    take_stage_finish(&self.b);
    take_stage_finish(&self.a);
    return result;
}

mrt_result take_diff_run(take_call *call, error *err)
{
    const exports_file table = {call->text[TAKE_CSV], EXPORTS_NONE};
    mrt_result result = call->text[TAKE_CSV] ? exports_check(&table, 1, err) : MRT_OK;
    return result < 0 ? result : take_diff_report(call, call->word[1], call->word[2], err);
}
