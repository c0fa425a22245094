/* The dialog that opens a show or a face: folders, files, or a path that is typed. */
#include "window/desk_state.h"

#include "place.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char dialog[] = "open";
static const char *const kind_names[DESK_OPENS_KINDS] = {"Show", "Face"};
static const char *const show_endings[] = {".marotte", NULL};
static const char *const face_endings[] = {".rig.json", ".glb", ".gltf", ".obj",
                                           ".ply",      ".off", ".stl",  NULL};
/* The faces that come with the program. */
static const char *const shipped[] = {"puppet", "moai"};

static const char *const *endings_of(desk_open_kind kind)
{
    return kind == DESK_OPENS_SHOW ? show_endings : face_endings;
}

static void go(desk *self, const char *path)
{
    desk_opening *opening = &self->opening;
    error err = {0};
    const mrt_result result =
        folder_go(&opening->at[opening->kind], path, endings_of(opening->kind), &err);
    (void)snprintf(opening->trouble, sizeof opening->trouble, "%s", result < 0 ? err.text : "");
}

/* Where the one that is open lies; else at home. */
static void go_somewhere(desk *self)
{
    const char *home = getenv("HOME");
    char path[FOLDER_PATH];
    if (self->opening.at[self->opening.kind].path[0])
        return;
    show *s = studio_show(self->studio);
    const char *of = self->opening.kind == DESK_OPENS_FACE ? studio_face_path(self->studio)
                     : s                                   ? show_path(s)
                                                           : "";
    (void)snprintf(path, sizeof path, "%s", of);
    char *slash = strrchr(path, '/');
    if (slash)
        *(slash > path ? slash : slash + 1) = '\0';
    else
        (void)snprintf(path, sizeof path, "%s", home ? home : "/");
    go(self, path);
    if (!self->opening.at[self->opening.kind].path[0])
        go(self, "/");
}

void desk_open_ask(desk *self, desk_open_kind kind)
{
    self->opening.kind = kind;
    self->opening.name[0] = self->opening.trouble[0] = '\0';
    go_somewhere(self);
    ui_dialog_open(self->ui, dialog);
}

/* ---- opening ---- */

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* A show that is typed without its ending has one all the same. */
static bool path_typed(const desk *self, char out[FOLDER_PATH])
{
    const desk_opening *opening = &self->opening;
    if (!folder_join(&opening->at[opening->kind], opening->name, out))
        return false;
    if (opening->kind == DESK_OPENS_FACE || is_folder(out) || access(out, F_OK) == 0 ||
        folder_name_ends(out, show_endings))
        return true;
    const size_t length = strlen(out);
    if (length + sizeof ".marotte" > FOLDER_PATH)
        return false;
    memcpy(out + length, ".marotte", sizeof ".marotte");
    return true;
}

static void say_newest(desk *self)
{
    const news_list *news = studio_news(self->studio);
    const uint32_t count = news_list_count(news);
    (void)snprintf(self->opening.trouble, sizeof self->opening.trouble, "%s",
                   count ? news_list_at(news, count - 1)->text : "it could not be opened");
}

static void open_path(desk *self, const char *path)
{
    if (self->opening.kind == DESK_OPENS_FACE) {
        ui_dialog_close(self->ui);
        desk_change_face(self, path);
    } else if (studio_open_show(self->studio, path) >= 0) {
        ui_dialog_close(self->ui);
    } else {
        say_newest(self);
    }
}

static void open_typed(desk *self)
{
    char path[FOLDER_PATH];
    if (!path_typed(self, path)) {
        (void)snprintf(self->opening.trouble, sizeof self->opening.trouble, "the path is too long");
    } else if (is_folder(path)) {
        go(self, path);
        self->opening.name[0] = '\0';
    } else {
        open_path(self, path);
    }
}

/* ---- drawing ---- */

static void draw_list(desk *self)
{
    ui *on = self->ui;
    const folder *at = &self->opening.at[self->opening.kind];
    char label[FOLDER_NAME + 48], chosen[FOLDER_PATH];
    bool is_double = false;
    chosen[0] = '\0';
    ui_scroll_begin(on, "files", 0.0f, 264.0f);
    for (uint32_t i = 0; i < at->count; ++i) {
        const folder_entry *entry = &at->entry[i];
        (void)snprintf(label, sizeof label, "%s%s##%u", entry->name, entry->is_folder ? "/" : "",
                       i);
        const ui_row_click click =
            ui_row(on, label, !entry->is_folder && strcmp(entry->name, self->opening.name) == 0);
        if (click == UI_ROW_NONE)
            continue;
        (void)snprintf(chosen, sizeof chosen, "%s", entry->name);
        is_double = click == UI_ROW_DOUBLE_CLICKED || entry->is_folder;
    }
    if (at->count <= 1)
        ui_text(on, UI_STYLE_DIM,
                self->opening.kind == DESK_OPENS_SHOW ? "No show is here." : "No face is here.");
    if (at->has_more)
        ui_text(on, UI_STYLE_DIM, "There are more: type the name.");
    ui_scroll_end(on);
    if (!chosen[0])
        return;
    (void)snprintf(self->opening.name, sizeof self->opening.name, "%s", chosen);
    if (is_double)
        open_typed(self);
}

static void draw_shipped(desk *self)
{
    for (size_t i = 0; i < sizeof shipped / sizeof shipped[0]; ++i) {
        const bool is_pressed = ui_button(self->ui, shipped[i], UI_PLAIN);
        ui_same_line(self->ui);
        if (!is_pressed)
            continue;
        char *path = place_face(shipped[i]);
        if (path)
            open_path(self, path);
        free(path);
    }
    ui_text(self->ui, UI_STYLE_DIM, "come with marotte");
}

static void draw_buttons(desk *self)
{
    ui *on = self->ui;
    char path[FOLDER_PATH];
    const bool is_new = self->opening.kind == DESK_OPENS_SHOW && self->opening.name[0] &&
                        path_typed(self, path) && access(path, F_OK) != 0;
    if (self->opening.trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->opening.trouble);
    ui_space(on, 8.0f);
    ui_disabled_begin(on, !self->opening.name[0]);
    if (ui_button(on, is_new ? "Create##go" : "Open##go", UI_ACCENT))
        open_typed(self);
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_PLAIN))
        ui_dialog_close(on);
}

void desk_open_draw(desk *self)
{
    ui *on = self->ui;
    desk_opening *opening = &self->opening;
    uint32_t kind = opening->kind;
    if (!ui_dialog_begin(on, dialog, "Open", 560.0f))
        return;
    if (ui_tabs(on, "kinds", kind_names, DESK_OPENS_KINDS, &kind)) {
        opening->kind = (desk_open_kind)kind;
        opening->name[0] = opening->trouble[0] = '\0';
        go_somewhere(self);
    }
    ui_space(on, 4.0f);
    if (opening->kind == DESK_OPENS_FACE)
        draw_shipped(self);
    ui_text(on, UI_STYLE_DIM, opening->at[opening->kind].path);
    draw_list(self);
    ui_space(on, 4.0f);
    const bool is_show = opening->kind == DESK_OPENS_SHOW;
    ui_width(on, -1.0f);
    (void)ui_input(on, "##name", is_show ? "Name of a show, also of a new one" : "Name or path",
                   opening->name, sizeof opening->name);
    if (ui_pressed(on, UI_KEY_ENTER, 0) && opening->name[0])
        open_typed(self);
    draw_buttons(self);
    ui_dialog_end(on);
}
