/* Before the program ends or another face comes: what becomes of work that is not saved, and of
 * exports that go on. */
#include "window/desk_state.h"

#include <stdio.h>

/* ---- work that is not saved ---- */

static const char unsaved_dialog[] = "unsaved", exporting_dialog[] = "exporting";

static void ask_about_exports(desk *self)
{
    self->leaving = DESK_QUITS;
    self->failed_exports = studio_exports_failed(self->studio);
    self->waits_for_exports = false;
    ui_dialog_open(self->ui, exporting_dialog);
}

static void go_on(desk *self)
{
    const desk_leaving what = self->leaving;
    self->leaving = DESK_STAYS;
    if (what == DESK_QUITS && studio_exports_going(self->studio) > 0)
        ask_about_exports(self);
    else if (what == DESK_QUITS)
        self->is_over = true;
    else if (what == DESK_CHANGES_FACE)
        (void)!studio_open_face(self->studio, self->next_face);
}

static void leave(desk *self, desk_leaving what)
{
    self->leaving = what;
    if (studio_unsaved_now(self->studio))
        ui_dialog_open(self->ui, unsaved_dialog);
    else
        go_on(self);
}

void desk_quit(desk *self)
{
    if (self->leaving != DESK_QUITS)
        leave(self, DESK_QUITS);
}

void desk_change_face(desk *self, const char *path)
{
    (void)snprintf(self->next_face, sizeof self->next_face, "%s", path);
    leave(self, DESK_CHANGES_FACE);
}

static void stay(desk *self)
{
    self->leaving = DESK_STAYS;
    studio_stay(self->studio);
}

static void save_and_go(desk *self, const studio_unsaved *unsaved)
{
    error err = {0};
    if (unsaved->save(unsaved->owner, &err) >= 0) {
        go_on(self);
        return;
    }
    news_list_add(studio_news(self->studio), MRT_LOG_ERROR, "stage", err.text);
    stay(self);
}

static void draw_unsaved(desk *self)
{
    ui *on = self->ui;
    const studio_unsaved *now = studio_unsaved_now(self->studio);
    char words[EDIT_TEXT + 40];
    if (!ui_dialog_begin(on, unsaved_dialog, "Not saved yet", 440.0f)) {
        if (self->leaving != DESK_STAYS && self->asks)
            stay(self); /* Escape */
        self->asks = false;
        return;
    }
    self->asks = true;
    (void)snprintf(words, sizeof words, "%s has changes that are not saved.",
                   now ? now->words : "the rig");
    words[0] = (char)(words[0] >= 'a' && words[0] <= 'z' ? words[0] - 'a' + 'A' : words[0]);
    ui_text_wrapped(on, UI_STYLE_BODY, words);
    ui_space(on, 8.0f);
    const bool saves = ui_button(on, "Save", UI_ACCENT);
    ui_same_line(on);
    const bool leaves = ui_button(on, "Don't save", UI_PLAIN);
    ui_same_line(on);
    const bool stays = ui_button(on, "Stay", UI_PLAIN);
    if (saves || leaves || stays) {
        const studio_unsaved copy = now ? *now : (studio_unsaved){.owner = NULL};
        self->asks = false;
        ui_dialog_close(on);
        if (stays)
            stay(self);
        else if (saves && copy.save)
            save_and_go(self, &copy);
        else {
            if (leaves && copy.leave)
                copy.leave(copy.owner);
            go_on(self);
        }
    }
    ui_dialog_end(on);
}

/* ---- exports that go on ---- */

/* They ended while it was asked: what has failed is read before the program goes. */
static void exports_ended(desk *self)
{
    self->asks_exports = false;
    ui_dialog_close(self->ui);
    if (studio_exports_failed(self->studio) != self->failed_exports)
        stay(self);
    else
        self->is_over = true;
}

static void draw_answers(desk *self)
{
    ui *on = self->ui;
    ui_disabled_begin(on, self->waits_for_exports);
    if (ui_button(on, "Quit when done", UI_ACCENT))
        self->waits_for_exports = true;
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Give up and quit", UI_PLAIN)) {
        self->asks_exports = false;
        self->is_over = true;
        ui_dialog_close(on);
    }
    ui_same_line(on);
    if (ui_button(on, "Stay", UI_PLAIN)) {
        self->asks_exports = false;
        ui_dialog_close(on);
        stay(self);
    }
}

static void draw_exporting(desk *self)
{
    ui *on = self->ui;
    const bool is_one = studio_exports_going(self->studio) == 1;
    if (!ui_dialog_begin(on, exporting_dialog, "An export goes on", 520.0f)) {
        if (self->asks_exports)
            stay(self); /* Escape */
        self->asks_exports = false;
        return;
    }
    self->asks_exports = true;
    if (studio_exports_going(self->studio) == 0) {
        exports_ended(self);
        ui_dialog_end(on);
        return;
    }
    desk_exports_list(self);
    if (self->waits_for_exports)
        ui_text(on, UI_STYLE_DIM, "The program ends with the last of them.");
    else
        ui_text(on, UI_STYLE_BODY,
                is_one ? "It ends with the program: nothing of it would be left."
                       : "They end with the program: nothing of them would be left.");
    ui_space(on, 8.0f);
    draw_answers(self);
    ui_dialog_end(on);
}

void desk_leave_draw(desk *self)
{
    draw_unsaved(self);
    draw_exporting(self);
}
