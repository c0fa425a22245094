#include "window/menus.h"
#include "window/app/browser.h"
#include "window/open_any.h"

#include "base/file.h"
#include "base/installed.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#ifndef MAROTTE_VERSION
#error "the build sets MAROTTE_VERSION"
#endif

static const char menu_id[] = "window_menu", palette_dialog[] = "palette", about_dialog[] = "about";

enum { FOUND_SHOWN = 12 }; /* rows of the search */

void menus_init(menus *out, app *of, ui *on, dialogs *with)
{
    *out = (menus){.app = of, .ui = on, .dialogs = with};
}

static void run(menus *self, action of)
{
    app_do(self->app, of);
}

/* ---- the menu of the window ---- */

static const action menu_actions[] = {
    ACTION_NEW,  ACTION_OPEN,   ACTION_NONE, ACTION_SAVE_AS, ACTION_SAVE,    ACTION_EXPORT,
    ACTION_NONE, ACTION_UNDO,   ACTION_REDO, ACTION_NONE,    ACTION_PALETTE, ACTION_HELP,
    ACTION_NONE, ACTION_GUIDES, ACTION_TOUR, ACTION_ABOUT,   ACTION_NONE,    ACTION_QUIT,
};
enum { MENU_ACTIONS = sizeof menu_actions / sizeof menu_actions[0] };

static void draw_action(menus *self, action of)
{
    char keys[KEY_WORDS];
    key_map_words(&app_looks_of(self->app)->keys, of, keys);
    if (ui_menu_item(self->ui, action_of(of)->title, keys, app_can(self->app, of, NULL)))
        run(self, of);
    ui_hint(self->ui, action_of(of)->help);
}

static void draw_recent(menus *self)
{
    const char *recent[OPEN_RECENT_MAX];
    const uint32_t count = open_recent(app_settings(self->app), recent);
    for (uint32_t i = 0; i < count; ++i) {
        char label[OPEN_NAME + 24];
        (void)snprintf(label, sizeof label, "%.*s##recent%u", OPEN_NAME, file_name_of(recent[i]),
                       i);
        if (ui_menu_item(self->ui, label, i == 0 ? "Recent" : "", true))
            dialogs_drop(self->dialogs, recent[i]);
        ui_hint(self->ui, recent[i]);
    }
    if (count > 0)
        ui_rule(self->ui);
}

static void draw_items(menus *self)
{
    bool has_recent = false;
    for (uint32_t i = 0; i < MENU_ACTIONS; ++i) {
        if (menu_actions[i] != ACTION_NONE) {
            draw_action(self, menu_actions[i]);
            continue;
        }
        ui_rule(self->ui);
        if (!has_recent)
            draw_recent(self);
        has_recent = true;
    }
}

static void draw_menu(menus *self, float x, float y)
{
    ui_panel_begin(self->ui, menu_id, (ui_rectangle){x, y, 1.0f, 1.0f}, UI_GROUND_NONE);
    if (app_take_request(self->app, ACTION_MENU))
        ui_menu_open(self->ui, menu_id, x, y);
    if (ui_open_menu_begin(self->ui, menu_id)) {
        draw_items(self);
        ui_menu_end(self->ui);
    }
    ui_panel_end(self->ui);
}

/* ---- the search for a command ---- */

/* Returns whether the text has the word, in any case. */
static bool has_word(const char *text, const char *word, size_t length)
{
    for (; *text; ++text) {
        size_t i = 0;
        while (i < length && text[i] &&
               tolower((unsigned char)text[i]) == tolower((unsigned char)word[i]))
            ++i;
        if (i == length)
            return true;
    }
    return length == 0;
}

/* 0: it lacks a word; 2: its title has all words; 1: its title and its help together. */
static int match(action of, const char *sought)
{
    const action_entry *entry = action_of(of);
    bool is_title = true;
    for (const char *word = sought; *word;) {
        const size_t length = strcspn(word, " ");
        if (!has_word(entry->title, word, length)) {
            is_title = false;
            if (!has_word(entry->help, word, length) &&
                !has_word(action_group_name[entry->group], word, length))
                return 0;
        }
        word += length;
        word += strspn(word, " ");
    }
    return is_title ? 2 : 1;
}

/* Writes the actions that have all words, those with the words in their title first. Returns the
 * count. */
static uint32_t find(const char *sought, action out[ACTION_COUNT])
{
    uint32_t count = 0;
    for (int wanted = 2; wanted >= 1; --wanted)
        for (uint32_t i = 1; i < ACTION_COUNT; ++i)
            if (i != ACTION_PALETTE && match((action)i, sought) == wanted)
                out[count++] = (action)i;
    return count;
}

static bool draw_found(menus *self, action of, bool is_chosen)
{
    const char *why = "";
    char keys[KEY_WORDS], label[400];
    const bool can = app_can(self->app, of, &why);
    key_map_words(&app_looks_of(self->app)->keys, of, keys);
    (void)snprintf(label, sizeof label, "%s: %s%s%s%s%s%s##%s",
                   action_group_name[action_of(of)->group], action_of(of)->title,
                   keys[0] ? "   (" : "", keys, keys[0] ? ")" : "",
                   can ? "" : "   Not now: ", can ? "" : why, action_of(of)->name);
    ui_disabled_begin(self->ui, !can);
    const bool is_pressed = ui_row(self->ui, label, is_chosen) != UI_ROW_NONE;
    if (is_chosen)
        ui_scroll_to_row(self->ui);
    ui_disabled_end(self->ui);
    ui_hint(self->ui, action_of(of)->help);
    return is_pressed;
}

static void draw_palette(menus *self)
{
    ui *on = self->ui;
    action found[ACTION_COUNT], chosen = ACTION_NONE;
    char before[sizeof self->sought];
    if (!ui_dialog_begin(on, palette_dialog, "Find a command", 560.0f))
        return;
    memcpy(before, self->sought, sizeof before);
    if (!ui_is_typing(on))
        ui_input_take_keys(on);
    ui_width(on, -1.0f);
    (void)ui_input(on, "##sought", "Type a part of its name", self->sought, sizeof self->sought);
    const bool is_entered = ui_input_is_entered(on);
    const uint32_t count = find(self->sought, found);
    if (strcmp(before, self->sought) != 0)
        self->at = 0;
    else if (count > 0)
        self->at = (uint32_t)((int)self->at + ui_input_arrows(on) + (int)count) % count;
    ui_scroll_begin(on, "found", 0.0f, (float)FOUND_SHOWN * ui_row_height(on));
    for (uint32_t i = 0; i < count; ++i)
        if (draw_found(self, found[i], i == self->at))
            chosen = found[i];
    if (count == 0)
        ui_text(on, UI_STYLE_DIM, "No command has these words.");
    ui_scroll_end(on);
    if (is_entered && count > 0)
        chosen = found[self->at];
    const bool is_run = chosen != ACTION_NONE && app_can(self->app, chosen, NULL);
    if (is_run)
        ui_dialog_close(on);
    ui_dialog_end(on);
    if (is_run)
        run(self, chosen);
}

/* ---- about ---- */

static void draw_folder(ui *on, const char *label, file_home which)
{
    char path[1024];
    error err = {0};
    const mrt_result result = file_home_path(path, sizeof path, which, "", &err);
    ui_fact(on, label, 130.0f, UI_STYLE_BODY, result < 0 ? err.text : path);
    ui_hint(on, path);
}

static void draw_about(menus *self)
{
    ui *on = self->ui;
    if (!ui_dialog_begin(on, about_dialog, "marotte " MAROTTE_VERSION, 520.0f))
        return;
    ui_text_wrapped(on, UI_STYLE_BODY,
                    "Perform a face with your hands. A marotte is a puppet's head on a stick.");
    ui_space(on, 8.0f);
    draw_folder(on, "Shows", FILE_HOME_DOCUMENTS);
    draw_folder(on, "Settings", FILE_HOME_CONFIG);
    draw_folder(on, "Plugins, data", FILE_HOME_DATA);
    ui_space(on, 12.0f);
    if (ui_button(on, "Close", UI_ACCENT))
        ui_dialog_close(on);
    ui_dialog_end(on);
}

/* ---- the guides ---- */

static void show_guides(menus *self)
{
    char path[INSTALLED_LENGTH];
    error err = {0};
    mrt_result result = MRT_OK;
    if (installed_data(path, "guides/index.html")) {
        (void)snprintf(self->guides, sizeof self->guides, "file://%.580s", path);
        result = browser_start(&self->browser, self->guides, &err);
    } else if (installed_prefix(path)) { /* built without pandoc: the same guides as text */
        (void)snprintf(self->guides, sizeof self->guides,
                       "file://%.500s/share/doc/marotte/README.md", path);
        result = browser_start(&self->browser, self->guides, &err);
    } else {
        result = error_set(&err, MRT_ERR_IO, "the guides were not found: install marotte again");
    }
    if (result < 0)
        news_list_add(app_news(self->app), MRT_LOG_ERROR, "stage", err.text);
}

static void follow_browser(menus *self)
{
    int status = 0;
    error err = {0};
    if (self->browser == 0)
        return;
    const pid_t ended = waitpid(self->browser, &status, WNOHANG);
    if (ended == 0) {
        app_want_frame(self->app, 0.1);
        return;
    }
    if (ended == self->browser && browser_ended(status, self->guides, &err) < 0)
        news_list_add(app_news(self->app), MRT_LOG_ERROR, "stage", err.text);
    self->browser = 0;
}

void menus_draw(menus *self, float x, float y)
{
    if (app_take_request(self->app, ACTION_PALETTE)) {
        self->sought[0] = '\0';
        self->at = 0;
        ui_dialog_open(self->ui, palette_dialog);
    }
    if (app_take_request(self->app, ACTION_ABOUT))
        ui_dialog_open(self->ui, about_dialog);
    if (app_take_request(self->app, ACTION_GUIDES) && self->browser == 0)
        show_guides(self);
    follow_browser(self);
    draw_menu(self, x, y);
    draw_palette(self);
    draw_about(self);
}
