#include "window/mapping_panel_inside.h"
#include "window/panel_label.h"
#include "window/panels.h"
#include "window/theme.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- what is linked ---- */

static const char *contact_name(const mapping_panel *self, uint32_t contact)
{
    const mrt_face *about = studio_view(self->studio)->about;
    return about && contact > 0 && contact <= about->contact_count
               ? about->contacts[contact - 1].name
               : NULL;
}

static void set_link(mapping_panel *self, instance *mapping, int finger, uint32_t contact)
{
    char words[EDIT_TEXT];
    const char *name = contact_name(self, contact);
    uint32_t index = learn_param_of(mapping->type, finger);
    if (index == mapping->type->param_count)
        return;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        self->values[i] = instance_value(mapping, i);
    self->values[index] = (double)contact;
    if (name)
        (void)snprintf(words, sizeof words, "%s pulls %.100s", learn_finger_name[finger], name);
    else
        (void)snprintf(words, sizeof words, "%s is free again", learn_finger_name[finger]);
    mapping_panel_set(self, self->values, words);
    (void)snprintf(self->learnt, sizeof self->learnt, "%s", words);
}

static void draw_links(mapping_panel *self, ui *on, instance *mapping)
{
    uint32_t count = 0;
    char missing[32];
    for (int finger = 0; finger < LEARN_FINGERS; ++finger) {
        uint32_t index = learn_param_of(mapping->type, finger);
        uint32_t contact =
            index < mapping->type->param_count ? (uint32_t)instance_value(mapping, index) : 0;
        if (contact == 0)
            continue;
        const char *name = contact_name(self, contact);
        (void)snprintf(missing, sizeof missing, "contact %u: not there", contact);
        ui_id_begin(on, learn_finger_name[finger]);
        panel_label(on, "finger", 92.0f, THEME_TEXT, learn_finger_name[finger]);
        panel_label(on, "contact", ui_available_width(on) - 80.0f,
                    name ? THEME_ACCENT : THEME_WARNING, name ? name : missing);
        if (ui_button(on, "Remove", UI_QUIET))
            set_link(self, mapping, finger, 0);
        ui_id_end(on);
        count += 1;
    }
    if (count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "No finger is linked: each pulls the place where it is laid.");
}

/* ---- learning ---- */

static void begin(mapping_panel *self)
{
    self->is_learning = true;
    self->had_contacts = studio_looks_of(self->studio)->shows_contacts;
    studio_looks_of(self->studio)->shows_contacts = true;
    self->learnt[0] = '\0';
    learn_begin(&self->learn);
}

void mapping_learn_end(mapping_panel *self)
{
    viewport *view = studio_viewport(self->studio);
    if (!self->is_learning)
        return;
    self->is_learning = false;
    studio_looks_of(self->studio)->shows_contacts = self->had_contacts;
    if (view)
        viewport_set_use(view, VIEWPORT_PERFORMS, 0.0f);
}

static void follow_click(mapping_panel *self, instance *mapping)
{
    viewport *view = studio_viewport(self->studio);
    const viewport_stroke *stroke = view ? viewport_stroke_now(view) : NULL;
    if (!stroke || !stroke->is_pressed)
        return;
    if (self->learn.finger == LEARN_NONE) {
        (void)snprintf(self->learnt, sizeof self->learnt,
                       "First move one finger, well apart from "
                       "the others.");
    } else if (stroke->contact == 0) {
        (void)snprintf(self->learnt, sizeof self->learnt,
                       "There is no contact there: click one of the dots.");
    } else {
        set_link(self, mapping, self->learn.finger, stroke->contact);
        learn_begin(&self->learn); /* the next finger */
    }
}

void mapping_learn_update(mapping_panel *self, instance *mapping, double dt_s)
{
    viewport *view = studio_viewport(self->studio);
    if (!self->is_learning)
        return;
    if (!self->was_drawn || !mapping || !learn_can(mapping->type)) {
        mapping_learn_end(self);
        return;
    }
    learn_look(&self->learn, studio_view(self->studio)->hand, dt_s);
    if (view)
        viewport_set_use(view, VIEWPORT_PICKS, 0.0f);
    follow_click(self, mapping);
}

/* How far each finger of a hand has gone in the last second. */
static void draw_travel(const mapping_panel *self, ui *on, int first, const char *id)
{
    static const char *const letter[5] = {"thumb", "index", "middle", "ring", "little"};
    ui_canvas at;
    const float most_rad = 1.5f;
    ui_canvas_begin(on, id, 0.0f, 44.0f, &at);
    float wide = at.where.width / 5.0f;
    for (int i = 0; i < 5; ++i) {
        bool is_meant = self->learn.finger == first + i;
        float share = fminf(self->learn.travel_rad[first + i] / most_rad, 1.0f);
        ui_rectangle well = {at.where.x + wide * (float)i, at.where.y + 2.0f, wide - 8.0f, 22.0f};
        ui_draw_box(on, well, THEME_WELL, 2.0f);
        ui_draw_box(on,
                    (ui_rectangle){well.x, well.y + well.height * (1.0f - share), well.width,
                                   well.height * share},
                    is_meant ? THEME_ACCENT : THEME_HOVER, 2.0f);
        ui_draw_text(on, well.x, at.where.y + 26.0f, UI_STYLE_BODY,
                     is_meant ? THEME_ACCENT : THEME_DIM, wide - 2.0f, letter[i]);
    }
    ui_canvas_end(on);
}

static void draw_learning(mapping_panel *self, ui *on)
{
    const mrt_hand *hand = studio_view(self->studio)->hand;
    char words[96];
    if (!hand[0].present && !hand[1].present)
        (void)snprintf(words, sizeof words, "No hand is there: open a glove at Devices.");
    else if (self->learn.finger == LEARN_NONE)
        (void)snprintf(words, sizeof words, "Move one finger.");
    else
        (void)snprintf(words, sizeof words, "The %s. Now click a contact on the face.",
                       learn_finger_name[self->learn.finger]);
    ui_text_wrapped(on, UI_STYLE_STRONG, words);
    if (hand[MRT_RIGHT].present)
        draw_travel(self, on, 0, "right");
    if (hand[MRT_LEFT].present)
        draw_travel(self, on, 5, "left");
    if (ui_button(on, "Done", UI_PLAIN) || ui_pressed(on, UI_KEY_ESCAPE, 0))
        mapping_learn_end(self);
    ui_hint(on, "Escape");
}

static void draw_cannot(mapping_panel *self, ui *on, const instance *mapping)
{
    char words[200];
    (void)snprintf(words, sizeof words,
                   "%.60s decides by itself which finger moves what. Anchored lets each finger "
                   "pull a contact of your choice.",
                   mapping->type->name);
    ui_text_wrapped(on, UI_STYLE_DIM, words);
    if (ui_button(on, "Perform with Anchored", UI_PLAIN))
        mapping_steps_choose(self->steps, "anchored");
}

void mapping_learn_draw(mapping_panel *self, ui *on, instance *mapping)
{
    if (!learn_can(mapping->type)) {
        draw_cannot(self, on, mapping);
        return;
    }
    draw_links(self, on, mapping);
    ui_space(on, 6.0f);
    if (self->is_learning)
        draw_learning(self, on);
    else if (ui_button(on, "Learn", UI_ACCENT))
        begin(self);
    if (!self->is_learning)
        ui_hint(on, "Move a finger, then click the contact that it is to pull.");
    if (self->learnt[0])
        ui_text_wrapped(on, UI_STYLE_DIM, self->learnt);
}
