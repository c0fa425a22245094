#include "cli/take.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/installed.h"
#include "base/text.h"
#include "cli/terminal.h"
#include "show/edit_store.h"
#include "show/hash.h"
#include "show/own.h"
#include "show/pack.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RIG_BYTES_MAX = 16 << 20 };

/* ---- the face of a performance ---- */

static mrt_result hash_rig(char out[TAKE_HASH], const char *path, error *err)
{
    file_bytes text;
    mrt_result result = file_read(&text, path, RIG_BYTES_MAX, err);
    if (result < 0)
        return result;
    hash_bytes(out, text.data, text.size);
    file_bytes_finish(&text);
    return MRT_OK;
}

static json_t *pose_named(json_t *poses, const char *name)
{
    for (size_t i = 0; name && i < json_array_size(poses); ++i) {
        json_t *one = json_array_get(poses, i);
        const char *is = json_string_value(json_object_get(one, "name"));
        if (is && strcmp(is, name) == 0)
            return one;
    }
    return NULL;
}

/* Returns whether the current rig performs like the recorded one. Additional poses do not matter.
 * Changed poses matter only if a patch moved the face by them. */
static bool performs_as_then(const char *then, const char *path, bool has_patch)
{
    json_error_t ignored;
    json_t *was = json_loads(then, 0, &ignored), *is = json_load_file(path, 0, &ignored);
    json_t *old = json_incref(json_object_get(was, "poses"));
    json_t *now = json_incref(json_object_get(is, "poses"));
    (void)json_object_del(was, "poses");
    (void)json_object_del(is, "poses");
    bool is_same = was && is && json_equal(was, is);
    for (size_t i = 0; is_same && has_patch && i < json_array_size(old); ++i) {
        json_t *pose = json_array_get(old, i);
        const char *name = json_string_value(json_object_get(pose, "name"));
        is_same = json_equal(pose, pose_named(now, name));
    }
    json_decref(old);
    json_decref(now);
    json_decref(was);
    json_decref(is);
    return is_same;
}

/* Compares the hashes of the performance with the files. out_change: the file that differs. */
static mrt_result compare(const char *path, const take_performance *p, const rig *r,
                          error *out_change, error *err)
{
    char now[TAKE_HASH] = "";
    mrt_result result = MRT_OK;
    const char *mesh_path = r ? r->mesh_path : path;
    out_change->text[0] = '\0';
    if (r)
        result = hash_rig(now, path, err);
    if (result >= 0 && strcmp(now, p->rig_hash) != 0 &&
        !(p->rig_json && performs_as_then(p->rig_json, path, p->patch != NULL)))
        (void)error_set(out_change, MRT_OK, "%s", path);
    if (result >= 0)
        result = hash_file(now, mesh_path, err);
    if (result >= 0 && !out_change->text[0] && strcmp(now, p->mesh_hash) != 0)
        (void)error_set(out_change, MRT_OK, "%s", mesh_path);
    return result;
}

static int64_t first_performance(const take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (own_layer_is_active(t, i) && t->layer[i].clip_count > 0)
            return t->layer[i].clip[0].performance;
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (t->layer[i].clip_count > 0)
            return t->layer[i].clip[0].performance;
    return 0;
}

/* The recorded unit is only valid for the same mesh. */
static mesh_frame frame_for(const char *path, const take_performance *p, const char *other)
{
    char now[TAKE_HASH];
    error ignored = {""};
    bool is_same =
        !other || (hash_file(now, path, &ignored) >= 0 && strcmp(now, p->mesh_hash) == 0);
    return (mesh_frame){.mm_per_unit = is_same ? p->unit_mm : 0.0};
}

mrt_result take_face_read(face_file *out, char **out_path, take_call *call, const take *t,
                          const char *other, error *err)
{
    show_performance of;
    int64_t performance = first_performance(t);
    if (performance == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld is empty: it has no performance",
                         (long long)t->id);
    mrt_result result = show_performance_read(call->show, performance, &of, err);
    if (result < 0)
        return result;
    char packed[PATH_MAX];
    char *kept = installed_kept_face(of.performance.rig);
    const char *path = other ? other : kept;
    error change = {""};
    if (!kept)
        result = error_set(err, MRT_ERR_MEMORY, "no memory");
    else if (!other)
        result = pack_find(packed, show_path(call->show), &of.performance, err);
    if (!other && result == MRT_OK && kept)
        path = packed;
    if (!other && result == MRT_END && access(path, F_OK) != 0)
        result = error_set(err, MRT_ERR_IO,
                           "cannot find the face of take %lld: %s. Use --face FILE. To move a "
                           "show with its faces, use marotte take pack",
                           (long long)t->id, path);
    const mesh_frame frame = frame_for(path, &of.performance, other);
    if (result >= 0)
        result = face_file_read(out, path, &frame, FACE_FILE_USABLE, err);
    if (result >= 0)
        result = compare(path, &of.performance, out->rig, &change, err);
    *out_path = result >= 0 ? strdup(path) : NULL;
    if (result >= 0 && !*out_path)
        result = error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0 && change.text[0])
        fprintf(stderr, "note: %s changed since take %lld was recorded. The current file is used\n",
                change.text, (long long)t->id);
    free(kept);
    show_performance_finish(&of);
    return result;
}

/* ---- opening and closing ---- */

mrt_result take_stage_open(take_stage *out, take_call *call, const char *text, const char *other,
                           error *err)
{
    *out = (take_stage){.log = log_queue_create()};
    if (!out->log)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = plugin_list_load(&out->plugins, err);
    if (result >= 0)
        result = take_read(call, text, &out->take, err);
    if (result >= 0)
        result = take_face_read(&out->face, &out->face_path, call, &out->take, other, err);
    if (result < 0)
        return result;
    news_print_notes(out->face.note);
    const sequencer_settings settings = {
        .show = call->show, .plugins = &out->plugins, .log = out->log, .face = &out->face};
    return sequencer_create(&out->sequencer, &settings, &out->take, err);
}

void take_stage_finish(take_stage *self)
{
    sequencer_destroy(self->sequencer);
    face_file_destroy(&self->face);
    free(self->face_path);
    take_finish(&self->take);
    plugin_list_destroy(&self->plugins);
    if (self->log)
        news_print(self->log);
    log_queue_destroy(self->log);
    *self = (take_stage){0};
}

void take_stage_report(take_stage *self)
{
    news_print(self->log);
    news_print_notes(sequencer_note(self->sequencer));
}

/* ---- frames ---- */

enum { PLAYED_S = 600, BYTES_A_SECOND = 200 };

static int64_t first_frame_from(timecode_rate rate, int64_t time_ns)
{
    int64_t frame = timecode_frame(rate, time_ns);
    return timecode_time_ns(rate, frame) < time_ns ? frame + 1 : frame;
}

/* Limits the length of a take: a damaged show of a few rows may claim that a take lasts for days,
 * and its export would fill the disk. */
static mrt_result check_length(const take_call *call, const take *t, error *err)
{
    const double allowed_s =
        PLAYED_S + (double)show_file_size(call->show) / BYTES_A_SECOND; /* recordings are denser */
    const double length_s = (double)t->duration_ns / 1e9;
    if (call->text[TAKE_OUT] || length_s <= allowed_s)
        return MRT_OK;
    return error_set(
        err, MRT_ERR_ARGUMENT,
        "take %lld is %.6g s long, too much for a show of %llu bytes. Limit it with --out",
        (long long)t->id, length_s, (unsigned long long)show_file_size(call->show));
}

/* Reads --frames A-B. */
static mrt_result take_share(take_frames *out, take_call *call, error *err)
{
    const char *text = call->text[TAKE_FRAMES], *dash = text ? strchr(text, '-') : NULL;
    int64_t from, to;
    if (!text)
        return MRT_OK;
    if (!dash || !text_int(text_view_of(text, (size_t)(dash - text)), &from) ||
        !text_int(text_view_of(dash + 1, strlen(dash + 1)), &to) || from < 1 || from > to)
        return take_misused(call, err, "--frames \"%s\" is not FIRST-LAST, from 1, such as 1-250",
                            text);
    if (to > out->count)
        return error_set(err, MRT_ERR_ARGUMENT, "--frames %s: there are only %lld frames", text,
                         (long long)out->count);
    out->first += from - 1;
    out->count = to - from + 1;
    return MRT_OK;
}

/* Reads --in and --out; without them, the whole take. */
static mrt_result read_range(take_call *call, const take *t, int64_t *in_ns, int64_t *out_ns,
                             error *err)
{
    *in_ns = 0;
    *out_ns = t->duration_ns;
    mrt_result result = take_time(call, TAKE_IN, t, in_ns, err);
    if (result >= 0)
        result = take_time(call, TAKE_OUT, t, out_ns, err);
    if (result < 0)
        return result;
    if (t->duration_ns <= 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld is empty: it lasts 0 s",
                         (long long)t->id);
    if (*in_ns >= 0 && *in_ns < *out_ns && *out_ns <= t->duration_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%.9g .. %.9g s is not a range of take %lld, which is %.9g s long",
                     (double)*in_ns / 1e9, (double)*out_ns / 1e9, (long long)t->id,
                     (double)t->duration_ns / 1e9);
}

mrt_result take_frames_of(take_frames *out, take_call *call, const take *t, error *err)
{
    int64_t in_ns, out_ns;
    mrt_result result = take_rate(call, t, &out->rate, err);
    if (result >= 0)
        result = read_range(call, t, &in_ns, &out_ns, err);
    if (result >= 0)
        result = check_length(call, t, err);
    if (result < 0)
        return result;
    out->first = first_frame_from(out->rate, in_ns);
    out->count = first_frame_from(out->rate, out_ns) - out->first;
    if (out->count > 0)
        return take_share(out, call, err);
    return error_set(err, MRT_ERR_ARGUMENT, "no frame of %.6g fps begins within %.9g .. %.9g s",
                     timecode_fps(out->rate), (double)in_ns / 1e9, (double)out_ns / 1e9);
}

mrt_result take_stage_play(take_stage *self, take_call *call, const take_frames *frames,
                           mrt_result (*publish)(void *data, const stage_frame *f, error *err),
                           void *data, error *err)
{
    stage_frame shown = {
        .performer = sequencer_performer(self->sequencer), .self = data, .publish = publish};
    const int64_t begin_ns = timecode_time_ns(frames->rate, frames->first);
    const double total_s =
        (double)(timecode_time_ns(frames->rate, frames->first + frames->count) - begin_ns) / 1e9;
    mrt_result result = MRT_OK;
    progress_start(&call->shown, "performing");
    for (int64_t i = 0; i < frames->count && result >= 0; ++i) {
        int64_t at_ns = timecode_time_ns(frames->rate, frames->first + i);
        if (cancel_is_requested()) {
            result = error_set(err, MRT_ERR_IO, "stopped at frame %lld", (long long)i);
            break;
        }
        result = sequencer_play_to(self->sequencer, at_ns, err);
        if (result >= 0)
            result = frame_draw(&shown, at_ns, err);
        if (result >= 0)
            result = sequencer_check(self->sequencer, err);
        progress_show_time(&call->shown, (double)(at_ns - begin_ns) / 1e9, total_s);
    }
    progress_end(&call->shown);
    take_stage_report(self);
    return result;
}

/* ---- take play: sends a take to outputs in real time ---- */

static const int64_t ahead_ns = 200 * NS_PER_MS;     /* time before the first instant is due */
static const int64_t slice_ns = 100 * NS_PER_MS;     /* maximum delay of the reaction to a signal */
static const int64_t least_apart_ns = 4 * NS_PER_MS; /* minimum interval of shown instants */
/* An instant that is later than late_ns is skipped, unless no face was shown for pause_ns. */
static const int64_t late_ns = 10 * NS_PER_MS, pause_ns = 50 * NS_PER_MS;

typedef struct playing {
    take_call *call;
    take_stage stage;
    perform_outputs outputs;
    int64_t in_ns, out_ns, begun_ns; /* begun_ns: host clock, when in_ns is due */
    int64_t shown_at_ns;             /* take time of the last shown instant */
} playing;

static mrt_result open_outputs(playing *self, error *err)
{
    const perform_mapping_settings with = {&self->stage.plugins, self->stage.log, CLOCK_REAL,
                                           ISOLATE_FOREIGN};
    performer *p = sequencer_performer(self->stage.sequencer);
    return perform_outputs_open(&self->outputs, self->call->output, self->call->output_count, &with,
                                p->composer, &self->stage.face, err);
}

/* Returns whether to show this instant. A slow machine skips instants; the others keep their
 * times. */
static bool is_wanted(const playing *self, int64_t at_ns)
{
    int64_t late_by_ns = clock_now_ns() - (self->begun_ns + (at_ns - self->in_ns));
    return at_ns - self->shown_at_ns >= least_apart_ns &&
           (late_by_ns < late_ns || at_ns - self->shown_at_ns >= pause_ns);
}

/* Shows the current instant of the sequencer when it is due. It is computed before that. */
static void show_when_due(playing *self, int64_t at_ns)
{
    performer *p = sequencer_performer(self->stage.sequencer);
    composer_draw(p->composer);
    int64_t due_ns = self->begun_ns + (at_ns - self->in_ns), now_ns = clock_now_ns();
    for (; now_ns < due_ns && !cancel_is_requested(); now_ns = clock_now_ns())
        clock_sleep_until_ns(due_ns - now_ns > slice_ns ? now_ns + slice_ns : due_ns);
    perform_outputs_show(&self->outputs, p, due_ns, at_ns);
    self->shown_at_ns = at_ns;
    progress_show_time(&self->call->shown, (double)(at_ns - self->in_ns) / 1e9,
                       (double)(self->out_ns - self->in_ns) / 1e9);
    news_print(self->stage.log);
}

static mrt_result play(playing *self, error *err)
{
    sequencer *s = self->stage.sequencer;
    mrt_result result = sequencer_seek(s, self->in_ns, err);
    self->begun_ns = clock_now_ns() + ahead_ns;
    self->shown_at_ns = self->in_ns - pause_ns;
    while (result >= 0 && result != MRT_END && !cancel_is_requested()) {
        int64_t at_ns = sequencer_now_ns(s) > self->in_ns ? sequencer_now_ns(s) : self->in_ns;
        if (at_ns > self->out_ns)
            break;
        if (is_wanted(self, at_ns))
            show_when_due(self, at_ns);
        result = sequencer_step(s, err);
        if (result >= 0 && sequencer_check(s, err) < 0)
            result = MRT_ERR_FORMAT;
    }
    /* Show the last face, because the receivers keep it. */
    if (result == MRT_END && !cancel_is_requested() && sequencer_now_ns(s) > self->shown_at_ns)
        show_when_due(self, sequencer_now_ns(s));
    return result;
}

mrt_result take_play_run(take_call *call, error *err)
{
    playing self = {.call = call};
    mrt_result result = take_need(call, TAKE_OUTPUT, err);
    if (result >= 0)
        result = take_stage_open(&self.stage, call, call->word[1], call->text[TAKE_FACE], err);
    if (result >= 0)
        result = read_range(call, &self.stage.take, &self.in_ns, &self.out_ns, err);
    if (result >= 0)
        result = open_outputs(&self, err);
    if (result >= 0) {
        progress_start(&call->shown, "playing");
        result = play(&self, err);
        progress_end(&call->shown);
        take_stage_report(&self.stage);
        perform_outputs_report(self.outputs.outputs, call->told);
    }
    perform_outputs_close(&self.outputs);
    take_stage_finish(&self.stage);
    return result < 0 ? result : MRT_OK;
}
