/* marotte take remap: the tracks of a take through another mapping, calibration, filter, or onto
 * another face, as a new take. */
#include "base/text.h"
#include "base/clock.h"
#include "hand/calibration_file.h"
#include "news.h"
#include "perform_mapping.h"
#include "stage/input/spec.h"
#include "stage/take/identity.h"
#include "take/edit_store.h"
#include "take_play.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PERFORMANCES_MAX = 256 };

typedef struct remap {
    take_call *call;
    take old;
    show_take made; /* how the old one was made */
    log_queue *log;
    plugin_list plugins;
    plugin_spec map;         /* of --map */
    perform_mapping mapping; /* of it; in a process of its own, or not */
    face_file face;          /* of --face */
    char *calibration[2];
    double hand_length_mm; /* 0: as it was */
    take_again filter;     /* the filter's part of it */
    int64_t then[PERFORMANCES_MAX], now[PERFORMANCES_MAX];
    uint32_t count;
    show_edits edits;
    char **json; /* of the new take: the old one's, then others */
    size_t json_count;
    show_span *span;
    size_t span_count;
} remap;

/* ---- what is to be different ---- */

static mrt_result read_map(remap *self, error *err)
{
    const char *text = self->call->text[TAKE_MAP];
    const perform_mapping_settings apart = {&self->plugins, self->log, CLOCK_VIRTUAL,
                                            PERFORM_ISOLATE_AUTO};
    if (!text)
        return MRT_OK;
    if (!spec_read(&self->map, text) || self->map.address[0])
        return take_misused(self->call, err, "--map \"%s\" is not PLUGIN[,key=value]", text);
    return perform_mapping_open(&self->mapping, &self->map, &apart, err);
}

static mrt_result read_calibrations(remap *self, error *err)
{
    mrt_result result = MRT_OK;
    calibration_file *file = malloc(sizeof *file);
    if (!file)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    for (uint32_t i = 0; i < self->call->calibration_count && result >= 0; ++i) {
        result = calibration_file_read(file, self->call->calibration[i], err);
        if (result < 0)
            break;
        free(self->calibration[file->side]);
        self->calibration[file->side] = calibration_file_text(file);
        if (!self->calibration[file->side])
            result = error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
        calibration_file_finish(file);
    }
    free(file);
    return result;
}

/* "min_cutoff=1,beta=0.02" */
static mrt_result read_filter(remap *self, error *err)
{
    const char *text = self->call->text[TAKE_FILTER];
    text_view rest = text_view_of(text, text ? strlen(text) : 0), field, key;
    while (text && text_next_field(&rest, ',', &field)) {
        double value = -1.0;
        bool has_key = text_next_field(&field, '=', &key);
        bool is_number = has_key && text_double(text_trim(field), &value);
        if (is_number && text_equals(key, "min_cutoff") && value >= 0.001 && value <= 1000.0) {
            self->filter.min_cutoff_hz = value;
        } else if (is_number && text_equals(key, "beta") && value >= 0.0 && value <= 100.0) {
            self->filter.has_beta = true;
            self->filter.beta = value;
        } else {
            return take_misused(self->call, err,
                                "--filter \"%s\" is not min_cutoff=HZ (0.001 to 1000), beta=N (0 "
                                "to 100), or both with a comma",
                                text);
        }
    }
    return MRT_OK;
}

static mrt_result read_wishes(remap *self, error *err)
{
    const take_call *call = self->call;
    if (!call->text[TAKE_MAP] && !call->text[TAKE_FACE] && !call->text[TAKE_FILTER] &&
        !call->text[TAKE_HAND_LENGTH] && call->calibration_count == 0)
        return take_misused(self->call, err,
                            "say what is to be different: --map, --face, --calibration, "
                            "--hand-length or --filter");
    mrt_result result = read_filter(self, err);
    if (result >= 0)
        result = take_number(self->call, TAKE_HAND_LENGTH, 50, 400, &self->hand_length_mm, err);
    if (result >= 0)
        result = plugin_list_load(&self->plugins, err);
    if (result >= 0)
        result = read_map(self, err);
    if (result >= 0)
        result = read_calibrations(self, err);
    if (result >= 0 && call->text[TAKE_FACE])
        result = face_file_read(&self->face, call->text[TAKE_FACE], MESH_UNIT_AUTO,
                                FACE_FILE_USABLE, err);
    return result;
}

/* ---- the performances ---- */

static mrt_result describe(remap *self, take_performance *p, error *err)
{
    mrt_result result = MRT_OK;
    p->again.of = p->id;
    const instance *mapping = &self->mapping.instance;
    if (mapping->type) {
        free(p->mapping);
        p->mapping = identity_of_plugin(&self->plugins, mapping->type);
        if (!p->mapping)
            return error_set(err, MRT_ERR_MEMORY, "no memory for a performance");
        identity_of_params(p, mapping);
        p->again.ignores_params = true;
    }
    if (self->face.mesh.vertex_count > 0)
        result = identity_of_face(p, &self->face, self->call->text[TAKE_FACE], 0.0, err);
    for (int side = 0; side < 2 && result >= 0; ++side) {
        if (!self->calibration[side])
            continue;
        free(p->again.calibration[side]);
        p->again.calibration[side] = strdup(self->calibration[side]);
        if (!p->again.calibration[side])
            result = error_set(err, MRT_ERR_MEMORY, "no memory for a performance");
    }
    if (self->hand_length_mm > 0.0)
        p->hand_length_mm = self->hand_length_mm;
    if (self->filter.min_cutoff_hz > 0.0)
        p->again.min_cutoff_hz = self->filter.min_cutoff_hz;
    if (self->filter.has_beta) {
        p->again.has_beta = true;
        p->again.beta = self->filter.beta;
    }
    return result;
}

static mrt_result perform_anew(remap *self, int64_t performance, error *err)
{
    show_performance of;
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->then[i] == performance)
            return MRT_OK;
    if (self->count == PERFORMANCES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "take %lld shows more than %d performances",
                         (long long)self->old.id, PERFORMANCES_MAX);
    mrt_result result = show_performance_read(self->call->show, performance, &of, err);
    if (result < 0)
        return result;
    result = describe(self, &of.performance, err);
    if (result >= 0)
        result = show_performance_create(self->call->show, &of.performance, err);
    if (result >= 0) {
        self->then[self->count] = performance;
        self->now[self->count++] = of.performance.id;
    }
    show_performance_finish(&of);
    return result;
}

/* ---- the take ---- */

/* The old one's edits say what its clips are; the new one's slate and place are its own. */
static bool is_copied(const char *json)
{
    edit e;
    error ignored = {""};
    if (edit_parse(&e, json, strlen(json), &ignored) < 0)
        return true;
    bool is_own =
        e.kind == EDIT_TAKE_SLATE || e.kind == EDIT_TAKE_DELETE || e.kind == EDIT_TAKE_RESTORE;
    edit_finish(&e);
    return !is_own;
}

static mrt_result perform_clip(remap *self, const take_clip *c, error *err)
{
    edit e;
    mrt_result result = perform_anew(self, c->performance, err);
    if (result < 0)
        return result;
    edit_init(&e, EDIT_CLIP_PERFORM);
    e.clip = c->id;
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->then[i] == c->performance)
            e.performance = self->now[i];
    result = edit_write(&self->json[self->json_count], &e, err);
    self->json_count += result >= 0;
    self->span[self->span_count++] =
        (show_span){.performance = e.performance, .from_ns = c->from_ns, .to_ns = c->to_ns};
    return result;
}

static mrt_result gather(remap *self, error *err)
{
    show_span *spans;
    size_t clip_count = 0, old_count;
    show *s = self->call->show;
    for (uint32_t i = 0; i < self->old.layer_count; ++i)
        clip_count += self->old.layer[i].clip_count;
    if (clip_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld is empty: it shows no performance",
                         (long long)self->old.id);
    mrt_result result = show_edits_of(s, &self->made, &self->edits, err);
    if (result >= 0)
        result = show_take_spans(s, self->old.id, &spans, &old_count, err);
    if (result < 0)
        return result;
    self->json = calloc(self->edits.count + clip_count, sizeof *self->json);
    self->span = calloc(old_count + clip_count, sizeof *self->span);
    if (!self->json || !self->span) {
        free(spans);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    }
    memcpy(self->span, spans, old_count * sizeof *spans);
    self->span_count = old_count;
    free(spans);
    for (size_t i = 0; i < self->edits.count; ++i) {
        show_edit *of = &self->edits.edit[i];
        if (of->n > self->edits.head || !is_copied(of->json))
            continue;
        self->json[self->json_count++] = of->json;
        of->json = NULL;
    }
    for (uint32_t i = 0; i < self->old.layer_count && result >= 0; ++i)
        for (uint32_t k = 0; k < self->old.layer[i].clip_count && result >= 0; ++k)
            result = perform_clip(self, &self->old.layer[i].clip[k], err);
    return result;
}

static mrt_result make_take(remap *self, int64_t *out_id, error *err)
{
    const take_call *call = self->call;
    char origin[96];
    const instance *mapping = &self->mapping.instance;
    (void)snprintf(origin, sizeof origin, "take %lld through %.60s", (long long)self->old.id,
                   mapping->type ? mapping->type->id : "its own mapping, anew");
    const show_new_take made = {
        .created_ns = clock_utc_ms() * 1000000,
        .start_ns = self->made.start_ns,
        .end_ns = self->made.end_ns,
        .scene = call->text[TAKE_SCENE] ? call->text[TAKE_SCENE] : self->old.scene,
        .shot = call->text[TAKE_SHOT] ? call->text[TAKE_SHOT] : self->old.shot,
        .origin = origin,
        .spans = self->span,
        .span_count = self->span_count,
        .base_edits = (const char *const *)self->json,
        .base_edit_count = self->json_count,
        .utc_ms = clock_utc_ms()};
    return show_take_create(call->show, &made, out_id, err);
}

static void finish(remap *self)
{
    for (size_t i = 0; i < self->json_count; ++i)
        free(self->json[i]);
    free(self->json);
    free(self->span);
    show_edits_finish(&self->edits);
    free(self->calibration[0]);
    free(self->calibration[1]);
    face_file_destroy(&self->face);
    perform_mapping_close(&self->mapping);
    spec_finish(&self->map);
    plugin_list_destroy(&self->plugins);
    if (self->log)
        news_print(self->log);
    log_queue_destroy(self->log);
    take_finish(&self->old);
}

static mrt_result tell(remap *self, int64_t id, error *err)
{
    take now;
    char a[24], b[24];
    take_call *call = self->call;
    mrt_result result = edit_store_take(&now, call->show, id, err);
    if (result < 0)
        return result;
    facts_text(call->told, "take", "take", take_slate_text(now.scene, now.shot, now.number).text);
    facts_number(call->told, "take_id", "take id", (double)id, 0, "");
    facts_text(call->told, "origin", "origin", now.origin);
    facts_number(call->told, "performances", "performed anew", self->count, 0, "");
    take_finish(&now);
    (void)snprintf(a, sizeof a, "%lld", (long long)self->old.id);
    (void)snprintf(b, sizeof b, "%lld", (long long)id);
    call->text[TAKE_FACE] = NULL; /* each on its own */
    error why = {""};
    if (take_diff_tell(call, a, b, &why) < 0)
        fprintf(stderr, "note: the two are not compared: %s\n", why.text);
    return MRT_OK;
}

mrt_result take_remap_run(take_call *call, error *err)
{
    int64_t id = 0;
    remap *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    self->call = call;
    self->log = log_queue_create();
    mrt_result result =
        self->log ? read_wishes(self, err) : error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = take_read(call, call->word[1], &self->old, err);
    if (result >= 0)
        result = show_take_read(call->show, self->old.id, &self->made, err);
    if (result >= 0)
        result = gather(self, err);
    if (result >= 0)
        result = make_take(self, &id, err);
    if (result >= 0)
        result = tell(self, id, err);
    finish(self);
    free(self);
    return result;
}
