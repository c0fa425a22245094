/* window/gui/ui.h - the user interface in plain C: an immediate-mode facade over Dear ImGui, and
 * its queue of events. It exposes no ImGui type, and no text is a format string. Windows, scripts
 * and tests push the same events. Leaves out windows and their contexts (window.h), colours
 * (theme.h) and the text of panels. Lengths are in points: at scale 2 a point is two pixels. Needs
 * a current OpenGL 3.3 context. [main] */
#ifndef MAROTTE_UI_WINDOW_GUI_UI_H
#define MAROTTE_UI_WINDOW_GUI_UI_H
#include "window/gui/theme.h"
#include "window/gui/ui_types.h"

#include "base/error.h"

typedef struct ui ui;

CHECKED mrt_result ui_create(ui **out, error *err);
void ui_destroy(ui *self); /* NULL is fine; its context is current */

/* ---- events: queued, and handed over such that no tap is lost: of one key or button at most one
 * change a frame, in order ---- */

void ui_push(ui *self, const ui_event *event);
bool ui_is_idle(const ui *self);    /* all that was pushed has been handed over */
bool ui_is_holding(const ui *self); /* a key or a button, in this frame */
/* Where text is copied to and from; without it, within the window alone. get: until its next call.
 */
typedef struct ui_clipboard {
    void *data;
    const char *(*get)(void *data);
    void (*set)(void *data, const char *text);
} ui_clipboard;
void ui_set_clipboard(ui *self, const ui_clipboard *clipboard);

/* ---- a frame: begin, panels, end; end draws the changed parts into the bound framebuffer, which
 * must still contain the previous frame ---- */

typedef struct ui_screen {
    float width, height; /* points */
    float scale;         /* pixels a point; fonts are rebuilt when it changes */
    double dt_s;         /* since the frame before */
    bool is_hidden;      /* the window is not visible: everything runs, but nothing is drawn */
    bool is_lost;        /* the framebuffer lost its content */
    bool is_late; /* this frame only advances the clock (pace_begin): the next one handles events */
} ui_screen;
void ui_begin(ui *self, const ui_screen *screen);
void ui_end(ui *self);
bool ui_is_hidden(const ui *self); /* of this frame */
/* After ui_end: this frame differed from the previous one, and was drawn. */
bool ui_is_new(const ui *self);
/* Draws the whole of the last frame again. For tests. */
void ui_draw_again(ui *self);
/* Requests a frame in at most that time, for an animation or a delay without event and face. 0: the
 * next frame. The request holds for one frame. */
void ui_want_frame(ui *self, double in_s);
double ui_wanted_s(const ui *self); /* HUGE_VAL: none */
/* Takes effect in the next frame. All colours passed to the ui are those of the dark theme. */
void ui_set_theme(ui *self, theme of);
/* Begins drawing over the picture of the face. The theme does not change its wall, so colours stay
 * dark there. */
void ui_on_face_begin(ui *self);
void ui_on_face_end(ui *self);

/* ---- layout: panels have fixed rectangles; what is in them flows downwards ---- */

typedef enum ui_ground { UI_GROUND_NONE = 0, UI_GROUND_PANEL } ui_ground;
/* Everything is drawn between these two. */
void ui_panel_begin(ui *self, const char *id, ui_rectangle where, ui_ground ground);
void ui_panel_end(ui *self);
/* A part of a panel that scrolls; width or height 0: what is left, < 0: what is left less that. */
void ui_scroll_begin(ui *self, const char *id, float width, float height);
void ui_scroll_end(ui *self);
void ui_scroll_to_end(ui *self); /* of the innermost scrolling part */
void ui_scroll_to_row(ui *self); /* the last row comes into the middle, unless it is in sight */
void ui_same_line(ui *self);     /* the next thing comes to the right of the last */
void ui_next_line(ui *self);     /* after ui_same_line: what comes did not fit */
void ui_at(ui *self, float x);   /* on this line, from where the lines of the panel begin */
void ui_space(ui *self, float height);
void ui_rule(ui *self);               /* a thin line */
void ui_width(ui *self, float width); /* of the next widget; 0: as it likes, < 0: what is left less
                                         that */
float ui_available_width(const ui *self);
float ui_available_height(const ui *self);
float ui_row_height(const ui *self);
void ui_id_begin(ui *self, const char *id); /* opens a scope of names */
void ui_id_end(ui *self);
void ui_disabled_begin(ui *self, bool is_disabled); /* greyed, takes no clicks */
void ui_disabled_end(ui *self);

/* ---- text ---- */

typedef enum ui_style {
    UI_STYLE_BODY = 0,
    UI_STYLE_DIM, /* what recedes; still 4.5:1 */
    UI_STYLE_STRONG,
    UI_STYLE_TITLE,  /* of a section */
    UI_STYLE_LARGE,  /* legible at two metres: time, record state */
    UI_STYLE_NUMBER, /* digits of one width */
    UI_STYLE_GOOD,
    UI_STYLE_WARNING,
    UI_STYLE_BAD
} ui_style;
void ui_text(ui *self, ui_style style, const char *text); /* one line, cut with an ellipsis */
void ui_text_wrapped(ui *self, ui_style style, const char *text); /* at the panel's width */
/* "label      value": the value at x as by ui_at. */
void ui_fact(ui *self, const char *label, float x, ui_style style, const char *value);
/* A text in a line of widgets, `width` wide, cut where it does not fit; the next thing comes behind
 * it. id: its own in the panel. */
void ui_label(ui *self, const char *id, float width, uint32_t colour, const char *text);
float ui_text_width(const ui *self, ui_style style, const char *text);
float ui_text_height(const ui *self, ui_style style);

/* ---- widgets: true when the person changed something; a label "Name##id" shows "Name" ---- */

typedef enum ui_emphasis { UI_PLAIN = 0, UI_ACCENT, UI_QUIET } ui_emphasis;
bool ui_button(ui *self, const char *label, ui_emphasis emphasis);
bool ui_check(ui *self, const char *label, bool *value);
/* The label to the left in the first `label_width` points. */
bool ui_choice(ui *self, const char *label, float label_width, const char *const *items,
               uint32_t count, uint32_t *index);
typedef struct ui_range {
    double min, max;
    const char *unit; /* "" or "mm" */
    uint32_t digits;  /* behind the point */
    bool is_whole;
    double initial; /* where a double click puts it */
} ui_range;
/* A control-click types the number in. */
bool ui_slider(ui *self, const char *label, float label_width, const ui_range *range,
               double *value);
bool ui_slider_is_held(const ui *self); /* the last slider is being dragged */
/* One line; true when it was ended (Enter, or a click elsewhere) and has changed. */
bool ui_input(ui *self, const char *id, const char *hint, char *text, size_t capacity);
bool ui_input_lines(ui *self, const char *id, char *text, size_t capacity, float height);
bool ui_input_is_entered(const ui *self); /* the last ui_input was ended with Enter, now */
void ui_input_take_keys(ui *self);        /* the next ui_input gets the keyboard */
int ui_input_arrows(const ui *self); /* down less up, pressed in this frame, also while typing */
/* Height of the tabs at a width. They use as many rows as needed. */
float ui_tabs_height(const ui *self, const char *const *names, uint32_t count, float width);
bool ui_tabs(ui *self, const char *id, const char *const *names, uint32_t count, uint32_t *index);
/* Calls `each` behind each tab, while that is the last widget: for its hint, menu and drag. */
bool ui_tabs_each(ui *self, const char *id, const char *const *names, uint32_t count,
                  uint32_t *index, void (*each)(void *data, uint32_t tab), void *data);
typedef enum ui_drag_state { UI_DRAG_NONE = 0, UI_DRAG_MOVES, UI_DRAG_DROPPED } ui_drag_state;
typedef struct ui_drag {
    ui_drag_state state;
    float x, y;         /* of the pointer, on the screen */
    ui_rectangle where; /* the widget */
} ui_drag;
ui_drag ui_last_drag(ui *self); /* of the last widget, by the left button */
bool ui_section(ui *self, const char *title, bool is_open_at_first); /* true: open, draw what is in
                                                                        it */
#define UI_CHIP       22.0f /* width of a colour's chip in a menu */
#define UI_CHIP_LABEL 66.0f
typedef enum ui_row_click { UI_ROW_NONE = 0, UI_ROW_CLICKED, UI_ROW_DOUBLE_CLICKED } ui_row_click;
ui_row_click ui_row(ui *self, const char *label, bool is_selected); /* a line of a list */
void ui_bar(ui *self, float share, float width, float height, ui_style style); /* 0..1 */
void ui_hint(ui *self, const char *text);     /* a tooltip, after a moment */
bool ui_menu_begin(ui *self, const char *id); /* right click on the last widget; then ui_row or
                                                 ui_menu_item, ui_menu_end if true */
/* A menu that a key or a left click opens, at a place on the screen; ui_menu_end if true. Both in
 * the same panel. */
void ui_menu_open(ui *self, const char *id, float x, float y);
bool ui_open_menu_begin(ui *self, const char *id);
bool ui_menu_item(ui *self, const char *label, const char *keys, bool is_enabled);
/* A line of a menu with a chip of each colour to the right of its label, of UI_CHIP points each.
 * The first one, for none, is a ring. True: another one was chosen. */
bool ui_menu_colours(ui *self, const char *label, const char *const *names, const uint32_t *colours,
                     uint32_t count, uint32_t *index);
void ui_menu_end(ui *self);
/* A question over everything else: ui_dialog_open once, then begin (true while it is open) .. end
 * each frame. Escape closes it. */
void ui_dialog_open(ui *self, const char *id);
bool ui_dialog_begin(ui *self, const char *id, const char *title, float width);
void ui_dialog_close(ui *self);
void ui_dialog_end(ui *self);
bool ui_has_dialog(const ui *self); /* one was drawn in the last frame */

/* ---- keys: Tab goes round the controls (ui_focus.hpp); Enter, Space and the arrows are then
 * theirs ---- */

/* What is drawn next covers the panels before: Tab does not reach them. */
void ui_focus_covers(ui *self);
/* Label of the control with the ring of the keyboard; "": none. */
const char *ui_ringed(const ui *self);

/* Pressed in this frame, with exactly these modifiers, and no text is being typed; keys that write
 * nothing (F1..F12, Ctrl with what a text does not use, page up and down) end the text first. */
bool ui_pressed(const ui *self, uint32_t key, uint32_t modifiers);
bool ui_is_down(const ui *self, uint32_t key); /* the same, held */
uint32_t ui_modifiers(const ui *self);
bool ui_is_typing(const ui *self); /* for tests: ui_pressed knows */

/* ---- a canvas: a rectangle of the panel to draw on and to drag in ---- */

typedef struct ui_canvas {
    ui_rectangle where;     /* on the screen */
    float x, y;             /* of the pointer, from the canvas's top left */
    float start_x, start_y; /* where the drag began */
    float moved_x, moved_y; /* since the frame before, while dragging */
    float wheel_x, wheel_y; /* notches, while it is hovered */
    uint32_t modifiers;
    int32_t button; /* that is dragging, or was in its last frame: 0..2; -1: none */
    bool is_hovered, is_pressed, is_dragging, is_released, is_double_clicked;
} ui_canvas;
/* The pointer is over that part of it; where: on the screen. */
static inline bool ui_canvas_is_over(const ui_canvas *canvas, ui_rectangle where)
{
    return canvas->is_hovered &&
           ui_rectangle_has(where, canvas->where.x + canvas->x, canvas->where.y + canvas->y);
}
/* is_released comes with the last position: apply the drag in it too. */
void ui_canvas_begin(ui *self, const char *id, float width, float height, ui_canvas *out);
/* A part of the canvas that a click or the keyboard presses; where: on the screen. Draws nothing.
 */
bool ui_canvas_button(ui *self, const ui_canvas *canvas, const char *label, ui_rectangle where,
                      bool is_enabled);
void ui_canvas_end(ui *self); /* contents are clipped to it */

/* On the screen's points, on the panel or canvas that is open. A colour: 0xRRGGBBAA, theme.h. */
void ui_draw_box(ui *self, ui_rectangle where, uint32_t colour, float rounding);
void ui_draw_frame(ui *self, ui_rectangle where, uint32_t colour, float rounding, float thickness);
void ui_draw_line(ui *self, float x0, float y0, float x1, float y1, uint32_t colour,
                  float thickness);
void ui_draw_lines(ui *self, const float *xy, uint32_t count, uint32_t colour, float thickness);
void ui_draw_area(ui *self, const float *x, const float *low, const float *high, uint32_t count,
                  uint32_t colour); /* between two curves */
void ui_draw_disc(ui *self, float x, float y, float radius, uint32_t colour);
void ui_draw_ring(ui *self, float x, float y, float radius, uint32_t colour, float thickness);
void ui_draw_triangle(ui *self, const float xy[6], uint32_t colour);
/* Top left at x, y; max_width > 0: cut with an ellipsis. */
void ui_draw_text(ui *self, float x, float y, ui_style style, uint32_t colour, float max_width,
                  const char *text);
/* The first row at the bottom. Another version: the texture's pixels have changed. */
void ui_draw_image(ui *self, ui_rectangle where, uint32_t texture, uint64_t version,
                   bool is_mirrored);
void ui_clip_begin(ui *self, ui_rectangle where);
void ui_clip_end(ui *self);
typedef enum ui_cursor {
    UI_CURSOR_ARROW = 0,
    UI_CURSOR_HAND,
    UI_CURSOR_MOVE,
    UI_CURSOR_ACROSS, /* <-> */
    UI_CURSOR_DOWN,   /* up and down */
    UI_CURSOR_TEXT,
    UI_CURSOR_CROSS
} ui_cursor;
void ui_set_cursor(ui *self, ui_cursor cursor); /* for this frame */
/* A panel that is the edge between two others. Returns how far it was dragged in this frame, across
 * its length. */
float ui_drag_edge(ui *self, const char *id, ui_rectangle where, ui_cursor cursor);
ui_cursor ui_cursor_wanted(const ui *self); /* after ui_end */

/* What was drawn since ui_begin. */
void ui_note_words(ui *self, bool is_noting);
uint32_t ui_words(const ui *self, const ui_word **out);
/* Likewise: buttons, checks, choices, sliders, texts that are typed. */
uint32_t ui_controls(const ui *self, const ui_control **out);

#endif
