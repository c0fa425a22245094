#include "stage/live/live_stage.h"
#include "base/clock.h"
#include "hand/calibration_file.h"
#include "stage/take/identity.h"
#include "stage/take/kept_solver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* [main] Who performs: the face and the mapping; and what every change has in common: it ends the
 * performance that is recorded and begins another one. */

/* What goes to the frame thread with a change, and what comes back. */
typedef struct live_change {
    recorder_cast *cast; /* NULL: nothing is recorded */
    live_scene *scene;
    live_mapping_role *role;
    layer_room *room;
    instance *old;
    input *add;
    live_sample_board *heard;
    uint32_t remove, side;
    const hand_calibration *calibration;
    hand_skeleton *skeleton;
    uint32_t pedal;
    const void *taught;
    size_t taught_size;
    patch_plan *plan; /* that comes; then the one that was */
} live_change;

static void live_inputs_change_pedal(live *self);

static char *copy_of(const char *text)
{
    return text ? strdup(text) : NULL;
}

mrt_result live_check_free(const live *self, const char *what, error *err)
{
    if (!self->status.is_recording)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%s: not while a take is recorded: end it first", what);
}

/* ---- scenes ---- */

void live_scene_destroy(live_scene *scene)
{
    while (scene) {
        live_scene *before = scene->before;
        performer_destroy(scene->performer);
        live_board_destroy(&scene->board);
        face_board_drop(scene->outgoing);
        take_performance_finish(&scene->face);
        free(scene->path);
        free(scene);
        scene = before;
    }
}

/* Its owner is the performer's face; whoever makes another face of it copies it. */
static void lend_binding(live_scene *scene)
{
    const face *f = performer_face(scene->performer);
    scene->ready = *scene->file;
    if (!scene->ready.bound)
        scene->ready.bound = (binding *)(uintptr_t)face_binding(f);
}

/* The same face again: as it is bound now. */
static const face_file *bound_already(const live *self, const face_file *file)
{
    return self->scene && self->scene->file == file ? &self->scene->ready : file;
}

static csrbf_settings solver_on(const live *self, const face_file *file)
{
    const kept_solver own = {self->has_own_solver, self->own_solver};
    return kept_solver_on(&own, file);
}

mrt_result live_scene_create(live *self, const face_file *file, const char *path, double unit_mm,
                             live_mapping_role *role, live_scene **out, error *err)
{
    *out = NULL;
    live_scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    scene->file = file;
    scene->unit_mm = unit_mm;
    scene->solver = solver_on(self, file);
    scene->path = copy_of(path ? path : "");
    mrt_result result = scene->path
                            ? identity_of_face(&scene->face, file, scene->path, unit_mm, err)
                            : error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    const performer_settings settings = {
        .solver = scene->solver,
        .side_length_mm = {self->length_mm[MRT_LEFT], self->length_mm[MRT_RIGHT]},
        .rezero_pedal = self->rezero_pedal,
        .patch = self->patch.count > 0 ? &self->patch : NULL};
    if (result >= 0)
        result = performer_create(&scene->performer, bound_already(self, file), &role->instance,
                                  &settings, err);
    if (result >= 0)
        lend_binding(scene);
    if (result >= 0)
        result = live_board_create(&scene->board, performer_composer(scene->performer), err);
    if (result >= 0)
        result =
            face_board_create(&scene->outgoing, performer_composer(scene->performer), file, err);
    if (result < 0) {
        live_scene_destroy(scene);
        return result;
    }
    *out = scene;
    return MRT_OK;
}

/* ---- what is recorded of it ---- */

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
        .calibration = {self->calibration_text[MRT_LEFT], self->calibration_text[MRT_RIGHT]},
        .layer = performer_layer(scene->performer),
        .mapping = live_mapping_now(role),
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

/* What is recorded from the change on. */
static mrt_result live_cast_prepare(live *self, const recorder_settings *as, live_change *out,
                                    error *err)
{
    return self->recorder ? recorder_prepare(self->recorder, as, &out->cast, err) : MRT_OK;
}

/* [frame] The recorder goes over, and time goes on, so that the performance begins here. */
static mrt_result live_cast_begin(live_stage *stage, live_change *c, error *err)
{
    if (c->cast) {
        c->cast = recorder_change(stage->recorder, c->cast);
        const char *rebuilt = stage->reload ? reload_identity(stage->reload) : "";
        if (rebuilt[0])
            recorder_change_mapping(stage->recorder, rebuilt);
    }
    return live_frame_tick(stage, err);
}

/* what has ended, or was not needed */
static void live_cast_dismiss(live *self, live_change *c)
{
    if (self->recorder)
        recorder_dismiss(self->recorder, c->cast);
    c->cast = NULL;
}

static mrt_result begin_anew(live_stage *stage, void *data, error *err)
{
    return live_cast_begin(stage, data, err);
}

mrt_result live_cast_anew(live *self, error *err)
{
    live_change c = {0};
    const recorder_settings as = live_cast_settings(self, true);
    mrt_result result = live_cast_prepare(self, &as, &c, err);
    if (result >= 0)
        result = live_ask(self, begin_anew, &c, err);
    live_cast_dismiss(self, &c);
    return result;
}

/* ---- what the mapping was taught ---- */

typedef struct taught {
    unsigned char bytes[TAUGHT_BYTES_MAX];
    size_t size;
} taught;

static mrt_result save_taught(live_stage *stage, void *data, error *err)
{
    (void)err;
    taught *out = data;
    out->size = taught_save(layer_mapping(performer_layer(stage->scene->performer)), out->bytes,
                            sizeof out->bytes);
    return MRT_OK;
}

/* To be freed; NULL: it was taught nothing, or no memory. */
static taught *fetch_taught(live *self)
{
    error ignored = {""};
    taught *out = malloc(sizeof *out);
    if (out && live_ask(self, save_taught, out, &ignored) >= 0 && out->size > 0)
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

/* MRT_HOLD: one mapping leaves while another comes; later. */
static mrt_result teach_now(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    layer *of = performer_layer(stage->scene->performer);
    if (layer_is_fading(of))
        return MRT_HOLD;
    mrt_result result = taught_load(layer_mapping(of), c->taught, c->taught_size, err);
    if (result < 0)
        return result;
    layer_crossfade(of);
    return live_cast_begin(stage, c, err);
}

mrt_result live_teach(live *self, const void *bytes, size_t size, error *err)
{
    mrt_result result = live_check_free(self, "what the mapping was taught", err);
    if (result >= 0 && self->coming)
        result = error_set(err, MRT_ERR_ARGUMENT, "another mapping is coming: try again");
    live_change c = {.taught = bytes, .taught_size = size};
    const recorder_settings as = live_cast_settings(self, true);
    if (result >= 0)
        result = live_cast_prepare(self, &as, &c, err);
    const int64_t until_ns = clock_now_ns() + NS_PER_S; /* a blend takes LAYER_FADE_S */
    while (result >= 0 && (result = live_ask(self, teach_now, &c, err)) == MRT_HOLD) {
        if (clock_now_ns() >= until_ns)
            result = error_set(err, MRT_ERR_ARGUMENT, "another mapping is coming: try again");
        else
            clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
    live_cast_dismiss(self, &c);
    return result;
}

/* For another instance of it, on another face. */
static void teach(live *self, live_mapping_role *role)
{
    error ignored = {""};
    taught *t = fetch_taught(self);
    if (t && taught_load(&role->instance, t->bytes, t->size, &ignored) < 0)
        log_push(self->settings.log, MRT_LOG_WARNING, "stage",
                 "the mapping does not take what it was taught over to this face");
    free(t);
}

void live_cast_keep_taught(live *self)
{
    error err = {""};
    taught *t = self->show && self->scene && self->scene->performer ? fetch_taught(self) : NULL;
    if (t && taught_keep(self->show, self->role->instance.type, t->bytes, t->size, &err) < 0)
        log_push(self->settings.log, MRT_LOG_WARNING, "show", err.text);
    free(t);
}

/* ---- what the pointer made of the face ---- */

typedef struct pulled {
    live_change change;
    void *bytes;
    size_t size, capacity;
    int grip; /* that the pointer has now */
} pulled;

/* MRT_HOLD: the sample with which the pointer let go is still to be performed. */
static mrt_result await_pointer(const live_stage *stage, const pulled *p)
{
    return (int)stage->pointed.value[POINTER_GRIP] == p->grip ? MRT_OK : MRT_HOLD;
}

static mrt_result ask_pulled(live *self, live_command_run *run, pulled *p, error *err)
{
    const int64_t until_ns = clock_now_ns() + NS_PER_S / 2;
    mrt_result result = live_ask(self, run, p, err);
    while (result == MRT_HOLD && clock_now_ns() < until_ns) {
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
        result = live_ask(self, run, p, err);
    }
    return result == MRT_HOLD ? error_set(err, MRT_ERR_ARGUMENT, "the stage is too busy: try again")
                              : result;
}

static mrt_result save_pulled(live_stage *stage, void *data, error *err)
{
    (void)err;
    pulled *p = data;
    if (await_pointer(stage, p) == MRT_HOLD)
        return MRT_HOLD;
    p->size = performer_save_pulled(stage->scene->performer, p->bytes, p->capacity);
    return MRT_OK;
}

mrt_result live_save_pulled(live *self, void **out, size_t *out_size, error *err)
{
    pulled p = {.capacity = (size_t)64 << 10, .grip = (int)self->pointed[POINTER_GRIP]};
    for (;;) {
        p.bytes = malloc(p.capacity);
        mrt_result result = p.bytes ? ask_pulled(self, save_pulled, &p, err)
                                    : error_set(err, MRT_ERR_MEMORY, "no memory to undo it");
        if (result >= 0 && p.size <= p.capacity) {
            *out = p.bytes;
            *out_size = p.size;
            return MRT_OK;
        }
        free(p.bytes);
        if (result < 0)
            return result;
        p.capacity = p.size + p.size / 4; /* the face moves on meanwhile */
    }
}

static mrt_result load_pulled(live_stage *stage, void *data, error *err)
{
    pulled *p = data;
    if (await_pointer(stage, p) == MRT_HOLD)
        return MRT_HOLD;
    mrt_result result = performer_load_pulled(stage->scene->performer, p->bytes, p->size, err);
    return result < 0 ? result : live_cast_begin(stage, &p->change, err);
}

mrt_result live_load_pulled(live *self, const void *bytes, size_t size, error *err)
{
    pulled p = {.bytes = (void *)(uintptr_t)bytes, .size = size};
    mrt_result result = live_check_free(self, "what was pulled", err);
    const recorder_settings as = live_cast_settings(self, true);
    if (result >= 0)
        result = live_cast_prepare(self, &as, &p.change, err);
    if (result >= 0) {
        live_pointer_eases(self);
        result = ask_pulled(self, load_pulled, &p, err);
    }
    live_cast_dismiss(self, &p.change);
    return result;
}

/* ---- the patch ---- */

/* MRT_HOLD: what was changed before still comes; time goes on, so that it does. */
static mrt_result patch_now(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    patch_plan *old;
    if (!layer_set_patch(performer_layer(stage->scene->performer), c->plan, &old)) {
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
        patch_plan_check_params(c.plan, live_mapping_now(self->role)->type);
    *before = self->patch;
    self->patch = *p; /* what is recorded from here on */
    const recorder_settings as = live_cast_settings(self, true);
    result = live_cast_prepare(self, &as, &c, err);
    if (result >= 0)
        result = live_ask(self, patch_now, &c, err);
    if (result != MRT_OK)
        self->patch = *before;
    live_cast_dismiss(self, &c);
    patch_plan_destroy(c.plan);
    free(before);
    return result;
}

const char *live_patch_note(const live *self)
{
    const patch_plan *plan = layer_bay(performer_layer(self->scene->performer))->plan;
    return plan ? patch_plan_note(plan) : "";
}

/* ---- the mapping ---- */

/* MRT_HOLD: one comes already; later. */
static mrt_result switch_mapping(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    layer *of = performer_layer(stage->scene->performer);
    if (layer_is_fading(of))
        return MRT_HOLD;
    const face *posed = composer_face(performer_composer(stage->scene->performer));
    c->old = layer_replace(of, &c->role->instance, c->room, face_metered(posed)->dof);
    c->room = NULL;
    stage->role = c->role;
    stage->reload = NULL;
    return live_cast_begin(stage, c, err);
}

/* The one that comes is active on the face and begins anew. */
static mrt_result activate(live *self, live_mapping_role *role, error *err)
{
    const mrt_mapping *functions = plugin_interface(role->instance.type, MRT_MAPPING);
    const mrt_face *about = composer_about(performer_composer(self->scene->performer));
    error why = {""};
    instance_listen(&role->instance, &why, NULL);
    mrt_result result = functions->activate(role->instance.self, about);
    instance_listen_end(&role->instance);
    if (result < 0)
        return error_set(err, result, "mapping %s cannot be used on this face%s%s",
                         role->instance.type->id, why.text[0] ? ": " : "", why.text);
    functions->reset(role->instance.self);
    instance_latch(&role->instance);
    return MRT_OK;
}

static void drop_coming(live *self)
{
    if (!self->coming)
        return;
    live_mapping_deactivate(live_mapping_now(self->coming));
    live_mapping_destroy(self->coming);
    self->coming = NULL;
}

/* MRT_HOLD: not yet. */
static mrt_result let_come(live *self, error *err)
{
    live_change c = {.role = self->coming};
    live_mapping_role *before = self->role;
    const recorder_settings as = cast_settings(self, self->scene, self->coming, true);
    c.room = layer_room_create(&self->coming->instance);
    mrt_result result = c.room ? live_cast_prepare(self, &as, &c, err)
                               : error_set(err, MRT_ERR_MEMORY, "no memory for a mapping");
    if (result >= 0)
        result = live_ask(self, switch_mapping, &c, err);
    live_cast_dismiss(self, &c);
    layer_room_destroy(c.room);
    if (result == MRT_HOLD || !c.old)
        return result;
    self->role = self->coming;
    self->coming = NULL;
    live_mapping_deactivate(c.old);
    live_mapping_destroy(before);
    live_cast_watch(self);
    return result;
}

mrt_result live_set_mapping(live *self, const char *text, error *err)
{
    live_mapping_role *role;
    mrt_result result = live_check_free(self, text && text[0] ? text : "the mapping", err);
    if (result >= 0)
        result = live_mapping_create(&role, text, self->settings.plugins, self->settings.log, err);
    if (result < 0)
        return result;
    live_cast_keep_taught(self);
    taught_recall(self->show, &role->instance, self->settings.log);
    result = activate(self, role, err);
    if (result < 0) {
        live_mapping_destroy(role);
        return result;
    }
    drop_coming(self);
    self->coming = role;
    result = let_come(self, err);
    if (result < 0)
        drop_coming(self);
    return result < 0 ? result : MRT_OK;
}

instance *live_mapping(live *self)
{
    live_mapping_role *role = self->coming ? self->coming : self->role;
    return live_mapping_is_nothing(role) ? NULL : live_mapping_now(role);
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
    live_mapping_destroy(role);
    scene->before = self->old_scene;
    self->old_scene = scene;
    const mrt_face *about = composer_about(performer_composer(self->scene->performer));
    for (; scene; scene = scene->before)
        for (int i = 0; i < 3; ++i)
            scene->board.view[i].about = about;
}

static void publish_first(live_scene *scene)
{
    composer *of = performer_composer(scene->performer);
    live_view *view = live_board_fill(&scene->board, of, clock_now_ns());
    view->about = composer_about(of);
    view->solver = composer_solver(of);
    live_board_publish(&scene->board);
}

static mrt_result set_scene(live *self, const face_file *file, const char *path, double unit_mm,
                            error *err)
{
    live_mapping_role *role, *last = self->coming ? self->coming : self->role;
    live_scene *scene = NULL;
    live_take_drop(self);
    mrt_result result =
        live_mapping_create(&role, last->text, self->settings.plugins, self->settings.log, err);
    if (result < 0)
        return result;
    instance_copy_values(&role->instance, live_mapping_now(last));
    if (last == self->role)
        teach(self, role);
    drop_coming(self);
    result = live_scene_create(self, file, path, unit_mm, role, &scene, err);
    live_change c = {.scene = scene, .role = role};
    if (result >= 0) {
        const recorder_settings as = cast_settings(self, scene, role, true);
        result = live_cast_prepare(self, &as, &c, err);
    }
    if (result < 0) {
        live_scene_destroy(scene);
        live_mapping_destroy(role);
        return result;
    }
    publish_first(scene);
    result = live_ask(self, switch_scene, &c, err);
    live_scene *old_scene = self->scene;
    live_mapping_role *old_role = self->role;
    self->scene = scene;
    self->role = role;
    outputs_show(self->outputs, scene->outgoing);
    live_cast_dismiss(self, &c);
    retire(self, old_scene, old_role);
    live_cast_watch(self);
    return result;
}

mrt_result live_set_face(live *self, const face_file *file, const char *path, double unit_mm,
                         error *err)
{
    mrt_result result = live_check_free(self, path ? path : "the face", err);
    return result < 0 ? result : set_scene(self, file, path, unit_mm, err);
}

void live_own_solver(live *self, const csrbf_settings *solver)
{
    self->has_own_solver = solver != NULL;
    if (solver)
        self->own_solver = *solver;
}

/* A take that is shown goes on being shown, as it is with this engine. */
mrt_result live_set_solver(live *self, const csrbf_settings *solver, error *err)
{
    const live_scene *now = self->scene;
    const csrbf_settings before = self->own_solver;
    const bool had_own = self->has_own_solver;
    take shown = {0};
    bool is_shown = self->is_shown;
    mrt_result result = live_check_free(self, "the engine", err);
    if (result >= 0 && is_shown)
        result = take_copy(&shown, &self->shown, err);
    if (result >= 0) {
        live_own_solver(self, solver);
        result = set_scene(self, now->file, now->path, now->unit_mm, err);
        if (result < 0)
            live_own_solver(self, had_own ? &before : NULL);
    }
    if (result >= 0 && is_shown)
        result = live_show_take(self, &shown, err);
    take_finish(&shown);
    return result;
}

/* ---- now and then ---- */

static mrt_result watch_role(live_stage *stage, void *data, error *err)
{
    (void)err;
    stage->reload = data;
    return MRT_OK;
}

void live_cast_watch(live *self)
{
    error err = {""};
    const mrt_face *about = composer_about(performer_composer(self->scene->performer));
    mrt_result result = live_mapping_watch(self->role, about, self->settings.log, &err);
    if (result >= 0)
        result = live_ask(self, watch_role, self->role->reload, &err);
    if (result < 0)
        log_push(self->settings.log, MRT_LOG_WARNING, "stage", err.text);
}

void live_cast_update(live *self)
{
    error err = {""};
    if (self->coming && let_come(self, &err) < 0) {
        log_push(self->settings.log, MRT_LOG_ERROR, "stage", err.text);
        drop_coming(self);
    }
    if (self->rezero_wanted != self->rezero_pedal && !self->status.is_recording)
        live_inputs_change_pedal(self);
}

/* ---- which mappings take the face that is on the stage ---- */

mrt_result live_check_mapping(const live_settings *settings, const char *text, error *err)
{
    live_mapping_role *made;
    mrt_result result = live_mapping_create(&made, text, settings->plugins, settings->log, err);
    live_mapping_destroy(made);
    return result;
}

/* A process of its own for one that did not come with the program, as on the stage. */
static bool takes(live *self, const char *id, const mrt_face *about)
{
    error heard = {""}, ignored = {""};
    live_mapping_role *role;
    if (live_mapping_create(&role, id, self->settings.plugins, NULL, &ignored) < 0)
        return false;
    const mrt_mapping *functions = plugin_interface(role->instance.type, MRT_MAPPING);
    instance_listen(&role->instance, &heard, NULL);
    bool is_taken = functions->activate(role->instance.self, about) >= 0;
    instance_listen_end(&role->instance);
    if (is_taken)
        live_mapping_deactivate(&role->instance);
    live_mapping_destroy(role);
    return is_taken;
}

void live_list_fitting(live *self, char *out, size_t capacity)
{
    const plugin_list *plugins = self->settings.plugins;
    const mrt_face *about = composer_about(performer_composer(self->scene->performer));
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const char *id = plugins->entry[i].type->id, *dot = strrchr(id, '.');
        const char *name = dot ? dot + 1 : id;
        if (!plugin_interface(plugins->entry[i].type, MRT_MAPPING) ||
            used + strlen(name) + 3 > capacity || !takes(self, id, about))
            continue;
        used += (size_t)snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", name);
    }
}

/* ---- the inputs of a live stage, and how hands are measured ---- */

static const char *const side_name[2] = {"left", "right"};

/* ---- inputs ---- */

static mrt_result add_input(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    stage->heard[stage->input_count++] = c->heard;
    player_add_input(stage->loop, c->add);
    return live_cast_begin(stage, c, err);
}

static mrt_result remove_input(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    player_remove_input(stage->loop, c->remove);
    stage->input_count -= 1;
    for (uint32_t i = c->remove; i < stage->input_count; ++i)
        stage->heard[i] = stage->heard[i + 1];
    return live_cast_begin(stage, c, err);
}

static void finish_entry(live_input_entry *entry)
{
    input_destroy(entry->input);
    free(entry->text);
    free(entry->heard);
}

/* The entry is in the list; taken out again when it cannot be. */
static mrt_result join_input(live *self, live_input_entry *entry, error *err)
{
    live_change c = {.add = entry->input, .heard = entry->heard};
    const recorder_settings as = live_cast_settings(self, true);
    mrt_result result = live_cast_prepare(self, &as, &c, err);
    input_set_wake(entry->input, player_wake(self->stage.loop));
    if (result >= 0)
        result = input_start(entry->input, err);
    if (result >= 0)
        result = live_ask(self, add_input, &c, err);
    live_cast_dismiss(self, &c);
    return result;
}

mrt_result live_add_input(live *self, input *made, const char *text, error *err)
{
    mrt_result result = live_check_free(self, text, err);
    if (result >= 0 && self->entry_count == LIVE_INPUTS_MAX)
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: %d inputs are open, more are not possible",
                           text, LIVE_INPUTS_MAX);
    live_input_entry entry = {
        .input = made, .text = copy_of(text), .heard = calloc(1, sizeof(live_sample_board))};
    if (result >= 0 && (!entry.text || !entry.heard))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for input %s", text);
    if (result < 0) {
        finish_entry(&entry);
        return result;
    }
    slot_init(&entry.heard->slot);
    self->entry[self->entry_count++] = entry;
    result = join_input(self, &entry, err);
    if (result < 0) {
        self->entry_count -= 1;
        finish_entry(&entry);
    }
    return result;
}

mrt_result live_remove_input(live *self, uint32_t index, error *err)
{
    if (index >= self->entry_count)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no input %u", index);
    mrt_result result = live_check_free(self, self->entry[index].text, err);
    if (result < 0)
        return result;
    live_input_entry gone = self->entry[index], *at = &self->entry[index];
    live_change c = {.remove = index + 1};
    self->entry_count -= 1;
    size_t behind = (self->entry_count - index) * sizeof *at;
    memmove(at, at + 1, behind);
    const recorder_settings as = live_cast_settings(self, true);
    result = live_cast_prepare(self, &as, &c, err);
    if (result < 0) { /* it is recorded with the others: it stays */
        memmove(at + 1, at, behind);
        *at = gone;
        self->entry_count += 1;
        return result;
    }
    result = live_ask(self, remove_input, &c, err);
    live_cast_dismiss(self, &c);
    finish_entry(&gone);
    return result;
}

uint32_t live_input_count(const live *self)
{
    return self->entry_count;
}

input *live_input(live *self, uint32_t index)
{
    return index < self->entry_count ? self->entry[index].input : NULL;
}

const char *live_input_text(const live *self, uint32_t index)
{
    return index < self->entry_count ? self->entry[index].text : "";
}

bool live_input_sample(live *self, uint32_t index, mrt_sample *out)
{
    if (index >= self->entry_count)
        return false;
    live_sample_board *board = self->entry[index].heard;
    (void)slot_take(&board->slot);
    *out = board->sample[slot_front(&board->slot)];
    return out->count > 0;
}

void live_tap(live *self, uint32_t index)
{
    tap_listen(self->tap, index < self->entry_count ? index : UINT32_MAX);
}

bool live_take_tapped(live *self, mrt_sample *out)
{
    return tap_take(self->tap, out);
}

/* ---- how hands are measured ---- */

static mrt_result recalibrate(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    player_calibrate(stage->loop, c->side, c->calibration);
    c->skeleton =
        hands_change(layer_hands(performer_layer(stage->scene->performer)), c->side, c->skeleton);
    return live_cast_begin(stage, c, err);
}

typedef struct measured { /* a calibration that was read */
    char *path, *text;
    hand_calibration *use;
    double length_mm;
} measured;

static void finish_measured(measured *m)
{
    free(m->path);
    free(m->text);
    free(m->use);
}

static mrt_result read_calibration(measured *out, uint32_t side, const char *path, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    *out = (measured){.use = malloc(sizeof *out->use), .path = copy_of(path)};
    mrt_result result = MRT_OK;
    if (!file || !out->use || !out->path)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    if (result >= 0)
        result = calibration_file_read(file, path, err);
    if (result >= 0) {
        if (file->side != side)
            result = error_set(err, MRT_ERR_ARGUMENT, "%s: is of the %s hand, not of the %s one",
                               path, side_name[file->side % 2], side_name[side]);
        calibration_file_use(file, out->use);
        out->length_mm = file->hand_length_mm;
        out->text = calibration_file_text(file);
        if (!out->text && result >= 0)
            result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
        calibration_file_finish(file);
    }
    free(file);
    if (result < 0)
        finish_measured(out);
    return result;
}

/* What it was until now comes out in `m`. */
static void put_on(live *self, uint32_t side, measured *m)
{
    const measured before = {self->calibration_path[side], self->calibration_text[side],
                             self->calibration[side], self->length_mm[side]};
    self->calibration_path[side] = m->path;
    self->calibration_text[side] = m->text;
    self->calibration[side] = m->use;
    self->length_mm[side] = m->length_mm;
    *m = before;
}

mrt_result live_calibrate(live *self, uint32_t side, const char *path, error *err)
{
    measured m = {0};
    if (side > MRT_RIGHT)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no hand %u", side);
    mrt_result result = live_check_free(self, path ? path : "the calibration", err);
    if (result >= 0 && path)
        result = read_calibration(&m, side, path, err);
    if (result < 0)
        return result;
    live_change c = {.side = side, .calibration = m.use};
    double length_mm = m.length_mm > 0.0 ? m.length_mm : HAND_LENGTH_MM;
    put_on(self, side, &m);
    const recorder_settings as = live_cast_settings(self, true);
    c.skeleton = hand_skeleton_create(side, length_mm);
    if (!c.skeleton)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a hand");
    if (result >= 0)
        result = live_cast_prepare(self, &as, &c, err);
    if (result >= 0)
        result = live_ask(self, recalibrate, &c, err);
    else
        put_on(self, side, &m);
    live_cast_dismiss(self, &c);
    hand_skeleton_destroy(c.skeleton);
    finish_measured(&m);
    return result;
}

const char *live_calibration(const live *self, uint32_t side)
{
    return side <= MRT_RIGHT ? self->calibration_path[side] : NULL;
}

static mrt_result rezero(live_stage *stage, void *data, error *err)
{
    (void)data, (void)err;
    performer *p = stage->scene->performer;
    const mrt_hand *hand = layer_frame(performer_layer(p))->hand;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        error why = {""};
        if (!hand[side].present)
            continue;
        if (performer_rezero(p, side, &why) != MRT_OK)
            log_pushf(stage->log, MRT_LOG_INFO, "stage", "%s hand not re-zeroed: %s",
                      side_name[side], why.text);
        else if (stage->recorder)
            recorder_rezero(stage->recorder, side);
    }
    return MRT_OK;
}

void live_rezero(live *self)
{
    error ignored = {""};
    (void)!live_ask(self, rezero, NULL, &ignored);
}

static mrt_result change_pedal(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    hands_set_rezero_pedal(layer_hands(performer_layer(stage->scene->performer)), c->pedal);
    return live_cast_begin(stage, c, err);
}

static void live_inputs_change_pedal(live *self)
{
    error err = {""};
    live_change c = {.pedal = self->rezero_wanted};
    self->rezero_pedal = self->rezero_wanted;
    const recorder_settings as = live_cast_settings(self, true);
    mrt_result result = live_cast_prepare(self, &as, &c, &err);
    if (result >= 0)
        result = live_ask(self, change_pedal, &c, &err);
    if (result < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "stage", err.text);
    live_cast_dismiss(self, &c);
}

void live_set_rezero_pedal(live *self, uint32_t pedal)
{
    self->rezero_wanted = pedal <= MRT_MAX_PEDALS ? pedal : 0;
    live_cast_update(self);
}
