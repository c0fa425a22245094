/* Subcommands that read shows. */
#include "base/program.h"
#include "base/cancel.h"
#include "base/clock.h"
#include "base/file.h"
#include "cli/take.h"
#include "show/edit_store.h"
#include "show/hash.h"
#include "show/pack.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- take show: contents of a take ---- */

static double seconds(int64_t time_ns)
{
    return (double)time_ns / 1e9;
}

/* ---- layers and clips ---- */

static void join_own(char *out, size_t capacity, const take_layer *l)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < l->own_count && used + TAKE_NAME + 2 < capacity; ++i)
        used += (size_t)snprintf(out + used, capacity - used, "%s%s", i ? "," : "", l->own[i]);
}

static void report_clip(take_call *call, const take_layer *l, const take_clip *c)
{
    static const char *const parts[TAKE_PARTS] = {[TAKE_WHOLE] = "",
                                                  [TAKE_HANDS] = ", its hands alone",
                                                  [TAKE_PALETTE] = ", the poses that were played",
                                                  [TAKE_LIFE] = ", the life of the face"};
    char label[24], line[256];
    (void)snprintf(label, sizeof label, "  clip %u", c->id);
    (void)snprintf(line, sizeof line, "%.3f .. %.3f s, performance %lld%s%s%s%s%s",
                   seconds(c->start_ns + l->offset_ns), seconds(c->end_ns + l->offset_ns),
                   (long long)c->performance, parts[c->part], c->warp_count > 1 ? ", retimed" : "",
                   c->smooth_s > 0.0 ? ", smoothed" : "", c->is_muted ? ", muted" : "",
                   c->gain < 1.0 || c->gain > 1.0 ? ", with a gain" : "");
    const facts_cell cells[] = {{"id", NULL, c->id, 0},
                                {"layer", NULL, l->id, 0},
                                {"start_s", NULL, seconds(c->start_ns + l->offset_ns), 9},
                                {"end_s", NULL, seconds(c->end_ns + l->offset_ns), 9},
                                {"performance", NULL, (double)c->performance, 0},
                                {"part", NULL, c->part, 0},
                                {"points", NULL, c->warp_count, 0},
                                {"fade_in_s", NULL, seconds(c->fade_in_ns), 9},
                                {"fade_out_s", NULL, seconds(c->fade_out_ns), 9},
                                {"gain", NULL, c->gain, 9},
                                {"smooth_s", NULL, c->smooth_s, 9},
                                {"muted", NULL, c->is_muted, -1}};
    facts_row(call->told, "clips", label, line, cells, sizeof cells / sizeof cells[0]);
}

static void report_layer(take_call *call, const take_layer *l)
{
    char label[24], line[512], own[256];
    join_own(own, sizeof own, l);
    (void)snprintf(label, sizeof label, "layer %u", l->id);
    (void)snprintf(line, sizeof line, "'%s', owns %s, gain %.3g%s%s%s", l->name,
                   own[0] ? own : "all", l->gain, l->is_muted ? ", muted" : "",
                   l->is_solo ? ", solo" : "", l->is_additive ? ", additive" : "");
    const facts_cell cells[] = {{"id", NULL, l->id, 0},
                                {"name", l->name, 0, 0},
                                {"own", own, 0, 0},
                                {"gain", NULL, l->gain, 9},
                                {"offset_s", NULL, seconds(l->offset_ns), 9},
                                {"muted", NULL, l->is_muted, -1},
                                {"solo", NULL, l->is_solo, -1},
                                {"additive", NULL, l->is_additive, -1}};
    facts_row(call->told, "layers", label, line, cells, sizeof cells / sizeof cells[0]);
    for (uint32_t i = 0; i < l->clip_count; ++i)
        report_clip(call, l, &l->clip[i]);
}

/* ---- performances and tracks ---- */

static mrt_result report_track(take_call *call, int64_t id, error *err)
{
    show_track of;
    char label[24], line[512];
    mrt_result result = show_track_read(call->show, id, &of, err);
    if (result < 0)
        return result;
    double length_s = seconds(of.to_ns - of.from_ns);
    (void)snprintf(label, sizeof label, "track %lld", (long long)id);
    (void)snprintf(line, sizeof line, "%.200s, %u channels, %.2f s (%.120s)", of.track.device,
                   of.track.channel_count, length_s, of.track.input);
    const facts_cell cells[] = {{"id", NULL, (double)id, 0},
                                {"device", of.track.device, 0, 0},
                                {"input", of.track.input, 0, 0},
                                {"plugin", of.track.plugin, 0, 0},
                                {"channels", NULL, of.track.channel_count, 0},
                                {"length_s", NULL, length_s, 9}};
    facts_row(call->told, "tracks", label, line, cells, sizeof cells / sizeof cells[0]);
    show_track_finish(&of);
    return MRT_OK;
}

static mrt_result report_performance(take_call *call, int64_t id, error *err)
{
    show_performance of;
    char label[32], line[512], again[64] = "";
    mrt_result result = show_performance_read(call->show, id, &of, err);
    if (result < 0)
        return result;
    const take_performance *p = &of.performance;
    if (p->again.of)
        (void)snprintf(again, sizeof again, ", repeats %lld", (long long)p->again.of);
    int id_length = (int)strcspn(p->mapping, " ");
    (void)snprintf(label, sizeof label, "performance %lld", (long long)id);
    (void)snprintf(line, sizeof line, "%.*s on %.300s%s", id_length, p->mapping, p->rig, again);
    const facts_cell cells[] = {{"id", NULL, (double)id, 0},
                                {"mapping", p->mapping, 0, 0},
                                {"face", p->rig, 0, 0},
                                {"face_hash", p->rig_hash, 0, 0},
                                {"mesh_hash", p->mesh_hash, 0, 0},
                                {"again_of", NULL, (double)p->again.of, 0}};
    facts_row(call->told, "performances", label, line, cells, sizeof cells / sizeof cells[0]);
    for (uint32_t i = 0; i < p->track_count && result >= 0; ++i)
        result = report_track(call, p->track[i], err);
    show_performance_finish(&of);
    return result;
}

static mrt_result report_performances(take_call *call, const take *t, error *err)
{
    int64_t told[64];
    uint32_t count = 0;
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k) {
            int64_t id = t->layer[i].clip[k].performance;
            uint32_t at = 0;
            while (at < count && told[at] != id)
                ++at;
            if (at < count || count == 64)
                continue;
            told[count++] = id;
            mrt_result result = report_performance(call, id, err);
            if (result < 0)
                return result;
        }
    return MRT_OK;
}

/* ---- edits, events ---- */

static mrt_result report_edits(take_call *call, int64_t id, error *err)
{
    edit_store *store;
    history *of;
    mrt_result result = edit_store_open(&store, call->show, id, clock_utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(store);
    result = history_open(&of, edit_store_bare(store), &list, err);
    for (int64_t n = 1; result >= 0 && n <= history_last(of); ++n) {
        char label[32];
        bool is_undone = n > history_head(of);
        (void)snprintf(label, sizeof label, "edit %lld%s", (long long)n,
                       is_undone ? " undone" : "");
        const facts_cell cells[] = {{"n", NULL, (double)n, 0},
                                    {"words", history_words(of, n), 0, 0},
                                    {"undone", NULL, is_undone, -1}};
        facts_row(call->told, "edits", label, history_words(of, n), cells, 3);
    }
    if (result >= 0)
        history_close(of);
    edit_store_close(store);
    return result;
}

static const char *kind_of(const take_event *e)
{
    static const char *const kinds[] = {"event",     "parameter", "re-zero", "went away",
                                        "came back", "lost",      "mark"};
    return kinds[e->kind <= TAKE_EVENT_MARK ? e->kind : 0];
}

static mrt_result report_events(take_call *call, const take *t, error *err)
{
    take_event *event;
    size_t count;
    mrt_result result =
        show_events(call->show, t->start_ns, t->start_ns + t->duration_ns, &event, &count, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < count; ++i) {
        char line[192];
        double at_s = seconds(event[i].time_ns - t->start_ns);
        (void)snprintf(line, sizeof line, "%.3f s: %s %s", at_s, kind_of(&event[i]), event[i].text);
        const facts_cell cells[] = {{"at_s", NULL, at_s, 9},
                                    {"kind", kind_of(&event[i]), 0, 0},
                                    {"track", NULL, (double)event[i].track, 0},
                                    {"value", NULL, event[i].value, 9},
                                    {"text", event[i].text, 0, 0}};
        facts_row(call->told, "events", "event", line, cells, 5);
    }
    free(event);
    return MRT_OK;
}

/* ---- the take itself ---- */

static void report_take(take_call *call, const take *t)
{
    facts *told = call->told;
    facts_number(told, "take_id", "take id", (double)t->id, 0, "");
    facts_text(told, "take", "take", take_slate_text(t->scene, t->shot, t->number).text);
    if (t->name[0])
        facts_text(told, "name", "name", t->name);
    facts_text(told, "origin", "origin", t->origin);
    facts_number(told, "duration_s", "duration", seconds(t->duration_ns), 3, "s");
    if (t->rating)
        facts_number(told, "rating", "rating", t->rating, 0, "of 5");
    if (t->note[0])
        facts_text(told, "note", "note", t->note);
    if (t->fps > 0.0)
        facts_number(told, "fps", "frame rate", t->fps, 3, "per second");
    if (t->is_deleted)
        facts_text(told, "state", "state", "deleted: marotte take restore");
    else if (t->is_recording)
        facts_text(told, "state", "state", "being recorded");
    if (t->audio.audio) {
        facts_number(told, "audio", "sound", (double)t->audio.audio, 0, "");
        facts_number(told, "audio_offset_s", "  starts at", seconds(t->audio.offset_ns), 3, "s");
        if (t->audio.in_ns)
            facts_number(told, "audio_in_s", "  plays from", seconds(t->audio.in_ns), 3,
                         "s of the sound");
        if (t->audio.out_ns)
            facts_number(told, "audio_out_s", "  plays to", seconds(t->audio.out_ns), 3,
                         "s of the sound");
    }
    for (uint32_t i = 0; i < t->layer_count; ++i)
        report_layer(call, &t->layer[i]);
    for (uint32_t i = 0; i < t->marker_count; ++i) {
        char line[160];
        (void)snprintf(line, sizeof line, "%.3f s: %s", seconds(t->marker[i].at_ns),
                       t->marker[i].text);
        const facts_cell cells[] = {{"at_s", NULL, seconds(t->marker[i].at_ns), 9},
                                    {"text", t->marker[i].text, 0, 0}};
        facts_row(told, "markers", "mark", line, cells, 2);
    }
}

/* ---- the sum of all vertices ---- */

typedef struct vertex_sum {
    hash_sum *sum;
    float *rows;
    size_t vertex_count;
} vertex_sum;

static mrt_result add_frame(void *data, const stage_frame *drawn, error *err)
{
    (void)err;
    vertex_sum *self = data;
    const face *f = composer_face(drawn->performer->composer);
    points_to_rows(self->rows, face_shown(f), face_order(f));
    hash_add(self->sum, self->rows, self->vertex_count * 3 * sizeof(float));
    return MRT_OK;
}

static mrt_result report_hash(take_call *call, error *err)
{
    take_stage stage;
    take_frames frames;
    char sum[TAKE_HASH];
    vertex_sum self = {.sum = hash_begin()};
    mrt_result result = take_stage_open(&stage, call, call->word[1], call->text[TAKE_FACE], err);
    if (result >= 0)
        result = take_frames_of(&frames, call, &stage.take, err);
    if (result >= 0) {
        self.vertex_count = stage.face.mesh.vertex_count;
        self.rows = malloc(self.vertex_count * 3 * sizeof(float));
        if (!self.rows || !self.sum)
            result = error_set(err, MRT_ERR_MEMORY, "no memory");
    }
    if (result >= 0)
        result = take_stage_play(&stage, call, &frames, add_frame, &self, err);
    hash_end(sum, self.sum);
    if (result >= 0) {
        facts_number(call->told, "frames", "frames", (double)frames.count, 0, "");
        facts_text(call->told, "hash", "SHA-256", sum);
    }
    free(self.rows);
    take_stage_finish(&stage);
    return result;
}

static mrt_result run_show(take_call *call, error *err)
{
    take t;
    mrt_result result = take_read(call, call->word[1], &t, err);
    if (result < 0)
        return result;
    report_take(call, &t);
    result = report_performances(call, &t, err);
    error problem = {""};
    if (result >= 0 && report_edits(call, t.id, &problem) < 0)
        facts_list(call->told, "problems", "problem", problem.text);
    if (result >= 0)
        result = report_events(call, &t, err);
    take_finish(&t);
    return result < 0 || !call->text[TAKE_HASH_OPTION] ? result : report_hash(call, err);
}

/* ---- the show: list, keep the newest seconds, pack, recover, check ---- */

/* ---- list ---- */

static void report_row(take_call *call, const show_take *made, const take *t, const char *problem)
{
    char label[24], line[512], stars[8] = "";
    for (uint32_t i = 0; i < t->rating && i < 5; ++i)
        stars[i] = '*';
    take_name slate = take_slate_text(t->scene, t->shot, t->number);
    (void)snprintf(label, sizeof label, "take %lld", (long long)made->id);
    (void)snprintf(line, sizeof line, "%s  %.2f s%s%s%s%s%s%s%s%s", slate.text,
                   (double)t->duration_ns / 1e9, stars[0] ? "  " : "", stars,
                   t->name[0] ? "  " : "", t->name, t->audio.audio ? "  with sound" : "",
                   t->is_deleted ? "  deleted" : "", t->is_recording ? "  being recorded" : "",
                   problem[0] ? "  damaged" : "");
    const facts_cell cells[] = {{"id", NULL, (double)made->id, 0},
                                {"slate", slate.text, 0, 0},
                                {"name", t->name, 0, 0},
                                {"duration_s", NULL, (double)t->duration_ns / 1e9, 9},
                                {"rating", NULL, t->rating, 0},
                                {"origin", t->origin, 0, 0},
                                {"layers", NULL, t->layer_count, 0},
                                {"edits", NULL, made->edit_head, 0},
                                {"deleted", NULL, t->is_deleted, -1},
                                {"recording", NULL, t->is_recording, -1},
                                {"problem", problem, 0, 0}};
    facts_row(call->told, "takes", label, line, cells, sizeof cells / sizeof cells[0]);
}

static mrt_result run_list(take_call *call, error *err)
{
    show_take *takes;
    size_t count;
    mrt_result result = show_read_begin(call->show, err);
    if (result >= 0)
        result = show_takes(call->show, &takes, &count, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < count && !cancel_is_requested(); ++i) {
        take t;
        error problem = {""};
        if (edit_store_take_of(&t, call->show, &takes[i], &problem) < 0 && !problem.text[0])
            (void)error_set(&problem, MRT_ERR_FORMAT, "damaged");
        report_row(call, &takes[i], &t, problem.text);
        take_finish(&t);
    }
    show_read_end(call->show);
    facts_number(call->told, "take_count", "takes", (double)count, 0, "");
    free(takes);
    return cancel_check(err);
}

/* ---- keep ---- */

typedef struct keep {
    int64_t from_ns, to_ns;
    show_span *span;
    size_t count;
} keep;

/* Visits the live performances. The first pass finds their end, the second stores the spans. */
static mrt_result visit(take_call *call, const int64_t *ids, size_t count, keep *out, error *err)
{
    for (size_t i = 0; i < count; ++i) {
        show_performance of;
        mrt_result result = show_performance_read(call->show, ids[i], &of, err);
        if (result < 0)
            return result;
        bool is_live = of.performance.again.of == 0;
        int64_t from_ns = of.from_ns, to_ns = of.to_ns;
        show_performance_finish(&of);
        if (!is_live)
            continue;
        if (!out->span) {
            out->to_ns = to_ns > out->to_ns ? to_ns : out->to_ns;
            continue;
        }
        from_ns = from_ns > out->from_ns ? from_ns : out->from_ns;
        if (from_ns < to_ns)
            out->span[out->count++] = (show_span){
                .performance = ids[i], .from_ns = from_ns, .to_ns = to_ns, .is_shown = true};
    }
    return MRT_OK;
}

/* Live performances do not overlap, but recordings performed faster than real time can. Then the
 * newer one is kept, and the part of the older one before it. */
static void keep_one_at_a_time(keep *out)
{
    size_t left = out->count;
    int64_t newer_ns = INT64_MAX;
    for (size_t i = out->count; i-- > 0;) {
        show_span span = out->span[i];
        span.to_ns = span.to_ns < newer_ns ? span.to_ns : newer_ns;
        if (span.from_ns >= span.to_ns)
            continue;
        newer_ns = span.from_ns;
        out->span[--left] = span;
    }
    out->count -= left;
    memmove(out->span, out->span + left, out->count * sizeof *out->span);
}

static mrt_result keep_newest(take_call *call, double seconds, const int64_t *ids, size_t count,
                              keep *out, error *err)
{
    mrt_result result = visit(call, ids, count, out, err);
    if (result >= 0 && out->to_ns == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the show has no performance yet",
                         call->word[0]);
    if (result < 0)
        return result;
    out->from_ns = out->to_ns - (int64_t)(seconds * 1e9);
    out->span = calloc(count + 1, sizeof *out->span);
    if (!out->span)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    result = visit(call, ids, count, out, err);
    keep_one_at_a_time(out);
    if (out->count > 0)
        out->from_ns = out->span[0].from_ns;
    return result;
}

static mrt_result run_keep(take_call *call, error *err)
{
    double seconds = 30.0;
    int64_t *ids, id;
    size_t count;
    keep kept = {0};
    mrt_result result = take_number(call, TAKE_LAST, 0.001, 1e6, &seconds, err);
    if (result >= 0)
        result = show_performance_ids(call->show, &ids, &count, err);
    if (result < 0)
        return result;
    result = keep_newest(call, seconds, ids, count, &kept, err);
    free(ids);
    const show_new_take made = {.created_ns = clock_utc_ms() * 1000000,
                                .start_ns = kept.from_ns,
                                .end_ns = kept.to_ns,
                                .scene = call->text[TAKE_SCENE] ? call->text[TAKE_SCENE] : "",
                                .shot = call->text[TAKE_SHOT] ? call->text[TAKE_SHOT] : "",
                                .origin = "kept from the journal",
                                .spans = kept.span,
                                .span_count = kept.count};
    if (result >= 0)
        result = show_take_create(call->show, &made, &id, err);
    if (result >= 0) {
        facts_number(call->told, "take_id", "take id", (double)id, 0, "");
        facts_number(call->told, "duration_s", "duration",
                     (double)(kept.to_ns - kept.from_ns) / 1e9, 3, "s");
    }
    free(kept.span);
    return result;
}

/* ---- pack ---- */

/* Calls `each` for all performances, also after a failure. Returns the last failure. */
static mrt_result
for_performances(show *s, mrt_result (*each)(void *data, const take_performance *p, error *err),
                 void *data, error *err)
{
    int64_t *ids;
    size_t count;
    mrt_result worst = MRT_OK, result = show_performance_ids(s, &ids, &count, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < count && !cancel_is_requested(); ++i) {
        show_performance of;
        result = show_performance_read(s, ids[i], &of, err);
        if (result >= 0) {
            result = each(data, &of.performance, err);
            show_performance_finish(&of);
        }
        worst = result < 0 ? result : worst;
    }
    free(ids);
    return worst;
}

typedef struct packing {
    take_call *call;
    const char *copied_to; /* show that gets the packed faces; NULL: pack again */
    uint32_t packed_count, there_count, failed_count;
} packing;

static mrt_result pack_one(void *data, const take_performance *p, error *err)
{
    packing *self = data;
    mrt_result result = self->copied_to ? pack_copy(self->call->word[0], self->copied_to, p, err)
                                        : pack_add(self->call->word[0], p, err);
    self->packed_count += result == MRT_OK;
    self->there_count += result == MRT_END;
    self->failed_count += result < 0;
    if (result == MRT_OK)
        facts_list(self->call->told, "faces", "packed", p->rig);
    if (result < 0)
        fprintf(stderr, "warning: %s\n", err->text);
    return result;
}

static mrt_result run_pack(take_call *call, error *err)
{
    packing self = {.call = call};
    mrt_result result = for_performances(call->show, pack_one, &self, err);
    if (self.failed_count == 0 && result < 0)
        return result;
    if (self.packed_count + self.failed_count + self.there_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the show has no performance yet",
                         call->word[0]);
    facts_number(call->told, "packed_count", "faces packed now", self.packed_count, 0, "");
    call->is_told = true;
    if (self.failed_count == 0)
        return cancel_check(err);
    return error_set(err, MRT_ERR_IO, "%s: the faces of %u performances are not packed",
                     call->word[0], self.failed_count);
}

/* ---- recover ---- */

/* Copies the packed faces of a damaged show to the recovered one. Reports missing faces. */
static mrt_result recover_pack(take_call *call, error *err)
{
    packing self = {.call = call, .copied_to = call->text[TAKE_OUT]};
    error ignored;
    mrt_result result = show_open(&call->show, self.copied_to, SHOW_READ, err);
    if (result >= 0)
        (void)!for_performances(call->show, pack_one, &self, &ignored);
    return result;
}

static mrt_result run_recover(take_call *call, error *err)
{
    show_recovery report;
    mrt_result result = take_need(call, TAKE_OUT, err);
    if (result >= 0)
        result = file_make_parent(call->text[TAKE_OUT], err);
    if (result >= 0)
        result = show_recover(&report, call->word[0], call->text[TAKE_OUT], err);
    if (result < 0)
        return result;
    facts_number(call->told, "rows", "rows copied", (double)report.row_count, 0, "");
    facts_number(call->told, "damaged", "damaged, left out", (double)report.damaged_count, 0, "");
    if (report.is_cut)
        fprintf(stderr, "warning: %s has circular references: only a part of it was read\n",
                call->word[0]);
    facts_file(call->told, call->text[TAKE_OUT], "");
    return recover_pack(call, err);
}

/* ---- take check: reads everything once ---- */

enum { TOLD_MAX = 100, PIECE_BYTES = 1 << 16 };

typedef struct checking {
    take_call *call;
    uint32_t problem_count;
    uint64_t sample_count;
    char rig[TAKE_HASH], mesh[TAKE_HASH]; /* hashes of the packed face checked last */
    uint32_t packed_count;
} checking;

static void note(checking *self, const error *problem)
{
    if (self->problem_count++ < TOLD_MAX)
        facts_list(self->call->told, "problems", "damaged", problem->text);
}

static mrt_result check_track(checking *self, int64_t id, error *err)
{
    show_track of;
    show_reader *reader = NULL;
    mrt_sample sample;
    error problem = {""};
    mrt_result result = show_track_read(self->call->show, id, &of, &problem);
    if (result < 0) {
        note(self, &problem);
        return MRT_OK;
    }
    result = show_reader_open(&reader, self->call->show, id, of.from_ns, of.to_ns, err);
    show_track_finish(&of);
    if (result < 0)
        return result;
    while ((result = show_reader_next(reader, &sample, &problem)) != MRT_END) {
        if (result == MRT_OK)
            self->sample_count += 1;
        else
            note(self, &problem);
        if (result < 0 && (self->problem_count > 100000 || cancel_is_requested()))
            break;
    }
    show_reader_close(reader);
    return MRT_OK;
}

static void check_states(checking *self, int64_t performance, int64_t from_ns, int64_t to_ns)
{
    error problem = {""};
    for (int64_t at_ns = to_ns; at_ns >= from_ns;) {
        show_checkpoint kept;
        if (show_checkpoint_before(self->call->show, performance, at_ns, 0, &kept, &problem) < 0) {
            note(self, &problem);
            return;
        }
        if (!kept.bytes)
            return;
        bool is_first = kept.time_ns == INT64_MIN;
        at_ns = is_first ? at_ns : kept.time_ns - 1;
        show_checkpoint_finish(&kept);
        if (is_first)
            return;
    }
}

static mrt_result check_performance(checking *self, int64_t id, error *err)
{
    show_performance of;
    error problem = {""};
    (void)err;
    if (show_performance_read(self->call->show, id, &of, &problem) < 0) {
        note(self, &problem);
        return MRT_OK;
    }
    check_states(self, id, of.from_ns, of.to_ns);
    show_performance_finish(&of);
    return MRT_OK;
}

static mrt_result check_takes(checking *self, error *err)
{
    show_take *takes;
    size_t count;
    mrt_result result = show_takes(self->call->show, &takes, &count, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < count && !cancel_is_requested(); ++i) {
        take t;
        error problem = {""};
        if (edit_store_take_of(&t, self->call->show, &takes[i], &problem) < 0)
            note(self, &problem);
        take_finish(&t);
    }
    free(takes);
    facts_number(self->call->told, "takes", "takes", (double)count, 0, "");
    return MRT_OK;
}

static mrt_result check_sound(checking *self, int64_t id, error *err)
{
    show_audio of;
    error problem = {""};
    void *piece = malloc(PIECE_BYTES);
    if (!piece)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = show_audio_info(self->call->show, id, &of, &problem);
    for (int64_t frame = 0; result >= 0 && frame < of.frame_count;) {
        size_t size = 0;
        size_t width = of.channel_count * (of.format[1] == '1'   ? 2u
                                           : of.format[1] == '2' ? 3u
                                                                 : 4u);
        result = show_audio_read(self->call->show, id, frame, piece, PIECE_BYTES, &size, &problem);
        if (result < 0 || size < width || width == 0)
            break;
        frame += (int64_t)(size / width);
    }
    if (result < 0)
        note(self, &problem);
    free(piece);
    return MRT_OK;
}

/* Checks each item of a list, and reports their number. */
static mrt_result
check_all(checking *self, mrt_result (*list)(show *s, int64_t **out, size_t *out_count, error *err),
          mrt_result (*check)(checking *self, int64_t id, error *err), const char *name, error *err)
{
    int64_t *ids;
    size_t count;
    mrt_result result = list(self->call->show, &ids, &count, err);
    if (result < 0)
        return result;
    progress_start(&self->call->shown, "reading");
    for (size_t i = 0; i < count && result >= 0 && !cancel_is_requested(); ++i) {
        progress_show(&self->call->shown, (double)i / (double)count, "");
        result = check(self, ids[i], err);
    }
    progress_end(&self->call->shown);
    free(ids);
    facts_number(self->call->told, name, name, (double)count, 0, "");
    return result;
}

/* Checks each face once, also if many performances in a row have it. */
static mrt_result check_packed(void *data, const take_performance *p, error *err)
{
    checking *self = data;
    char path[PATH_MAX];
    if (strcmp(self->mesh, p->mesh_hash) == 0 && strcmp(self->rig, p->rig_hash) == 0)
        return MRT_OK;
    (void)snprintf(self->mesh, sizeof self->mesh, "%s", p->mesh_hash);
    (void)snprintf(self->rig, sizeof self->rig, "%s", p->rig_hash);
    mrt_result result = pack_find(path, self->call->word[0], p, err);
    self->packed_count += result == MRT_OK;
    if (result < 0)
        note(self, err);
    return MRT_OK;
}

/* Checks the packed faces. A performance that cannot be read was already reported. */
static void check_pack(checking *self)
{
    error ignored;
    (void)!for_performances(self->call->show, check_packed, self, &ignored);
    if (self->packed_count)
        facts_number(self->call->told, "packed_faces", "packed faces", self->packed_count, 0, "");
}

static mrt_result run_check(take_call *call, error *err)
{
    checking self = {.call = call};
    mrt_result result = check_all(&self, show_track_ids, check_track, "tracks", err);
    if (result >= 0) {
        facts_number(call->told, "samples", "samples", (double)self.sample_count, 0, "");
        result = check_all(&self, show_performance_ids, check_performance, "performances", err);
    }
    if (result >= 0)
        result = check_takes(&self, err);
    if (result >= 0)
        result = check_all(&self, show_audio_ids, check_sound, "sounds", err);
    if (result >= 0)
        check_pack(&self);
    if (result >= 0)
        result = cancel_check(err);
    if (result < 0)
        return result;
    error whole = {""};
    if (self.problem_count == 0 && show_check(call->show, &whole) < 0)
        note(&self, &whole);
    facts_number(call->told, "problem_count", "damaged places", self.problem_count, 0, "");
    if (self.problem_count == 0)
        return MRT_OK;
    char quoted[1024];
    program_quote(quoted, sizeof quoted, call->word[0]);
    call->is_told = true;
    return error_set(err, MRT_ERR_FORMAT,
                     "%s is damaged in %u places: marotte take recover %s --out NEW.marotte saves "
                     "the rest",
                     call->word[0], self.problem_count, quoted[0] ? quoted : "SHOW");
}

/* ---- table of subcommands ---- */

static const take_verb file_verbs[] = {
    {"list", "SHOW", "", "list the takes of a show", "", TAKE_READS, .run = run_list,
     .examples = "take list show.marotte\ntake list show.marotte --json\n"},
    {"show", "SHOW TAKE",
     "  --hash         print a SHA-256 over all vertices of all frames\n"
     "  --fps RATE     the frame rate for --hash (the take's, or 30)\n"
     "  --in T, --out T   a range for --hash\n"
     "  --face FILE    perform on this face (the face of the recording)\n",
     "print the layers, clips, inputs and edits of a take", "hash fps face in out", TAKE_READS,
     .run = run_show,
     .examples = "take show show.marotte last\n"
                 "take show show.marotte last --hash --fps 25 --in 1 --out 2\n"},
    {"keep", "SHOW",
     "  --last S       its length in seconds (30)\n  --scene S, --shot S   its slate\n",
     "make a take of the newest seconds", "last scene shot", TAKE_WRITES, .run = run_keep,
     .examples = "take keep show.marotte\ntake keep show.marotte --last 2 --scene 12 --shot a\n"},
    {"check", "SHOW", "Exit code 1: the show is damaged.\n",
     "read everything in a show and report damage", "", TAKE_READS, .run = run_check,
     .examples = "take check show.marotte\ntake check show.marotte --json\n"},
    {"pack", "SHOW",
     "Copies the files of its faces (rigs, meshes, pictures) into the folder NAME.pack beside\n"
     "NAME.marotte. Move the two together to another computer: takes perform the same there.\n"
     "Sounds, calibrations and mapping settings are in the show already.\n",
     "copy the faces of a show into a folder beside it", "", TAKE_READS, .run = run_pack,
     .examples = "take pack show.marotte\ntake pack show.marotte --json\n"},
    {"recover", "SHOW", "  --out NEW      the new show; it must not exist. SHOW is not changed\n",
     "copy all readable parts of a damaged show", "out", TAKE_OPENS_ITSELF, .run = run_recover,
     .examples = "take recover show.marotte --out out/recovered.marotte\n"
                 "take recover show.marotte --out rescued.marotte --json\n"},
};
const take_verbs take_file_verbs = {"The show", file_verbs,
                                    sizeof file_verbs / sizeof file_verbs[0]};
