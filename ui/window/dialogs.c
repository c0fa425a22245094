#include "window/dialogs.h"
#include "base/file.h"
#include "base/installed.h"
#include "window/app/settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- the desktop's own file dialog ---- */

/* How long the desktop has to begin to ask; 0: it is never asked. */
static const char wait_key[] = "open.desktop_wait_s";
static const double wait_s = 4.0;
static const float file_day_width = 142.0f, file_facts_width = 224.0f; /* points */

static void forget_desktop(dialogs_desktop *self)
{
    portal_close(self->asked);
    self->asked = NULL;
}

static void ask_desktop(dialogs *self, dialogs_desktop *with, portal_question question)
{
    forget_desktop(with);
    question.patience_s = settings_number(app_settings(self->app), wait_key, wait_s);
    with->asked = question.patience_s > 0.0 ? portal_ask(&question) : NULL;
}

/* Each frame. Our dialog may have been closed, by whatever: the desktop's goes with it. */
static bool goes_with(dialogs_desktop *self, bool is_shown)
{
    if (self->is_shown && !is_shown)
        forget_desktop(self);
    self->is_shown = is_shown;
    return is_shown;
}

/* PORTAL_WAITS too where nobody is asked. What is answered ends it. */
static portal_answer look_at_desktop(dialogs_desktop *self, app *of, char out_path[PORTAL_PATH])
{
    const portal_answer answer = self->asked ? portal_look(self->asked, out_path) : PORTAL_WAITS;
    self->asks = answer == PORTAL_ASKS;
    if (self->asked)
        app_want_frame(of, 0.05);
    if (answer > PORTAL_ASKS)
        forget_desktop(self);
    return answer;
}

static void say_desktop(ui *on, const dialogs_desktop *self)
{
    if (self->asked)
        ui_text(on, UI_STYLE_DIM,
                self->asks ? "Choose the file in the dialog of the desktop."
                           : "Opening the dialog of the desktop.");
}

/* ---- unsaved work and running exports, before the program quits or opens another face ---- */

/* ---- work that is not saved ---- */

static const char unsaved_dialog[] = "unsaved", exporting_dialog[] = "exporting";

static void ask_about_exports(dialogs *self)
{
    self->leaving = DIALOGS_QUITS;
    self->failed_exports = app_exports_failed(self->app);
    self->waits_for_exports = false;
    ui_dialog_open(self->ui, exporting_dialog);
}

static void go_on(dialogs *self)
{
    const dialogs_leaving what = self->leaving;
    self->leaving = DIALOGS_STAYS;
    if (what == DIALOGS_QUITS && exporter_count(app_exporter(self->app)) > 0)
        ask_about_exports(self);
    else if (what == DIALOGS_QUITS)
        self->is_over = true;
    else if (what == DIALOGS_CHANGES_FACE)
        (void)!open_any(self->app, self->next_face); /* so is what is wrong */
}

static void leave(dialogs *self, dialogs_leaving what)
{
    self->leaving = what;
    if (app_unsaved_now(self->app))
        ui_dialog_open(self->ui, unsaved_dialog);
    else
        go_on(self);
}

void dialogs_quit(dialogs *self)
{
    if (self->leaving != DIALOGS_QUITS)
        leave(self, DIALOGS_QUITS);
}

static void change_face(dialogs *self, const char *path)
{
    (void)snprintf(self->next_face, sizeof self->next_face, "%s", path);
    leave(self, DIALOGS_CHANGES_FACE);
}

static void stay(dialogs *self)
{
    self->leaving = DIALOGS_STAYS;
    app_stay(self->app);
}

static void save_and_go(dialogs *self, const app_unsaved *unsaved)
{
    error err = {0};
    if (app_report(self->app, unsaved->save(unsaved->owner, &err), &err) >= 0)
        go_on(self);
    else
        stay(self);
}

static void draw_unsaved(dialogs *self)
{
    ui *on = self->ui;
    const app_unsaved *now = app_unsaved_now(self->app);
    char words[EDIT_TEXT + 40];
    if (!ui_dialog_begin(on, unsaved_dialog, "Not saved yet", 440.0f)) {
        if (self->leaving != DIALOGS_STAYS && self->asks)
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
        const app_unsaved copy = now ? *now : (app_unsaved){.owner = NULL};
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

/* The exports ended while the dialog was open: failures are shown before the program quits. */
static void exports_ended(dialogs *self)
{
    self->asks_exports = false;
    ui_dialog_close(self->ui);
    if (app_exports_failed(self->app) != self->failed_exports)
        stay(self);
    else
        self->is_over = true;
}

static void draw_answers(dialogs *self)
{
    ui *on = self->ui;
    ui_disabled_begin(on, self->waits_for_exports);
    if (ui_button(on, "Quit when done", UI_ACCENT))
        self->waits_for_exports = true;
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Cancel and quit", UI_PLAIN)) {
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

static void draw_exporting(dialogs *self)
{
    ui *on = self->ui;
    const bool is_one = exporter_count(app_exporter(self->app)) == 1;
    if (!ui_dialog_begin(on, exporting_dialog, "An export is running", 520.0f)) {
        if (self->asks_exports)
            stay(self); /* Escape */
        self->asks_exports = false;
        return;
    }
    self->asks_exports = true;
    if (exporter_count(app_exporter(self->app)) == 0) {
        exports_ended(self);
        ui_dialog_end(on);
        return;
    }
    export_page_list_going(on, self->app);
    if (self->waits_for_exports)
        ui_text(on, UI_STYLE_DIM, "marotte quits when the last export has ended.");
    else
        ui_text(on, UI_STYLE_BODY,
                is_one ? "Quitting cancels it. Its file will not be written."
                       : "Quitting cancels them. Their files will not be written.");
    ui_space(on, 8.0f);
    draw_answers(self);
    ui_dialog_end(on);
}

/* ---- the open dialog: folders, files, recent files, or a typed path ---- */

static const char open_dialog[] = "open";
static const char *const kind_names[OPEN_KINDS] = {"All",   "Shows",  "Faces",
                                                   "Hands", "Voices", "Pictures"};
static const char *const kind_keys[OPEN_KINDS] = {"open.any",   "open.show",  "open.face",
                                                  "open.hands", "open.voice", "open.picture"};
static const char *const kind_nothing[OPEN_KINDS] = {
    "This folder has no file that marotte can open.",
    "This folder has no show.",
    "This folder has no face.",
    "This folder has no recorded hand.",
    "This folder has no sound.",
    "No picture (PNG, JPEG) is here."};
/* The faces that come with the program. */
static const char *const shipped[] = {"puppet", "moai"};

static void go(dialogs *self, const char *path)
{
    dialogs_opening *opening = &self->opening;
    opening->trouble = (error){""};
    if (open_folder_go(&opening->at[opening->kind], path, open_endings(opening->kind),
                       &opening->trouble) >= 0)
        settings_set_text(app_settings(self->app), kind_keys[opening->kind],
                          opening->at[opening->kind].path);
}

/* Cuts "/home/me/a.glb" to /home/me, and "/a.glb" to /. False: the path has no folder. */
static bool cut_to_folder(char *path)
{
    char *slash = strrchr(path, '/');
    if (slash)
        *(slash > path ? slash : slash + 1) = '\0';
    return slash != NULL;
}

/* Where one of its kind was looked for last, in this run or another; else where the one that is
 * open lies, or at home. */
static void go_somewhere(dialogs *self)
{
    const char *home = getenv("HOME");
    char path[OPEN_PATH];
    const open_kind kind = self->opening.kind;
    if (self->opening.at[kind].path[0]) {
        go(self, self->opening.at[kind].path); /* unchanged */
        return;
    }
    const char *last = settings_text(app_settings(self->app), kind_keys[kind], "");
    if (last[0])
        go(self, last);
    if (self->opening.at[kind].path[0])
        return;
    show *s = app_show(self->app);
    const char *of = kind == OPEN_FACE ? app_face_path(self->app) : s ? show_path(s) : "";
    (void)snprintf(path, sizeof path, "%s", of);
    if (!cut_to_folder(path))
        (void)snprintf(path, sizeof path, "%s", home ? home : "/");
    go(self, path);
    if (!self->opening.at[self->opening.kind].path[0])
        go(self, "/");
}

/* The kind that is wanted first; then all, then the others. */
static void open_by_desktop(dialogs *self)
{
    const open_kind kind = self->opening.kind;
    portal_filter filter[OPEN_KINDS] = {{kind_names[kind], open_endings(kind)}};
    uint32_t count = 1;
    for (open_kind i = OPEN_ANY; i < OPEN_KINDS; ++i)
        if (i != kind)
            filter[count++] = (portal_filter){kind_names[i], open_endings(i)};
    ask_desktop(self, &self->opening.desktop,
                (portal_question){.title = "Open",
                                  .folder = self->opening.at[kind].path,
                                  .name = "",
                                  .filter = filter,
                                  .filter_count = count});
}

void dialogs_ask_open(dialogs *self, open_kind kind)
{
    self->opening.kind = kind;
    self->opening.is_asked_first = true;
    self->opening.desktop.is_shown = false;
    self->opening.name[0] = '\0';
    self->opening.trouble = (error){""};
    go_somewhere(self);
    open_by_desktop(self);
    ui_dialog_open(self->ui, open_dialog);
}

/* ---- opening ---- */

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* A show that is typed without its ending has one all the same. */
static bool path_typed(const dialogs *self, char out[OPEN_PATH])
{
    const dialogs_opening *opening = &self->opening;
    if (!open_folder_join(&opening->at[opening->kind], opening->name, out))
        return false;
    if (opening->kind > OPEN_SHOW || is_folder(out) || access(out, F_OK) == 0 ||
        open_kind_of(out) != OPEN_ANY)
        return true;
    const size_t length = strlen(out);
    if (length + sizeof ".marotte" > OPEN_PATH)
        return false;
    memcpy(out + length, ".marotte", sizeof ".marotte");
    return true;
}

static void say_not_there(dialogs *self, const char *path)
{
    (void)error_set(&self->opening.trouble, MRT_ERR_IO, "%.900s does not exist", path);
}

static void open_path(dialogs *self, const char *path)
{
    if (open_kind_of(path) == OPEN_FACE && access(path, F_OK) != 0) {
        say_not_there(self, path);
    } else if (open_kind_of(path) == OPEN_FACE) {
        ui_dialog_close(self->ui);
        change_face(self, path);
    } else if (open_any(self->app, path) >= 0) {
        ui_dialog_close(self->ui);
    } else {
        (void)error_set(&self->opening.trouble, MRT_ERR_IO, "%s",
                        news_list_newest(app_news(self->app)));
    }
}

void dialogs_drop(dialogs *self, const char *path)
{
    if (is_folder(path)) {
        dialogs_ask_open(self, OPEN_ANY);
        forget_desktop(&self->opening.desktop); /* its list is what is wanted */
        go(self, path);
    } else if (open_kind_of(path) == OPEN_FACE) {
        change_face(self, path);
    } else {
        (void)!open_any(self->app, path); /* the error is in the messages */
    }
}

static void open_typed(dialogs *self)
{
    char path[OPEN_PATH];
    self->opening.is_asked_first = true; /* the field, while the dialog stays */
    self->opening.trouble = (error){""};
    if (!path_typed(self, path)) {
        (void)error_set(&self->opening.trouble, MRT_ERR_ARGUMENT, "the path is too long");
    } else if (is_folder(path)) {
        go(self, path);
        self->opening.name[0] = '\0';
    } else {
        open_path(self, path);
    }
}

/* Opens the selected file. Never creates it: for a new show the user types its name. */
static void open_chosen(dialogs *self, const char *path)
{
    char at[OPEN_PATH];
    (void)snprintf(at, sizeof at, "%s", path);
    if (is_folder(path)) {
        go(self, path);
        return;
    }
    (void)cut_to_folder(at);
    go(self, at);
    if (access(path, F_OK) == 0)
        open_path(self, path);
    else
        say_not_there(self, path);
}

static void look_what_to_open(dialogs *self)
{
    dialogs_opening *opening = &self->opening;
    char path[PORTAL_PATH];
    const portal_answer answer = look_at_desktop(&opening->desktop, self->app, path);
    if (answer > PORTAL_ASKS)
        opening->is_asked_first = true; /* the list, if it stays */
    if (answer == PORTAL_CHOSEN)
        open_chosen(self, path);
    else if (answer == PORTAL_CANCELLED)
        ui_dialog_close(self->ui);
}

/* ---- drawing ---- */

/* Draws the recent files. Returns true to open `chosen`. */
static bool draw_recent(dialogs *self, char chosen[OPEN_PATH])
{
    ui *on = self->ui;
    const char *recent[OPEN_RECENT_MAX];
    const uint32_t count = open_recent(app_settings(self->app), recent);
    const open_kind kind = self->opening.kind;
    char label[OPEN_PATH + 32];
    bool is_double = false, any = false;
    for (uint32_t i = 0; i < count; ++i) {
        if ((kind != OPEN_ANY && open_kind_of(recent[i]) != kind) || access(recent[i], R_OK) != 0)
            continue;
        if (!any)
            ui_text(on, UI_STYLE_DIM, "Lately");
        any = true;
        const char *slash = strrchr(recent[i], '/');
        const char *name = slash ? slash + 1 : recent[i];
        (void)snprintf(label, sizeof label, "%s   in %.*s##recent%u", name,
                       slash ? (int)(slash - recent[i]) : 0, recent[i], i);
        const ui_row_click click = ui_row(on, label, strcmp(recent[i], self->opening.name) == 0);
        if (click == UI_ROW_NONE)
            continue;
        (void)snprintf(chosen, OPEN_PATH, "%s", recent[i]);
        is_double = click == UI_ROW_DOUBLE_CLICKED;
    }
    if (any != (self->opening.desktop.asked != NULL))
        ui_text(on, UI_STYLE_DIM, any ? "Here" : "No recent files.");
    return is_double;
}

static void say_size(char *out, size_t capacity, uint64_t bytes)
{
    if (bytes < 1000000)
        (void)snprintf(out, capacity, "%.0f KB", ceil((double)bytes / 1e3));
    else if (bytes < 1000000000)
        (void)snprintf(out, capacity, "%.1f MB", (double)bytes / 1e6);
    else
        (void)snprintf(out, capacity, "%.1f GB", (double)bytes / 1e9);
}

/* How large a file is and when it was changed, at the end of its row. */
static void draw_file_facts(ui *on, const open_entry *entry, float end)
{
    char size[32], day[32] = "";
    struct tm changed;
    const time_t changed_s = (time_t)entry->changed_s;
    say_size(size, sizeof size, entry->bytes);
    if (!localtime_r(&changed_s, &changed) ||
        strftime(day, sizeof day, "%Y-%m-%d %H:%M", &changed) == 0)
        day[0] = '\0';
    ui_same_line(on);
    ui_at(on, end - file_day_width - ui_text_width(on, UI_STYLE_DIM, size));
    ui_text(on, UI_STYLE_DIM, size);
    ui_same_line(on);
    ui_at(on, end - ui_text_width(on, UI_STYLE_DIM, day));
    ui_text(on, UI_STYLE_DIM, day);
}

/* Draws the files of the folder. Returns true to open `chosen`. */
static bool draw_files(dialogs *self, char chosen[OPEN_PATH])
{
    ui *on = self->ui;
    const open_folder *at = &self->opening.at[self->opening.kind];
    char label[OPEN_NAME + 48];
    bool is_double = false;
    const float end = ui_available_width(on) - 7.0f;
    for (uint32_t i = 0; i < at->count; ++i) {
        const open_entry *entry = &at->entry[i];
        (void)snprintf(label, sizeof label, "%s%s##%u", entry->name, entry->is_folder ? "/" : "",
                       i);
        ui_width(on, entry->is_folder ? 0.0f : -file_facts_width);
        const ui_row_click click =
            ui_row(on, label, !entry->is_folder && strcmp(entry->name, self->opening.name) == 0);
        ui_hint(on, entry->name);
        if (!entry->is_folder)
            draw_file_facts(on, entry, end);
        if (click == UI_ROW_NONE)
            continue;
        (void)snprintf(chosen, OPEN_PATH, "%s", entry->name);
        is_double = click == UI_ROW_DOUBLE_CLICKED || entry->is_folder;
    }
    if (at->count <= 1)
        ui_text(on, UI_STYLE_DIM, kind_nothing[self->opening.kind]);
    if (at->has_more)
        ui_text(on, UI_STYLE_DIM, "There are more files: type the name.");
    return is_double;
}

static void draw_list(dialogs *self)
{
    ui *on = self->ui;
    char chosen[OPEN_PATH];
    chosen[0] = '\0';
    ui_scroll_begin(on, "files", 0.0f, self->opening.desktop.asked ? 150.0f : 264.0f);
    bool is_double = draw_recent(self, chosen);
    if (!self->opening.desktop.asked)
        is_double = draw_files(self, chosen) || is_double;
    ui_scroll_end(on);
    if (!chosen[0])
        return;
    (void)snprintf(self->opening.name, sizeof self->opening.name, "%s", chosen);
    if (is_double)
        open_typed(self);
}

static void draw_shipped(dialogs *self)
{
    for (size_t i = 0; i < sizeof shipped / sizeof shipped[0]; ++i) {
        const bool is_pressed = ui_button(self->ui, shipped[i], UI_PLAIN);
        ui_same_line(self->ui);
        if (!is_pressed)
            continue;
        char *path = installed_path(INSTALLED_FACE, shipped[i]);
        if (path)
            open_path(self, path);
        free(path);
    }
    ui_text(self->ui, UI_STYLE_DIM, "come with marotte");
}

/* The choice is kept. */
static void draw_whose_list(dialogs *self)
{
    ui *on = self->ui;
    settings *kept = app_settings(self->app);
    const bool is_desktops = self->opening.desktop.asked != NULL;
    if (!is_desktops && settings_number(kept, wait_key, wait_s) > 0.0)
        return; /* there is none */
    ui_same_line(on);
    const bool is_pressed =
        ui_button(on, is_desktops ? "List in this window" : "Desktop's dialog", UI_QUIET);
    ui_hint(on, is_desktops ? "Close the dialog of the desktop, and list files here in future."
                            : "Choose files in the dialog of the desktop in future.");
    if (!is_pressed)
        return;
    settings_set_number(kept, wait_key, is_desktops ? 0.0 : wait_s);
    self->opening.is_asked_first = true;
    forget_desktop(&self->opening.desktop);
    if (!is_desktops)
        open_by_desktop(self);
}

static void draw_buttons(dialogs *self)
{
    ui *on = self->ui;
    char path[OPEN_PATH];
    const bool is_new = self->opening.name[0] && path_typed(self, path) &&
                        open_kind_of(path) == OPEN_SHOW && access(path, F_OK) != 0;
    if (self->opening.trouble.text[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->opening.trouble.text);
    ui_space(on, 8.0f);
    ui_disabled_begin(on, !self->opening.name[0]);
    if (ui_button(on, is_new ? "Create##go" : "Open##go", UI_ACCENT))
        open_typed(self);
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_PLAIN))
        ui_dialog_close(on);
    draw_whose_list(self);
}

static void draw_tabs(dialogs *self)
{
    dialogs_opening *opening = &self->opening;
    uint32_t kind = opening->kind;
    if (ui_tabs(self->ui, "kinds", kind_names, OPEN_KINDS, &kind)) {
        opening->kind = (open_kind)kind;
        opening->name[0] = '\0';
        opening->trouble = (error){""};
        go_somewhere(self);
    }
}

static void draw_open(dialogs *self)
{
    ui *on = self->ui;
    dialogs_opening *opening = &self->opening;
    if (!goes_with(&opening->desktop, ui_dialog_begin(on, open_dialog, "Open", 560.0f)))
        return;
    look_what_to_open(self);
    say_desktop(on, &opening->desktop);
    if (!opening->desktop.asked)
        draw_tabs(self);
    ui_space(on, 4.0f);
    if (opening->kind == OPEN_FACE || opening->desktop.asked)
        draw_shipped(self);
    if (!opening->desktop.asked)
        ui_text(on, UI_STYLE_DIM, opening->at[opening->kind].path);
    draw_list(self);
    ui_space(on, 4.0f);
    ui_width(on, -1.0f);
    if (opening->is_asked_first)
        ui_input_take_keys(on);
    opening->is_asked_first = false;
    (void)ui_input(on, "##name",
                   opening->kind <= OPEN_SHOW ? "Name or path; a new name makes a show"
                                              : "Name or path",
                   opening->name, sizeof opening->name);
    draw_buttons(self);
    ui_dialog_end(on);
}

/* ---- save as: work continues in the new file ---- */

static const char save_dialog[] = "save as";
static const char *const saved_names[] = {"The show", "The rig"};
static const char *const show_endings[] = {".marotte", NULL}, *const rig_endings[] = {".rig.json",
                                                                                      NULL};

static const char *const *endings_of(const dialogs_saving *saving)
{
    return saving->is_rig ? rig_endings : show_endings;
}

static const char *path_of_old(const dialogs *self)
{
    const show *s = app_show(self->app);
    return self->saving.is_rig ? app_rig_path(self->app) : s ? show_path(s) : "";
}

/* A name alone is one in the folder of the old file. */
static void put_saved_folder(dialogs *self)
{
    dialogs_saving *saving = &self->saving;
    const char *of = path_of_old(self), *slash = strrchr(of, '/');
    char whole[OPEN_PATH];
    if (!slash || strchr(saving->file, '/') ||
        snprintf(whole, sizeof whole, "%.*s%s", (int)(slash + 1 - of), of, saving->file) >=
            (int)sizeof whole)
        return;
    memcpy(saving->file, whole, strlen(whole) + 1);
}

static void put_saved_ending(dialogs_saving *saving)
{
    const char *ending = endings_of(saving)[0];
    const size_t length = strlen(saving->file);
    if (length > 0 && saving->file[length - 1] != '/' &&
        !open_name_ends(saving->file, endings_of(saving)) &&
        length + strlen(ending) < sizeof saving->file)
        memcpy(saving->file + length, ending, strlen(ending) + 1);
}

/* "night.marotte" gives "night 2.marotte", or the next that is free. */
static void put_free_name(dialogs *self)
{
    dialogs_saving *saving = &self->saving;
    const char *of = path_of_old(self);
    size_t stem = strlen(of);
    if (open_name_ends(of, endings_of(saving)))
        stem -= strlen(endings_of(saving)[0]);
    for (uint32_t number = 2; number < 1000; ++number) {
        (void)snprintf(saving->file, sizeof saving->file, "%.*s %u%s", (int)stem, of, number,
                       endings_of(saving)[0]);
        if (access(saving->file, F_OK) != 0)
            return;
    }
}

static void choose_saved(dialogs *self, bool is_rig)
{
    dialogs_saving *saving = &self->saving;
    const portal_filter filter = {is_rig ? "Rigs" : "Shows", is_rig ? rig_endings : show_endings};
    char at[OPEN_PATH];
    saving->is_rig = is_rig;
    saving->trouble = (error){""};
    saving->replaced[0] = '\0';
    saving->is_asked_first = true;
    put_free_name(self);
    (void)snprintf(at, sizeof at, "%s", saving->file);
    ask_desktop(self, &saving->desktop,
                (portal_question){.is_saving = true,
                                  .title = is_rig ? "Save the rig as" : "Save the show as",
                                  .folder = cut_to_folder(at) ? at : "",
                                  .name = file_name_of(saving->file),
                                  .filter = &filter,
                                  .filter_count = 1});
}

void dialogs_ask_save_as(dialogs *self)
{
    if (!app_show(self->app) && !app_rig_path(self->app)) {
        news_list_add(app_news(self->app), MRT_LOG_INFO, "stage", "there is nothing to save");
        return;
    }
    self->saving.desktop.is_shown = false;
    choose_saved(self, app_rig_path(self->app) &&
                           (app_looks_of(self->app)->layouts.now.current == APP_RIG ||
                            !app_show(self->app)));
    ui_dialog_open(self->ui, save_dialog);
}

/* Replaces an existing rig at the second request; never replaces a show. */
static void save_as(dialogs *self)
{
    dialogs_saving *saving = &self->saving;
    put_saved_folder(self);
    put_saved_ending(saving);
    if (saving->is_rig && access(saving->file, F_OK) == 0 &&
        strcmp(saving->replaced, saving->file) != 0) {
        (void)snprintf(saving->replaced, sizeof saving->replaced, "%s", saving->file);
        (void)error_set(&saving->trouble, MRT_ERR_ARGUMENT,
                        "%.900s already exists. Press Save again to replace it.", saving->file);
        return;
    }
    saving->trouble = (error){""};
    const mrt_result result = saving->is_rig
                                  ? app_save_rig_as(self->app, saving->file, &saving->trouble)
                                  : app_save_show_as(self->app, saving->file, &saving->trouble);
    if (result >= 0)
        ui_dialog_close(self->ui);
}

static void look_where_to_save(dialogs *self)
{
    dialogs_saving *saving = &self->saving;
    char path[PORTAL_PATH];
    const portal_answer answer = look_at_desktop(&saving->desktop, self->app, path);
    if (answer == PORTAL_CANCELLED)
        ui_dialog_close(self->ui);
    if (answer != PORTAL_CHOSEN)
        return;
    (void)snprintf(saving->file, sizeof saving->file, "%s", path);
    (void)snprintf(saving->replaced, sizeof saving->replaced, "%s", path); /* it has asked */
    save_as(self);
}

static void draw_saving(dialogs *self)
{
    ui *on = self->ui;
    dialogs_saving *saving = &self->saving;
    uint32_t which = saving->is_rig;
    if (!goes_with(&saving->desktop, ui_dialog_begin(on, save_dialog, "Save as", 520.0f)))
        return;
    look_where_to_save(self);
    if (app_rig_path(self->app) && app_show(self->app) &&
        ui_tabs(on, "saved", saved_names, 2, &which))
        choose_saved(self, which == 1);
    say_desktop(on, &saving->desktop);
    ui_space(on, 4.0f);
    ui_width(on, -1.0f);
    if (saving->is_asked_first)
        ui_input_take_keys(on);
    saving->is_asked_first = false;
    (void)ui_input(on, "##saved", "Path of the file", saving->file, sizeof saving->file);
    ui_text_wrapped(on, UI_STYLE_DIM,
                    saving->is_rig
                        ? "In the folder of the mesh, or above it. You continue with the new file."
                        : "A copy of everything recorded. You continue with the copy.");
    if (saving->trouble.text[0])
        ui_text_wrapped(on, UI_STYLE_BAD, saving->trouble.text);
    ui_space(on, 8.0f);
    ui_disabled_begin(on, !saving->file[0]);
    if (ui_button(on, "Save##as", UI_ACCENT))
        save_as(self);
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_PLAIN))
        ui_dialog_close(on);
    ui_dialog_end(on);
}

/* ---- all of them ---- */

void dialogs_init(dialogs *out, app *of, ui *on)
{
    *out = (dialogs){.app = of, .ui = on};
    export_page_init(&out->exports, of, on);
}

void dialogs_finish(dialogs *self)
{
    forget_desktop(&self->opening.desktop);
    forget_desktop(&self->saving.desktop);
    for (uint32_t i = 0; i < OPEN_KINDS; ++i)
        open_folder_finish(&self->opening.at[i]);
}

void dialogs_draw(dialogs *self)
{
    draw_open(self);
    draw_saving(self);
    export_page_draw(&self->exports);
    draw_unsaved(self);
    draw_exporting(self);
}
