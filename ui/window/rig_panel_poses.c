/* The poses of a rig: listed, shown, made of the shape that is on the stage. */
#include "rigpose.h"
#include "window/rig_panel_inside.h"

#include <stdio.h>
#include <string.h>

enum { WORDS = 160 };

/* ---- shown ---- */

bool rig_panel_show_pose(rig_panel *self)
{
    error err;
    const rig_work *work = rig_model_work(self->model);
    const uint32_t pose = self->parting.pose;
    const csrbf_settings solver = studio_view(self->of)->solver;
    if (pose == RIG_NONE || !work || !work->face || pose >= work->rig.pose_count ||
        !rig_model_is_laid(self->model) || !(solver.radius > 0.0))
        return false;
    if (rigpose_show_on(work->face, &work->rig, pose, &solver, &err) < 0)
        return false;
    points_to_rows(self->shown.position, face_shown(work->face), face_order(work->face));
    face_reset(work->face); /* as others expect it */
    return true;
}

/* ---- made ---- */

static const char *free_name(const rig *r, char out[RIG_PANEL_NAME])
{
    for (uint32_t number = 1;; ++number) {
        bool is_taken = false;
        (void)snprintf(out, RIG_PANEL_NAME, "pose %u", number);
        for (uint32_t i = 0; i < r->pose_count; ++i)
            is_taken = is_taken || strcmp(r->pose[i].name, out) == 0;
        if (!is_taken)
            return out;
    }
}

/* NULL: it can be made. */
static const char *why_not(const rig_panel *self)
{
    const rig_work *work = rig_model_work(self->model);
    const live_view *view = studio_view(self->of);
    if (!work || !work->face || !rig_model_is_laid(self->model))
        return "The rig is being laid on the face.";
    if (!view->about || view->contact_count != work->rig.contact_count)
        return "The stage does not have this rig yet.";
    return NULL;
}

static void add_pose(rig_panel *self)
{
    error err = {""};
    rig_pose made;
    char name[RIG_PANEL_NAME];
    uint32_t index = RIG_NONE;
    const rig_work *work = rig_model_work(self->model);
    const live_view *view = studio_view(self->of);
    const csrbf_settings solver = studio_view(self->of)->solver;
    mrt_result result =
        rigpose_of(&made, free_name(rig_model_rig(self->model), name), work->face, MRT_MAX_VECTORS,
                   &work->rig, &solver, view->contact, view->meter.dof, &err);
    if (result < 0) {
        rig_panel_say(self, err.text);
        return;
    }
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_add_pose(r, &made, &index, &err), &err, "add a pose"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, index);
    rigpose_finish(&made);
}

static void remove_pose(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_remove_pose(r, self->parting.pose, &err), &err,
                              "take out a pose"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
}

static void name_pose(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self, rig_edit_name_pose(r, self->parting.pose, self->parting.pose_name.text, &err),
            &err, "name a pose");
}

/* ---- drawn ---- */

static void draw_chosen(rig_panel *self, ui *on, const rig *r)
{
    char words[WORDS];
    const uint32_t index = self->parting.pose;
    const rig_pose *pose = &r->pose[index];
    const uint64_t number = rig_model_number(self->model);
    ui_id_begin(on, "pose");
    (void)snprintf(words, sizeof words, "%u pulls, %u turns", pose->pull_count, pose->dof_count);
    if (rig_panel_draw_name(self, on, &self->parting.pose_name, index, pose->name))
        name_pose(self);
    ui_fact(on, "Holds", RIG_PANEL_LABEL, UI_STYLE_BODY, words);
    if (number == rig_model_number(self->model) && ui_button(on, "Take out", UI_PLAIN))
        remove_pose(self);
    ui_id_end(on);
}

void rig_panel_draw_poses(rig_panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    for (uint32_t i = 0; i < r->pose_count; ++i) {
        char label[WORDS];
        (void)snprintf(label, sizeof label, "%s##pose%u", r->pose[i].name, i);
        if (ui_row(on, label, i == self->parting.pose) != UI_ROW_NONE)
            rig_panel_choose_part(self, RIG_NONE, RIG_NONE, i == self->parting.pose ? RIG_NONE : i);
    }
    if (r->pose_count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "None yet.");
    if (self->parting.pose != RIG_NONE)
        draw_chosen(self, on, rig_model_rig(self->model));
    const char *why = why_not(self);
    ui_disabled_begin(on, why != NULL);
    if (ui_button(on, "Add the shape on the stage", UI_PLAIN))
        add_pose(self);
    ui_disabled_end(on);
    ui_hint(on, why ? why : "Bones as they are turned, contacts where they are, become a pose.");
}
