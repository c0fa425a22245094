#include "stage/live/live_stage.h"
#include "base/text.h"
#include "base/clock.h"
#include "base/hash.h"
#include "stage/mapping/null_mapping.h"
#include "stage/playback/kept_solver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* [main] The cast: the face, the mapping, and changes of them. */

mrt_result live_check_free(const live *self, const char *what, error *err)
{
    if (!self->status.is_recording)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: not possible while a take is recorded: stop it first", what);
}

/* ---- mappings ---- */

static mrt_result find_type(live_mapping_role *self, const plugin_list *plugins,
                            const mrt_plugin_type **out, const char **out_params, error *err)
{
    size_t length = strcspn(self->text, ",");
    *out_params = self->text[length] == ',' ? self->text + length + 1 : "";
    *out = &null_mapping_type;
    if (length == 0)
        return MRT_OK;
    char *name = text_duplicate(self->text, length);
    if (!name)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a mapping");
    mrt_result result = plugin_list_find(plugins, name, MRT_MAPPING, out, err);
    free(name);
    if (result < 0)
        return result;
    self->library = plugin_list_path_of(plugins, *out);
    if (!isolate_is_wanted(ISOLATE_FOREIGN, self->library))
        return MRT_OK;
    result = isolate_create_mapping(&self->isolate, *out, self->library, &self->isolation, err);
    if (result >= 0)
        *out = isolate_type(self->isolate);
    return result;
}

/* Returns the instance that performs now. Valid until the next call. */
static instance *mapping_now(live_mapping_role *self)
{
    return self->reload ? reload_current(self->reload) : &self->instance;
}

static bool is_null_mapping(const live_mapping_role *self)
{
    return self->instance.type == &null_mapping_type;
}

isolate_counts live_mapping_isolated(live_mapping_role *self)
{
    const instance *now = mapping_now(self);
    return self->isolate && now->self ? isolate_counted(now->self) : (isolate_counts){0};
}

/* Must be deactivated before. Accepts NULL. */
static void destroy_mapping(live_mapping_role *self)
{
    if (!self)
        return;
    reload_stop(self->reload);
    instance_destroy(&self->instance);
    isolate_destroy(self->isolate);
    free(self->text);
    free(self);
}

/* text: "PLUGIN[,key=value]"; NULL or "": the null mapping. The struct does not move in memory. */
static mrt_result create_mapping(live_mapping_role **out, const char *text,
                                 const plugin_list *plugins, log_queue *log, error *err)
{
    const mrt_plugin_type *type = NULL;
    const char *params = "";
    *out = NULL;
    live_mapping_role *self = calloc(1, sizeof *self);
    if (self)
        self->text = strdup(text ? text : "");
    if (!self || !self->text) {
        free(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a mapping");
    }
    self->isolation = (isolate_settings){.clock = CLOCK_REAL, .writes_reports = true};
    mrt_result result = find_type(self, plugins, &type, &params, err);
    if (result >= 0)
        result = instance_create(&self->instance, type, CLOCK_REAL, log, err);
    if (result >= 0)
        result = instance_set_list(&self->instance, params, err);
    if (result < 0) {
        destroy_mapping(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

/* ---- scenes ---- */

void live_scene_destroy(live_scene *scene)
{
    while (scene) {
        live_scene *before = scene->before;
        performer_destroy(scene->performer);
        live_board_destroy(&scene->board);
        face_board_release(scene->outgoing);
        take_performance_finish(&scene->face);
        free(scene->path);
        free(scene);
        scene = before;
    }
}

/* The performer's face owns the binding. Another face copies it. */
static void share_binding(live_scene *scene)
{
    const face *f = composer_face(scene->performer->composer);
    scene->ready = *scene->file;
    if (!scene->ready.bound)
        scene->ready.bound = (binding *)(uintptr_t)face_binding(f);
}

/* Returns the same face file with its computed binding, if it is the current face. */
static const face_file *bound_already(const live *self, const face_file *file)
{
    return self->scene && self->scene->file == file ? &self->scene->ready : file;
}

static csrbf_settings solver_on(const live *self, const face_file *file)
{
    const kept_solver own = {self->has_own_solver, self->own_solver};
    return kept_solver_on(&own, file);
}

static mrt_result create_scene(live *self, const face_file *file, const char *path, double unit_mm,
                               live_mapping_role *role, live_scene **out, error *err)
{
    *out = NULL;
    live_scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    scene->file = file;
    scene->unit_mm = unit_mm;
    scene->solver = solver_on(self, file);
    scene->path = strdup(path ? path : "");
    mrt_result result = scene->path
                            ? recorder_face_identity(&scene->face, file, scene->path, unit_mm, err)
                            : error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    const performer_settings settings = {
        .solver = scene->solver,
        .side_length_mm = {self->hand[MRT_LEFT].length_mm, self->hand[MRT_RIGHT].length_mm},
        .rezero_pedal = self->rezero_pedal,
        .patch = self->patch.count > 0 ? &self->patch : NULL};
    if (result >= 0)
        result = performer_create(&scene->performer, bound_already(self, file), &role->instance,
                                  &settings, err);
    if (result >= 0)
        share_binding(scene);
    if (result >= 0)
        result = live_board_create(&scene->board, scene->performer->composer, err);
    if (result >= 0)
        result = face_board_create(&scene->outgoing, scene->performer->composer, file, err);
    if (result < 0) {
        live_scene_destroy(scene);
        return result;
    }
    *out = scene;
    return MRT_OK;
}

/* ---- settings for the recorder ---- */

static uint32_t list_inputs(live *self, input *inputs[PLAYER_INPUTS_MAX],
                            const char *text[PLAYER_INPUTS_MAX])
{
    inputs[0] = self->pointer;
    text[0] = "pointer";
    for (uint32_t i = 0; i < self->entry_count; ++i) {
        inputs[i + 1] = self->entry[i].input;
        text[i + 1] = self->entry[i].text;
    }
    return self->entry_count + 1;
}

static recorder_settings cast_settings(live *self, const live_scene *scene, live_mapping_role *role,
                                       bool moves_face)
{
    uint32_t count = list_inputs(self, self->cast_input, self->cast_text);
    return (recorder_settings){
        .show = self->show,
        .plugins = self->settings.plugins,
        .log = self->settings.log,
        .clock = CLOCK_REAL,
        .journal_ns = (int64_t)(self->settings.journal_s * 1e9),
        .inputs = self->cast_input,
        .input_text = self->cast_text,
        .input_count = count,
        .calibration = {self->hand[MRT_LEFT].text, self->hand[MRT_RIGHT].text},
        .layer = scene->performer->voice[0].layer,
        .mapping = mapping_now(role),
        .performer = moves_face ? scene->performer : NULL,
        .face_path = scene->path,
        .face = scene->file,
        .unit_mm = scene->unit_mm,
        .rezero_pedal = self->rezero_pedal,
        .patch = self->patch.count > 0 ? &self->patch : NULL,
        .state_bytes = (size_t)4 << 20};
}

recorder_settings live_cast_settings(live *self, bool moves_face)
{
    return cast_settings(self, self->scene, self->role, moves_face);
}

mrt_result live_cast_prepare(live *self, live_change *c, error *err)
{
    if (!self->recorder)
        return MRT_OK;
    const recorder_settings as = cast_settings(self, c->scene ? c->scene : self->scene,
                                               c->role ? c->role : self->role, true);
    return recorder_prepare(self->recorder, &as, &c->cast, err);
}

/* Changes the recorder's cast and performs a step now, so that the performance begins here. */
mrt_result live_cast_begin(live_stage *stage, live_change *c, error *err)
{
    if (c->cast) {
        c->cast = recorder_change(stage->recorder, c->cast);
        const char *rebuilt = stage->reload ? reload_identity(stage->reload) : "";
        if (rebuilt[0])
            recorder_change_mapping(stage->recorder, rebuilt);
    }
    return live_frame_tick(stage, err);
}

void live_cast_dismiss(live *self, live_change *c)
{
    if (self->recorder)
        recorder_dismiss(self->recorder, c->cast);
    c->cast = NULL;
}

mrt_result live_cast_change(live *self, live_command_run *run, live_change *c, error *err)
{
    mrt_result result = live_cast_prepare(self, c, err);
    if (result >= 0)
        result = live_run_command(self, run, c, err);
    live_cast_dismiss(self, c);
    return result;
}

static mrt_result begin_performance(live_stage *stage, void *data, error *err)
{
    return live_cast_begin(stage, data, err);
}

mrt_result live_cast_restart(live *self, error *err)
{
    live_change c = {0};
    return live_cast_change(self, begin_performance, &c, err);
}

/* ---- taught values ---- */

typedef struct taught {
    unsigned char bytes[TAUGHT_BYTES_MAX];
    size_t size;
} taught;

static mrt_result save_taught(live_stage *stage, void *data, error *err)
{
    (void)err;
    taught *out = data;
    out->size = taught_save(stage->scene->performer->voice[0].layer->mapping, out->bytes,
                            sizeof out->bytes);
    return MRT_OK;
}

/* The caller frees it. NULL: no taught values, or out of memory. */
static taught *fetch_taught(live *self)
{
    error ignored = {""};
    taught *out = malloc(sizeof *out);
    if (out && live_run_command(self, save_taught, out, &ignored) >= 0 && out->size > 0)
        return out;
    free(out);
    return NULL;
}

size_t live_taught(live *self, void *bytes, size_t capacity)
{
    taught *t = fetch_taught(self);
    size_t size = t ? t->size : 0;
    if (t)
        memcpy(bytes, t->bytes, size < capacity ? size : capacity);
    free(t);
    return size;
}

/* MRT_HOLD: a crossfade is running; try again later. */
static mrt_result teach_now(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    layer *of = stage->scene->performer->voice[0].layer;
    if (layer_is_fading(of))
        return MRT_HOLD;
    mrt_result result = taught_load(of->mapping, c->taught, c->taught_size, err);
    if (result < 0)
        return result;
    layer_crossfade(of);
    return live_cast_begin(stage, c, err);
}

mrt_result live_teach(live *self, const void *bytes, size_t size, error *err)
{
    mrt_result result = live_check_free(self, "teach the mapping", err);
    if (result >= 0 && self->coming)
        result = error_set(err, MRT_ERR_ARGUMENT, "the mapping is being changed: try again");
    live_change c = {.taught = bytes, .taught_size = size};
    if (result >= 0)
        result = live_cast_prepare(self, &c, err);
    const int64_t until_ns = clock_now_ns() + NS_PER_S; /* a crossfade takes LAYER_FADE_S */
    while (result >= 0 && (result = live_run_command(self, teach_now, &c, err)) == MRT_HOLD) {
        if (clock_now_ns() >= until_ns)
            result = error_set(err, MRT_ERR_ARGUMENT, "the mapping is being changed: try again");
        else
            clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
    live_cast_dismiss(self, &c);
    return result;
}

static void recall_taught(live *self, live_mapping_role *role)
{
    taught_restore(self->show, &role->instance, self->settings.log);
    role->is_of_show = true;
}

/* Copies the taught values to another instance for another face. */
static void teach(live *self, live_mapping_role *role)
{
    error ignored = {""};
    taught *t = fetch_taught(self);
    if (t && taught_load(&role->instance, t->bytes, t->size, &ignored) < 0)
        log_push(self->settings.log, MRT_LOG_WARNING, "stage",
                 "the taught values of the mapping cannot be used on this face");
    free(t);
}

static void note_taught(live *self, const taught *t)
{
    error err = {""};
    self->role->noted_hash = hash_bytes(HASH_START, t->bytes, t->size);
    if (taught_keep(self->show, self->role->instance.type, t->bytes, t->size, &err) < 0)
        log_push(self->settings.log, MRT_LOG_WARNING, "show", err.text);
}

static bool can_note_taught(const live *self)
{
    return self->show && self->scene && self->scene->performer && self->role->is_of_show &&
           plugin_interface(self->role->instance.type, MRT_STATE);
}

void live_cast_keep_taught(live *self)
{
    taught *t = can_note_taught(self) ? fetch_taught(self) : NULL;
    if (t)
        note_taught(self, t);
    free(t);
}

/* A crash loses the values that were taught within this time. An isolated mapping is read only when
 * it is replaced, because the frame thread would wait for its answer. */
static const int64_t note_every_ns = 5 * NS_PER_S;

static void note_changed_taught(live *self)
{
    const int64_t now_ns = clock_now_ns();
    live_mapping_role *role = self->role;
    if (now_ns - role->noted_ns < note_every_ns || role->isolate || !can_note_taught(self))
        return;
    taught *t = fetch_taught(self);
    role->noted_ns = now_ns;
    const uint64_t hash = t ? hash_bytes(HASH_START, t->bytes, t->size) : 0;
    if (t && role->noted_hash == 0)
        role->noted_hash = hash; /* unchanged since the mapping was created */
    else if (t && role->noted_hash != hash)
        note_taught(self, t);
    free(t);
}

/* ---- the patch ---- */

/* MRT_HOLD: the previous change is still running. The tick lets it continue. */
static mrt_result patch_now(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    patch_plan *old;
    if (!patch_bay_set(&stage->scene->performer->voice[0].layer->bay, c->plan, &old)) {
        mrt_result result = live_frame_tick(stage, err);
        return result < 0 ? result : MRT_HOLD;
    }
    c->plan = old;
    return live_cast_begin(stage, c, err);
}

mrt_result live_set_patch(live *self, const patch *p, error *err)
{
    live_change c = {.plan = NULL};
    patch *before = malloc(sizeof *before);
    mrt_result result = before ? live_check_free(self, "the patch", err)
                               : error_set(err, MRT_ERR_MEMORY, "no memory for a patch");
    if (result >= 0 && p->count > 0)
        result = performer_make_patch(self->scene->performer, p, &c.plan, err);
    if (result < 0) {
        free(before);
        return result;
    }
    if (c.plan)
        patch_plan_check_params(c.plan, mapping_now(self->role)->type);
    *before = self->patch;
    self->patch = *p; /* for the new recorder cast */
    result = live_cast_change(self, patch_now, &c, err);
    if (result != MRT_OK)
        self->patch = *before;
    patch_plan_destroy(c.plan);
    free(before);
    return result;
}

const char *live_patch_note(const live *self)
{
    const patch_plan *plan = self->scene->performer->voice[0].layer->bay.plan;
    return plan ? patch_plan_note(plan) : "";
}

/* ---- the mapping ---- */

/* MRT_HOLD: a crossfade is running; try again later. */
static mrt_result switch_mapping(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    layer *of = stage->scene->performer->voice[0].layer;
    if (layer_is_fading(of))
        return MRT_HOLD;
    const face *posed = composer_face(stage->scene->performer->composer);
    c->old =
        layer_replace(of, &c->role->instance, &c->room, face_metered(posed)->driven, c->keeps_clay);
    stage->role = c->role;
    stage->reload = NULL;
    return live_cast_begin(stage, c, err);
}

/* Activates and resets the new mapping. */
static mrt_result activate(live *self, live_mapping_role *role, error *err)
{
    const mrt_mapping *functions = plugin_interface(role->instance.type, MRT_MAPPING);
    const mapped_face *mapped = composer_mapped(self->scene->performer->composer);
    mrt_result result = instance_activate(&role->instance, mapped, err);
    if (result < 0)
        return result;
    functions->reset(role->instance.self);
    instance_latch(&role->instance);
    return MRT_OK;
}

static mrt_result watch_role(live_stage *stage, void *data, error *err)
{
    (void)err;
    stage->reload = data;
    return MRT_OK;
}

/* Watches the library of the mapping, if it has one. */
static void watch(live *self)
{
    error err = {""};
    live_mapping_role *role = self->role;
    const reload_settings settings = {.library = role->library,
                                      .mapping = &role->instance,
                                      .mapped = composer_mapped(self->scene->performer->composer),
                                      .log = self->settings.log,
                                      .clock = CLOCK_REAL,
                                      .isolate = role->isolate ? &role->isolation : NULL,
                                      .is_asked = true};
    mrt_result result = role->library ? reload_start(&role->reload, &settings, &err) : MRT_OK;
    if (result >= 0)
        result = live_run_command(self, watch_role, role->reload, &err);
    if (result < 0)
        log_push(self->settings.log, MRT_LOG_WARNING, "stage", err.text);
}

static void drop_coming(live *self)
{
    if (!self->coming)
        return;
    instance_deactivate(mapping_now(self->coming));
    destroy_mapping(self->coming);
    self->coming = NULL;
}

/* MRT_HOLD: not possible yet. */
static mrt_result switch_to_coming(live *self, error *err)
{
    live_change c = {.role = self->coming, .keeps_clay = self->settings.keeps_clay};
    live_mapping_role *before = self->role;
    c.room = layer_room_create(&self->coming->instance);
    mrt_result result = c.room ? live_cast_change(self, switch_mapping, &c, err)
                               : error_set(err, MRT_ERR_MEMORY, "no memory for a mapping");
    layer_room_destroy(c.room);
    if (result == MRT_HOLD || !c.old)
        return result;
    self->role = self->coming;
    self->coming = NULL;
    live_ease(self);
    instance_deactivate(c.old);
    destroy_mapping(before);
    watch(self);
    return result;
}

/* Starts the switch to a mapping with the taught values of the show. Destroys the mapping on
 * error. */
static mrt_result start_switch(live *self, live_mapping_role *role, error *err)
{
    recall_taught(self, role);
    mrt_result result = activate(self, role, err);
    if (result < 0) {
        destroy_mapping(role);
        return result;
    }
    drop_coming(self);
    self->coming = role;
    result = switch_to_coming(self, err);
    if (result < 0)
        drop_coming(self);
    return result < 0 ? result : MRT_OK;
}

void live_keep_clay(live *self, bool keeps)
{
    self->settings.keeps_clay = keeps;
}

bool live_keeps_clay(const live *self)
{
    return self->settings.keeps_clay;
}

mrt_result live_set_mapping(live *self, const char *text, error *err)
{
    live_mapping_role *role;
    mrt_result result = live_check_free(self, text && text[0] ? text : "the mapping", err);
    if (result >= 0)
        result = create_mapping(&role, text, self->settings.plugins, self->settings.log, err);
    if (result < 0)
        return result;
    live_cast_keep_taught(self);
    return start_switch(self, role, err);
}

mrt_result live_cast_follow_show(live *self, error *err)
{
    live_mapping_role *role, *last = self->coming ? self->coming : self->role;
    self->role->is_of_show = false;
    if (!plugin_interface(last->instance.type, MRT_STATE))
        return MRT_OK;
    mrt_result result =
        create_mapping(&role, last->text, self->settings.plugins, self->settings.log, err);
    if (result < 0)
        return result;
    instance_copy_values(&role->instance, mapping_now(last));
    return start_switch(self, role, err);
}

instance *live_mapping(live *self)
{
    live_mapping_role *role = self->coming ? self->coming : self->role;
    return is_null_mapping(role) ? NULL : mapping_now(role);
}

/* ---- another face ---- */

static mrt_result switch_scene(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    if (stage->scene)
        live_board_ease_from(&c->scene->board, &stage->scene->board, clock_now_ns());
    stage->scene = c->scene;
    stage->role = c->role;
    stage->reload = NULL;
    stage->is_dirty = true;
    mrt_result result = live_cast_begin(stage, c, err);
    live_frame_publish(stage);
    return result;
}

static void retire(live *self, live_scene *scene, live_mapping_role *role)
{
    performer_destroy(scene->performer);
    scene->performer = NULL;
    destroy_mapping(role);
    scene->before = self->old_scene;
    self->old_scene = scene;
    const mrt_face *about = composer_about(self->scene->performer->composer);
    for (; scene; scene = scene->before)
        for (int i = 0; i < 3; ++i)
            scene->board.view[i].about = about;
}

static void publish_first(live_scene *scene)
{
    composer *of = scene->performer->composer;
    live_view *view = live_board_fill(&scene->board, of, clock_now_ns());
    view->about = composer_about(of);
    view->solver = composer_solver(of);
    live_board_publish(&scene->board);
}

mrt_result live_cast_set_scene(live *self, const face_file *file, const char *path, double unit_mm,
                               error *err)
{
    live_mapping_role *role, *last = self->coming ? self->coming : self->role;
    live_scene *scene = NULL;
    mrt_result result =
        create_mapping(&role, last->text, self->settings.plugins, self->settings.log, err);
    if (result < 0)
        return result;
    instance_copy_values(&role->instance, mapping_now(last));
    role->is_of_show = last->is_of_show;
    role->noted_hash = last->noted_hash;
    if (last == self->role)
        teach(self, role);
    else
        recall_taught(self, role);
    drop_coming(self);
    result = create_scene(self, file, path, unit_mm, role, &scene, err);
    live_change c = {.scene = scene, .role = role};
    if (result >= 0)
        result = live_cast_prepare(self, &c, err);
    if (result < 0) {
        live_scene_destroy(scene);
        destroy_mapping(role);
        return result;
    }
    publish_first(scene);
    result = live_run_command(self, switch_scene, &c, err);
    live_scene *old_scene = self->scene;
    live_mapping_role *old_role = self->role;
    self->scene = scene;
    self->role = role;
    outputs_show(self->outputs, scene->outgoing);
    live_cast_dismiss(self, &c);
    retire(self, old_scene, old_role);
    watch(self);
    return result;
}

const mrt_rig_pose *live_poses(const live *self, uint32_t *out_count)
{
    const mapped_face *mapped = composer_mapped(self->scene->performer->composer);
    *out_count = mapped->pose_count;
    return mapped->pose;
}

void live_own_solver(live *self, const csrbf_settings *solver)
{
    self->has_own_solver = solver != NULL;
    if (solver)
        self->own_solver = *solver;
}

/* ---- update ---- */

void live_cast_update(live *self)
{
    error err = {""};
    if (self->coming && switch_to_coming(self, &err) < 0) {
        log_push(self->settings.log, MRT_LOG_ERROR, "stage", err.text);
        drop_coming(self);
    }
    note_changed_taught(self);
}

/* ---- mappings that accept the current face ---- */

mrt_result live_check_mapping(const live_settings *settings, const char *text, error *err)
{
    live_mapping_role *made;
    mrt_result result = create_mapping(&made, text, settings->plugins, settings->log, err);
    destroy_mapping(made);
    return result;
}

/* Runs a mapping that is not built in in its own process, as on the stage. */
static bool accepts_face(live *self, const char *id, const mapped_face *mapped)
{
    error ignored = {""};
    live_mapping_role *role;
    if (create_mapping(&role, id, self->settings.plugins, NULL, &ignored) < 0)
        return false;
    bool is_taken = instance_activate(&role->instance, mapped, &ignored) >= 0;
    if (is_taken)
        instance_deactivate(&role->instance);
    destroy_mapping(role);
    return is_taken;
}

void live_list_fitting(live *self, char *out, size_t capacity)
{
    const plugin_list *plugins = self->settings.plugins;
    const mapped_face *mapped = composer_mapped(self->scene->performer->composer);
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        const char *name = plugin_short_name(type);
        if (!plugin_interface(type, MRT_MAPPING) || !plugin_is_offered(type) ||
            used + strlen(name) + 3 > capacity || !accepts_face(self, type->id, mapped))
            continue;
        used += (size_t)snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", name);
    }
}

/* ---- start and finish ---- */

mrt_result live_cast_start(live *self, error *err)
{
    const live_settings *s = &self->settings;
    live_own_solver(self, s->solver);
    mrt_result result = create_mapping(&self->role, s->mapping, s->plugins, s->log, err);
    if (result >= 0)
        recall_taught(self, self->role);
    if (result >= 0)
        result =
            create_scene(self, s->face, s->face_path, s->unit_mm, self->role, &self->scene, err);
    if (result < 0)
        return result;
    self->stage.scene = self->scene;
    self->stage.role = self->role;
    outputs_show(self->outputs, self->scene->outgoing);
    live_frame_publish(&self->stage);
    live_frame_pulse(&self->stage);
    watch(self);
    return MRT_OK;
}

void live_cast_finish(live *self)
{
    drop_coming(self);
    live_scene_destroy(self->scene);
    live_scene_destroy(self->old_scene);
    destroy_mapping(self->role);
}
