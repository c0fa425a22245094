/* Widgets that hold a value: choices, sliders, lines that are typed. */
#include "window/ui_inside.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>

/* A label in the first points of the line; returns the box of what is to the right of it. */
static ImRect put_label(ui *self, const char *label, float label_width)
{
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    const ImVec2 at = window->DC.CursorPos;
    const float room = ImGui::GetContentRegionAvail().x, high = ImGui::GetFrameHeight();
    const float left = label_width > 0.0f ? ui_whole_px(self, label_width) : 0.0f;
    if (left > 0.0f) {
        ImRect box(at, at + ImVec2(left - ui_px(self, 6.0f), high));
        ui_put_text_in(self, self->font[UI_FONT_BODY], box, 0.0f, THEME_DIM, label,
                       ImGui::FindRenderedTextEnd(label));
        window->DC.CursorPos.x += left;
    }
    const float width = ui_take_width(self, ImMax(room - left, 1.0f));
    const ImVec2 from = window->DC.CursorPos;
    ImGui::SetNextItemWidth(ImMax(width, 1.0f));
    return ImRect(from, from + ImVec2(ImMax(width, 1.0f), high));
}

/* ---- choices ---- */

static void put_arrow(ui *self, const ImRect &box)
{
    const ImVec2 middle(box.Max.x - ui_px(self, 12.0f), box.GetCenter().y);
    const float r = ui_px(self, 4.0f);
    ImGui::GetWindowDrawList()->AddTriangleFilled(
        middle + ImVec2(-r, -0.5f * r), middle + ImVec2(r, -0.5f * r),
        middle + ImVec2(0.0f, 0.6f * r), ui_ink(THEME_DIM));
}

bool ui_choice(ui *self, const char *label, float label_width, const char *const *items,
               uint32_t count, uint32_t *index)
{
    const ImRect box = put_label(self, label, label_width);
    const char *shown = *index < count ? items[*index] : "";
    bool has_changed = false;
    ImGui::PushID(label);
    ui_put_box(self, box, THEME_WELL, ImGui::GetStyle().FrameRounding);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ui_px2(self, 6.0f, 6.0f));
    ImGui::PushStyleColor(ImGuiCol_FrameBg, 0u);
    ImGui::PushStyleColor(ImGuiCol_FrameBgHovered, ui_ink(THEME_RAISED));
    const bool is_open = ImGui::BeginCombo(
        "##choice", "", ImGuiComboFlags_NoArrowButton | ImGuiComboFlags_HeightLarge);
    ImGui::PopStyleColor(2);
    ImGui::PopStyleVar();
    if (is_open) {
        ui_enter_popup(self);
        for (uint32_t i = 0; i < count; ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (ui_row(self, items[i], i == *index) != UI_ROW_NONE) {
                has_changed = i != *index;
                *index = i;
                ImGui::CloseCurrentPopup();
            }
            ImGui::PopID();
        }
        ui_leave_popup(self);
        ImGui::EndCombo();
    }
    ImGui::PopID();
    put_arrow(self, box);
    ImRect words = box;
    words.Min.x += ui_whole_px(self, 8.0f);
    words.Max.x -= ui_whole_px(self, 22.0f);
    ui_put_text_in(self, self->font[UI_FONT_BODY], words, 0.0f, ui_colour_here(self, THEME_TEXT),
                   shown, ImGui::FindRenderedTextEnd(shown));
    return has_changed;
}

/* ---- sliders ---- */

struct slider_format {
    char text[48];
};

/* For printf, by what reads the number back too: so a unit's '%' is doubled. */
static slider_format format_of(const ui_range *range)
{
    slider_format out;
    const char *unit = range->unit ? range->unit : "";
    char shown[24] = "";
    size_t length = 0;
    for (; *unit && length + 3 < sizeof shown; ++unit) {
        if (*unit == '%')
            shown[length++] = '%';
        shown[length++] = *unit;
    }
    shown[length] = '\0';
    std::snprintf(out.text, sizeof out.text, "%%.%uf%s%s",
                  range->is_whole ? 0u : ImMin(range->digits, 9u), shown[0] ? " " : "", shown);
    return out;
}

static float share_of(const ui_range *range, double value)
{
    const double span = range->max - range->min;
    return span > 0.0 ? ImSaturate(static_cast<float>((value - range->min) / span)) : 0.0f;
}

/* What the slider has written in its middle. */
static void write_value(char (&out)[64], const ui_range *range, double value)
{
    const int digits = range->is_whole ? 0 : static_cast<int>(ImMin(range->digits, 9u));
    const char *unit = range->unit ? range->unit : "";
    std::snprintf(out, sizeof out, "%.*f%s%s", digits, value, unit[0] ? " " : "", unit);
}

/* Where it stands; above and below the number where it would cross that. */
static void put_mark(ui *self, const ImRect &at, const ImRect &words, uint32_t colour)
{
    if (at.Max.x < words.Min.x || at.Min.x > words.Max.x) {
        ui_put_box(self, at, colour, 0.0f);
        return;
    }
    ui_put_box(self, ImRect(at.Min, ImVec2(at.Max.x, words.Min.y)), colour, 0.0f);
    ui_put_box(self, ImRect(ImVec2(at.Min.x, words.Max.y), at.Max), colour, 0.0f);
}

static void put_track(ui *self, const ImRect &box, const ui_range *range, double value)
{
    const float rounding = ImGui::GetStyle().FrameRounding, mark = ui_whole_px(self, 2.0f);
    char text[64];
    write_value(text, range, value);
    const ImVec2 size = ui_measure(self->font[UI_FONT_BODY], text, nullptr);
    const ImVec2 half(0.5f * size.x + 2.0f * mark,
                      ImMin(0.5f * size.y, 0.5f * box.GetHeight() - 2.0f * mark));
    const ImRect words(ImFloor(box.GetCenter() - half), ImFloor(box.GetCenter() + half));
    ImRect full = box, at = box;
    full.Max.x = ImFloor(box.Min.x + share_of(range, value) * box.GetWidth());
    at.Min.x = ImClamp(full.Max.x - mark, box.Min.x, box.Max.x - mark);
    at.Max.x = at.Min.x + mark;
    ui_put_box(self, box, THEME_WELL, rounding);
    if (full.GetWidth() > 1.0f)
        ui_put_box(self, full, THEME_RAISED, rounding);
    put_mark(self, at, words, self->disabled_depth ? THEME_RULE : THEME_ACCENT);
}

static void note_value(ui *self, const ImRect &box, const ui_range *range, double value)
{
    char text[64];
    write_value(text, range, value);
    ImFont *font = self->font[UI_FONT_BODY];
    const char *end = text + std::strlen(text);
    const ImVec2 size = ui_measure(font, text, end);
    ui_note_text(self, font, box.GetCenter() - size * 0.5f, ui_colour_here(self, THEME_TEXT), box,
                 size.x > box.GetWidth(), text, end);
}

bool ui_slider(ui *self, const char *label, float label_width, const ui_range *range, double *value)
{
    const double before = *value;
    const slider_format format = format_of(range);
    const ImRect box = put_label(self, label, label_width);
    ImGui::PushID(label);
    const bool is_typed = ImGui::TempInputIsActive(ImGui::GetID("##slider"));
    if (!is_typed)
        put_track(self, box, range, *value);
    ImGui::PushStyleColor(ImGuiCol_FrameBg, is_typed ? ui_ink(THEME_WELL) : 0u);
    ImGui::PushStyleColor(ImGuiCol_FrameBgHovered, is_typed ? ui_ink(THEME_WELL) : 0u);
    ImGui::PushStyleColor(ImGuiCol_FrameBgActive, is_typed ? ui_ink(THEME_WELL) : 0u);
    ImGui::SliderScalar("##slider", ImGuiDataType_Double, value, &range->min, &range->max,
                        format.text, ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopStyleColor(3);
    if (!is_typed)
        note_value(self, box, range, *value);
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0)) {
        *value = range->initial;
        ImGui::ClearActiveID();
    }
    self->is_slider_held = ImGui::IsItemActive() && !is_typed;
    ImGui::PopID();
    if (range->is_whole)
        *value = std::floor(*value + 0.5);
    if (!std::isfinite(*value))
        *value = range->initial;
    return *value != before;
}

bool ui_slider_is_held(const ui *self)
{
    return self->is_slider_held;
}

/* ---- what is typed ---- */

void ui_input_take_keys(ui *self)
{
    self->takes_keys = true;
}

static void note_input(ui *self, const ImRect &box, const char *text, uint32_t colour)
{
    const ImVec2 padding = ImGui::GetStyle().FramePadding;
    ImFont *font = self->font[UI_FONT_BODY];
    const char *line_end = std::strchr(text, '\n'), *stop = nullptr;
    const char *end = line_end ? line_end : text + std::strlen(text);
    font->CalcTextSizeA(font->FontSize, ImMax(box.GetWidth() - 2.0f * padding.x, 1.0f), 0.0f, text,
                        end, &stop);
    ui_note_text(self, font, box.Min + padding, colour, box, false, text, stop);
}

/* After the widget: true when it was ended with another text. */
static bool was_ended(ui *self, const char *text)
{
    if (ImGui::IsItemActivated())
        ImStrncpy(self->before, text, sizeof self->before);
    return ImGui::IsItemDeactivated() &&
           std::strncmp(self->before, text, sizeof self->before - 1) != 0;
}

bool ui_input(ui *self, const char *id, const char *hint, char *text, size_t capacity)
{
    const ImRect box = put_label(self, id, 0.0f);
    ui_notes_box(self->notes, self->surface, ui_points_box(self, box), THEME_WELL);
    if (self->takes_keys)
        ImGui::SetKeyboardFocusHere();
    self->takes_keys = false;
    ImGui::InputTextWithHint(id, hint ? hint : "", text, capacity,
                             ImGuiInputTextFlags_AutoSelectAll);
    const bool is_ended = was_ended(self, text);
    note_input(self, box, text[0] ? text : hint ? hint : "", text[0] ? THEME_TEXT : THEME_DIM);
    return is_ended;
}

bool ui_input_is_entered(const ui *self)
{
    (void)self;
    return ImGui::IsItemDeactivated() &&
           ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
}

bool ui_input_lines(ui *self, const char *id, char *text, size_t capacity, float height)
{
    ImRect box = put_label(self, id, 0.0f);
    const float high = height > 0.0f ? ui_px(self, height)
                                     : ImGui::GetContentRegionAvail().y + ui_px(self, height);
    box.Max.y = box.Min.y + high;
    ui_notes_box(self->notes, self->surface, ui_points_box(self, box), THEME_WELL);
    ImGui::InputTextMultiline(id, text, capacity, box.GetSize());
    const bool is_ended = was_ended(self, text);
    note_input(self, box, text, THEME_TEXT);
    return is_ended;
}
