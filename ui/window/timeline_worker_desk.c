#include "window/timeline_worker_state.h"

#include "stage/take/kept_solver.h"
#include "take/edit_store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is read ---- */

static void note(worker_desk *self, const error *err)
{
    (void)snprintf(self->note, sizeof self->note, "%.255s", err->text);
}

static void open_face(worker_desk *self, const char *path)
{
    error err = {""};
    if (!path || face_file_read(&self->face, path, MESH_UNIT_AUTO, FACE_FILE_USABLE, &err) < 0) {
        note(self, &err);
        return;
    }
    self->has_face = true;
    const csrbf_settings solver = kept_solver_for(self->show, &self->face, NULL);
    if (composer_create(&self->scratch, &self->face, &solver, &err) < 0)
        note(self, &err);
}

void worker_desk_open(worker_desk *self, const char *show_path, const char *face_path)
{
    error err = {""};
    self->note[0] = '\0';
    if (!show_path)
        return;
    if (show_open(&self->show, show_path, SHOW_READ, &err) < 0) {
        self->show = NULL;
        note(self, &err);
        return;
    }
    open_face(self, face_path);
    self->world = (source_world){
        .show = self->show, .plugins = self->plugins, .log = self->log, .scratch = self->scratch};
}

static void drop_news(worker_desk *self)
{
    log_record record;
    while (log_pop(self->log, &record))
        continue;
}

void worker_desk_close(worker_desk *self)
{
    for (uint32_t i = 0; i < self->curve_count; ++i)
        activity_destroy(self->curve[i].curve);
    waveform_destroy(self->wave);
    composer_destroy(self->scratch);
    if (self->has_face)
        face_file_destroy(&self->face);
    show_close(self->show);
    *self = (worker_desk){.plugins = self->plugins, .log = self->log};
}

/* ---- curves ---- */

static worker_curve *place_for_curve(worker_desk *self)
{
    if (self->curve_count < WORKER_CURVES_MAX)
        return &self->curve[self->curve_count++];
    worker_curve *oldest = self->curve;
    for (uint32_t i = 1; i < self->curve_count; ++i)
        if (self->curve[i].used < oldest->used)
            oldest = &self->curve[i];
    activity_destroy(oldest->curve);
    return oldest;
}

static void begin_curve(worker_desk *self, worker_curve *out, int64_t performance)
{
    error err = {""};
    show_performance about;
    *out = (worker_curve){.performance = performance, .is_done = true};
    if (show_performance_read(self->show, performance, &about, &err) < 0) {
        note(self, &err);
        return;
    }
    out->from_ns = about.from_ns;
    show_performance_finish(&about);
    if (!self->scratch)
        return;
    if (activity_create(&out->curve, &self->world, performance, &err) < 0) {
        out->curve = NULL;
        note(self, &err);
    }
    out->is_done = out->curve == NULL;
}

static worker_curve *curve_of(worker_desk *self, int64_t performance)
{
    worker_curve *curve = NULL;
    for (uint32_t i = 0; i < self->curve_count && !curve; ++i)
        if (self->curve[i].performance == performance)
            curve = &self->curve[i];
    if (!curve) {
        curve = place_for_curve(self);
        begin_curve(self, curve, performance);
    }
    curve->used = ++self->uses;
    return curve;
}

static bool step_curve(worker_desk *self, worker_curve *curve)
{
    error err = {""};
    if (!curve->curve)
        return false;
    mrt_result result = activity_step(curve->curve, WORKER_SAMPLES, &err);
    drop_news(self);
    if (result < 0)
        note(self, &err);
    curve->is_done = result != MRT_OK;
    return !curve->is_done;
}

/* The first that is not done; those that are may go on as their recording does. */
static bool step_curves(worker_desk *self, const timeline_wish *wish)
{
    for (uint32_t i = 0; i < wish->strip_count; ++i) {
        worker_curve *curve = curve_of(self, wish->strip[i].performance);
        if (!curve->is_done && step_curve(self, curve))
            return true;
    }
    for (uint32_t i = 0; i < self->curve_count; ++i)
        self->curve[i].is_done = self->curve[i].curve == NULL;
    return false;
}

/* ---- the sound ---- */

static void begin_wave(worker_desk *self, int64_t audio)
{
    error err = {""};
    waveform_destroy(self->wave);
    self->wave = NULL;
    self->wave_of = audio;
    self->is_wave_done = false;
    self->about = (show_audio){0};
    if (!audio)
        return;
    if (show_audio_info(self->show, audio, &self->about, &err) < 0 ||
        waveform_create(&self->wave, self->show, audio, &err) < 0) {
        self->wave = NULL;
        note(self, &err);
    }
}

static bool step_wave(worker_desk *self)
{
    error err = {""};
    if (!self->wave)
        return false;
    mrt_result result = waveform_step(self->wave, self->show, WORKER_FRAMES, &err);
    if (result < 0)
        note(self, &err);
    return result != MRT_END;
}

int64_t worker_desk_known(const worker_desk *self)
{
    int64_t known = self->wave ? waveform_known_frames(self->wave) : 0;
    for (uint32_t i = 0; i < self->curve_count; ++i)
        known += self->curve[i].curve ? activity_known_ns(self->curve[i].curve) : 0;
    return known + self->curve_count;
}

/* ---- when takes were made ---- */

static void read_spans(worker_desk *self, uint64_t edition)
{
    error err = {""};
    show_take *takes;
    size_t count;
    self->spans_edition = edition;
    if (show_takes(self->show, &takes, &count, &err) < 0) {
        note(self, &err);
        return;
    }
    self->span_count = 0;
    for (size_t i = count; i-- > 0 && self->span_count < TIMELINE_SPANS_MAX;)
        self->span[self->span_count++] =
            (timeline_span){takes[i].id, takes[i].start_ns, takes[i].end_ns};
    free(takes);
}

bool worker_desk_step(worker_desk *self, const timeline_wish *wish)
{
    if (!self->show)
        return false;
    if (wish->audio != self->wave_of)
        begin_wave(self, wish->audio);
    if (wish->spans_edition && wish->spans_edition != self->spans_edition)
        read_spans(self, wish->spans_edition);
    bool has_more = step_wave(self);
    return step_curves(self, wish) || has_more;
}

/* ---- what is given ---- */

static void read_strip(const worker_curve *curve, const timeline_strip *strip, activity_bin *out,
                       activity_bin *scratch)
{
    bool is_first = true;
    for (uint32_t lane = 0; lane < ACTIVITY_LANES; ++lane) {
        if (!(strip->lanes & 1u << lane))
            continue;
        activity_bin *into = is_first ? out : scratch;
        activity_read(curve->curve, lane, strip->from_ns - curve->from_ns,
                      strip->to_ns - curve->from_ns, strip->bin_count, into);
        for (uint32_t i = 0; !is_first && i < strip->bin_count; ++i) {
            out[i].least = scratch[i].least > out[i].least ? scratch[i].least : out[i].least;
            out[i].greatest =
                scratch[i].greatest > out[i].greatest ? scratch[i].greatest : out[i].greatest;
        }
        is_first = false;
    }
}

static void fill_strips(worker_desk *self, const timeline_wish *wish, timeline_seen *out)
{
    activity_bin *scratch = calloc(wish->bin_count + (size_t)1, sizeof *scratch);
    out->strip_count = wish->strip_count;
    memcpy(out->strip, wish->strip, wish->strip_count * sizeof *wish->strip);
    for (uint32_t i = 0; i < wish->bin_count; ++i)
        out->bin[i] = (activity_bin){1.0f, 0.0f};
    for (uint32_t i = 0; scratch && self->show && i < wish->strip_count; ++i) {
        const timeline_strip *strip = &wish->strip[i];
        const worker_curve *curve = curve_of(self, strip->performance);
        if (curve->curve)
            read_strip(curve, strip, out->bin + strip->first_bin, scratch);
    }
    free(scratch);
}

static void fill_wave(worker_desk *self, const timeline_wish *wish, timeline_seen *out)
{
    error err = {""};
    out->audio = self->wave_of;
    out->about = self->about;
    out->has_wave = self->wave && wish->audio == self->wave_of && wish->audio_pairs > 0 &&
                    wish->audio_from < wish->audio_to &&
                    waveform_read(self->wave, self->show, wish->audio_from, wish->audio_to,
                                  wish->audio_pairs, &out->wave, &err) >= 0;
    if (err.text[0])
        note(self, &err);
}

void worker_desk_fill(worker_desk *self, const timeline_wish *wish, timeline_seen *out)
{
    fill_strips(self, wish, out);
    fill_wave(self, wish, out);
    out->span_count = self->span_count;
    memcpy(out->span, self->span, self->span_count * sizeof *self->span);
    memcpy(out->note, self->note, sizeof out->note);
}

/* ---- other takes ---- */

static bool is_of_slate(const take *t, const timeline_wish *wish)
{
    return !t->is_deleted && !t->is_recording && t->layer_count > 0 &&
           strcmp(t->scene, wish->scene) == 0 && strcmp(t->shot, wish->shot) == 0;
}

static void look_at(worker_desk *self, const show_take *of, const timeline_wish *wish,
                    timeline_comps *out)
{
    error err = {""};
    take *t = &out->take[out->count];
    bool may_be = of->edit_count > 0 || of->base_edit_count > 0 ||
                  (strcmp(of->scene, wish->scene) == 0 && strcmp(of->shot, wish->shot) == 0);
    if (of->id == wish->comps_of || !may_be || of->is_recording)
        return;
    if (edit_store_take(t, self->show, of->id, &err) < 0 && t->id == 0)
        return;
    if (is_of_slate(t, wish))
        out->count += 1;
    else
        take_finish(t);
}

timeline_comps *worker_desk_comps(worker_desk *self, const timeline_wish *wish)
{
    error err = {""};
    show_take *takes;
    size_t count;
    if (!self->show ||
        (wish->comps_of == self->comps_of && wish->comps_edition == self->comps_edition))
        return NULL;
    self->comps_of = wish->comps_of;
    self->comps_edition = wish->comps_edition;
    timeline_comps *out = calloc(1, sizeof *out);
    if (!out || !wish->comps_of || show_takes(self->show, &takes, &count, &err) < 0)
        return out;
    out->of = wish->comps_of;
    for (size_t i = count; i-- > 0 && out->count < TIMELINE_COMPS_MAX;)
        look_at(self, &takes[i], wish, out);
    free(takes);
    return out;
}
