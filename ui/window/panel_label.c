#include "window/panel_label.h"

void panel_label(ui *on, const char *id, float width, uint32_t colour, const char *text)
{
    ui_canvas at;
    ui_canvas_begin(on, id, width, ui_row_height(on), &at);
    float y = at.where.y + 0.5f * (at.where.height - ui_text_height(on, UI_STYLE_BODY));
    ui_draw_text(on, at.where.x, y, UI_STYLE_BODY, colour, at.where.width, text);
    ui_canvas_end(on);
    if (ui_text_width(on, UI_STYLE_BODY, text) > width)
        ui_hint(on, text);
    ui_same_line(on);
}
