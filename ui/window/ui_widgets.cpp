/* Widgets that are pressed: buttons, checks, tabs, sections, rows; and bars. */
#include "window/ui_inside.hpp"

float ui_take_width(ui *self, float natural_px)
{
    const float wanted = self->next_width, room = ImGui::GetContentRegionAvail().x;
    self->next_width = 0.0f;
    if (wanted > 0.0f)
        return wanted;
    return wanted < 0.0f ? ImMax(room + wanted, 1.0f) : natural_px;
}

ui_pressing ui_press_item(const char *label, ImVec2 size, ImGuiButtonFlags flags)
{
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    ui_pressing out = {};
    const ImGuiID id = window->GetID(label);
    const ImVec2 at = window->DC.CursorPos;
    out.box = ImRect(at, at + size);
    ImGui::ItemSize(size, ImGui::GetStyle().FramePadding.y);
    out.is_seen = ImGui::ItemAdd(out.box, id);
    if (out.is_seen)
        out.is_pressed = ImGui::ButtonBehavior(out.box, id, &out.is_hovered, &out.is_held, flags);
    return out;
}

static const char *shown_end(const char *label)
{
    return ImGui::FindRenderedTextEnd(label);
}

/* ---- buttons and checks ---- */

typedef struct button_look {
    uint32_t ground, hover, text;
} button_look;

static button_look look_of(const ui *self, ui_emphasis emphasis)
{
    if (self->disabled_depth)
        return button_look{emphasis == UI_QUIET ? 0u : THEME_WELL, THEME_WELL, THEME_DIM};
    switch (emphasis) {
    case UI_ACCENT:
        return button_look{THEME_ACCENT, 0xe6b65cffu, THEME_STAGE};
    case UI_RECORD:
        return button_look{THEME_RECORD, 0xff8278ffu, THEME_STAGE};
    case UI_QUIET:
        return button_look{0, THEME_RAISED, THEME_TEXT};
    case UI_PLAIN:
        break;
    }
    return button_look{THEME_RAISED, THEME_HOVER, THEME_TEXT};
}

bool ui_button(ui *self, const char *label, ui_emphasis emphasis)
{
    const char *end = shown_end(label);
    ImFont *font = self->font[UI_FONT_BODY];
    const float padding = ui_whole_px(self, emphasis == UI_QUIET ? 7.0f : 11.0f);
    const float natural = ImCeil(ui_measure(font, label, end).x) + 2.0f * padding;
    const float width = ui_take_width(self, natural);
    const ui_pressing press = ui_press_item(label, ImVec2(width, ImGui::GetFrameHeight()), 0);
    if (!press.is_seen)
        return false;
    const button_look look = look_of(self, emphasis);
    const float inset = ImMin(padding, ImMax(0.5f * (width - (natural - 2.0f * padding)), 2.0f));
    ui_put_box(self, press.box, press.is_hovered ? look.hover : look.ground,
               ImGui::GetStyle().FrameRounding);
    ImRect inner = press.box;
    inner.Min.x += inset;
    inner.Max.x -= inset;
    ui_put_text_in(self, font, inner, 0.5f, look.text, label, end);
    return press.is_pressed;
}

static void put_tick(ui *self, const ImRect &box)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    const float unit = box.GetWidth() / 16.0f;
    list->PathLineTo(box.Min + ImVec2(3.5f * unit, 8.5f * unit));
    list->PathLineTo(box.Min + ImVec2(6.8f * unit, 11.8f * unit));
    list->PathLineTo(box.Min + ImVec2(12.5f * unit, 4.8f * unit));
    list->PathStroke(ui_ink(self->disabled_depth ? THEME_DIM : THEME_STAGE), 0, 2.0f * unit);
}

bool ui_check(ui *self, const char *label, bool *value)
{
    const char *end = shown_end(label);
    ImFont *font = self->font[UI_FONT_BODY];
    const float side = ui_whole_px(self, 16.0f), gap = ui_whole_px(self, 7.0f);
    const float width =
        ui_take_width(self, side + gap + ImCeil(ui_measure(font, label, end).x) + 2.0f);
    const ui_pressing press = ui_press_item(label, ImVec2(width, ImGui::GetFrameHeight()), 0);
    if (!press.is_seen)
        return false;
    if (press.is_pressed)
        *value = !*value;
    ImRect box(press.box.Min, press.box.Min + ImVec2(side, side));
    box.Translate(ImVec2(0.0f, ImFloor(0.5f * (press.box.GetHeight() - side))));
    const bool is_bright = *value && !self->disabled_depth;
    ui_put_box(self, box,
               is_bright          ? THEME_ACCENT
               : press.is_hovered ? THEME_HOVER
                                  : THEME_RAISED,
               ui_px(self, 3.0f));
    if (*value)
        put_tick(self, box);
    ImRect words = press.box;
    words.Min.x += side + gap;
    ui_put_text_in(self, font, words, 0.0f, ui_colour_here(self, THEME_TEXT), label, end);
    return press.is_pressed;
}

/* ---- tabs and sections ---- */

static bool put_tab(ui *self, const char *name, float width, bool is_chosen)
{
    ImFont *font = self->font[is_chosen ? UI_FONT_STRONG : UI_FONT_BODY];
    const ui_pressing press = ui_press_item(name, ImVec2(width, ui_whole_px(self, 30.0f)), 0);
    if (!press.is_seen)
        return false;
    ImRect line = press.box;
    line.Min.y = line.Max.y - ui_whole_px(self, 2.0f);
    if (press.is_hovered && !is_chosen)
        ui_put_box(self, press.box, THEME_RAISED, ImGui::GetStyle().FrameRounding);
    if (is_chosen)
        ui_put_box(self, line, THEME_ACCENT, 0.0f);
    ui_put_text_in(self, font, press.box, 0.5f, is_chosen ? THEME_TEXT : THEME_DIM, name,
                   shown_end(name));
    return press.is_pressed;
}

bool ui_tabs(ui *self, const char *id, const char *const *names, uint32_t count, uint32_t *index)
{
    const uint32_t before = *index;
    float words = 0.0f;
    for (uint32_t i = 0; i < count; ++i)
        words += ui_measure(self->font[UI_FONT_STRONG], names[i], shown_end(names[i])).x;
    const float room = ImGui::GetContentRegionAvail().x;
    const float most = ui_px(self, 28.0f), even = (room - words) / static_cast<float>(count);
    const float padding = ImClamp(even, 2.0f, most);
    ImGui::PushID(id);
    for (uint32_t i = 0; i < count; ++i) {
        if (i > 0)
            ImGui::SameLine(0.0f, 0.0f);
        const float own = ui_measure(self->font[UI_FONT_STRONG], names[i], shown_end(names[i])).x;
        if (put_tab(self, names[i], ImFloor(own + padding), i == before))
            *index = i;
    }
    ImGui::PopID();
    return *index != before;
}

static void put_triangle(const ImRect &box, bool is_open, uint32_t colour)
{
    const ImVec2 middle = box.GetCenter();
    const float r = 0.5f * box.GetWidth();
    ImDrawList *list = ImGui::GetWindowDrawList();
    if (is_open)
        list->AddTriangleFilled(middle + ImVec2(-r, -0.5f * r), middle + ImVec2(r, -0.5f * r),
                                middle + ImVec2(0.0f, 0.7f * r), ui_ink(colour));
    else
        list->AddTriangleFilled(middle + ImVec2(-0.5f * r, -r), middle + ImVec2(0.7f * r, 0.0f),
                                middle + ImVec2(-0.5f * r, r), ui_ink(colour));
}

bool ui_section(ui *self, const char *title, bool is_open_at_first)
{
    ImGuiStorage *storage = ImGui::GetStateStorage();
    const ImGuiID id = ImGui::GetID(title);
    bool is_open = storage->GetBool(id, is_open_at_first);
    ui_space(self, 4.0f);
    const float width = ImGui::GetContentRegionAvail().x;
    const ui_pressing press = ui_press_item(title, ImVec2(width, ImGui::GetFrameHeight()), 0);
    if (press.is_pressed) {
        is_open = !is_open;
        storage->SetBool(id, is_open);
    }
    if (!press.is_seen)
        return is_open;
    const float side = ui_whole_px(self, 8.0f), left = ui_whole_px(self, 15.0f);
    ImRect mark(press.box.Min, press.box.Min + ImVec2(side, side));
    mark.Translate(ImVec2(0.0f, ImFloor(0.5f * (press.box.GetHeight() - side))));
    if (press.is_hovered)
        ui_put_box(self, press.box, THEME_RAISED, ImGui::GetStyle().FrameRounding);
    put_triangle(mark, is_open, press.is_hovered ? THEME_TEXT : THEME_DIM);
    ImRect words = press.box;
    words.Min.x += left;
    ui_put_text_in(self, self->font[UI_FONT_TITLE], words, 0.0f, THEME_TEXT, title,
                   shown_end(title));
    return is_open;
}

/* ---- rows and bars ---- */

ui_row_click ui_row(ui *self, const char *label, bool is_selected)
{
    const float width = ui_take_width(self, ImGui::GetContentRegionAvail().x);
    const ui_pressing press = ui_press_item(
        label, ImVec2(ImMax(width, 1.0f), ImGui::GetFrameHeight()),
        ImGuiButtonFlags_PressedOnClickRelease | ImGuiButtonFlags_PressedOnDoubleClick);
    if (!press.is_seen)
        return UI_ROW_NONE;
    if (is_selected || press.is_hovered)
        ui_put_box(self, press.box, is_selected ? THEME_HOVER : THEME_RAISED,
                   ImGui::GetStyle().FrameRounding);
    ImRect words = press.box;
    words.Min.x += ui_whole_px(self, 7.0f);
    words.Max.x -= ui_whole_px(self, 7.0f);
    ui_put_text_in(self, self->font[UI_FONT_BODY], words, 0.0f, ui_colour_here(self, THEME_TEXT),
                   label, shown_end(label));
    if (press.is_pressed && ImGui::IsMouseDoubleClicked(0))
        return UI_ROW_DOUBLE_CLICKED;
    return press.is_pressed ? UI_ROW_CLICKED : UI_ROW_NONE;
}

void ui_bar(ui *self, float share, float width, float height, ui_style style)
{
    const float wide =
        width > 0.0f ? ui_px(self, width) : ImGui::GetContentRegionAvail().x + ui_px(self, width);
    const ImVec2 size(ImMax(wide, 1.0f), ImMax(ui_whole_px(self, height), 1.0f));
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    const ImVec2 at = window->DC.CursorPos + ImVec2(0.0f, window->DC.CurrLineTextBaseOffset);
    const ImRect box(at, at + size);
    ImGui::ItemSize(size, 0.0f);
    if (!ImGui::ItemAdd(box, 0))
        return;
    const float part = share == share ? ImSaturate(share) : 0.0f, rounding = ui_px(self, 2.0f);
    ImRect full = box;
    full.Max.x = box.Min.x + part * size.x;
    ui_put_box(self, box, THEME_WELL, rounding);
    if (full.GetWidth() >= 1.0f)
        ui_put_box(self, full, style == UI_STYLE_BODY ? THEME_ACCENT : ui_style_colour(style),
                   rounding);
}
