/* Text: how wide it is, put on the screen, cut, wrapped, and noted for tests. */
#include "window/ui_inside.hpp"

#include <cstring>

static const char ELLIPSIS[] = "\xe2\x80\xa6";

uint32_t ui_style_colour(ui_style style)
{
    switch (style) {
    case UI_STYLE_DIM:
        return THEME_DIM;
    case UI_STYLE_GOOD:
        return THEME_GOOD;
    case UI_STYLE_WARNING:
        return THEME_WARNING;
    case UI_STYLE_BAD:
        return THEME_BAD;
    default:
        return THEME_TEXT;
    }
}

ImFont *ui_style_font(const ui *self, ui_style style)
{
    switch (style) {
    case UI_STYLE_STRONG:
        return self->font[UI_FONT_STRONG];
    case UI_STYLE_TITLE:
        return self->font[UI_FONT_TITLE];
    case UI_STYLE_LARGE:
        return self->font[UI_FONT_LARGE];
    case UI_STYLE_NUMBER:
        return self->font[UI_FONT_NUMBER];
    default:
        return self->font[UI_FONT_BODY];
    }
}

ImVec2 ui_measure(const ImFont *font, const char *begin, const char *end)
{
    return font->CalcTextSizeA(font->FontSize, FLT_MAX, 0.0f, begin, end);
}

/* ---- notes ---- */

/* The box of what is really inked. */
static ImRect ink_of(const ImFont *font, ImVec2 at, const char *begin, const char *end)
{
    ImRect ink(FLT_MAX, FLT_MAX, -FLT_MAX, -FLT_MAX);
    float x = at.x;
    while (begin < end) {
        unsigned int c = 0;
        begin += ImTextCharFromUtf8(&c, begin, end);
        if (c == 0)
            break;
        const ImFontGlyph *glyph = font->FindGlyph(static_cast<ImWchar>(c));
        if (!glyph)
            continue;
        if (glyph->Visible)
            ink.Add(ImRect(x + glyph->X0, at.y + glyph->Y0, x + glyph->X1, at.y + glyph->Y1));
        x += glyph->AdvanceX;
    }
    return ink.Min.x > ink.Max.x ? ImRect(at, at) : ink;
}

void ui_note_text(ui *self, ImFont *font, ImVec2 at, uint32_t colour, const ImRect &clip,
                  bool is_cut, const char *begin, const char *end)
{
    if (!ui_notes_is_on(self->notes) || begin == end)
        return;
    char text[512];
    const size_t size = ImMin(static_cast<size_t>(end - begin), sizeof text - 1);
    std::memcpy(text, begin, size);
    text[size] = '\0';
    ui_word word = {};
    word.where = ui_points_box(self, ink_of(font, at, begin, end));
    word.clip = ui_points_box(self, clip);
    word.colour = colour;
    word.is_cut = is_cut;
    word.text = text;
    ui_notes_word(self->notes, self->surface, &word);
}

/* ---- putting it there ---- */

void ui_put_text(ui *self, ImFont *font, ImVec2 at, uint32_t colour, float max_px,
                 const char *begin, const char *end)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImVec4 clip = list->_ClipRectStack.back();
    const ImRect clip_box(clip);
    at = ImFloor(at + ImVec2(0.5f, 0.5f));
    if (max_px <= 0.0f || ui_measure(font, begin, end).x <= max_px) {
        list->AddText(font, font->FontSize, at, ui_ink(colour), begin, end);
        ui_note_text(self, font, at, colour, clip_box, false, begin, end);
        return;
    }
    const float dots_px = ui_measure(font, ELLIPSIS, nullptr).x;
    const char *stop = begin;
    float width =
        font->CalcTextSizeA(font->FontSize, ImMax(max_px - dots_px, 1.0f), 0.0f, begin, end, &stop)
            .x;
    while (stop > begin && stop[-1] == ' ')
        --stop;
    width = ui_measure(font, begin, stop).x;
    list->AddText(font, font->FontSize, at, ui_ink(colour), begin, stop);
    list->AddText(font, font->FontSize, at + ImVec2(width, 0.0f), ui_ink(colour), ELLIPSIS);
    ui_note_text(self, font, at, colour, clip_box, true, begin, stop);
}

void ui_put_text_in(ui *self, ImFont *font, const ImRect &box, float align, uint32_t colour,
                    const char *begin, const char *end)
{
    const ImVec2 size = ui_measure(font, begin, end);
    const float room = box.GetWidth() - size.x;
    const ImVec2 at(box.Min.x + ImMax(room, 0.0f) * align,
                    box.Min.y + 0.5f * (box.GetHeight() - font->FontSize));
    ui_put_text(self, font, at, colour, ImMax(box.GetWidth() + 0.5f, 1.0f), begin, end);
}

void ui_put_box(ui *self, const ImRect &box, uint32_t colour, float rounding_px)
{
    if ((colour & 0xffu) == 0)
        return;
    ImGui::GetWindowDrawList()->AddRectFilled(box.Min, box.Max, ui_ink(colour), rounding_px);
    ui_notes_box(self->notes, self->surface, ui_points_box(self, box), colour);
}

/* ---- lines of a panel ---- */

static void put_line(ui *self, ui_style style, uint32_t colour, const char *begin, const char *end)
{
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    ImFont *font = ui_style_font(self, style);
    const ImVec2 at = window->DC.CursorPos + ImVec2(0.0f, window->DC.CurrLineTextBaseOffset);
    const float room = ImMax(ImGui::GetContentRegionAvail().x, 1.0f);
    const ImVec2 size(ImMin(ui_measure(font, begin, end).x, room), font->FontSize);
    const ImRect box(at, at + size);
    ImGui::ItemSize(size, 0.0f);
    if (ImGui::ItemAdd(box, 0))
        ui_put_text(self, font, at, colour, room + 0.5f, begin, end);
}

void ui_text(ui *self, ui_style style, const char *text)
{
    put_line(self, style, ui_colour_here(self, ui_style_colour(style)), text,
             text + std::strlen(text));
}

/* Where a line ends: at a blank, for Dear ImGui breaks "0.5" too; within a word that has no room.
 */
static const char *line_stop(const ImFont *font, const char *text, const char *end, float room)
{
    const char *stop = font->CalcWordWrapPositionA(1.0f, text, end, room);
    const char *blank = stop;
    if (stop == end || *stop == ' ' || *stop == '\n')
        return stop;
    while (blank > text && blank[-1] != ' ' && blank[-1] != '\n')
        --blank;
    return blank > text ? blank : stop;
}

void ui_text_wrapped(ui *self, ui_style style, const char *text)
{
    const char *end = text + std::strlen(text);
    const ImFont *font = ui_style_font(self, style);
    const float room = ImMax(ImGui::GetContentRegionAvail().x, 1.0f);
    const ImGuiStyle &look = ImGui::GetStyle();
    ImGui::BeginGroup();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(look.ItemSpacing.x, 0.0f));
    do {
        const char *stop = line_stop(font, text, end, room);
        const char *line_end =
            static_cast<const char *>(std::memchr(text, '\n', static_cast<size_t>(stop - text)));
        if (line_end)
            stop = line_end;
        if (stop == text && stop < end && *stop != '\n')
            stop = text + 1;
        put_line(self, style, ui_colour_here(self, ui_style_colour(style)), text, stop);
        text = stop;
        while (text < end && (*text == ' ' || *text == '\n'))
            ++text;
    } while (text < end);
    ImGui::PopStyleVar();
    ImGui::EndGroup();
}

void ui_fact(ui *self, const char *label, float x, ui_style style, const char *value)
{
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    const ImGuiStyle &look = ImGui::GetStyle();
    ImFont *font = ui_style_font(self, style), *body = self->font[UI_FONT_BODY];
    const ImVec2 at = window->DC.CursorPos;
    const float line = ImMax(font->FontSize, body->FontSize),
                room = ImGui::GetContentRegionAvail().x;
    const float left = window->Pos.x + window->WindowPadding.x - window->Scroll.x + ui_px(self, x);
    const float drop = 0.5f * (line - body->FontSize);
    ImGui::ItemSize(ImVec2(room, line), 0.0f);
    if (!ImGui::ItemAdd(ImRect(at, at + ImVec2(room, line)), 0))
        return;
    ui_put_text(self, body, at + ImVec2(0.0f, drop), THEME_DIM,
                ImMax(left - at.x - look.ItemSpacing.x, 1.0f), label, label + std::strlen(label));
    ui_put_text(self, font, ImVec2(left, at.y + 0.5f * (line - font->FontSize)),
                ui_colour_here(self, ui_style_colour(style)), ImMax(at.x + room - left, 1.0f),
                value, value + std::strlen(value));
}

float ui_text_width(const ui *self, ui_style style, const char *text)
{
    return ui_measure(ui_style_font(self, style), text, nullptr).x / self->scale;
}

float ui_text_height(const ui *self, ui_style style)
{
    return ui_style_font(self, style)->FontSize / self->scale;
}
