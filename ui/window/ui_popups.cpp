/* What comes over the panels for a while: hints, menus, questions. */
#include "window/ui_inside.hpp"

#include <cstring>

void ui_enter_popup(ui *self)
{
    const ui_rectangle where = ui_points_box(self, ImGui::GetCurrentWindow()->Rect());
    if (self->popup_depth < UI_POPUPS_MAX)
        self->surface_below[self->popup_depth] = self->surface;
    self->popup_depth += 1;
    self->surface = ui_notes_surface(self->notes, where, true);
    ui_notes_box(self->notes, self->surface, where, THEME_PANEL);
}

void ui_leave_popup(ui *self)
{
    self->popup_depth -= 1;
    if (self->popup_depth < UI_POPUPS_MAX)
        self->surface = self->surface_below[self->popup_depth];
}

/* ---- of the last widget ---- */

bool ui_is_hovered(const ui *self)
{
    (void)self;
    return ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
}

static void put_hint(ui *self, const char *text)
{
    const float widest = ui_px(self, 300.0f),
                wide = ui_measure(self->font[UI_FONT_BODY], text, nullptr).x;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ui_px2(self, 9.0f, 7.0f));
    ImGui::SetNextWindowSize(ImVec2(ImMin(wide + 1.0f, widest) + 2.0f * ui_px(self, 9.0f), 0.0f));
    ImGui::BeginTooltipEx(ImGuiWindowFlags_NoFocusOnAppearing, ImGuiTooltipFlags_None);
    const int disabled = self->disabled_depth;
    ui_enter_popup(self);
    self->disabled_depth = 0;
    ui_text_wrapped(self, UI_STYLE_BODY, text);
    self->disabled_depth = disabled;
    ui_leave_popup(self);
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
}

void ui_hint(ui *self, const char *text)
{
    constexpr double moment_s = 0.6;
    ImGuiID id = ImGui::GetItemID();
    if (!ui_is_hovered(self)) {
        if (id && self->hinted == id)
            self->hinted = 0;
        return;
    }
    if (!id)
        id = ImGui::GetID(text);
    if (self->hinted != id) {
        self->hinted = id;
        self->hinted_s = 0.0;
    }
    const ImGuiIO &io = ImGui::GetIO();
    self->hinted_s += self->screen.dt_s;
    if (io.MouseDown[0] || io.MouseDown[1] || io.MouseWheel != 0.0f)
        self->hinted_s = 0.0;
    if (self->hinted_s >= moment_s && text[0])
        put_hint(self, text);
}

/* ---- menus ---- */

bool ui_menu_begin(ui *self, const char *id)
{
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ui_px2(self, 6.0f, 6.0f));
    const bool is_open = ImGui::BeginPopupContextItem(id);
    ImGui::PopStyleVar();
    if (is_open)
        ui_enter_popup(self);
    return is_open;
}

bool ui_menu_item(ui *self, const char *label, const char *keys, bool is_enabled)
{
    const char *end = ImGui::FindRenderedTextEnd(label);
    ImFont *font = self->font[UI_FONT_BODY];
    const float padding = ui_whole_px(self, 7.0f), gap = ui_whole_px(self, 24.0f);
    const float key_width = keys && keys[0] ? gap + ui_measure(font, keys, nullptr).x : 0.0f;
    const float natural = ImCeil(ui_measure(font, label, end).x + key_width) + 2.0f * padding;
    ui_disabled_begin(self, !is_enabled);
    const float width = ImMax(natural, ImGui::GetContentRegionAvail().x);
    const ui_pressing press = ui_press_item(label, ImVec2(width, ImGui::GetFrameHeight()), 0);
    if (press.is_seen) {
        ImRect inner = press.box;
        inner.Expand(ImVec2(-padding, 0.0f));
        if (press.is_hovered)
            ui_put_box(self, press.box, THEME_HOVER, ImGui::GetStyle().FrameRounding);
        ui_put_text_in(self, font, inner, 0.0f, ui_colour_here(self, THEME_TEXT), label, end);
        if (key_width > 0.0f)
            ui_put_text_in(self, font, inner, 1.0f, THEME_DIM, keys, keys + std::strlen(keys));
    }
    ui_disabled_end(self);
    if (press.is_pressed)
        ImGui::CloseCurrentPopup();
    return press.is_pressed;
}

void ui_menu_end(ui *self)
{
    ui_leave_popup(self);
    ImGui::EndPopup();
}

/* ---- questions ---- */

/* The same name means the same question, from whichever panel it is asked. */
static ImGuiID family_of_dialogs(void)
{
    return ImHashStr("dialogs");
}

/* It opens where it is begun: asked for in a menu, it would go with the menu. */
void ui_dialog_open(ui *self, const char *id)
{
    self->dialog_wanted = ImHashStr(id);
}

static bool begin_modal(ui *self, const char *id, float width)
{
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float wide = ImMin(ui_px(self, width), screen.x - 2.0f * ui_px(self, THEME_PADDING));
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings |
                                   ImGuiWindowFlags_AlwaysAutoResize;
    if (self->dialog_wanted == ImHashStr(id)) {
        self->dialog_wanted = 0;
        ImGui::OpenPopup(id);
    }
    if (!ImGui::IsPopupOpen(id))
        return false;
    ImGui::SetNextWindowPos(ImFloor(ImVec2(0.5f * screen.x, 0.42f * screen.y)), ImGuiCond_Always,
                            ImVec2(0.5f, 0.42f));
    ImGui::SetNextWindowSizeConstraints(ImVec2(ImFloor(wide), 0.0f),
                                        ImVec2(ImFloor(wide), 0.94f * screen.y));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ui_px2(self, 18.0f, 16.0f));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, ui_px(self, 8.0f));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, ui_px(self, 1.0f));
    const bool is_open = ImGui::BeginPopupModal(id, nullptr, flags);
    ImGui::PopStyleVar(3);
    return is_open;
}

bool ui_dialog_begin(ui *self, const char *id, const char *title, float width)
{
    ImGui::PushOverrideID(family_of_dialogs());
    if (!begin_modal(self, id, width)) {
        ImGui::PopID();
        return false;
    }
    self->dialog_depth += 1;
    self->has_dialog = true;
    ui_enter_popup(self);
    ui_text(self, UI_STYLE_TITLE, title);
    ui_space(self, 6.0f);
    if (ui_pressed(self, UI_KEY_ESCAPE, 0))
        ImGui::CloseCurrentPopup();
    return true;
}

/* Whoever asked has gone, and the question with him: else it would block everything, unseen. */
void ui_close_left_popups()
{
    const ImGuiContext &context = *ImGui::GetCurrentContext();
    for (int level = 0; level < context.OpenPopupStack.Size; ++level) {
        const ImGuiWindow *popup = context.OpenPopupStack[level].Window;
        if (!popup || popup->Active)
            continue;
        ImGui::ClosePopupToLevel(level, false);
        return;
    }
}

bool ui_has_dialog(const ui *self)
{
    return self->has_dialog || self->had_dialog;
}

void ui_dialog_close(ui *self)
{
    (void)self;
    ImGui::CloseCurrentPopup();
}

void ui_dialog_end(ui *self)
{
    ui_leave_popup(self);
    self->dialog_depth -= 1;
    ImGui::EndPopup();
    ImGui::PopID();
}
