/* The newest news over the face, for a while; an error until it is clicked. */
#include "window/desk_state.h"

#include <stdio.h>
#include <string.h>

#define SHOWN_S   6.0
#define WARNING_S 12.0

/* What plugins have to tell that is no trouble is in the log. */
static bool is_for_everybody(const news_item *item)
{
    return item->level >= MRT_LOG_WARNING || strcmp(item->source, "stage") == 0;
}

/* A calmer line does not push an error away. */
static bool gives_way(const desk *self, const news_item *to)
{
    return self->news[0] == '\0' || self->news_level < MRT_LOG_ERROR || to->level >= MRT_LOG_ERROR;
}

/* What is said in one frame is one: of that the most serious is shown, the newest of several. */
static const news_item *most_serious_of_new(desk *self)
{
    const news_list *list = studio_news(self->studio);
    const uint32_t count = news_list_count(list);
    const uint64_t total = news_list_said(list), fresh = total - self->news_seen;
    const news_item *best = NULL;
    self->news_seen = total;
    for (uint32_t i = fresh < count ? count - (uint32_t)fresh : 0; i < count; ++i) {
        const news_item *item = news_list_at(list, i);
        if (is_for_everybody(item) && (!best || item->level >= best->level))
            best = item;
    }
    return best;
}

/* A plugin says what it did, not who it is: "troubled" of "org.example.troubled". */
static const char *speaker_of(const news_item *item)
{
    const char *dot = strrchr(item->source, '.');
    return dot ? dot + 1 : "";
}

void desk_update_news(desk *self, double dt_s)
{
    const news_item *item = most_serious_of_new(self);
    if (self->news_left_s > 0.0) {
        self->news_left_s -= dt_s;
        if (self->news_left_s <= 0.0)
            self->news[0] = '\0';
    }
    if (!item || !gives_way(self, item))
        return;
    const char *speaker = speaker_of(item);
    (void)snprintf(self->news, sizeof self->news, "%s%s%s", speaker, speaker[0] ? ": " : "",
                   item->text);
    self->news_level = item->level;
    self->news_left_s = item->level >= MRT_LOG_ERROR     ? -1.0
                        : item->level >= MRT_LOG_WARNING ? WARNING_S
                                                         : SHOWN_S;
}

/* Where a text that is too long for one line is broken: at its last blank that fits. */
static size_t first_line(const ui *on, ui_style style, const char *text, float width)
{
    char part[sizeof((desk *)NULL)->news];
    size_t fits = 0;
    if (ui_text_width(on, style, text) <= width)
        return strlen(text);
    for (const char *c = strchr(text, ' '); c; c = strchr(c + 1, ' ')) {
        (void)snprintf(part, sizeof part, "%.*s", (int)(c - text), text);
        if (ui_text_width(on, style, part) > width)
            break;
        fits = (size_t)(c - text);
    }
    return fits ? fits : strlen(text);
}

void desk_draw_news(desk *self, ui_rectangle over)
{
    char first[sizeof self->news];
    if (!self->news[0])
        return;
    ui *on = self->ui;
    const ui_style style = self->news_level >= MRT_LOG_ERROR     ? UI_STYLE_BAD
                           : self->news_level >= MRT_LOG_WARNING ? UI_STYLE_WARNING
                                                                 : UI_STYLE_BODY;
    const bool stays = self->news_left_s < 0.0;
    const float padding = 12.0f, line = 20.0f, cross = stays ? 24.0f : 0.0f;
    float width = ui_text_width(on, style, self->news) + 2.0f * padding + cross;
    if (width > over.width - 24.0f)
        width = over.width - 24.0f;
    const float room = width - 2.0f * padding - cross + 1.0f;
    const size_t break_at = first_line(on, style, self->news, room);
    const char *rest = self->news + break_at + (self->news[break_at] == ' ');
    const float height = rest[0] ? 32.0f + line : 32.0f;
    (void)snprintf(first, sizeof first, "%.*s", (int)break_at, self->news);
    const ui_rectangle box = {over.x + 12.0f, over.y + over.height - height - 12.0f, width, height};
    ui_canvas canvas;
    ui_panel_begin(on, "news", box, UI_GROUND_NONE);
    ui_canvas_begin(on, "line", 0.0f, 0.0f, &canvas);
    ui_draw_box(on, box, THEME_PANEL, 5.0f);
    const uint32_t colour = style == UI_STYLE_BAD       ? THEME_BAD
                            : style == UI_STYLE_WARNING ? THEME_WARNING
                                                        : THEME_TEXT;
    const float y = box.y + 0.5f * (32.0f - ui_text_height(on, UI_STYLE_BODY));
    ui_draw_text(on, box.x + padding, y, UI_STYLE_BODY, colour, room, first);
    if (rest[0])
        ui_draw_text(on, box.x + padding, y + line, UI_STYLE_BODY, colour, room, rest);
    if (stays) {
        const float x = box.x + width - padding - 5.0f, middle = box.y + 0.5f * height;
        ui_draw_line(on, x - 4.0f, middle - 4.0f, x + 4.0f, middle + 4.0f, THEME_DIM, 1.5f);
        ui_draw_line(on, x - 4.0f, middle + 4.0f, x + 4.0f, middle - 4.0f, THEME_DIM, 1.5f);
    }
    if (canvas.is_hovered)
        ui_set_cursor(on, UI_CURSOR_HAND);
    if (canvas.is_pressed)
        self->news[0] = '\0';
    ui_canvas_end(on);
    ui_hint(on, self->news); /* the line may have been cut */
    ui_panel_end(on);
}
