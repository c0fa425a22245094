#include "window/gui/ui_focus.hpp"

#include <algorithm>
#include <cstdio>

static ImGuiID &here(ui_focus *self)
{
    return self->at[self->level];
}

static void take_away(ui_focus *self)
{
    if (here(self) != 0)
        self->last = here(self);
    here(self) = 0;
    self->label[0] = '\0';
}

void ui_focus_begin(ui_focus *self, const ui_frame_input *input, bool has_menu)
{
    const ImGuiContext &g = *ImGui::GetCurrentContext();
    const int level = ImMin(g.OpenPopupStack.Size, UI_FOCUS_LEVELS - 1);
    for (int i = self->level + 1; i <= level; ++i)
        self->at[i] = i == level ? self->claimed : 0;
    self->has_moved |= level > self->level && self->claimed != 0;
    self->claimed = 0;
    self->level = level;
    const uint32_t modifiers = ui_frame_modifiers(input);
    const bool is_back = modifiers == UI_SHIFT;
    self->order.resize(0);
    self->step = 0;
    self->is_seen = self->has_arrived = false;
    self->took_arrows = self->takes_arrows;
    self->takes_arrows = false;
    if (input->pressed[UI_KEY_TAB] && (modifiers == 0 || is_back))
        self->step = is_back ? -1 : 1;
    if (has_menu && modifiers == 0)
        self->step += (input->pressed[UI_KEY_DOWN] ? 1 : 0) - (input->pressed[UI_KEY_UP] ? 1 : 0);
    if (self->step != 0 && input->is_typing) { /* on from the text, which ends */
        here(self) = g.ActiveId;
        ImGui::ClearActiveID();
    }
    bool is_pointing = false;
    for (int i = 0; i < UI_BUTTONS; ++i)
        is_pointing |= input->button[i];
    self->is_escaping = here(self) != 0 && input->pressed[UI_KEY_ESCAPE] && level == 0;
    if (is_pointing || self->is_escaping || here(self) == 0)
        take_away(self);
    if (here(self) == 0 && g.ActiveId != 0)
        self->last = g.ActiveId;
    self->is_pressing = here(self) != 0 && !input->is_typing && modifiers == 0 &&
                        (input->pressed[UI_KEY_ENTER] || input->pressed[' ']);
}

bool ui_focus_add(ui_focus *self, const char *label, ImGuiID id, const ImRect &box,
                  bool is_disabled)
{
    ImGuiContext &g = *ImGui::GetCurrentContext();
    if (is_disabled || ImMin(g.BeginPopupStack.Size, UI_FOCUS_LEVELS - 1) != self->level)
        return false;
    self->order.push_back(ui_focus_stop{id, ImGui::GetCurrentWindow()->RootWindow->Pos});
    if (here(self) != id)
        return false;
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    self->has_arrived = self->has_moved;
    self->has_moved = false;
    if (self->has_arrived)
        ImGui::ScrollToRect(window, box);
    self->is_seen = true;
    self->ring = box;
    self->clip = window->ClipRect;
    std::snprintf(self->label, sizeof self->label, "%s", label);
    return true;
}

void ui_focus_move(ui_focus *self, ImGuiID id)
{
    here(self) = id;
    self->has_moved = true;
}

void ui_focus_claim(ui_focus *self, ImGuiID id)
{
    self->claimed = id;
}

void ui_focus_forget(ui_focus *self)
{
    self->order.resize(0);
    self->is_seen = false;
}

int ui_focus_arrows(ui_focus *self, const ui_frame_input *input, bool is_upright)
{
    const int less = is_upright ? UI_KEY_UP : UI_KEY_LEFT,
              more = is_upright ? UI_KEY_DOWN : UI_KEY_RIGHT;
    self->takes_arrows = true;
    if (input->is_typing || (ui_frame_modifiers(input) & ~static_cast<uint32_t>(UI_SHIFT)) != 0)
        return 0;
    return (ImGui::IsKeyPressed(more, true) ? 1 : 0) - (ImGui::IsKeyPressed(less, true) ? 1 : 0);
}

bool ui_focus_has_key(const ui_focus *self, uint32_t key)
{
    const bool is_arrow =
        key == UI_KEY_LEFT || key == UI_KEY_RIGHT || key == UI_KEY_UP || key == UI_KEY_DOWN;
    return (self->is_escaping && key == UI_KEY_ESCAPE) ||
           (self->at[self->level] != 0 &&
            (key == UI_KEY_ENTER || key == ' ' || (is_arrow && self->took_arrows)));
}

static bool is_before(const ui_focus_stop &a, const ui_focus_stop &b)
{
    return a.panel.y < b.panel.y || (a.panel.y == b.panel.y && a.panel.x < b.panel.x);
}

/* From no control: to the first one, or backwards to the last. */
static void move(ui_focus *self)
{
    const ImGuiID was = here(self) != 0 ? here(self) : self->last;
    const int count = self->order.Size;
    int from = -1;
    std::stable_sort(self->order.begin(), self->order.end(), is_before);
    for (int i = 0; i < count && was != 0; ++i)
        if (self->order[i].id == was)
            from = i;
    const int to =
        from < 0 ? (self->step > 0 ? 0 : count - 1) : (from + self->step + count) % count;
    ui_focus_move(self, self->order[to].id);
}

void ui_focus_end(ui_focus *self, ImU32 colour, float thickness, float rounding)
{
    if (self->step != 0 && self->order.Size > 0)
        move(self);
    if (!self->is_seen) {
        if (!self->has_moved)
            take_away(self);
        return;
    }
    ImDrawList *list = ImGui::GetForegroundDrawList();
    ImRect ring = self->ring, clip = self->clip;
    clip.Expand(2.0f * thickness);
    ring.Expand(thickness);
    list->PushClipRect(clip.Min, clip.Max);
    list->AddRect(ring.Min, ring.Max, colour, rounding, 0, thickness);
    list->PopClipRect();
}
