/* The rig panel: which vertex rides on what, where the face can be pulled, how the jaw turns, and
 * what is wrong with it. */
#include "base/file.h"
#include "window/rig_panel_inside.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double look_after_s = 1.5; /* for what was kept, when the panel is not seen */

struct panel {
    rig_panel of;
};

/* ---- what is said ---- */

void rig_panel_say(rig_panel *self, const char *trouble)
{
    (void)snprintf(self->trouble, sizeof self->trouble, "%s", trouble);
    if (trouble[0])
        news_list_add(studio_news(self->of), MRT_LOG_ERROR, "rig", trouble);
}

static void tell(rig_panel *self, const char *text)
{
    news_list_add(studio_news(self->of), MRT_LOG_INFO, "rig", text);
}

/* ---- changes ---- */

static void go(rig_panel *self, uint64_t number)
{
    rig_panel_end_stroke(self);
    self->jawing.is_changing = self->is_says_held = self->parting.is_held = false;
    if (!self->model || !rig_model_go(self->model, number))
        rig_panel_say(self, "That change of the rig is too long ago to be undone.");
    self->shown.is_tint_new = self->shown.is_shape_new = true;
}

static void undo(void *owner, uint64_t number)
{
    go(owner, number - 1);
}

static void redo(void *owner, uint64_t number)
{
    go(owner, number);
}

void rig_panel_note_step(rig_panel *self, uint64_t number, const char *words)
{
    studio_step step = {.owner = self, .undo = undo, .redo = redo, .number = number};
    (void)snprintf(step.words, sizeof step.words, "rig: %s", words);
    studio_did(self->of, &step);
    self->shown.is_tint_new = self->shown.is_shape_new = true;
}

rig *rig_panel_begin(rig_panel *self)
{
    error err = {""};
    rig *out = rig_model_begin(self->model, &err);
    if (!out)
        rig_panel_say(self, err.text);
    return out;
}

bool rig_panel_finish(rig_panel *self, mrt_result result, const error *err, const char *words)
{
    rig_panel_say(self, result < 0 ? err->text : "");
    if (result < 0) {
        rig_model_abandon(self->model);
        return false;
    }
    rig_panel_note_step(self, rig_model_commit(self->model), words);
    return true;
}

void rig_panel_choose(rig_panel *self, rig_tab tab, uint32_t index)
{
    self->tab = tab;
    if (tab == RIG_TAB_REGIONS)
        self->region = index;
    if (tab == RIG_TAB_CONTACTS)
        self->contact = index;
    self->is_says_held = false;
    self->shown.is_tint_new = true;
}

uint32_t rig_panel_jaw(const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (r->bone[i].kind == BONE_JAW)
            return i;
    return RIG_NONE;
}

/* ---- which face ---- */

static void forget_face(rig_panel *self)
{
    rig_panel_end_stroke(self);
    studio_forget_steps(self->of, self);
    studio_set_unsaved(self->of, NULL);
    self->was_unsaved = false;
    rig_model_destroy(self->model);
    self->model = NULL;
    rig_panel_shown_finish(&self->shown);
    free(self->confirm);
    self->confirm = NULL;
    self->region = self->contact = RIG_NONE;
    self->placing = (rig_placing){.name_of = RIG_NONE};
    self->jawing = (rig_jawing){.held = RIG_HANDLES};
    rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
    self->painting.is_on = false;
    self->trouble[0] = '\0';
}

static bool is_same_face(const rig_panel *self, const face_file *file)
{
    const char *path = studio_face_path(self->of);
    return file && self->stage_path && path && file->rig == self->stage_rig &&
           file->mesh.position == self->stage_position && strcmp(path, self->stage_path) == 0;
}

static void note_face(rig_panel *self)
{
    const face_file *file = studio_face(self->of);
    const char *path = studio_face_path(self->of);
    free(self->stage_path);
    self->stage_rig = file ? file->rig : NULL;
    self->stage_rig_is_file = path && strcmp(file_extension_of(path).text, "json") == 0;
    self->stage_position = file ? file->mesh.position : NULL;
    self->stage_path = strdup(path ? path : "");
}

static void follow_face(rig_panel *self, double dt_s)
{
    const face_file *file = studio_face(self->of);
    self->known_s += dt_s;
    if (is_same_face(self, file))
        return;
    if (self->adopts && self->model && file &&
        file->mesh.vertex_count == rig_model_mesh(self->model)->vertex_count)
        note_face(self);
    else {
        forget_face(self);
        note_face(self);
        self->known_s = 0.0;
    }
    self->adopts = false;
}

/* Not before it is needed: the first face should be on the screen by then. */
static void open_model(rig_panel *self)
{
    error err = {""};
    const face_file *file = studio_face(self->of);
    if (self->model || !file || !(self->is_seen || self->known_s > look_after_s))
        return;
    if (rig_model_create(&self->model, file, studio_face_path(self->of),
                         settings_folder(studio_settings(self->of)), &err) < 0) {
        if (!self->trouble[0])
            rig_panel_say(self, err.text);
        return;
    }
    self->shown.is_tint_new = self->shown.is_shape_new = true;
    if (rig_model_has_kept(self->model))
        tell(self, "Changes of this face's rig that were not saved are still here: F4.");
}

/* ---- the stage ---- */

static void give_to_stage(rig_panel *self)
{
    if (studio_status(self->of)->is_recording)
        return; /* later: the face of a take does not change */
    face_file *file = rig_model_take_face(self->model);
    if (!file)
        return;
    if (studio_change_face(self->of, file) < 0)
        self->trouble[0] = '\0'; /* the studio has said why not */
    free(file);
    note_face(self);
}

/* ---- the file ---- */

/* The first rig of a mesh alone: from now on it is the face, so that the show names it. */
static void open_saved(rig_panel *self, const char *path)
{
    char copy[RIG_PANEL_PATH];
    (void)snprintf(copy, sizeof copy, "%s", path);
    self->adopts = studio_open_face(self->of, copy) >= 0;
}

static mrt_result save(void *owner, error *err)
{
    rig_panel *self = owner;
    rig_panel_end_stroke(self);
    mrt_result result = rig_model_save(self->model, err);
    if (result < 0)
        return result;
    const char *path = rig_model_path(self->model);
    char text[RIG_PANEL_TROUBLE];
    (void)snprintf(text, sizeof text, "Saved %.400s", path);
    tell(self, text);
    self->trouble[0] = '\0';
    if (!self->stage_rig_is_file)
        open_saved(self, path);
    return result;
}

static void leave(void *owner)
{
    rig_panel *self = owner;
    rig_model_leave(self->model);
}

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void save_as_asked(rig_panel *self)
{
    error err = {""};
    if (save(self, &err) < 0)
        rig_panel_say(self, err.text);
}

static void tell_unsaved(rig_panel *self)
{
    bool is_unsaved = !rig_model_is_saved(self->model);
    if (is_unsaved == self->was_unsaved)
        return;
    studio_unsaved unsaved = {.owner = self, .save = save, .leave = leave};
    (void)snprintf(unsaved.words, sizeof unsaved.words, "the rig %.100s",
                   file_name(rig_model_path(self->model)));
    studio_set_unsaved(self->of, is_unsaved ? &unsaved : NULL);
    self->was_unsaved = is_unsaved;
}

/* ---- each frame ---- */

static void keep_choices(rig_panel *self)
{
    const rig *r = rig_model_rig(self->model);
    if (!r || self->region >= r->region_count)
        self->region = RIG_NONE;
    if (!r || self->contact >= r->contact_count)
        self->contact = RIG_NONE;
    if (!r || self->painting.ink.bone >= r->bone_count)
        self->painting.ink.bone = 0;
    rig_panel_keep_part(self);
}

static void update(panel *self_, double dt_s)
{
    rig_panel *self = &self_->of;
    viewport *view = studio_viewport(self->of);
    follow_face(self, dt_s);
    open_model(self);
    if (self->model) {
        if (studio_asked(self->of, ACTION_SAVE))
            save_as_asked(self);
        if (rig_model_update(self->model, dt_s))
            self->shown.is_tint_new = self->shown.is_shape_new = true;
        give_to_stage(self);
        tell_unsaved(self);
        keep_choices(self);
    }
    if (view && self->model && self->is_seen)
        rig_panel_face(self, view);
    else if (view)
        rig_panel_release(self, view);
    self->is_seen = false;
}

/* ---- drawn ---- */

static void draw_head(rig_panel *self, ui *on)
{
    char text[128];
    if (!rig_model_rig(self->model)) {
        ui_text(on, UI_STYLE_TITLE, file_name(studio_face_path(self->of)));
        return;
    }
    bool is_saved = rig_model_is_saved(self->model);
    (void)snprintf(text, sizeof text, "%.80s%s", file_name(rig_model_path(self->model)),
                   is_saved ? "" : " \xe2\x97\x8f");
    ui_text(on, UI_STYLE_TITLE, text);
    if (!is_saved)
        ui_hint(on, "There are changes that are not saved.");
    ui_same_line(on);
    ui_at(on, 252.0f);
    ui_disabled_begin(on, is_saved);
    if (ui_button(on, "Save##rig", is_saved ? UI_PLAIN : UI_ACCENT))
        save_as_asked(self);
    ui_disabled_end(on);
    ui_hint(on, "Ctrl+S");
}

static void draw_kept(rig_panel *self, ui *on)
{
    uint64_t number;
    error err = {""};
    if (!rig_model_has_kept(self->model))
        return;
    ui_text_wrapped(on, UI_STYLE_WARNING, "Changes that were not saved last time are still here.");
    if (ui_button(on, "Take them up", UI_ACCENT)) {
        mrt_result result = rig_model_take_kept(self->model, &number, &err);
        rig_panel_say(self, result < 0 ? err.text : "");
        if (result >= 0)
            rig_panel_note_step(self, number, "take up what was not saved");
    }
    ui_same_line(on);
    if (ui_button(on, "Forget them", UI_QUIET))
        rig_model_drop_kept(self->model);
    ui_rule(on);
}

static void draft(rig_panel *self)
{
    uint64_t number;
    error err = {""};
    char *confirm = NULL;
    mrt_result result = rig_model_draft(self->model, &confirm, &number, &err);
    rig_panel_say(self, result < 0 ? err.text : "");
    if (result < 0)
        return;
    free(self->confirm);
    self->confirm = confirm;
    rig_panel_note_step(self, number, "draft");
    rig_panel_choose(self, RIG_TAB_CHECK, 0);
}

static void draw_without_rig(rig_panel *self, ui *on)
{
    char label[128], path[1024];
    const char *beside = rig_model_beside(self->model);
    ui_text_wrapped(on, UI_STYLE_BODY,
                    "This mesh has no rig: all of it can be pulled, like clay. A rig gives it a "
                    "skull, a jaw and places to pull at.");
    ui_space(on, 6.0f);
    if (beside) {
        (void)snprintf(label, sizeof label, "Open %.60s", file_name(beside));
        (void)snprintf(path, sizeof path, "%s", beside);
        if (ui_button(on, label, UI_ACCENT) && studio_open_face(self->of, path) >= 0)
            return;
        ui_same_line(on);
    }
    if (ui_button(on, "Draft a rig", beside ? UI_PLAIN : UI_ACCENT))
        draft(self);
}

static void check_title(const rig_panel *self, char *out, size_t capacity)
{
    const rig_work *work = rig_model_work(self->model);
    uint32_t errors = work ? rig_findings_count(&work->findings, RIG_ERROR) : 0;
    uint32_t count = errors + (work ? rig_findings_count(&work->findings, RIG_WARNING) : 0);
    if (count > 0)
        (void)snprintf(out, capacity, "Check %u", count);
    else
        (void)snprintf(out, capacity, "Check");
}

static void draw_tabs(rig_panel *self, ui *on)
{
    static void (*const draw_tab[RIG_TABS])(rig_panel *, ui *) = {
        rig_panel_draw_regions, rig_panel_draw_contacts, rig_panel_draw_jaw, rig_panel_draw_parts,
        rig_panel_draw_check};
    char check[32];
    uint32_t before = self->tab;
    check_title(self, check, sizeof check);
    const char *const names[RIG_TABS] = {"Regions", "Contacts", "Jaw", "Parts", check};
    (void)ui_tabs(on, "tabs", names, RIG_TABS, &self->tab);
    if (self->tab != before)
        self->shown.is_tint_new = self->shown.is_shape_new = true;
    if (self->trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble);
    ui_scroll_begin(on, names[self->tab] == check ? "check" : names[self->tab], 0.0f, 0.0f);
    draw_tab[self->tab](self, on);
    ui_scroll_end(on);
}

static void draw(panel *self_, ui *on, ui_rectangle where)
{
    rig_panel *self = &self_->of;
    self->is_seen = true;
    ui_panel_begin(on, "rig", where, UI_GROUND_PANEL);
    if (!self->model) {
        ui_text_wrapped(on, UI_STYLE_DIM,
                        self->trouble[0] ? self->trouble : "There is no face on the stage.");
    } else {
        draw_head(self, on);
        draw_kept(self, on);
        if (rig_model_rig(self->model))
            draw_tabs(self, on);
        else
            draw_without_rig(self, on);
    }
    if (self->model && !rig_model_rig(self->model) && self->trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble);
    ui_panel_end(on);
}

/* ---- made ---- */

static panel *create(studio *of)
{
    panel *out = calloc(1, sizeof *out);
    if (!out)
        return NULL;
    rig_panel *self = &out->of;
    self->of = of;
    self->region = self->contact = self->region_name_of = RIG_NONE;
    self->placing.name_of = RIG_NONE;
    self->jawing.held = RIG_HANDLES;
    rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
    self->is_even = true;
    self->painting.shape = (brush_shape){.radius_mm = 12.0, .sides = BRUSH_BOTH_SIDES};
    self->painting.ink = (rig_stroke_ink){.ink = RIG_INK_RIDES, .strength = 1.0};
    self->shown.is_released = true;
    return out;
}

static void destroy(panel *self_)
{
    if (!self_)
        return;
    forget_face(&self_->of);
    free(self_->of.stage_path);
    free(self_);
}

const panel_type panel_rig = {create, destroy, draw, update};
