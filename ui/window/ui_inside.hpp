/* window/ui_inside.hpp - what the files of the facade share: its state, points to pixels, and text
 * as it is put on the screen. The only place where Dear ImGui is known. [main] */
#ifndef MAROTTE_UI_WINDOW_UI_INSIDE_HPP
#define MAROTTE_UI_WINDOW_UI_INSIDE_HPP
extern "C" {
#include "window/theme.h"
#include "window/ui.h"
#include "window/ui_notes.h"
#include "window/ui_queue.h"
}
#define IMGUI_DEFINE_MATH_OPERATORS
#include <imgui.h>
#include <imgui_internal.h>

constexpr int UI_PANELS_MAX = 32;
constexpr int UI_POPUPS_MAX = 8;
constexpr int UI_INPUT_MAX = 4096;

enum ui_font {
    UI_FONT_BODY,
    UI_FONT_STRONG,
    UI_FONT_TITLE,
    UI_FONT_LARGE,
    UI_FONT_NUMBER,
    UI_FONTS
};

struct ui_grip { /* of the canvas that is dragged */
    ImGuiID id;
    int button;
    ImVec2 start, last; /* pixels of the screen */
};

struct ui {
    ImGuiContext *context;
    ui_queue *queue;
    ui_frame_input *input;
    ui_notes *notes;
    ui_screen screen;
    float scale; /* pixels a point, of the fonts that are loaded */
    ImFont *font[UI_FONTS];
    bool is_drawing; /* OpenGL side was started */
    ui_cursor cursor;

    ImGuiWindow *panel[UI_PANELS_MAX]; /* of this frame, in order */
    int panel_count;
    uint32_t surface; /* of ui_notes that is drawn on */
    uint32_t surface_below[UI_POPUPS_MAX];
    int popup_depth;
    bool has_dialog, had_dialog; /* drawn in this frame; in the one before */
    ImGuiID dialog_wanted;
    float next_width; /* pixels; of the next widget */
    int disabled_depth;
    int dialog_depth;
    bool is_slider_held;
    uint32_t command, command_modifiers; /* pressed while a text was typed: of the next frame */
    uint32_t late, late_modifiers;       /* the one of the frame before */
    bool takes_keys;                     /* the next input */
    ImGuiID hinted;                      /* what the pointer rests on */
    double hinted_s;
    ui_grip grip;
    char before[UI_INPUT_MAX]; /* the text of the input that is edited, as it was */
};

/* ---- sizes and colours ---- */

inline float ui_px(const ui *self, float points)
{
    return points * self->scale;
}
inline float ui_whole_px(const ui *self, float points)
{
    return ImFloorSigned(points * self->scale + 0.5f);
}
inline ImVec2 ui_px2(const ui *self, float x, float y)
{
    return ImVec2(ui_px(self, x), ui_px(self, y));
}
inline ImRect ui_px_box(const ui *self, ui_rectangle r)
{
    return ImRect(ui_px2(self, r.x, r.y), ui_px2(self, r.x + r.width, r.y + r.height));
}
inline ui_rectangle ui_points_box(const ui *self, const ImRect &r)
{
    return ui_rectangle{r.Min.x / self->scale, r.Min.y / self->scale,
                        (r.Max.x - r.Min.x) / self->scale, (r.Max.y - r.Min.y) / self->scale};
}
inline ImU32 ui_ink(uint32_t colour)
{
    return IM_COL32(colour >> 24, colour >> 16 & 0xffu, colour >> 8 & 0xffu, colour & 0xffu);
}
uint32_t ui_style_colour(ui_style style);
ImFont *ui_style_font(const ui *self, ui_style style);
/* The colour of text here: dim where nothing can be done. */
inline uint32_t ui_colour_here(const ui *self, uint32_t colour)
{
    return self->disabled_depth ? THEME_DIM : colour;
}

/* ---- drawing with notes of it (ui.cpp) ---- */

ImVec2 ui_measure(const ImFont *font, const char *begin, const char *end);
/* Draws, cut with an ellipsis when wider than max_px (0: as wide as it is); the top left at `at`.
 */
void ui_put_text(ui *self, ImFont *font, ImVec2 at, uint32_t colour, float max_px,
                 const char *begin, const char *end);
/* In the middle of the height of a box, `align` 0 left .. 1 right. */
void ui_put_text_in(ui *self, ImFont *font, const ImRect &box, float align, uint32_t colour,
                    const char *begin, const char *end);
/* Something else has drawn it there. */
void ui_note_text(ui *self, ImFont *font, ImVec2 at, uint32_t colour, const ImRect &clip,
                  bool is_cut, const char *begin, const char *end);
void ui_put_box(ui *self, const ImRect &box, uint32_t colour, float rounding_px);
/* Words from here on are of the popup that was begun. (ui_popups.cpp) */
void ui_close_left_popups(); /* once a frame, after everything was drawn */
void ui_enter_popup(ui *self);
void ui_leave_popup(ui *self);

/* ---- what a frame is handed (ui_keys.cpp) ---- */

/* Before ImGui's new frame. A command then ends the text that is typed. */
void ui_hand_over(ui *self);

/* ---- what widgets are made of (ui_widgets.cpp) ---- */

/* The width that was asked for the next widget, or its own. */
float ui_take_width(ui *self, float natural_px);
struct ui_pressing {
    ImRect box;
    bool is_seen, is_pressed, is_hovered, is_held;
};
/* An item of that size that can be pressed. */
ui_pressing ui_press_item(const char *label, ImVec2 size, ImGuiButtonFlags flags);

#endif
