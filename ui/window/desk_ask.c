/* What is asked: how a take is to be exported, and how far those are that go on. */
#include "window/desk_state.h"

#include "take/timecode.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- export ---- */

static const char export_dialog[] = "export";

typedef struct format {
    const char *name, *ending;
} format;
static const format formats[] = {
    {"glTF, for Blender, Unity, Unreal (.glb)", ".glb"},
    {"Video (.mp4)", ".mp4"},
    {"Pictures, a folder of PNG", "/"},
    {"Point cache 2 (.pc2)", ".pc2"},
    {"Motion Designer (.mdd)", ".mdd"},
    {"Table (.csv)", ".csv"},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

static const double rates[] = {0.0, 24.0, 25.0, 30.0, 50.0, 60.0};
static const char *const rate_names[] = {"As the take says", "24", "25", "30", "50", "60"};
enum { RATES = sizeof rates / sizeof rates[0] };

/* The file's name gets the ending of the format, in place of another one's. */
static void put_ending(desk_exporting *self)
{
    char *file = self->wish.file;
    size_t length = strlen(file);
    for (uint32_t i = 0; i < FORMATS; ++i) {
        const size_t ending = strlen(formats[i].ending);
        if (length > ending && strcmp(file + length - ending, formats[i].ending) == 0) {
            file[length -= ending] = '\0';
            break;
        }
    }
    const char *wanted = formats[self->format].ending;
    if (length > 0 && length + strlen(wanted) < sizeof self->wish.file)
        (void)snprintf(file + length, sizeof self->wish.file - length, "%s", wanted);
}

/* Beside the show, called as the take: "night_1_a_3_ride". */
static void put_name(desk *self)
{
    const studio_take_line *line;
    const uint32_t count = studio_takes(self->studio, &line);
    const char *of = studio_show(self->studio) ? show_path(studio_show(self->studio)) : "";
    char *file = self->exporting.wish.file;
    const char *dot = strrchr(of, '.');
    size_t length = (size_t)snprintf(file, EXPORT_FILE / 2, "%.*s_",
                                     dot ? (int)(dot - of) : (int)strlen(of), of);
    if (length >= EXPORT_FILE / 2)
        length = EXPORT_FILE / 2 - 1;
    const size_t from = length;
    for (uint32_t i = 0; i < count; ++i)
        if (line[i].id == studio_take_id(self->studio))
            length += (size_t)snprintf(file + length, EXPORT_FILE / 4, "%s", line[i].title);
    for (char *c = file + from; *c; ++c)
        if (*c == '/' || *c == ' ')
            *c = '_';
}

void desk_export_ask(desk *self)
{
    self->exporting.trouble[0] = self->exporting.replaced[0] = '\0';
    put_name(self);
    put_ending(&self->exporting);
    ui_dialog_open(self->ui, export_dialog);
}

static bool range_of(const desk *self, int64_t *out_in, int64_t *out_out)
{
    const transport *move = live_transport(studio_live(self->studio));
    *out_in = move->loop_in_ns;
    *out_out = move->loop_out_ns;
    return live_shown_take(studio_live(self->studio)) == studio_take_id(self->studio) &&
           *out_in < *out_out;
}

/* What is there already is replaced when it is asked for a second time. */
static bool needs_a_word(desk_exporting *exporting)
{
    const char *file = exporting->wish.file;
    if (strcmp(exporting->replaced, file) == 0 || access(file, F_OK) != 0)
        return false;
    (void)snprintf(exporting->replaced, sizeof exporting->replaced, "%s", file);
    (void)snprintf(exporting->trouble, sizeof exporting->trouble,
                   "%s is there already. Export again replaces it.", file);
    return true;
}

static void begin_export(desk *self)
{
    desk_exporting *exporting = &self->exporting;
    export_wish *wish = &exporting->wish;
    wish->fps = rates[exporting->rate];
    wish->in_ns = wish->out_ns = 0;
    if (exporting->only_range)
        (void)range_of(self, &wish->in_ns, &wish->out_ns);
    if (needs_a_word(exporting))
        return;
    if (studio_export_take(self->studio, wish) >= 0) {
        ui_dialog_close(self->ui);
        return;
    }
    const news_list *news = studio_news(self->studio);
    const uint32_t count = news_list_count(news);
    (void)snprintf(exporting->trouble, sizeof exporting->trouble, "%s",
                   count ? news_list_at(news, count - 1)->text : "");
}

static void draw_range(desk *self)
{
    int64_t in_ns, out_ns;
    char words[96];
    const bool has_range = range_of(self, &in_ns, &out_ns);
    if (!has_range) {
        self->exporting.only_range = false;
        return;
    }
    (void)snprintf(words, sizeof words, "Only the range, %.1f to %.1f s", 1e-9 * (double)in_ns,
                   1e-9 * (double)out_ns);
    ui_space(self->ui, 2.0f);
    (void)ui_check(self->ui, words, &self->exporting.only_range);
}

static void draw_wish(desk *self)
{
    ui *on = self->ui;
    desk_exporting *exporting = &self->exporting;
    const char *names[FORMATS];
    const float label = 124.0f;
    if (!ui_dialog_begin(on, export_dialog, "Export the chosen take", 520.0f))
        return;
    for (uint32_t i = 0; i < FORMATS; ++i)
        names[i] = formats[i].name;
    if (ui_choice(on, "Format", label, names, FORMATS, &exporting->format))
        put_ending(exporting);
    (void)ui_choice(on, "Frames a second", label, rate_names, RATES, &exporting->rate);
    ui_space(on, 2.0f);
    ui_width(on, -1.0f);
    (void)ui_input(on, "##file", "Path of the file", exporting->wish.file,
                   sizeof exporting->wish.file);
    draw_range(self);
    if (exporting->trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, exporting->trouble);
    ui_space(on, 8.0f);
    if (ui_button(on, "Export", UI_ACCENT))
        begin_export(self);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_PLAIN))
        ui_dialog_close(on);
    ui_dialog_end(on);
}

/* ---- the exports that go on ---- */

static const char exports_dialog[] = "exports";

void desk_exports_ask(desk *self)
{
    ui_dialog_open(self->ui, exports_dialog);
}

static void draw_going(desk *self, uint32_t index)
{
    ui *on = self->ui;
    const export_going going = studio_export_now(self->studio, index);
    char words[64], id[24];
    (void)snprintf(id, sizeof id, "export%u", index);
    ui_id_begin(on, id);
    if (going.is_cancelled || going.done < 0.0)
        (void)snprintf(words, sizeof words, "%s", going.is_cancelled ? "ends" : "begins");
    else
        (void)snprintf(words, sizeof words, "%s, %.0f %%", going.doing, 100.0 * going.done);
    ui_text(on, UI_STYLE_BODY, going.file);
    ui_text(on, UI_STYLE_DIM, words);
    ui_bar(on, going.done < 0.0 ? 0.0f : (float)going.done, 484.0f, 8.0f, UI_STYLE_GOOD);
    ui_disabled_begin(on, going.is_cancelled);
    if (ui_button(on, "Cancel", UI_PLAIN))
        studio_cancel_export(self->studio, index);
    ui_disabled_end(on);
    ui_id_end(on);
    ui_space(on, 6.0f);
}

void desk_exports_list(desk *self)
{
    const uint32_t count = studio_exports_going(self->studio);
    for (uint32_t i = 0; i < count; ++i)
        draw_going(self, i);
}

/* It closes with the last of them. */
static void draw_exports(desk *self)
{
    ui *on = self->ui;
    const uint32_t count = studio_exports_going(self->studio);
    if (!ui_dialog_begin(on, exports_dialog, "Exports", 520.0f))
        return;
    desk_exports_list(self);
    if (ui_button(on, "Close", UI_QUIET) || count == 0)
        ui_dialog_close(on);
    ui_dialog_end(on);
}

void desk_export_draw(desk *self)
{
    draw_wish(self);
    draw_exports(self);
}
