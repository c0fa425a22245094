/* marotte take show: what a take is made of. */
#include "take/edit_store.h"
#include "base/clock.h"
#include "take/hash.h"
#include "take_play.h"
#include "take_stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static void tell_clip(take_call *call, const take_layer *l, const take_clip *c)
{
    char label[24], line[256];
    (void)snprintf(label, sizeof label, "  clip %u", c->id);
    (void)snprintf(line, sizeof line, "%.3f .. %.3f s, performance %lld%s%s%s%s",
                   seconds(c->start_ns + l->offset_ns), seconds(c->end_ns + l->offset_ns),
                   (long long)c->performance, c->warp_count > 1 ? ", retimed" : "",
                   c->smooth_s > 0.0 ? ", smoothed" : "", c->is_muted ? ", muted" : "",
                   c->gain < 1.0 || c->gain > 1.0 ? ", with a gain" : "");
    const facts_cell cells[] = {{"id", NULL, c->id, 0},
                                {"layer", NULL, l->id, 0},
                                {"start_s", NULL, seconds(c->start_ns + l->offset_ns), 9},
                                {"end_s", NULL, seconds(c->end_ns + l->offset_ns), 9},
                                {"performance", NULL, (double)c->performance, 0},
                                {"points", NULL, c->warp_count, 0},
                                {"fade_in_s", NULL, seconds(c->fade_in_ns), 9},
                                {"fade_out_s", NULL, seconds(c->fade_out_ns), 9},
                                {"gain", NULL, c->gain, 9},
                                {"smooth_s", NULL, c->smooth_s, 9},
                                {"muted", NULL, c->is_muted, -1}};
    facts_row(call->told, "clips", label, line, cells, sizeof cells / sizeof cells[0]);
}

static void tell_layer(take_call *call, const take_layer *l)
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
        tell_clip(call, l, &l->clip[i]);
}

/* ---- performances and tracks ---- */

static mrt_result tell_track(take_call *call, int64_t id, error *err)
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

static mrt_result tell_performance(take_call *call, int64_t id, error *err)
{
    show_performance of;
    char label[32], line[512], again[64] = "";
    mrt_result result = show_performance_read(call->show, id, &of, err);
    if (result < 0)
        return result;
    const take_performance *p = &of.performance;
    if (p->again.of)
        (void)snprintf(again, sizeof again, ", %lld anew", (long long)p->again.of);
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
        result = tell_track(call, p->track[i], err);
    show_performance_finish(&of);
    return result;
}

static mrt_result tell_performances(take_call *call, const take *t, error *err)
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
            mrt_result result = tell_performance(call, id, err);
            if (result < 0)
                return result;
        }
    return MRT_OK;
}

/* ---- edits, events ---- */

static mrt_result tell_edits(take_call *call, int64_t id, error *err)
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

static mrt_result tell_events(take_call *call, const take *t, error *err)
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

static void tell_take(take_call *call, const take *t)
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
    }
    for (uint32_t i = 0; i < t->layer_count; ++i)
        tell_layer(call, &t->layer[i]);
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
} vertex_sum;

static mrt_result add_frame(void *data, take_stage *from, error *err)
{
    (void)err;
    vertex_sum *self = data;
    const face *f = performer_face(sequencer_performer(from->sequencer));
    points_to_rows(self->rows, face_shown(f), face_order(f));
    hash_add(self->sum, self->rows, (size_t)from->face.mesh.vertex_count * 3 * sizeof(float));
    return MRT_OK;
}

static mrt_result tell_hash(take_call *call, error *err)
{
    take_stage stage;
    take_frames frames;
    char sum[TAKE_HASH];
    vertex_sum self = {hash_begin(), NULL};
    mrt_result result = take_stage_open(&stage, call, call->word[1], call->text[TAKE_FACE], err);
    if (result >= 0)
        result = take_frames_of(&frames, call, &stage.take, err);
    if (result >= 0) {
        self.rows = malloc((size_t)stage.face.mesh.vertex_count * 3 * sizeof(float));
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

mrt_result take_show_run(take_call *call, error *err)
{
    take t;
    mrt_result result = take_read(call, call->word[1], &t, err);
    if (result < 0)
        return result;
    tell_take(call, &t);
    result = tell_performances(call, &t, err);
    error problem = {""};
    if (result >= 0 && tell_edits(call, t.id, &problem) < 0)
        facts_list(call->told, "problems", "problem", problem.text);
    if (result >= 0)
        result = tell_events(call, &t, err);
    take_finish(&t);
    return result < 0 || !call->text[TAKE_HASH_OPTION] ? result : tell_hash(call, err);
}
