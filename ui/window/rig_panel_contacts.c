/* The contacts of a rig: the list, and the chosen one; where they are is shown and changed on the
 * face (rig_panel_face.c). */
#include "window/rig_panel_inside.h"

#include <stdio.h>
#include <string.h>

enum { BONE_ITEMS = RIG_BONES_MAX + 1 };
static const float vertex_width = 62.0f, vertex_end = 292.0f;
static const float list_least = 130.0f, list_most = 480.0f, below_list = 175.0f; /* points high */

static float list_height(const ui *on)
{
    float left = ui_available_height(on) - below_list;
    return left < list_least ? list_least : left > list_most ? list_most : left;
}

static void draw_list(rig_panel *self, ui *on, const rig *r)
{
    ui_scroll_begin(on, "contacts", 0.0f, list_height(on));
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        char label[160], vertex[32];
        (void)snprintf(label, sizeof label, "%s##contact%u", r->contact[i].name, i);
        (void)snprintf(vertex, sizeof vertex, "%u", r->contact[i].vertex);
        ui_width(on, -vertex_width);
        if (ui_row(on, label, i == self->contact) != UI_ROW_NONE)
            rig_panel_choose(self, RIG_TAB_CONTACTS, i == self->contact ? RIG_NONE : i);
        ui_same_line(on);
        ui_at(on, vertex_end - ui_text_width(on, UI_STYLE_DIM, vertex));
        ui_text(on, UI_STYLE_DIM, vertex);
    }
    if (r->contact_count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "None yet: nothing can be pulled by name.");
    ui_scroll_end(on);
}

/* ---- the chosen one ---- */

static void draw_name(rig_panel *self, ui *on, const rig *r)
{
    error err = {""};
    rig_placing *placing = &self->placing;
    uint32_t number = (uint32_t)rig_model_number(self->model);
    if (placing->name_of != self->contact || placing->name_number != number) {
        (void)snprintf(placing->name, sizeof placing->name, "%s", r->contact[self->contact].name);
        placing->name_of = self->contact;
        placing->name_number = number;
    }
    ui_width(on, -1.0f);
    if (!ui_input(on, "contact name", "name", placing->name, sizeof placing->name))
        return;
    rig *changed = rig_panel_begin(self);
    if (changed)
        (void)rig_panel_finish(self,
                               rig_edit_name_contact(changed, self->contact, placing->name, &err),
                               &err, "name a contact");
    placing->name_of = RIG_NONE;
}

static void draw_bone(rig_panel *self, ui *on, const rig *r)
{
    error err = {""};
    const char *items[BONE_ITEMS] = {"by its vertex"};
    uint32_t bone = r->contact[self->contact].bone, index = bone == RIG_NONE ? 0 : bone + 1;
    for (uint32_t i = 0; i < r->bone_count; ++i)
        items[i + 1] = r->bone[i].name;
    if (!ui_choice(on, "Rides on", RIG_PANEL_LABEL, items, r->bone_count + 1, &index))
        return;
    rig *changed = rig_panel_begin(self);
    bone = index == 0 ? RIG_NONE : index - 1;
    if (changed)
        (void)rig_panel_finish(self, rig_edit_ride(changed, self->contact, bone, &err), &err,
                               "change what a contact rides on");
}

static void mirror(rig_panel *self)
{
    error err = {""};
    rig *changed = rig_panel_begin(self);
    if (!changed)
        return;
    uint32_t image =
        brush_mirror_of(rig_model_brush(self->model), changed->contact[self->contact].vertex);
    mrt_result result =
        image == UINT32_MAX
            ? error_set(&err, MRT_ERR_ARGUMENT, "there is no vertex on the other side of this one")
            : rig_edit_mirror_contact(changed, self->contact, image, &err);
    (void)rig_panel_finish(self, result, &err, "mirror a contact");
}

static void take_out(rig_panel *self)
{
    error err = {""};
    rig *changed = rig_panel_begin(self);
    if (changed && rig_panel_finish(self, rig_edit_remove_contact(changed, self->contact, &err),
                                    &err, "take out a contact"))
        self->contact = RIG_NONE;
}

static void draw_chosen(rig_panel *self, ui *on, const rig *r)
{
    const rig_contact *contact = &r->contact[self->contact];
    uint64_t number = rig_model_number(self->model);
    draw_name(self, on, r);
    if (number != rig_model_number(self->model))
        return;
    draw_bone(self, on, r);
    if (number != rig_model_number(self->model))
        return;
    ui_fact(on, "Mirror", RIG_PANEL_LABEL, UI_STYLE_BODY,
            contact->mirror == RIG_NONE ? "none" : r->contact[contact->mirror].name);
    if (ui_button(on, "Mirror it", UI_PLAIN))
        mirror(self);
    ui_hint(on,
            "Puts the contact of the other side where this one's mirror image is, or makes it.");
    ui_same_line(on);
    if (ui_button(on, "Take out", UI_PLAIN) && number == rig_model_number(self->model))
        take_out(self);
}

void rig_panel_draw_contacts(rig_panel *self, ui *on)
{
    rig_placing *placing = &self->placing;
    draw_list(self, on, rig_model_rig(self->model));
    if (ui_button(on, placing->is_adding ? "Click on the face##add" : "Add a contact##add",
                  placing->is_adding ? UI_ACCENT : UI_PLAIN))
        placing->is_adding = !placing->is_adding;
    ui_same_line(on);
    ui_at(on, 168.0f);
    (void)ui_check(on, "Both sides##contacts", &self->is_even);
    if (self->contact != RIG_NONE)
        draw_chosen(self, on, rig_model_rig(self->model));
    else
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "Click a dot on the face to choose it, drag it to put it elsewhere.");
}
