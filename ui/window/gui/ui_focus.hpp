/* window/gui/ui_focus.hpp - the way of the keyboard through the controls: Tab and Shift+Tab go
 * round them, panel by panel from the top left; in a menu the arrows do, too; a ring is around the
 * control that Enter and Space press. Only the controls of the innermost dialog or menu are
 * reached. The pointer and Escape take the ring away. For ui.cpp alone. [main] */
#ifndef MAROTTE_UI_WINDOW_GUI_UI_FOCUS_HPP
#define MAROTTE_UI_WINDOW_GUI_UI_FOCUS_HPP
extern "C" {
#include "window/gui/ui_queue.h"
}

#include <imgui.h>
#include <imgui_internal.h>

constexpr int UI_FOCUS_LEVELS = 8; /* of dialogs and menus that are open above each other */
constexpr int UI_FOCUS_LABEL = 96;

struct ui_focus_stop {
    ImGuiID id;
    ImVec2 panel; /* top left of its panel, px */
};

struct ui_focus {
    ImGuiID at[UI_FOCUS_LEVELS];   /* control with the ring, of each level; 0: none */
    int level;                     /* of the innermost dialog or menu; 0: the panels */
    ImGuiID last;                  /* control that had the ring or the pointer: Tab goes on there */
    ImVector<ui_focus_stop> order; /* controls of this frame, at that level */
    int step;                      /* of this frame: 1 forwards, -1 backwards */
    bool is_pressing;
    ImGuiID claimed;  /* gets the ring as the menu opens that is opened in this frame; 0: none */
    bool is_escaping; /* Escape has taken the ring away in this frame */
    bool has_moved,
        has_arrived; /* the ring comes to a control with its next frame; in this frame */
    bool takes_arrows,
        took_arrows; /* the control with the ring: in this frame; in the one before */
    bool is_seen;    /* the ring is drawn in this frame */
    ImRect ring, clip;
    char label[UI_FOCUS_LABEL]; /* of the control with the ring; "": none */
};

void ui_focus_begin(ui_focus *self, const ui_frame_input *input, bool has_menu);
/* Of each control, in the order of drawing. Returns true if it has the ring. label: as passed by
 * the panel. */
bool ui_focus_add(ui_focus *self, const char *label, ImGuiID id, const ImRect &box,
                  bool is_disabled);
/* The ring goes to this control with the next frame. */
void ui_focus_move(ui_focus *self, ImGuiID id);
/* The control of a menu that opens in this frame gets the ring. */
void ui_focus_claim(ui_focus *self, ImGuiID id);
/* Tab does not reach the controls that were added in this frame: they are covered. */
void ui_focus_forget(ui_focus *self);
/* Left and right, or up and down, change the control with the ring: its arrows are no action's.
 * Returns how far; goes on while the key is held. */
int ui_focus_arrows(ui_focus *self, const ui_frame_input *input, bool is_upright);
/* The key is the control's, not an action's. */
bool ui_focus_has_key(const ui_focus *self, uint32_t key);
/* Moves the ring, and draws it. Takes it away if its control was not drawn. colour: of ImGui. */
void ui_focus_end(ui_focus *self, ImU32 colour, float thickness, float rounding);

#endif
