#include "window/export_page.h"
#include "base/file.h"
#include "draw/scenery.h"
#include "io/export_formats.h"
#include "stream/video.h"
#include "show/export_name.h"
#include "window/app/kept_scenery.h"
#include "window/app/settings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- what can be chosen ---- */

static const char page_dialog[] = "export";

typedef struct format {
    const char *name, *ending, *holds;
} format;
static const format formats[] = {
#define X(format, ending, name, holds, lacks) {name, ending, "Holds: " holds ". Not: " lacks "."},
    EXPORTS_FORMATS(X)
#undef X
};
enum {
#define X(format, ending, name, holds, lacks) FORMAT_##format,
    EXPORTS_FORMATS(X)
#undef X
        FORMATS
};

typedef struct look { /* label, and option of take export; "": none */
    const char *name, *option;
} look;
static const look rates[] = {{"As in the take", ""}, {"24", "24"}, {"25", "25"},
                             {"30", "30"},           {"50", "50"}, {"60", "60"}};
static const look sizes[] = {{"1280 x 720", ""},
                             {"1920 x 1080", "1920x1080"},
                             {"2560 x 1440", "2560x1440"},
                             {"3840 x 2160", "3840x2160"},
                             {"1080 x 1920, upright", "1080x1920"},
                             {"1080 x 1080, square", "1080x1080"},
                             {"640 x 360", "640x360"},
                             {"Custom size", NULL}};
static const look views[] = {
    {"From the front", ""}, {"From the side", "side"}, {"Three-quarter view", "three-quarter"},
    {"Camera view 1", "1"}, {"Camera view 2", "2"},    {"Camera view 3", "3"},
    {"Camera view 4", "4"}, {"Camera view 5", "5"},    {"Camera view 6", "6"}};
static const look backgrounds[] = {{"The wall of the stage", ""},
                                   {"Green, for keying", "#00b140"},
                                   {"Blue, for keying", "#0047bb"},
                                   {"Black", "#000000"},
                                   {"White", "#ffffff"},
                                   {"Another colour, or a picture", NULL},
                                   {"Transparent", "transparent"}}; /* last: not of an .mp4 */
/* "NAME", ".ENDING|rate|size|view|background" */
static const look presets[] = {{"Video 1080p", ".mp4||1920x1080||"},
                               {"Video, upright", ".mp4||1080x1920||"},
                               {"Video, square", ".mp4||1080x1080||"},
                               {"Pictures to lay over a film", "/||1920x1080||transparent"},
                               {"Blender, Unity, Unreal", ".glb||||"}};
enum {
    RATES = sizeof rates / sizeof rates[0],
    SIZES = sizeof sizes / sizeof sizes[0],
    VIEWS = sizeof views / sizeof views[0],
    BACKGROUNDS = sizeof backgrounds / sizeof backgrounds[0],
    PRESETS = sizeof presets / sizeof presets[0],
    PRESETS_OWN = 32,
    CHOICES = 1 + PRESETS + PRESETS_OWN,
    EXPORT_WORDS = EXPORT_FILE + 128
};
static const char presets_key_of_exports[] = "export.preset", last_key[] = "export.last";

/* The file's name gets the ending of the format, in place of another one's. */
static void put_ending(export_page *self)
{
    char *file = self->file;
    size_t length = strlen(file);
    for (uint32_t i = 0; i < FORMATS; ++i) {
        const size_t ending = strlen(formats[i].ending);
        if (length > ending && strcmp(file + length - ending, formats[i].ending) == 0) {
            file[length -= ending] = '\0';
            break;
        }
    }
    const char *wanted = formats[self->format].ending;
    if (length > 0 && length + strlen(wanted) < sizeof self->file)
        (void)snprintf(file + length, sizeof self->file - length, "%s", wanted);
}

/* Called as the take: beside the show, or in the folder for documents if files cannot be written
 * there. */
static void put_name(export_page *self)
{
    static const char name[] = "{show}_{slate}";
    const char *of = app_show(self->app) ? show_path(app_show(self->app)) : "";
    char *folder = file_directory(of);
    if (!folder || access(folder[0] ? folder : ".", W_OK) == 0 ||
        file_home_path(self->file, EXPORT_FILE, FILE_HOME_DOCUMENTS, name, NULL) < 0)
        (void)snprintf(self->file, EXPORT_FILE, "%s%s", folder ? folder : "", name);
    free(folder);
}

static uint32_t index_of(const look *from, uint32_t count, const char *option)
{
    for (uint32_t i = 0; i < count; ++i)
        if (from[i].option && strcmp(from[i].option, option) == 0)
            return i;
    return count;
}

/* Selects a preset. Values that are not in the lists are custom; unknown ones select the first
 * entry. */
static void choose(export_page *self, const char *preset)
{
    char part[5][EXPORT_FILE] = {"", "", "", "", ""};
    const char *at = preset;
    for (int i = 0; i < 5 && at; ++i) {
        const char *bar = i < 4 ? strchr(at, '|') : NULL;
        (void)snprintf(part[i], sizeof part[i], "%.*s", bar ? (int)(bar - at) : (int)strlen(at),
                       at);
        at = bar ? bar + 1 : NULL;
    }
    self->format = 0;
    for (uint32_t i = 0; i < FORMATS; ++i)
        if (strcmp(formats[i].ending, part[0]) == 0)
            self->format = i;
    self->rate = index_of(rates, RATES, part[1]) % RATES;
    self->size = index_of(sizes, SIZES, part[2]);
    self->view = index_of(views, VIEWS, part[3]) % VIEWS;
    self->background = index_of(backgrounds, BACKGROUNDS, part[4]);
    if (self->size == SIZES) {
        self->size = SIZES - 1;
        (void)snprintf(self->own_size, sizeof self->own_size, "%.20s", part[2]);
    }
    if (self->background == BACKGROUNDS) {
        self->background = BACKGROUNDS - 2;
        (void)snprintf(self->own_background, sizeof self->own_background, "%s", part[4]);
    }
}

static const char *size_of(const export_page *self)
{
    return sizes[self->size].option ? sizes[self->size].option : self->own_size;
}

static const char *background_of(const export_page *self)
{
    const char *listed = backgrounds[self->background].option;
    return listed ? listed : self->own_background;
}

static void tell_choice(const export_page *self, char *out, size_t capacity)
{
    (void)snprintf(out, capacity, "%s|%s|%s|%s|%s", formats[self->format].ending,
                   rates[self->rate].option, size_of(self), views[self->view].option,
                   background_of(self));
}

/* Those that the format can have: H.264 has no alpha. */
static uint32_t backgrounds_of(const export_page *self)
{
    return self->format == FORMAT_MP4 ? BACKGROUNDS - 1 : BACKGROUNDS;
}

static bool is_drawn(const export_page *self)
{
    return self->format == FORMAT_MP4 || self->format == FORMAT_FOLDER;
}

/* ---- which takes ---- */

static bool is_ticked(const export_page *self, int64_t id, uint32_t *out_at)
{
    for (*out_at = 0; *out_at < self->ticked_count; ++*out_at)
        if (self->ticked[*out_at] == id)
            return true;
    return false;
}

static void tick(export_page *self, int64_t id, bool is_wanted)
{
    uint32_t at;
    const bool is_there = is_ticked(self, id, &at);
    if (is_there && !is_wanted)
        self->ticked[at] = self->ticked[--self->ticked_count];
    else if (id && !is_there && is_wanted && self->ticked_count < EXPORT_TICKS)
        self->ticked[self->ticked_count++] = id;
}

static bool can_be_exported(const app_take_line *of)
{
    return !of->is_deleted && !of->is_recording && of->duration_ns > 0;
}

/* The id of the newest take; 0: none. */
static int64_t newest(const export_page *self)
{
    const app_take_line *line;
    const uint32_t count = app_takes(self->app, &line);
    for (uint32_t i = count; i-- > 0;)
        if (can_be_exported(&line[i]))
            return line[i].id;
    return 0;
}

void export_page_ask(export_page *self)
{
    choose(self, settings_text(app_settings(self->app), last_key, ""));
    self->trouble = (error){""};
    self->replaced[0] = '\0';
    self->preset = 0;
    self->ticked_count = 0;
    tick(self, app_take_id(self->app) ? app_take_id(self->app) : newest(self), true);
    put_name(self);
    put_ending(self);
    self->is_asked_first = true;
    ui_dialog_open(self->ui, page_dialog);
}

static void draw_takes(export_page *self)
{
    ui *on = self->ui;
    const app_take_line *line;
    const uint32_t count = app_takes(self->app, &line);
    const bool wants_all = ui_button(on, "All takes", UI_PLAIN);
    ui_same_line(on);
    const bool wants_none = ui_button(on, "None", UI_PLAIN);
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t at;
        char id[32];
        if (!can_be_exported(&line[i]))
            continue;
        bool is_wanted = wants_all || (!wants_none && is_ticked(self, line[i].id, &at));
        (void)snprintf(id, sizeof id, "take%lld", (long long)line[i].id);
        ui_id_begin(on, id);
        if (ui_check(on, line[i].title, &is_wanted) || wants_all || wants_none)
            tick(self, line[i].id, is_wanted);
        ui_id_end(on);
    }
}

static mrt_result name_file(const export_page *self, const app_take_line *line, char *out,
                            error *err)
{
    const export_name_of of = {show_path(app_show(self->app)),
                               line->id,
                               line->scene,
                               line->shot,
                               line->name,
                               line->number};
    return export_name(out, EXPORT_FILE, self->file, &of, err);
}

/* Of the takes that are ticked, in the order of the list. Returns how many, or why not. */
static mrt_result name_files(export_page *self, char (*out)[EXPORT_FILE], int64_t *out_take,
                             uint32_t *out_count, error *err)
{
    const app_take_line *line;
    const uint32_t count = app_takes(self->app, &line);
    mrt_result result = MRT_OK;
    *out_count = 0;
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        uint32_t at;
        if (!is_ticked(self, line[i].id, &at))
            continue;
        out_take[*out_count] = line[i].id;
        result = name_file(self, &line[i], out[(*out_count)++], err);
    }
    for (uint32_t i = 0; i < *out_count && result >= 0; ++i)
        for (uint32_t k = 0; k < i && result >= 0; ++k)
            if (strcmp(out[i], out[k]) == 0)
                result = error_set(err, MRT_ERR_ARGUMENT,
                                   "Two takes would both be written to %s: use {take} in the name.",
                                   out[i]);
    return result;
}

/* ---- what is asked for ---- */

static bool range_of(const export_page *self, int64_t *out_in, int64_t *out_out)
{
    const transport *move = live_transport(app_live(self->app));
    *out_in = move->loop_in_ns;
    *out_out = move->loop_out_ns;
    return live_shown_take(app_live(self->app)) == app_take_id(self->app) && *out_in < *out_out &&
           self->ticked_count == 1 && self->ticked[0] == app_take_id(self->app);
}

/* Existing files are replaced at the second request. */
static bool needs_a_word(export_page *self, char (*name)[EXPORT_FILE], uint32_t count)
{
    uint32_t there = 0, first = 0;
    for (uint32_t i = count; i-- > 0;)
        if (access(name[i], F_OK) == 0) {
            there += 1;
            first = i;
        }
    if (there == 0 || (there == self->replaced_count && strcmp(self->replaced, name[first]) == 0))
        return false;
    (void)snprintf(self->replaced, sizeof self->replaced, "%s", name[first]);
    self->replaced_count = there;
    if (there == 1)
        (void)error_set(&self->trouble, MRT_ERR_ARGUMENT,
                        "%.900s already exists. Press Export again to replace it.", name[first]);
    else
        (void)error_set(
            &self->trouble, MRT_ERR_ARGUMENT,
            "%.900s and %u more files already exist. Press Export again to replace them.",
            name[first], there - 1);
    return true;
}

/* Of what was typed: as take export reads it. */
static mrt_result check_look(const export_page *self, const char *path, error *err)
{
    video_look is = video_look_default();
    const char *size = size_of(self), *background = background_of(self);
    if (!is_drawn(self))
        return MRT_OK;
    if (size != sizes[0].option && !video_look_size(&is, size))
        return error_set(err, MRT_ERR_ARGUMENT, "The size \"%s\" is not %s.", size,
                         video_look_sizes);
    if (background != backgrounds[0].option && !video_look_ground(&is, background))
        return error_set(err, MRT_ERR_ARGUMENT, "The background \"%.400s\" is not %s.", background,
                         video_look_grounds);
    if (is.picture_path && access(is.picture_path, R_OK) != 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: cannot be read.", is.picture_path);
    return self->format == FORMAT_MP4 ? video_look_check_mp4(&is, path, err) : MRT_OK;
}

static void ask_for(const export_page *self, export_request *out)
{
    const bool drawn = is_drawn(self);
    *out = (export_request){.fps = strtod(rates[self->rate].option, NULL)};
    (void)snprintf(out->size, sizeof out->size, "%s", drawn ? size_of(self) : "");
    (void)snprintf(out->view, sizeof out->view, "%s", drawn ? views[self->view].option : "");
    (void)snprintf(out->background, sizeof out->background, "%s", drawn ? background_of(self) : "");
    if (self->only_range)
        (void)range_of(self, &out->in_ns, &out->out_ns);
}

/* Those that were begun are not ticked any longer. */
static mrt_result begin_all(export_page *self, char (*name)[EXPORT_FILE], const int64_t *id,
                            uint32_t count)
{
    export_request request;
    mrt_result result = MRT_OK;
    ask_for(self, &request);
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        memcpy(request.file, name[i], sizeof request.file);
        result = app_export_take(self->app, id[i], &request);
        if (result >= 0)
            tick(self, id[i], false);
    }
    return result;
}

static void begin_export(export_page *self)
{
    char kept[EXPORT_WORDS];
    int64_t id[EXPORT_TICKS];
    uint32_t count = 0;
    error *err = &self->trouble;
    *err = (error){""};
    char(*name)[EXPORT_FILE] = malloc(EXPORT_TICKS * sizeof *name);
    mrt_result result = name ? name_files(self, name, id, &count, err)
                             : error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0 && count == 0)
        result = error_set(err, MRT_ERR_ARGUMENT, "Tick the takes to export.");
    if (result >= 0)
        result = check_look(self, name[0], err);
    const app_unsaved *unsaved = app_unsaved_now(self->app);
    if (result >= 0 && unsaved) /* an export performs the file of the rig */
        result = unsaved->save(unsaved->owner, err);
    if (result >= 0 && !needs_a_word(self, name, count)) {
        result = begin_all(self, name, id, count);
        if (result < 0)
            (void)error_set(err, result, "%s", news_list_newest(app_news(self->app)));
        tell_choice(self, kept, sizeof kept);
        settings_set_text(app_settings(self->app), last_key, kept);
        if (result >= 0)
            ui_dialog_close(self->ui);
    }
    free(name);
}

/* ---- the page ---- */

static void draw_range(export_page *self)
{
    int64_t in_ns, out_ns;
    char words[96];
    const bool has_range = range_of(self, &in_ns, &out_ns);
    if (!has_range) {
        self->only_range = false;
        return;
    }
    (void)snprintf(words, sizeof words, "Only the range, %.1f to %.1f s", 1e-9 * (double)in_ns,
                   1e-9 * (double)out_ns);
    ui_space(self->ui, 2.0f);
    (void)ui_check(self->ui, words, &self->only_range);
}

static void choose_look(ui *on, const char *words, float label, const look *from, uint32_t count,
                        uint32_t *chosen)
{
    const char *names[12];
    for (uint32_t i = 0; i < count; ++i)
        names[i] = from[i].name;
    if (*chosen >= count)
        *chosen = 0;
    (void)ui_choice(on, words, label, names, count, chosen);
}

static void draw_looks(export_page *self, float label)
{
    ui *on = self->ui;
    const uint32_t kept = kept_scenery_now(app_scenery(self->app))->view_count;
    choose_look(on, "Size", label, sizes, SIZES, &self->size);
    if (!sizes[self->size].option) {
        ui_width(on, -1.0f);
        (void)ui_input(on, "##size", "1600x900", self->own_size, sizeof self->own_size);
    }
    choose_look(on, "View", label, views, VIEWS - SCENERY_VIEWS + kept, &self->view);
    choose_look(on, "Background", label, backgrounds, backgrounds_of(self), &self->background);
    if (!backgrounds[self->background].option) {
        ui_width(on, -1.0f);
        (void)ui_input(on, "##background", "#336699, or the path of a .png or .jpg",
                       self->own_background, sizeof self->own_background);
    }
}

/* A choice, kept under a name in the settings. */
static void keep_preset(export_page *self)
{
    char name[PRESET_NAME], key[PRESET_NAME + 32], kept[EXPORT_WORDS];
    if (!presets_clean_name(name, self->preset_name))
        return;
    (void)snprintf(key, sizeof key, "%s.%s", presets_key_of_exports, name);
    tell_choice(self, kept, sizeof kept);
    settings_set_text(app_settings(self->app), key, kept);
    self->preset_name[0] = '\0';
}

static void draw_presets(export_page *self, float label)
{
    ui *on = self->ui;
    const char *names[CHOICES] = {"No preset"};
    char **own = NULL, key[PRESET_NAME + 32] = "";
    uint32_t count = settings_keys(app_settings(self->app), presets_key_of_exports, &own);
    count = count > PRESETS_OWN ? PRESETS_OWN : count;
    for (uint32_t i = 0; i < PRESETS; ++i)
        names[1 + i] = presets[i].name;
    for (uint32_t i = 0; i < count; ++i)
        names[1 + PRESETS + i] = own[i];
    if (self->preset > PRESETS + count)
        self->preset = 0;
    const bool is_new = ui_choice(on, "Preset", label, names, 1 + PRESETS + count, &self->preset);
    const uint32_t at = self->preset;
    if (at > PRESETS)
        (void)snprintf(key, sizeof key, "%s.%s", presets_key_of_exports, own[at - 1 - PRESETS]);
    if (is_new && at > 0) {
        choose(self, at <= PRESETS ? presets[at - 1].option
                                   : settings_text(app_settings(self->app), key, ""));
        put_ending(self);
    }
    free(own);
    if (key[0] && ui_button(on, "Remove the preset", UI_PLAIN)) {
        settings_set_text(app_settings(self->app), key, NULL);
        self->preset = 0;
    }
}

static void draw_keep(export_page *self)
{
    ui *on = self->ui;
    ui_width(on, 200.0f);
    (void)ui_input(on, "##preset", "Name of a preset", self->preset_name, sizeof self->preset_name);
    ui_same_line(on);
    ui_disabled_begin(on, !self->preset_name[0]);
    if (ui_button(on, "Keep", UI_PLAIN))
        keep_preset(self);
    ui_disabled_end(on);
}

static void draw_choices(export_page *self)
{
    ui *on = self->ui;
    const char *names[FORMATS];
    const float label = 124.0f;
    draw_presets(self, label);
    for (uint32_t i = 0; i < FORMATS; ++i)
        names[i] = formats[i].name;
    if (ui_choice(on, "Format", label, names, FORMATS, &self->format))
        put_ending(self);
    ui_text_wrapped(on, UI_STYLE_DIM, formats[self->format].holds);
    choose_look(on, "Frame rate", label, rates, RATES, &self->rate);
    if (is_drawn(self))
        draw_looks(self, label);
    ui_space(on, 4.0f);
    draw_keep(self);
}

/* What the first of them will be called. */
static void draw_file(export_page *self)
{
    ui *on = self->ui;
    char words[EXPORT_WORDS];
    ui_width(on, -1.0f);
    if (self->is_asked_first)
        ui_input_take_keys(on);
    self->is_asked_first = false;
    (void)ui_input(on, "##file", "Path of the file", self->file, sizeof self->file);
    const app_take_line *line;
    const uint32_t count = app_takes(self->app, &line);
    for (uint32_t i = 0, at; i < count; ++i) {
        error err;
        char path[EXPORT_FILE];
        if (!is_ticked(self, line[i].id, &at))
            continue;
        if (name_file(self, &line[i], path, &err) < 0) {
            ui_text_wrapped(on, UI_STYLE_BAD, err.text);
            return;
        }
        size_t from = strlen(path); /* the last part, of a folder too */
        from -= from > 0;
        while (from > 0 && path[from - 1] != '/')
            from -= 1;
        if (self->ticked_count > 1)
            (void)snprintf(words, sizeof words, "Writes %s and %u more", path + from,
                           self->ticked_count - 1);
        else
            (void)snprintf(words, sizeof words, "Writes %s", path + from);
        ui_text(on, UI_STYLE_DIM, words);
        return;
    }
    ui_text(on, UI_STYLE_DIM, "No take is ticked");
}

static void draw_request(export_page *self)
{
    ui *on = self->ui;
    const float height = 300.0f;
    if (!ui_dialog_begin(on, page_dialog, "Export takes", 720.0f))
        return;
    ui_scroll_begin(on, "takes", 200.0f, height);
    draw_takes(self);
    ui_scroll_end(on);
    ui_same_line(on);
    ui_scroll_begin(on, "choices", 0.0f, height);
    draw_choices(self);
    ui_scroll_end(on);
    ui_space(on, 2.0f);
    draw_file(self);
    draw_range(self);
    if (self->trouble.text[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble.text);
    ui_space(on, 6.0f);
    const app_unsaved *unsaved = app_unsaved_now(self->app);
    if (ui_button(on, unsaved ? "Save the rig and export" : "Export", UI_ACCENT))
        begin_export(self);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_PLAIN))
        ui_dialog_close(on);
    ui_dialog_end(on);
}

/* ---- the exports that go on ---- */

static const char going_dialog[] = "exports";

void export_page_ask_going(export_page *self)
{
    ui_dialog_open(self->ui, going_dialog);
}

static void draw_going(ui *on, app *of, uint32_t index)
{
    const export_progress going = exporter_at(app_exporter(of), index);
    char words[64], id[24];
    (void)snprintf(id, sizeof id, "export%u", index);
    ui_id_begin(on, id);
    if (going.is_cancelled || going.done < 0.0)
        (void)snprintf(words, sizeof words, "%s",
                       going.is_cancelled ? "ends"
                       : going.is_waiting ? "waits"
                                          : "begins");
    else
        (void)snprintf(words, sizeof words, "%s, %.0f %%", going.doing, 100.0 * going.done);
    ui_text(on, UI_STYLE_BODY, going.file);
    ui_text(on, UI_STYLE_DIM, words);
    ui_bar(on, going.done < 0.0 ? 0.0f : (float)going.done, 484.0f, 8.0f, UI_STYLE_GOOD);
    ui_disabled_begin(on, going.is_cancelled);
    if (ui_button(on, "Cancel", UI_PLAIN))
        exporter_cancel(app_exporter(of), index);
    ui_disabled_end(on);
    ui_id_end(on);
    ui_space(on, 6.0f);
}

void export_page_list_going(ui *on, app *of)
{
    const uint32_t count = exporter_count(app_exporter(of));
    const bool scrolls = count > 3;
    if (count > 1 && ui_button(on, "Cancel all", UI_PLAIN))
        for (uint32_t i = 0; i < count; ++i)
            exporter_cancel(app_exporter(of), i);
    if (scrolls)
        ui_scroll_begin(on, "going", 0.0f, 280.0f);
    for (uint32_t i = 0; i < count; ++i)
        draw_going(on, of, i);
    if (scrolls)
        ui_scroll_end(on);
}

/* It closes with the last of them. */
static void draw_exports(export_page *self)
{
    ui *on = self->ui;
    const uint32_t count = exporter_count(app_exporter(self->app));
    if (!ui_dialog_begin(on, going_dialog, "Exports", 520.0f))
        return;
    export_page_list_going(on, self->app);
    if (ui_button(on, "Close", UI_QUIET) || count == 0)
        ui_dialog_close(on);
    ui_dialog_end(on);
}

void export_page_init(export_page *out, app *of, ui *on)
{
    *out = (export_page){.app = of, .ui = on};
}

void export_page_draw(export_page *self)
{
    draw_request(self);
    draw_exports(self);
}
