/* The log panel: messages to the user, newest first. */
#include "window/panels/panels.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PAGE = 40, AS_TEXT = 1 << 16 };
typedef enum log_filter { LOG_ALL = 0, LOG_WARNINGS, LOG_ERRORS, LOG_FILTERS } log_filter;
static const char *const filters[LOG_FILTERS] = {"All", "Warnings", "Errors"};
static const int32_t least_level[LOG_FILTERS] = {MRT_LOG_INFO, MRT_LOG_WARNING, MRT_LOG_ERROR};

struct panel {
    app *app;
    uint32_t filter, room; /* room: maximum number of drawn messages */
    int64_t cleared_ms;    /* messages up to this time are hidden */
    bool is_text;
    char text[AS_TEXT];  /* for selecting and copying */
    uint64_t text_total; /* news_list_total at the last write; UINT64_MAX: not written */
    uint32_t text_filter;
};

static bool is_shown(const panel *self, const news_item *item)
{
    return item->level >= least_level[self->filter] && item->utc_ms > self->cleared_ms;
}

static void write_time(const news_item *item, char out[16])
{
    time_t seconds = (time_t)(item->utc_ms / 1000);
    struct tm local;
    if (!localtime_r(&seconds, &local) || strftime(out, 16, "%H:%M:%S", &local) == 0)
        (void)snprintf(out, 16, "--:--:--");
}

static ui_style style_of(int32_t level)
{
    if (level >= MRT_LOG_ERROR)
        return UI_STYLE_BAD;
    return level == MRT_LOG_WARNING ? UI_STYLE_WARNING : UI_STYLE_BODY;
}

static void draw_item(ui *on, const news_item *item)
{
    char time_words[16];
    write_time(item, time_words);
    ui_text(on, UI_STYLE_DIM, time_words);
    ui_same_line(on);
    ui_at(on, 66.0f);
    ui_text(on, UI_STYLE_DIM, item->source);
    ui_text_wrapped(on, style_of(item->level), item->text);
    ui_space(on, 4.0f);
}

static void draw_items(panel *self, ui *on)
{
    const news_list *news = app_news(self->app);
    uint32_t shown = 0, beyond = 0;
    for (uint32_t i = news_list_count(news); i-- > 0;) {
        const news_item *item = news_list_at(news, i);
        if (!is_shown(self, item))
            continue;
        if (shown < self->room) {
            draw_item(on, item);
            shown += 1;
        } else {
            beyond += 1;
        }
    }
    if (shown == 0)
        ui_text(on, UI_STYLE_DIM, "No messages.");
    if (beyond == 0)
        return;
    char label[48];
    (void)snprintf(label, sizeof label, "%u older###older", beyond);
    if (ui_button(on, label, UI_PLAIN))
        self->room += PAGE;
}

/* ---- as one text ---- */

static void write_text(panel *self)
{
    static const char *const level_name[] = {"debug", "note", "warning", "error"};
    const news_list *news = app_news(self->app);
    size_t used = 0;
    char time_words[16];
    self->text[0] = '\0';
    for (uint32_t i = news_list_count(news); i-- > 0;) {
        const news_item *item = news_list_at(news, i);
        if (!is_shown(self, item))
            continue;
        write_time(item, time_words);
        bool is_known = item->level >= MRT_LOG_DEBUG && item->level <= MRT_LOG_ERROR;
        int length =
            snprintf(self->text + used, AS_TEXT - used, "%s %s: %s: %s\n", time_words,
                     is_known ? level_name[item->level] : "note", item->source, item->text);
        if (length < 0 || used + (size_t)length >= AS_TEXT) {
            self->text[used] = '\0';
            return;
        }
        used += (size_t)length;
    }
}

static void draw_as_text(panel *self, ui *on)
{
    const news_list *news = app_news(self->app);
    if (news_list_total(news) != self->text_total || self->filter != self->text_filter) {
        write_text(self);
        self->text_total = news_list_total(news);
        self->text_filter = self->filter;
    }
    ui_width(on, 0.0f);
    (void)ui_input_lines(on, "##text", self->text, AS_TEXT, 0.0f);
}

/* ---- the panel ---- */

static void clear(panel *self)
{
    const news_list *news = app_news(self->app);
    uint32_t count = news_list_count(news);
    if (count > 0)
        self->cleared_ms = news_list_at(news, count - 1)->utc_ms;
    self->text_total = UINT64_MAX;
    self->room = PAGE;
}

static void draw(panel *self, ui *on, ui_rectangle where)
{
    ui_panel_begin(on, "log", where, UI_GROUND_PANEL);
    (void)ui_tabs(on, "filter", filters, LOG_FILTERS, &self->filter);
    ui_space(on, 2.0f);
    (void)ui_check(on, "As text", &self->is_text);
    ui_hint(on, "Show the messages as text that you can select and copy.");
    ui_same_line(on);
    ui_at(on, 96.0f);
    if (ui_button(on, "Clear", UI_PLAIN))
        clear(self);
    ui_hint(on, "Clear the messages in this panel.");
    ui_space(on, 2.0f);
    if (self->is_text) {
        draw_as_text(self, on);
    } else {
        ui_scroll_begin(on, "items", 0.0f, 0.0f);
        draw_items(self, on);
        ui_scroll_end(on);
    }
    ui_panel_end(on);
}

static void destroy(panel *self)
{
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->room = PAGE;
    self->text_total = UINT64_MAX;
    self->cleared_ms = INT64_MIN;
    return self;
}

const panel_type panel_log = {create, destroy, draw, NULL};
