/* The facade over Dear ImGui; beside it only ui_damage.cpp knows it. */
extern "C" {
#include "window/gui/ui.h"
#include "base/installed.h"
#include "draw/gl.h"
#include "draw/system_font.h"
#include "window/gui/theme.h"
#include "window/gui/ui_notes.h"
#include "window/gui/ui_queue.h"
}
#define IMGUI_DEFINE_MATH_OPERATORS
#include "window/gui/ui_damage.hpp"
#include "window/gui/ui_focus.hpp"
#include <imgui.h>
#include <imgui_internal.h>
#include <backends/imgui_impl_opengl3.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <unistd.h>

constexpr int UI_PANELS_MAX = 96;
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

constexpr uint32_t UI_CHARACTERS_MAX = 2048; /* bounds the texture of the fonts */

struct ui_characters {
    uint32_t bits[0x10000 / 32];
    uint32_t count;
    bool is_new; /* since the fonts were loaded */
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
    system_fonts *system;
    ui_characters *wanted;      /* those that were to be drawn and are not in the usual ranges */
    theme look, wanted_look;    /* of this frame; of the next */
    int plain_depth;            /* on the face: colours are not converted to the theme */
    bool is_drawing, has_drawn; /* OpenGL was started; OpenGL objects exist */
    ui_damage *damage;          /* draw lists of the previous frame */
    ui_damage_images images;    /* of this frame */
    bool is_new;                /* this frame was drawn: something of it is new */
    double wanted_s;            /* when the next frame is wanted; HUGE_VAL: nobody wants one */
    ui_cursor cursor;

    ImGuiWindow *panel[UI_PANELS_MAX]; /* of this frame, in order */
    int panel_count;
    uint32_t surface; /* of ui_notes that is drawn on */
    uint32_t surface_below[UI_POPUPS_MAX];
    int popup_depth;
    bool has_dialog, had_dialog; /* drawn in this frame; in the one before */
    bool types_lines;            /* in a text of several lines, in this frame */
    bool is_answered;            /* in this frame, by Enter */
    bool has_menu;               /* a menu or a drop-down was open as the frame began: Esc is its */
    ImGuiID dialog_wanted;
    ImVec2 menu_at;   /* pixels; where ui_menu_open opened one */
    float next_width; /* pixels; of the next widget */
    int disabled_depth;
    int dialog_depth;
    bool is_slider_held;
    uint32_t command, command_modifiers; /* pressed while a text was typed: of the next frame */
    uint32_t late, late_modifiers;       /* the one of the frame before */
    bool takes_keys;                     /* the next input */
    ui_focus focus;
    ImGuiID hinted; /* what the pointer rests on */
    double hinted_s;
    ui_grip grip;
    char before[UI_INPUT_MAX]; /* text of the edited field before editing */
};

/* ---- sizes and colours ---- */

static float ui_px(const ui *self, float points)
{
    return points * self->scale;
}

static float ui_whole_px(const ui *self, float points)
{
    return ImFloorSigned(points * self->scale + 0.5f);
}

static ImVec2 ui_px2(const ui *self, float x, float y)
{
    return ImVec2(ui_px(self, x), ui_px(self, y));
}

static ImRect ui_px_box(const ui *self, ui_rectangle r)
{
    return ImRect(ui_px2(self, r.x, r.y), ui_px2(self, r.x + r.width, r.y + r.height));
}

static ui_rectangle ui_points_box(const ui *self, const ImRect &r)
{
    return ui_rectangle{r.Min.x / self->scale, r.Min.y / self->scale,
                        (r.Max.x - r.Min.x) / self->scale, (r.Max.y - r.Min.y) / self->scale};
}

/* The colour in the current theme. */
static uint32_t ui_shown(const ui *self, uint32_t colour)
{
    const bool is_light = self->look.is_light && self->plain_depth == 0;
    return theme_colour(theme{is_light, self->look.is_colour_safe}, colour);
}

static ImU32 ui_ink(const ui *self, uint32_t said)
{
    const uint32_t colour = ui_shown(self, said);
    return IM_COL32(colour >> 24, colour >> 16 & 0xffu, colour >> 8 & 0xffu, colour & 0xffu);
}

/* The colour of text here: dim where nothing can be done. */
static uint32_t ui_colour_here(const ui *self, uint32_t colour)
{
    return self->disabled_depth ? THEME_DIM : colour;
}

struct ui_pressing {
    ImRect box;
    bool is_seen, is_pressed, is_hovered, is_held, has_ring;
};

/* ---- text: how wide it is, put on the screen, cut, wrapped, and noted for tests ---- */

static const char ELLIPSIS[] = "\xe2\x80\xa6";

static uint32_t ui_style_colour(ui_style style)
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

static ImFont *ui_style_font(const ui *self, ui_style style)
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

/* Of "Name##id". */
static const char *shown_end(const char *label)
{
    return ImGui::FindRenderedTextEnd(label);
}

static ImVec2 ui_measure(const ImFont *font, const char *begin, const char *end)
{
    return font->CalcTextSizeA(font->FontSize, FLT_MAX, 0.0f, begin, end);
}

/* Latin with accents, Greek, Cyrillic, dashes, arrows, shapes, stars. */
static const ImWchar text_ranges[] = {
    0x20,   0x17f,  0x2c6,  0x2dd,  0x391,  0x3c9,  0x401,  0x45f,  0x2010, 0x203a, 0x20ac, 0x20ac,
    0x2122, 0x2122, 0x2190, 0x2193, 0x2212, 0x2212, 0x221e, 0x221e, 0x2248, 0x2265, 0};
static const ImWchar sign_ranges[] = {0x2190, 0x21ff, 0x2300, 0x2328, 0x23ce,
                                      0x23fa, 0x25a0, 0x25ff, 0x2605, 0x2606,
                                      0x2660, 0x266f, 0x2713, 0x2718, 0};

static bool is_in_ranges(const ImWchar *ranges, unsigned int c)
{
    for (; ranges[0]; ranges += 2)
        if (c >= ranges[0] && c <= ranges[1])
            return true;
    return false;
}

/* Characters of other scripts are loaded for the next frame. */
static void ui_want_characters(ui *self, const char *begin, const char *end)
{
    ui_characters *wanted = self->wanted;
    while (begin < end) {
        if (static_cast<unsigned char>(*begin) < 0x80) {
            ++begin;
            continue;
        }
        unsigned int c = 0;
        begin += ImTextCharFromUtf8(&c, begin, end);
        if (c < 0x80 || c == IM_UNICODE_CODEPOINT_INVALID || c > IM_UNICODE_CODEPOINT_MAX ||
            (wanted->bits[c / 32] >> c % 32 & 1u) || wanted->count == UI_CHARACTERS_MAX ||
            is_in_ranges(text_ranges, c) || is_in_ranges(sign_ranges, c))
            continue;
        wanted->bits[c / 32] |= 1u << c % 32;
        wanted->count += 1;
        wanted->is_new = true;
        ui_want_frame(self, 0.0);
    }
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

/* Something else has drawn it there. */
static void ui_note_text(ui *self, ImFont *font, ImVec2 at, uint32_t colour, const ImRect &clip,
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
    word.colour = ui_shown(self, colour);
    word.is_cut = is_cut;
    word.text = text;
    ui_notes_word(self->notes, self->surface, &word);
}

/* ---- putting it there ---- */

/* Draws text with its top left at `at`. Cuts it with an ellipsis if it is wider than max_px (0: no
 * limit). */
static void ui_put_text(ui *self, ImFont *font, ImVec2 at, uint32_t colour, float max_px,
                        const char *begin, const char *end)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImVec4 clip = list->_ClipRectStack.back();
    const ImRect clip_box(clip);
    at = ImFloor(at + ImVec2(0.5f, 0.5f));
    ui_want_characters(self, begin, end ? end : begin + std::strlen(begin));
    if (max_px <= 0.0f || ui_measure(font, begin, end).x <= max_px) {
        list->AddText(font, font->FontSize, at, ui_ink(self, colour), begin, end);
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
    list->AddText(font, font->FontSize, at, ui_ink(self, colour), begin, stop);
    list->AddText(font, font->FontSize, at + ImVec2(width, 0.0f), ui_ink(self, colour), ELLIPSIS);
    ui_note_text(self, font, at, colour, clip_box, true, begin, stop);
}

/* In the middle of the height of a box, `align` 0 left .. 1 right. */
static void ui_put_text_in(ui *self, ImFont *font, const ImRect &box, float align, uint32_t colour,
                           const char *begin, const char *end)
{
    const ImVec2 size = ui_measure(font, begin, end);
    const float room = box.GetWidth() - size.x;
    const ImVec2 at(box.Min.x + ImMax(room, 0.0f) * align,
                    box.Min.y + 0.5f * (box.GetHeight() - font->FontSize));
    ui_put_text(self, font, at, colour, ImMax(box.GetWidth() + 0.5f, 1.0f), begin, end);
}

static void ui_put_box(ui *self, const ImRect &box, uint32_t colour, float rounding_px)
{
    if ((colour & 0xffu) == 0)
        return;
    ImGui::GetWindowDrawList()->AddRectFilled(box.Min, box.Max, ui_ink(self, colour), rounding_px);
    ui_notes_box(self->notes, self->surface, ui_points_box(self, box), ui_shown(self, colour));
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

/* ---- fonts: Inter, with DejaVu for what it has no signs for, and fonts of the system for other
 * scripts; without all, what Dear ImGui brings ---- */

/* Line height of Inter relative to its em. */
constexpr float LINE_PER_EM = 1.21f;

/* Those without a '/' in front are installed with the portable folder. */
static const char *const regular_paths[] = {
    "fonts/Inter-Regular.otf",
    "/usr/share/fonts/opentype/inter/Inter-Regular.otf",
    "/usr/share/fonts/truetype/inter/Inter-Regular.ttf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Regular.ttf",
    nullptr};
static const char *const strong_paths[] = {
    "fonts/Inter-SemiBold.otf",
    "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf",
    "/usr/share/fonts/truetype/inter/Inter-SemiBold.ttf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf",
    "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Medium.ttf",
    nullptr};
static const char *const sign_paths[] = {
    "fonts/DejaVuSans.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", nullptr};

static const ImWchar large_ranges[] = {0x20,   0xff,   0x2012, 0x2014, 0x2026,
                                       0x2026, 0x2212, 0x2212, 0};
static const ImWchar large_sign_ranges[] = {0x25a0, 0x25a0, 0x25b6, 0x25b6, 0x25cb, 0x25cf, 0};

/* The path of the first font that can be read; false: none. ImGui ends the process when a font is
 * missing. */
static bool find_font(char out[INSTALLED_LENGTH], const char *const *paths)
{
    for (; *paths; ++paths) {
        (void)std::snprintf(out, INSTALLED_LENGTH, "%s", *paths);
        if (**paths == '/' ? access(out, R_OK) == 0 : installed_data(out, *paths))
            return true;
    }
    return false;
}

static ImFontConfig config_of(bool is_merged)
{
    ImFontConfig config;
    config.OversampleH = 2;
    config.OversampleV = 1;
    config.PixelSnapH = false;
    config.MergeMode = is_merged;
    return config;
}

/* The fonts of the system that have the wanted characters, while the atlas is built. */
struct ui_fallback {
    static constexpr int FONTS_MAX = 8;
    ImVector<ImWchar> text, wanted; /* ranges: the usual ones and the wanted; the wanted */
    void *data[FONTS_MAX];
    int size[FONTS_MAX];
    system_font font[FONTS_MAX];
    int count;
};

static void *read_font(const char *path, int *out_size)
{
    FILE *file = std::fopen(path, "rb");
    void *data = nullptr;
    long size = 0;
    if (file && std::fseek(file, 0, SEEK_END) == 0 && (size = std::ftell(file)) > 0 &&
        size < (1l << 30) && std::fseek(file, 0, SEEK_SET) == 0)
        data = std::malloc(static_cast<size_t>(size));
    if (data && std::fread(data, static_cast<size_t>(size), 1, file) != 1) {
        std::free(data);
        data = nullptr;
    }
    if (file)
        std::fclose(file);
    *out_size = static_cast<int>(size);
    return data;
}

static void add_fallback_font(ui_fallback *out, system_font font)
{
    for (int i = 0; i < out->count; ++i)
        if (std::strcmp(out->font[i].path, font.path) == 0 && out->font[i].index == font.index)
            return;
    if (out->count == ui_fallback::FONTS_MAX)
        return;
    out->data[out->count] = read_font(font.path, &out->size[out->count]);
    out->font[out->count] = font;
    if (out->data[out->count])
        out->count += 1;
}

static void find_fallback(const ui *self, ui_fallback *out)
{
    char sign_path[INSTALLED_LENGTH];
    const bool has_signs = find_font(sign_path, sign_paths);
    out->count = 0;
    for (const ImWchar *range = text_ranges; *range; ++range)
        out->text.push_back(*range);
    for (unsigned int c = 1; self->wanted->count > 0 && c <= IM_UNICODE_CODEPOINT_MAX; ++c) {
        if (!(self->wanted->bits[c / 32] >> c % 32 & 1u))
            continue;
        for (int twice = 0; twice < 2; ++twice) { /* a range of one */
            out->text.push_back(static_cast<ImWchar>(c));
            out->wanted.push_back(static_cast<ImWchar>(c));
        }
        const system_font font = system_fonts_find(self->system, c);
        if (font.path && !(has_signs && std::strcmp(font.path, sign_path) == 0))
            add_fallback_font(out, font);
    }
    out->text.push_back(0);
    out->wanted.push_back(0);
}

static ImFont *load(float size_px, const char *const *paths, const ImWchar *ranges,
                    const ImWchar *signs, const ui_fallback *fallback)
{
    ImFontAtlas *atlas = ImGui::GetIO().Fonts;
    const float line_px = ImFloorSigned(size_px * LINE_PER_EM + 0.5f);
    ImFontConfig config = config_of(false), merged = config_of(true);
    char path[INSTALLED_LENGTH], sign_path[INSTALLED_LENGTH];
    const bool has_signs = find_font(sign_path, sign_paths);
    ImFont *font = find_font(path, paths)
                       ? atlas->AddFontFromFileTTF(path, line_px, &config, ranges)
                       : nullptr;
    if (!font)
        font = atlas->AddFontDefault();
    else if (has_signs)
        atlas->AddFontFromFileTTF(sign_path, line_px, &merged, signs);
    if (!fallback || fallback->wanted.Size == 1)
        return font;
    if (has_signs)
        atlas->AddFontFromFileTTF(sign_path, line_px, &merged, fallback->wanted.Data);
    merged.FontDataOwnedByAtlas = false;
    merged.OversampleH = 1;
    for (int i = 0; i < fallback->count; ++i) {
        merged.FontNo = static_cast<int>(fallback->font[i].index);
        atlas->AddFontFromMemoryTTF(fallback->data[i], fallback->size[i], line_px, &merged,
                                    fallback->wanted.Data);
    }
    return font;
}

/* So that numbers that run do not dance: all digits as wide as the widest. */
static void make_digits_even(ImFont *font)
{
    float widest = 0.0f;
    for (ImWchar c = '0'; c <= '9'; ++c)
        widest = ImMax(widest, font->GetCharAdvance(c));
    for (ImFontGlyph &glyph : font->Glyphs) {
        if (glyph.Codepoint < '0' || glyph.Codepoint > '9')
            continue;
        const float shift = ImFloorSigned(0.5f * (widest - glyph.AdvanceX) + 0.5f);
        glyph.X0 += shift;
        glyph.X1 += shift;
        glyph.AdvanceX = widest;
        font->IndexAdvanceX[static_cast<int>(glyph.Codepoint)] = widest;
    }
}

static bool build_fonts(ui *self, const ui_fallback *fallback)
{
    ImFontAtlas *atlas = ImGui::GetIO().Fonts;
    const float body = THEME_BODY_POINTS * self->scale, title = THEME_TITLE_POINTS * self->scale,
                large = THEME_LARGE_POINTS * self->scale;
    const ImWchar *text = fallback ? fallback->text.Data : text_ranges;
    atlas->Clear();
    atlas->Flags |= ImFontAtlasFlags_NoPowerOfTwoHeight;
    self->font[UI_FONT_BODY] = load(body, regular_paths, text, sign_ranges, fallback);
    self->font[UI_FONT_STRONG] = load(body, strong_paths, text, sign_ranges, fallback);
    self->font[UI_FONT_TITLE] = load(title, strong_paths, text, large_sign_ranges, fallback);
    self->font[UI_FONT_LARGE] = load(large, strong_paths, large_ranges, large_sign_ranges, nullptr);
    self->font[UI_FONT_NUMBER] =
        load(body, regular_paths, large_ranges, large_sign_ranges, nullptr);
    return atlas->Build();
}

static void load_fonts(ui *self)
{
    ui_fallback fallback;
    find_fallback(self, &fallback);
    if (!build_fonts(self, &fallback)) /* a font of the system that Dear ImGui cannot read */
        build_fonts(self, nullptr);
    ImGui::GetIO().Fonts->ClearInputData();
    for (int i = 0; i < fallback.count; ++i)
        std::free(fallback.data[i]);
    self->wanted->is_new = false;
    make_digits_even(self->font[UI_FONT_LARGE]);
    make_digits_even(self->font[UI_FONT_NUMBER]);
}

/* ---- the receiver of a key: a text field, a dialog, or the caller ---- */

/* The '?' of other keyboards is not over the '/'. */
static void read_question_mark(ui_frame_input *input)
{
    for (uint32_t i = 0; i < input->text_count; ++i)
        if (input->text[i] == '?' && !input->key['/'])
            input->pressed['?'] = true;
}

static bool is_text_of_lines()
{
    const ImGuiContext &g = *ImGui::GetCurrentContext();
    return g.InputTextState.ID == g.ActiveId &&
           (g.InputTextState.Flags & ImGuiInputTextFlags_Multiline) != 0;
}

/* Writes nothing and changes nothing in a text that is typed. Ctrl with Alt is AltGr. */
static bool is_command(uint32_t key, uint32_t modifiers)
{
    if (key >= UI_KEY_F1 && key <= UI_KEY_F12)
        return true;
    if (key == UI_KEY_PAGE_UP || key == UI_KEY_PAGE_DOWN)
        return !is_text_of_lines();
    return key > ' ' && key < 127 && (modifiers & UI_CONTROL) && !(modifiers & UI_ALT) &&
           !std::strchr("ACVXYZ", static_cast<int>(key));
}

/* A command ends the text as Enter does and is there in the next frame: what it does may put away
 * the widget that holds the text. */
static void find_command(ui *self)
{
    ui_frame_input *input = self->input;
    const uint32_t modifiers = ui_frame_modifiers(input);
    self->late = self->command;
    self->late_modifiers = self->command_modifiers;
    self->command = UI_KEY_NONE;
    if (!input->is_typing || ImGui::GetTopMostPopupModal())
        return;
    for (uint32_t key = 1; key < UI_KEY_COUNT; ++key) {
        if (!input->pressed[key] || !is_command(key, modifiers))
            continue;
        self->command = key;
        self->command_modifiers = modifiers;
    }
}

/* Before ImGui's new frame. A command then ends the text that is typed. */
static void ui_hand_over(ui *self)
{
    ImGuiIO &io = ImGui::GetIO();
    ui_frame_input *input = self->input;
    input->is_typing = io.WantTextInput;
    if (self->screen.is_late)
        ui_queue_pass(input);
    else
        ui_queue_take(self->queue, input);
    read_question_mark(input);
    find_command(self);
    io.MousePos =
        input->has_pointer ? ui_px2(self, input->x, input->y) : ImVec2(-FLT_MAX, -FLT_MAX);
    for (uint32_t i = 0; i < UI_BUTTONS; ++i)
        io.MouseDown[i] = input->button[i];
    io.MouseWheel = input->wheel_y;
    io.MouseWheelH = input->wheel_x;
    for (uint32_t i = 0; i < UI_KEY_COUNT; ++i)
        io.KeysDown[i] = input->key[i];
    io.KeyShift = input->key[UI_KEY_SHIFT];
    io.KeyCtrl = input->key[UI_KEY_CONTROL];
    io.KeyAlt = input->key[UI_KEY_ALT];
    for (uint32_t i = 0; i < input->text_count; ++i)
        io.AddInputCharacter(input->text[i]);
}

/* ---- keys ---- */

/* Questions over everything keep the keys to themselves. */
static bool has_keys(const ui *self)
{
    return !ImGui::GetIO().WantTextInput &&
           (self->dialog_depth > 0 || !ImGui::GetTopMostPopupModal());
}

bool ui_pressed(const ui *self, uint32_t key, uint32_t modifiers)
{
    if (key >= UI_KEY_COUNT || !has_keys(self) || (key == UI_KEY_ESCAPE && self->has_menu) ||
        (modifiers == 0 && ui_focus_has_key(&self->focus, key)))
        return false;
    if (key == '/' && modifiers == UI_SHIFT && self->input->pressed['?'])
        return true;
    if (key == self->late && modifiers == self->late_modifiers && key != UI_KEY_NONE)
        return true;
    return self->input->pressed[key] && ui_frame_modifiers(self->input) == modifiers;
}

bool ui_is_down(const ui *self, uint32_t key)
{
    return key < UI_KEY_COUNT && has_keys(self) && self->input->key[key] &&
           !(ui_frame_modifiers(self->input) == 0 && ui_focus_has_key(&self->focus, key));
}

uint32_t ui_modifiers(const ui *self)
{
    return ui_frame_modifiers(self->input);
}

bool ui_is_typing(const ui *self)
{
    (void)self;
    return ImGui::GetIO().WantTextInput;
}

/* ---- widgets that are pressed: buttons, checks, tabs, sections, rows; and bars ---- */

/* The width that was asked for the next widget, or its own. */
static float ui_take_width(ui *self, float natural_px)
{
    const float wanted = self->next_width, room = ImGui::GetContentRegionAvail().x;
    self->next_width = 0.0f;
    if (wanted > 0.0f)
        return wanted;
    return wanted < 0.0f ? ImMax(room + wanted, 1.0f) : natural_px;
}

/* Notes text left or right of the visible area as cut, for tests. */
static void note_beyond(ui *self, const ImRect &box, const char *label)
{
    const ImRect clip = ImGui::GetCurrentWindow()->ClipRect;
    const bool is_beside = box.Min.x >= clip.Max.x || box.Max.x <= clip.Min.x;
    if (!ui_notes_is_on(self->notes) || !is_beside || box.Max.y <= clip.Min.y ||
        box.Min.y >= clip.Max.y)
        return;
    ui_word word = {};
    word.where = ui_points_box(self, box);
    word.clip = ui_points_box(self, clip);
    word.colour = ui_shown(self, THEME_TEXT);
    word.is_cut = true;
    word.text = label;
    ui_notes_word(self->notes, self->surface, &word);
}

/* An item of that size that can be pressed. is_stop: Tab reaches it. */
static ui_pressing ui_press_item(ui *self, const char *label, ImVec2 size, ImGuiButtonFlags flags,
                                 bool is_stop = true)
{
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    ui_pressing out = {};
    const ImGuiID id = window->GetID(label);
    const ImVec2 at = window->DC.CursorPos;
    ui_notes_other(self->notes);
    out.box = ImRect(at, at + size);
    ImGui::ItemSize(size, ImGui::GetStyle().FramePadding.y);
    out.is_seen = ImGui::ItemAdd(out.box, id);
    out.has_ring =
        ui_focus_add(&self->focus, label, id, out.box, !is_stop || self->disabled_depth > 0);
    if (!out.is_seen)
        note_beyond(self, out.box, label);
    else
        out.is_pressed = ImGui::ButtonBehavior(out.box, id, &out.is_hovered, &out.is_held, flags);
    out.is_pressed |= out.has_ring && self->focus.is_pressing;
    return out;
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
        return button_look{THEME_ACCENT, THEME_ACCENT_HOVER, THEME_STAGE};
    case UI_QUIET:
        return button_look{0, THEME_RAISED, THEME_TEXT};
    case UI_PLAIN:
        break;
    }
    return button_look{THEME_RAISED, THEME_HOVER, THEME_TEXT};
}

/* Enter is a click on what a question is answered with, but where it ends a line of several. */
static bool is_entered(ui *self, ui_emphasis emphasis)
{
    if (emphasis != UI_ACCENT || self->dialog_depth == 0 || self->disabled_depth > 0 ||
        self->has_menu || self->types_lines || self->is_answered || self->focus.is_pressing ||
        ImGui::GetTopMostPopupModal() != ImGui::GetCurrentWindow()->RootWindow ||
        !self->input->pressed[UI_KEY_ENTER] || ui_frame_modifiers(self->input) != 0)
        return false;
    self->is_answered = true;
    return true;
}

bool ui_button(ui *self, const char *label, ui_emphasis emphasis)
{
    const char *end = shown_end(label);
    ImFont *font = self->font[UI_FONT_BODY];
    const float padding = ui_whole_px(self, emphasis == UI_QUIET ? 7.0f : 11.0f);
    const float natural = ImCeil(ui_measure(font, label, end).x) + 2.0f * padding;
    const float width = ui_take_width(self, natural);
    const ui_pressing press = ui_press_item(self, label, ImVec2(width, ImGui::GetFrameHeight()), 0);
    if (!press.is_seen)
        return false;
    ui_notes_control(self->notes, label);
    const button_look look = look_of(self, emphasis);
    const float inset = ImMin(padding, ImMax(0.5f * (width - (natural - 2.0f * padding)), 2.0f));
    ui_put_box(self, press.box, press.is_hovered ? look.hover : look.ground,
               ImGui::GetStyle().FrameRounding);
    ImRect inner = press.box;
    inner.Min.x += inset;
    inner.Max.x -= inset;
    ui_put_text_in(self, font, inner, 0.5f, look.text, label, end);
    return press.is_pressed || is_entered(self, emphasis);
}

static void put_tick(ui *self, const ImRect &box)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    const float unit = box.GetWidth() / 16.0f;
    list->PathLineTo(box.Min + ImVec2(3.5f * unit, 8.5f * unit));
    list->PathLineTo(box.Min + ImVec2(6.8f * unit, 11.8f * unit));
    list->PathLineTo(box.Min + ImVec2(12.5f * unit, 4.8f * unit));
    list->PathStroke(ui_ink(self, self->disabled_depth ? THEME_DIM : THEME_STAGE), 0, 2.0f * unit);
}

bool ui_check(ui *self, const char *label, bool *value)
{
    const char *end = shown_end(label);
    ImFont *font = self->font[UI_FONT_BODY];
    const float side = ui_whole_px(self, 16.0f), gap = ui_whole_px(self, 7.0f);
    const float width =
        ui_take_width(self, side + gap + ImCeil(ui_measure(font, label, end).x) + 2.0f);
    const ui_pressing press = ui_press_item(self, label, ImVec2(width, ImGui::GetFrameHeight()), 0);
    if (!press.is_seen)
        return false;
    ui_notes_control(self->notes, label);
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

/* Tab reaches the chosen one alone; out_step: how far the arrows go from it. */
static bool put_tab(ui *self, const char *name, float width, bool is_chosen, int *out_step)
{
    ImFont *font = self->font[is_chosen ? UI_FONT_STRONG : UI_FONT_BODY];
    const ui_pressing press =
        ui_press_item(self, name, ImVec2(width, ui_whole_px(self, 30.0f)), 0, is_chosen);
    if (press.has_ring)
        *out_step = ui_focus_arrows(&self->focus, self->input, false);
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

/* Of the words alone, px. */
static float tab_words(const ui *self, const char *const *names, uint32_t first, uint32_t end)
{
    float words = 0.0f;
    for (uint32_t i = first; i < end; ++i)
        words += ui_measure(self->font[UI_FONT_STRONG], names[i], shown_end(names[i])).x;
    return words;
}

static float widest_tab(const ui *self, const char *const *names, uint32_t count)
{
    float widest = 0.0f;
    for (uint32_t i = 0; i < count; ++i)
        widest = ImMax(widest, tab_words(self, names, i, i + 1));
    return widest;
}

/* Number of rows of tabs in which the text has enough space. */
static uint32_t tab_rows(const ui *self, const char *const *names, uint32_t count, float room)
{
    const float least = ui_px(self, 12.0f);
    for (uint32_t rows = 1; rows < count; ++rows) {
        const uint32_t across = (count + rows - 1) / rows;
        bool fits = true;
        for (uint32_t first = 0; first < count; first += across) {
            const uint32_t end = ImMin(first + across, count);
            fits &= tab_words(self, names, first, end) + least * static_cast<float>(end - first) <=
                    room;
        }
        if (fits)
            return rows;
    }
    return ImMax(count, 1u);
}

float ui_tabs_height(const ui *self, const char *const *names, uint32_t count, float width)
{
    const uint32_t rows = tab_rows(self, names, count, ui_px(self, width));
    return static_cast<float>(rows) * ui_whole_px(self, 30.0f) / self->scale;
}

bool ui_tabs(ui *self, const char *id, const char *const *names, uint32_t count, uint32_t *index)
{
    return ui_tabs_each(self, id, names, count, index, nullptr, nullptr);
}

ui_drag ui_last_drag(ui *self)
{
    const ImGuiIO &io = ImGui::GetIO();
    const ImRect box(ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
    const float far_px = ui_px(self, 8.0f); /* less is a click */
    ui_drag out = {UI_DRAG_NONE, io.MousePos.x / self->scale, io.MousePos.y / self->scale,
                   ui_rectangle{box.Min.x / self->scale, box.Min.y / self->scale,
                                box.GetWidth() / self->scale, box.GetHeight() / self->scale}};
    if (io.MouseDragMaxDistanceSqr[0] < far_px * far_px)
        return out;
    if (ImGui::IsItemActive())
        out.state = UI_DRAG_MOVES;
    else if (ImGui::IsItemDeactivated())
        out.state = UI_DRAG_DROPPED;
    return out;
}

bool ui_tabs_each(ui *self, const char *id, const char *const *names, uint32_t count,
                  uint32_t *index, void (*each)(void *data, uint32_t tab), void *data)
{
    const uint32_t before = *index;
    int step = 0;
    const float room = ImGui::GetContentRegionAvail().x;
    const uint32_t rows = tab_rows(self, names, count, room), across = (count + rows - 1) / rows;
    ImGui::PushID(id);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0.0f, 0.0f));
    const float column = ImFloor(room / static_cast<float>(across)); /* of several rows */
    const bool is_table = rows > 1 && widest_tab(self, names, count) + ui_px(self, 6.0f) <= column;
    for (uint32_t first = 0; first < count; first += across) {
        const uint32_t end = ImMin(first + across, count);
        const float even =
            (room - tab_words(self, names, first, end)) / static_cast<float>(end - first);
        const float padding = ImClamp(even, 2.0f, ui_px(self, 28.0f));
        for (uint32_t i = first; i < end; ++i) {
            if (i > first)
                ImGui::SameLine(0.0f, 0.0f);
            const float own = tab_words(self, names, i, i + 1);
            if (put_tab(self, names[i], is_table ? column : ImFloor(own + padding), i == before,
                        &step))
                *index = i;
            if (each)
                each(data, i);
        }
    }
    const int64_t to = static_cast<int64_t>(before) + step;
    if (step != 0 && to >= 0 && to < static_cast<int64_t>(count)) {
        *index = static_cast<uint32_t>(to);
        ui_focus_move(&self->focus, ImGui::GetID(names[to]));
    }
    ImGui::PopStyleVar();
    ImGui::PopID();
    return *index != before;
}

static void put_triangle(ui *self, const ImRect &box, bool is_open, uint32_t colour)
{
    const ImVec2 middle = box.GetCenter();
    const float r = 0.5f * box.GetWidth();
    ImDrawList *list = ImGui::GetWindowDrawList();
    if (is_open)
        list->AddTriangleFilled(middle + ImVec2(-r, -0.5f * r), middle + ImVec2(r, -0.5f * r),
                                middle + ImVec2(0.0f, 0.7f * r), ui_ink(self, colour));
    else
        list->AddTriangleFilled(middle + ImVec2(-0.5f * r, -r), middle + ImVec2(0.7f * r, 0.0f),
                                middle + ImVec2(-0.5f * r, r), ui_ink(self, colour));
}

bool ui_section(ui *self, const char *title, bool is_open_at_first)
{
    ImGuiStorage *storage = ImGui::GetStateStorage();
    const ImGuiID id = ImGui::GetID(title);
    bool is_open = storage->GetBool(id, is_open_at_first);
    ui_space(self, 4.0f);
    const float width = ImGui::GetContentRegionAvail().x;
    const ui_pressing press = ui_press_item(self, title, ImVec2(width, ImGui::GetFrameHeight()), 0);
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
    put_triangle(self, mark, is_open, press.is_hovered ? THEME_TEXT : THEME_DIM);
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
        self, label, ImVec2(ImMax(width, 1.0f), ImGui::GetFrameHeight()),
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

/* ---- what comes over the panels for a while: hints, menus, questions ---- */

static void ui_enter_popup(ui *self)
{
    const ui_rectangle where = ui_points_box(self, ImGui::GetCurrentWindow()->Rect());
    if (self->popup_depth < UI_POPUPS_MAX)
        self->surface_below[self->popup_depth] = self->surface;
    self->popup_depth += 1;
    self->surface = ui_notes_surface(self->notes, where, true);
    ui_notes_box(self->notes, self->surface, where, ui_shown(self, THEME_PANEL));
}

static void ui_leave_popup(ui *self)
{
    self->popup_depth -= 1;
    if (self->popup_depth < UI_POPUPS_MAX)
        self->surface = self->surface_below[self->popup_depth];
}

/* ---- hints ---- */

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
    if (text[0])
        ui_notes_hint(self->notes);
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
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
    if (self->hinted_s < moment_s)
        ui_want_frame(self, moment_s - self->hinted_s);
    if (self->hinted_s >= moment_s && text[0])
        put_hint(self, text);
}

/* ---- menus ---- */

static ImGuiWindow *innermost_popup(void)
{
    const ImVector<ImGuiPopupData> &open = GImGui->OpenPopupStack;
    return open.Size > 0 ? open.back().Window : nullptr;
}

/* A menu or a drop-down, not a question. */
static bool has_menu(void)
{
    const ImGuiWindow *popup = innermost_popup();
    return popup && !(popup->Flags & ImGuiWindowFlags_Modal);
}

/* Called after the new frame of ImGui. A right click outside a menu closes it immediately and acts
 * on its target. ImGui would close it at the end of the frame, and then open a menu for the
 * previous target. */
static void close_menus(ui *self)
{
    self->has_menu = has_menu();
    if (!self->has_menu || !ImGui::IsMouseClicked(1))
        return;
    ImGuiWindow *hovered = GImGui->HoveredWindow, *modal = ImGui::GetTopMostPopupModal();
    const bool is_above = hovered && (!modal || ImGui::IsWindowAbove(hovered, modal));
    ImGui::ClosePopupsOverWindow(is_above ? hovered : modal, true);
}

/* Within the menu. */
static void close_with_escape(const ui *self)
{
    if (self->has_menu && self->input->pressed[UI_KEY_ESCAPE] &&
        innermost_popup() == ImGui::GetCurrentWindow())
        ImGui::CloseCurrentPopup();
}

static bool enter_menu(ui *self, bool is_open)
{
    ImGui::PopStyleVar();
    if (is_open) {
        ui_enter_popup(self);
        close_with_escape(self);
    }
    return is_open;
}

bool ui_menu_begin(ui *self, const char *id)
{
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ui_px2(self, 6.0f, 6.0f));
    return enter_menu(self, ImGui::BeginPopupContextItem(id));
}

void ui_menu_open(ui *self, const char *id, float x, float y)
{
    ImGui::OpenPopup(id);
    self->menu_at = ui_px2(self, x, y);
}

bool ui_open_menu_begin(ui *self, const char *id)
{
    ImGui::SetNextWindowPos(self->menu_at, ImGuiCond_Appearing);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ui_px2(self, 6.0f, 6.0f));
    return enter_menu(self, ImGui::BeginPopup(id, ImGuiWindowFlags_NoMove));
}

bool ui_menu_item(ui *self, const char *label, const char *keys, bool is_enabled)
{
    const char *end = shown_end(label);
    ImFont *font = self->font[UI_FONT_BODY];
    const float padding = ui_whole_px(self, 7.0f), gap = ui_whole_px(self, 24.0f);
    const float key_width = keys && keys[0] ? gap + ui_measure(font, keys, nullptr).x : 0.0f;
    const float natural = ImCeil(ui_measure(font, label, end).x + key_width) + 2.0f * padding;
    ui_disabled_begin(self, !is_enabled);
    const float width = ImMax(natural, ImGui::GetContentRegionAvail().x);
    const ui_pressing press = ui_press_item(self, label, ImVec2(width, ImGui::GetFrameHeight()), 0);
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

bool ui_menu_colours(ui *self, const char *label, const char *const *names, const uint32_t *colours,
                     uint32_t count, uint32_t *index)
{
    ImFont *font = self->font[UI_FONT_BODY];
    const float high = ImGui::GetFrameHeight(), padding = ui_whole_px(self, 7.0f);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    bool is_changed = false;
    ui_put_text_in(
        self, font,
        ImRect(at + ImVec2(padding, 0.0f), at + ImVec2(ui_whole_px(self, UI_CHIP_LABEL), high)),
        0.0f, THEME_DIM, label, shown_end(label));
    for (uint32_t i = 0; i < count; ++i) {
        const float x = ui_whole_px(self, UI_CHIP_LABEL + UI_CHIP * (float)i);
        ImGui::SetCursorScreenPos(at + ImVec2(x, 0.0f));
        const ui_pressing press =
            ui_press_item(self, names[i], ImVec2(ui_whole_px(self, UI_CHIP), high), 0);
        if (!press.is_seen)
            continue;
        ui_notes_control(self->notes, names[i]);
        const ImVec2 middle = press.box.GetCenter();
        const float radius = ui_px(self, 7.0f), edge = ui_px(self, 1.5f);
        ImDrawList *list = ImGui::GetWindowDrawList();
        if (i == 0)
            list->AddCircle(middle, radius - edge, ui_ink(self, THEME_DIM), 0, edge);
        else
            list->AddCircleFilled(middle, radius, ui_ink(self, colours[i]));
        if (press.is_hovered || i == *index)
            list->AddCircle(middle, radius + 1.5f * edge,
                            ui_ink(self, i == *index ? THEME_ACCENT : THEME_TEXT), 0, edge);
        ui_hint(self, names[i]);
        if (press.is_pressed) {
            is_changed = i != *index;
            *index = i;
            ImGui::CloseCurrentPopup();
        }
    }
    return is_changed;
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
    if (self->input->pressed[UI_KEY_ESCAPE] && !self->has_menu &&
        ImGui::GetTopMostPopupModal() == ImGui::GetCurrentWindow()->RootWindow)
        ImGui::CloseCurrentPopup(); /* whatever is typed */
    return true;
}

/* Closes popups whose caller is gone. Otherwise they would block the window invisibly. */
static void ui_close_left_popups()
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

/* ---- widgets that hold a value: choices, sliders, lines that are typed ---- */

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
                       shown_end(label));
        window->DC.CursorPos.x += left;
    }
    const float width = ui_take_width(self, ImMax(room - left, 1.0f));
    const ImVec2 from = window->DC.CursorPos;
    ImGui::SetNextItemWidth(ImMax(width, 1.0f));
    ui_notes_control(self->notes, label);
    return ImRect(from, from + ImVec2(ImMax(width, 1.0f), high));
}

/* ---- choices ---- */

static void put_arrow(ui *self, const ImRect &box)
{
    const ImVec2 middle(box.Max.x - ui_px(self, 12.0f), box.GetCenter().y);
    const float r = ui_px(self, 4.0f);
    ImGui::GetWindowDrawList()->AddTriangleFilled(
        middle + ImVec2(-r, -0.5f * r), middle + ImVec2(r, -0.5f * r),
        middle + ImVec2(0.0f, 0.6f * r), ui_ink(self, THEME_DIM));
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
    ImGui::PushStyleColor(ImGuiCol_FrameBgHovered, ui_ink(self, THEME_RAISED));
    const ImGuiID id = ImGui::GetID("##choice");
    const bool has_ring = ui_focus_add(&self->focus, label, id, box, self->disabled_depth > 0);
    if (has_ring && self->focus.is_pressing)
        ImGui::OpenPopupEx(ImHashStr("##ComboPopup", 0, id)); /* as BeginCombo calls it */
    const bool is_open = ImGui::BeginCombo(
        "##choice", "", ImGuiComboFlags_NoArrowButton | ImGuiComboFlags_HeightLarge);
    ImGui::PopStyleColor(2);
    ImGui::PopStyleVar();
    if (is_open) {
        ui_enter_popup(self);
        close_with_escape(self);
        for (uint32_t i = 0; i < count; ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (i == *index && ImGui::IsWindowAppearing() && has_ring)
                ui_focus_claim(&self->focus, ImGui::GetID(items[i]));
            if (ui_row(self, items[i], i == *index) != UI_ROW_NONE) {
                has_changed = i != *index;
                *index = i;
                ImGui::CloseCurrentPopup();
            }
            ImGui::PopID();
        }
        ui_leave_popup(self);
        ImGui::EndCombo();
    } else if (has_ring) {
        const int to = static_cast<int>(*index) + ui_focus_arrows(&self->focus, self->input, true);
        if (to != static_cast<int>(*index) && to >= 0 && to < static_cast<int>(count)) {
            has_changed = true;
            *index = static_cast<uint32_t>(to);
        }
    }
    ImGui::PopID();
    put_arrow(self, box);
    ImRect words = box;
    words.Min.x += ui_whole_px(self, 8.0f);
    words.Max.x -= ui_whole_px(self, 22.0f);
    ui_put_text_in(self, self->font[UI_FONT_BODY], words, 0.0f, ui_colour_here(self, THEME_TEXT),
                   shown, shown_end(shown));
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

/* Writes the text in the middle of a slider. */
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

/* Of an arrow key: a hundredth of the range in whole digits, with Shift ten times as much. */
static double slider_step(const ui *self, const ui_range *range)
{
    const double least =
        range->is_whole ? 1.0 : std::pow(10.0, -static_cast<double>(range->digits));
    const double step = ImMax(std::floor((range->max - range->min) / 100.0 / least + 0.5), 1.0);
    return step * least * (ui_frame_modifiers(self->input) == UI_SHIFT ? 10.0 : 1.0);
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
    ImGui::PushStyleColor(ImGuiCol_FrameBg, is_typed ? ui_ink(self, THEME_WELL) : 0u);
    ImGui::PushStyleColor(ImGuiCol_FrameBgHovered, is_typed ? ui_ink(self, THEME_WELL) : 0u);
    ImGui::PushStyleColor(ImGuiCol_FrameBgActive, is_typed ? ui_ink(self, THEME_WELL) : 0u);
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
    if (ui_focus_add(&self->focus, label, ImGui::GetID("##slider"), box,
                     self->disabled_depth > 0)) {
        self->is_slider_held |= self->input->key[UI_KEY_LEFT] || self->input->key[UI_KEY_RIGHT];
        *value = ImClamp(*value + slider_step(self, range) *
                                      ui_focus_arrows(&self->focus, self->input, false),
                         range->min, range->max);
    }
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

void ui_focus_covers(ui *self)
{
    ui_focus_forget(&self->focus);
}

const char *ui_ringed(const ui *self)
{
    return self->focus.label;
}

int ui_input_arrows(const ui *self)
{
    const ui_frame_input *input = self->input;
    return (input->pressed[UI_KEY_DOWN] ? 1 : 0) - (input->pressed[UI_KEY_UP] ? 1 : 0);
}

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

/* Before the widget of a text: the ring brings the keys. */
static void give_keys(ui *self, const char *id, const ImRect &box)
{
    if (ui_focus_add(&self->focus, id, ImGui::GetID(id), box, self->disabled_depth > 0))
        self->takes_keys |= self->focus.has_arrived || self->focus.is_pressing;
    if (self->takes_keys)
        ImGui::SetKeyboardFocusHere();
    self->takes_keys = false;
}

bool ui_input(ui *self, const char *id, const char *hint, char *text, size_t capacity)
{
    const ImRect box = put_label(self, id, 0.0f);
    ui_notes_box(self->notes, self->surface, ui_points_box(self, box), ui_shown(self, THEME_WELL));
    give_keys(self, id, box);
    ImGui::PushAllowKeyboardFocus(false); /* Tab is ui_focus's */
    ImGui::InputTextWithHint(id, hint ? hint : "", text, capacity,
                             ImGuiInputTextFlags_AutoSelectAll);
    ImGui::PopAllowKeyboardFocus();
    const bool is_ended = was_ended(self, text);
    ui_want_characters(self, text, text + std::strlen(text));
    if (hint && hint[0]) /* notes where the text will be */
        ui_notes_hint(self->notes);
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
    ui_notes_box(self->notes, self->surface, ui_points_box(self, box), ui_shown(self, THEME_WELL));
    give_keys(self, id, box);
    ImGui::PushAllowKeyboardFocus(false);
    ImGui::InputTextMultiline(id, text, capacity, box.GetSize());
    ImGui::PopAllowKeyboardFocus();
    self->types_lines |= ImGui::IsItemActive();
    const bool is_ended = was_ended(self, text);
    ui_want_characters(self, text, text + std::strlen(text));
    note_input(self, box, text, THEME_TEXT);
    return is_ended;
}

/* ---- canvases: rectangles of a panel that take the pointer, and what is drawn on them ---- */

/* ---- the pointer ---- */

static void follow_drag(ui *self, ImGuiID id, const ImRect &box, ui_canvas *out)
{
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    const bool is_active = ImGui::IsItemActive(), is_released = ImGui::IsItemDeactivated();
    out->button = -1;
    if (ImGui::IsItemActivated()) {
        self->grip.id = id;
        self->grip.start = self->grip.last = pointer;
        self->grip.button = GImGui->ActiveIdMouseButton;
    }
    if (self->grip.id != id || !(is_active || is_released))
        return;
    out->button = self->grip.button;
    out->start_x = (self->grip.start.x - box.Min.x) / self->scale;
    out->start_y = (self->grip.start.y - box.Min.y) / self->scale;
    out->moved_x = (pointer.x - self->grip.last.x) / self->scale;
    out->moved_y = (pointer.y - self->grip.last.y) / self->scale;
    self->grip.last = pointer;
    out->is_pressed = ImGui::IsItemActivated();
    out->is_dragging = is_active;
    out->is_released = is_released;
    if (is_released)
        self->grip.id = 0;
}

static bool is_double_clicked(void)
{
    return ImGui::IsMouseDoubleClicked(0) || ImGui::IsMouseDoubleClicked(1) ||
           ImGui::IsMouseDoubleClicked(2);
}

void ui_canvas_begin(ui *self, const char *id, float width, float height, ui_canvas *out)
{
    const ImVec2 room = ImGui::GetContentRegionAvail();
    ui_notes_other(self->notes);
    const float wide = width > 0.0f ? ui_px(self, width) : room.x + ui_px(self, width);
    const float high = height > 0.0f ? ui_px(self, height) : room.y + ui_px(self, height);
    ImGui::InvisibleButton(id, ImVec2(ImMax(wide, 1.0f), ImMax(high, 1.0f)),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    const ImGuiIO &io = ImGui::GetIO();
    const ImRect box(ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
    *out = ui_canvas{};
    out->where = ui_points_box(self, box);
    out->x = (io.MousePos.x - box.Min.x) / self->scale;
    out->y = (io.MousePos.y - box.Min.y) / self->scale;
    out->is_hovered = ImGui::IsItemHovered();
    if (out->is_hovered) {
        out->wheel_x = io.MouseWheelH;
        out->wheel_y = io.MouseWheel;
        out->is_double_clicked = is_double_clicked();
    }
    out->modifiers = ui_modifiers(self);
    follow_drag(self, ImGui::GetItemID(), box, out);
    ImGui::PushClipRect(box.Min, box.Max, true);
}

bool ui_canvas_button(ui *self, const ui_canvas *canvas, const char *label, ui_rectangle where,
                      bool is_enabled)
{
    const bool has_ring =
        ui_focus_add(&self->focus, label, ImGui::GetID(label), ui_px_box(self, where), !is_enabled);
    const bool is_clicked =
        canvas->is_pressed && canvas->button == 0 && ui_canvas_is_over(canvas, where);
    return is_enabled && (is_clicked || (has_ring && self->focus.is_pressing));
}

void ui_canvas_end(ui *self)
{
    (void)self;
    ImGui::PopClipRect();
}

float ui_drag_edge(ui *self, const char *id, ui_rectangle where, ui_cursor cursor)
{
    ui_canvas canvas;
    const bool is_upright = where.height > where.width;
    ui_panel_begin(self, id, where, UI_GROUND_NONE);
    ui_canvas_begin(self, "edge", 0.0f, 0.0f, &canvas);
    if (canvas.is_hovered || canvas.is_dragging) {
        ui_set_cursor(self, cursor);
        ui_draw_box(self, where, canvas.is_dragging ? THEME_ACCENT : THEME_RULE, 0.0f);
    }
    ui_canvas_end(self);
    ui_panel_end(self);
    if (!canvas.is_dragging && !canvas.is_released)
        return 0.0f;
    return is_upright ? canvas.moved_x : canvas.moved_y;
}

/* ---- shapes ---- */

void ui_draw_box(ui *self, ui_rectangle where, uint32_t colour, float rounding)
{
    ui_put_box(self, ui_px_box(self, where), colour, ui_px(self, rounding));
}

void ui_draw_frame(ui *self, ui_rectangle where, uint32_t colour, float rounding, float thickness)
{
    const ImRect box = ui_px_box(self, where);
    ImGui::GetWindowDrawList()->AddRect(box.Min, box.Max, ui_ink(self, colour),
                                        ui_px(self, rounding), 0, ui_px(self, thickness));
}

void ui_draw_line(ui *self, float x0, float y0, float x1, float y1, uint32_t colour,
                  float thickness)
{
    ImGui::GetWindowDrawList()->AddLine(ui_px2(self, x0, y0), ui_px2(self, x1, y1),
                                        ui_ink(self, colour), ui_px(self, thickness));
}

void ui_draw_lines(ui *self, const float *xy, uint32_t count, uint32_t colour, float thickness)
{
    ImDrawList *list = ImGui::GetWindowDrawList();
    for (uint32_t i = 0; i < count; ++i)
        list->PathLineTo(ui_px2(self, xy[2 * i], xy[2 * i + 1]));
    list->PathStroke(ui_ink(self, colour), 0, ui_px(self, thickness));
}

/* Quads without the seams that anti-aliased edges between them would show. */
void ui_draw_area(ui *self, const float *x, const float *low, const float *high, uint32_t count,
                  uint32_t colour)
{
    constexpr uint32_t part_max = 8192; /* columns: indices have 16 bits */
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImVec2 white = ImGui::GetDrawListSharedData()->TexUvWhitePixel;
    const ImU32 ink = ui_ink(self, colour);
    for (uint32_t first = 0; first + 1 < count; first += part_max - 1) {
        const uint32_t columns = ImMin(count - first, part_max);
        list->PrimReserve(static_cast<int>(6 * (columns - 1)), static_cast<int>(2 * columns));
        const unsigned int base = list->_VtxCurrentIdx;
        for (uint32_t i = 0; i < columns; ++i) {
            list->PrimWriteVtx(ui_px2(self, x[first + i], low[first + i]), white, ink);
            list->PrimWriteVtx(ui_px2(self, x[first + i], high[first + i]), white, ink);
        }
        for (uint32_t i = 0; i + 1 < columns; ++i) {
            const unsigned int corner = base + 2 * i, order[] = {0, 1, 3, 0, 3, 2};
            for (unsigned int offset : order)
                list->PrimWriteIdx(static_cast<ImDrawIdx>(corner + offset));
        }
    }
}

void ui_draw_disc(ui *self, float x, float y, float radius, uint32_t colour)
{
    ImGui::GetWindowDrawList()->AddCircleFilled(ui_px2(self, x, y), ui_px(self, radius),
                                                ui_ink(self, colour));
}

void ui_draw_ring(ui *self, float x, float y, float radius, uint32_t colour, float thickness)
{
    ImGui::GetWindowDrawList()->AddCircle(ui_px2(self, x, y), ui_px(self, radius),
                                          ui_ink(self, colour), 0, ui_px(self, thickness));
}

void ui_draw_triangle(ui *self, const float xy[6], uint32_t colour)
{
    ImGui::GetWindowDrawList()->AddTriangleFilled(ui_px2(self, xy[0], xy[1]),
                                                  ui_px2(self, xy[2], xy[3]),
                                                  ui_px2(self, xy[4], xy[5]), ui_ink(self, colour));
}

void ui_draw_text(ui *self, float x, float y, ui_style style, uint32_t colour, float max_width,
                  const char *text)
{
    ui_put_text(self, ui_style_font(self, style), ui_px2(self, x, y), colour,
                max_width > 0.0f ? ui_px(self, max_width) : 0.0f, text, text + std::strlen(text));
}

void ui_draw_image(ui *self, ui_rectangle where, uint32_t texture, uint64_t version,
                   bool is_mirrored)
{
    ui_damage_images *images = &self->images;
    if (images->count < UI_DAMAGE_IMAGES)
        images->of[images->count] = {reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture)),
                                     version};
    images->count += 1;
    const ImRect box = ui_px_box(self, where);
    const float left = is_mirrored ? 1.0f : 0.0f;
    ImGui::GetWindowDrawList()->AddImage(
        reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture)), box.Min, box.Max,
        ImVec2(left, 1.0f), ImVec2(1.0f - left, 0.0f));
    ui_notes_box(self->notes, self->surface, where, 0);
}

void ui_clip_begin(ui *self, ui_rectangle where)
{
    const ImRect box = ui_px_box(self, where);
    ImGui::PushClipRect(box.Min, box.Max, true);
}

void ui_clip_end(ui *self)
{
    (void)self;
    ImGui::PopClipRect();
}

/* ---- a text in a line of widgets ---- */

void ui_label(ui *self, const char *id, float width, uint32_t colour, const char *text)
{
    ui_canvas at;
    ui_canvas_begin(self, id, width, ui_row_height(self), &at);
    const float y = at.where.y + 0.5f * (at.where.height - ui_text_height(self, UI_STYLE_BODY));
    ui_draw_text(self, at.where.x, y, UI_STYLE_BODY, colour, at.where.width, text);
    ui_canvas_end(self);
    if (ui_text_width(self, UI_STYLE_BODY, text) > width)
        ui_hint(self, text);
    ui_same_line(self);
}

/* ---- life ---- */

static void map_keys(ImGuiIO &io)
{
    io.KeyMap[ImGuiKey_Tab] = UI_KEY_TAB;
    io.KeyMap[ImGuiKey_LeftArrow] = UI_KEY_LEFT;
    io.KeyMap[ImGuiKey_RightArrow] = UI_KEY_RIGHT;
    io.KeyMap[ImGuiKey_UpArrow] = UI_KEY_UP;
    io.KeyMap[ImGuiKey_DownArrow] = UI_KEY_DOWN;
    io.KeyMap[ImGuiKey_PageUp] = UI_KEY_PAGE_UP;
    io.KeyMap[ImGuiKey_PageDown] = UI_KEY_PAGE_DOWN;
    io.KeyMap[ImGuiKey_Home] = UI_KEY_HOME;
    io.KeyMap[ImGuiKey_End] = UI_KEY_END;
    io.KeyMap[ImGuiKey_Insert] = UI_KEY_INSERT;
    io.KeyMap[ImGuiKey_Delete] = UI_KEY_DELETE;
    io.KeyMap[ImGuiKey_Backspace] = UI_KEY_BACKSPACE;
    io.KeyMap[ImGuiKey_Space] = ' ';
    io.KeyMap[ImGuiKey_Enter] = UI_KEY_ENTER;
    io.KeyMap[ImGuiKey_Escape] = UI_KEY_ESCAPE;
    io.KeyMap[ImGuiKey_A] = 'A';
    io.KeyMap[ImGuiKey_C] = 'C';
    io.KeyMap[ImGuiKey_V] = 'V';
    io.KeyMap[ImGuiKey_X] = 'X';
    io.KeyMap[ImGuiKey_Y] = 'Y';
    io.KeyMap[ImGuiKey_Z] = 'Z';
}

static ImVec4 style_colour(ui *self, uint32_t colour)
{
    return ImGui::ColorConvertU32ToFloat4(ui_ink(self, colour));
}

static void set_colours(ui *self, ImGuiStyle &style)
{
    const struct {
        ImGuiCol which;
        uint32_t colour;
    } colours[] = {{ImGuiCol_Text, THEME_TEXT},
                   {ImGuiCol_TextDisabled, THEME_DIM},
                   {ImGuiCol_WindowBg, THEME_PANEL},
                   {ImGuiCol_ChildBg, 0},
                   {ImGuiCol_PopupBg, THEME_PANEL},
                   {ImGuiCol_Border, THEME_RULE},
                   {ImGuiCol_FrameBg, THEME_WELL},
                   {ImGuiCol_FrameBgHovered, THEME_WELL},
                   {ImGuiCol_FrameBgActive, THEME_WELL},
                   {ImGuiCol_ScrollbarBg, 0},
                   {ImGuiCol_ScrollbarGrab, THEME_RULE},
                   {ImGuiCol_ScrollbarGrabHovered, THEME_HOVER},
                   {ImGuiCol_ScrollbarGrabActive, THEME_HOVER},
                   {ImGuiCol_SliderGrab, 0},
                   {ImGuiCol_SliderGrabActive, 0},
                   {ImGuiCol_Button, THEME_RAISED},
                   {ImGuiCol_ButtonHovered, THEME_HOVER},
                   {ImGuiCol_ButtonActive, THEME_HOVER},
                   {ImGuiCol_Header, THEME_RAISED},
                   {ImGuiCol_HeaderHovered, THEME_HOVER},
                   {ImGuiCol_HeaderActive, THEME_HOVER},
                   {ImGuiCol_TextSelectedBg, 0xd9a44150u},
                   {ImGuiCol_ModalWindowDimBg, 0x08090aa0u},
                   {ImGuiCol_NavHighlight, 0}};
    for (const auto &entry : colours)
        style.Colors[entry.which] = style_colour(self, entry.colour);
}

static void set_style(ui *self)
{
    ImGuiStyle style;
    set_colours(self, style);
    style.WindowPadding = ImVec2(THEME_PADDING, THEME_PADDING);
    style.FramePadding = ImVec2(8.0f, 4.0f);
    style.ItemSpacing = ImVec2(8.0f, 6.0f);
    style.WindowRounding = 0.0f;
    style.PopupRounding = 6.0f;
    style.FrameRounding = 4.0f;
    style.ScrollbarSize = 9.0f;
    style.ScrollbarRounding = 4.0f;
    style.WindowBorderSize = 0.0f;
    style.PopupBorderSize = 1.0f;
    style.DisabledAlpha = 1.0f;
    style.AntiAliasedLinesUseTex = true;
    style.ScaleAllSizes(self->scale);
    style.WindowMinSize = ImVec2(1.0f, 1.0f);
    ImGui::GetStyle() = style;
}

static mrt_result start(ui *self, error *err)
{
    self->queue = static_cast<ui_queue *>(std::malloc(sizeof(ui_queue)));
    self->input = static_cast<ui_frame_input *>(std::calloc(1, sizeof(ui_frame_input)));
    self->notes = ui_notes_create();
    self->damage = ui_damage_create();
    self->system = system_fonts_create();
    self->wanted = static_cast<ui_characters *>(std::calloc(1, sizeof(ui_characters)));
    if (!self->system || !self->wanted || !self->queue || !self->input || !self->notes ||
        !self->damage)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    ui_queue_init(self->queue);
    IMGUI_CHECKVERSION();
    self->context = ImGui::CreateContext();
    if (!self->context)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    ImGui::SetCurrentContext(self->context);
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    io.ConfigInputTextCursorBlink = false;
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    io.MouseDragThreshold = 3.0f;
    map_keys(io);
    self->is_drawing = ImGui_ImplOpenGL3_Init("#version 330 core");
    if (!self->is_drawing)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the panels cannot be drawn: OpenGL 3.3 did not start");
    return MRT_OK;
}

mrt_result ui_create(ui **out, error *err)
{
    *out = nullptr;
    mrt_result result = gl_check_current(err);
    if (result < 0)
        return result;
    ui *self = static_cast<ui *>(std::calloc(1, sizeof(ui)));
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    result = start(self, err);
    if (result < 0) {
        ui_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void ui_destroy(ui *self)
{
    if (!self)
        return;
    if (self->context)
        ImGui::SetCurrentContext(self->context);
    if (self->is_drawing)
        ImGui_ImplOpenGL3_Shutdown();
    self->focus.order.clear();
    if (self->context)
        ImGui::DestroyContext(self->context);
    ui_notes_destroy(self->notes);
    ui_damage_destroy(self->damage);
    system_fonts_destroy(self->system);
    std::free(self->wanted);
    std::free(self->input);
    std::free(self->queue);
    std::free(self);
}

/* ---- events ---- */

void ui_push(ui *self, const ui_event *event)
{
    ui_queue_push(self->queue, event);
}

bool ui_is_idle(const ui *self)
{
    return ui_queue_is_empty(self->queue);
}

bool ui_is_holding(const ui *self)
{
    const ui_frame_input *input = self->input;
    bool is_holding = false;
    for (bool is_down : input->button)
        is_holding |= is_down;
    for (bool is_down : input->key)
        is_holding |= is_down;
    return is_holding;
}

void ui_want_frame(ui *self, double in_s)
{
    self->wanted_s = ImMin(self->wanted_s, in_s);
}

double ui_wanted_s(const ui *self)
{
    return self->wanted_s;
}

void ui_set_clipboard(ui *self, const ui_clipboard *clipboard)
{
    ImGui::SetCurrentContext(self->context);
    ImGuiIO &io = ImGui::GetIO();
    io.ClipboardUserData = clipboard->data;
    io.GetClipboardTextFn = clipboard->get;
    io.SetClipboardTextFn = clipboard->set;
}

/* ---- frame ---- */

static void set_scale(ui *self, float scale)
{
    if (self->scale == scale && !self->wanted->is_new)
        return;
    self->scale = scale;
    ui_damage_forget(self->damage);
    load_fonts(self);
    set_style(self);
    /* Deletes only the texture of the old fonts. If the buffers were recreated too,
     * imgui_impl_opengl3 1.86 would assume their old size, and draw nothing. */
    if (!self->has_drawn)
        return;
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
}

static void set_look(ui *self)
{
    if (self->look.is_light == self->wanted_look.is_light &&
        self->look.is_colour_safe == self->wanted_look.is_colour_safe)
        return;
    self->look = self->wanted_look;
    set_style(self);
}

void ui_set_theme(ui *self, theme of)
{
    self->wanted_look = of;
}

void ui_on_face_begin(ui *self)
{
    self->plain_depth += 1;
}

void ui_on_face_end(ui *self)
{
    self->plain_depth -= 1;
}

static constexpr float double_click_s = 0.3f;

void ui_begin(ui *self, const ui_screen *screen)
{
    ImGui::SetCurrentContext(self->context);
    ImGuiIO &io = ImGui::GetIO();
    self->screen = *screen;
    set_scale(self, screen->scale > 0.25f ? screen->scale : 0.25f);
    set_look(self);
    io.DisplaySize = ui_px2(self, screen->width, screen->height);
    io.DeltaTime = screen->dt_s > 1e-5 ? static_cast<float>(screen->dt_s) : 1e-5f;
    /* Each click takes two frames (ui_queue.h): where they are slow, a hand is not. */
    io.MouseDoubleClickTime = double_click_s + 3.0f * io.DeltaTime;
    ui_hand_over(self);
    self->cursor = UI_CURSOR_ARROW;
    self->panel_count = self->popup_depth = 0;
    self->had_dialog = self->has_dialog;
    self->has_dialog = false;
    self->next_width = 0.0f;
    self->images.count = 0;
    self->wanted_s = HUGE_VAL;
    self->is_slider_held = self->types_lines = self->is_answered = false;
    ui_notes_begin(self->notes);
    ImGui_ImplOpenGL3_NewFrame();
    self->has_drawn = true;
    ImGui::NewFrame();
    close_menus(self);
    ui_focus_begin(&self->focus, self->input, self->has_menu);
    if (self->command != UI_KEY_NONE)
        ImGui::ClearActiveID();
}

/* Orders the panels: later ones cover earlier ones. */
static void order_panels(ui *self)
{
    for (int i = self->panel_count - 1; i >= 0; --i)
        ImGui::BringWindowToDisplayBack(self->panel[i]);
}

static ui_cursor cursor_of(ImGuiMouseCursor wanted)
{
    switch (wanted) {
    case ImGuiMouseCursor_TextInput:
        return UI_CURSOR_TEXT;
    case ImGuiMouseCursor_Hand:
        return UI_CURSOR_HAND;
    case ImGuiMouseCursor_ResizeAll:
        return UI_CURSOR_MOVE;
    case ImGuiMouseCursor_ResizeEW:
        return UI_CURSOR_ACROSS;
    case ImGuiMouseCursor_ResizeNS:
        return UI_CURSOR_DOWN;
    default:
        return UI_CURSOR_ARROW;
    }
}

static float whole_pixel(float at)
{
    return std::floor(at + 0.5f);
}

/* Draws a frame inside the box only. Clips are rounded to whole pixels: Dear ImGui truncates the
 * width of a clip, so an edge between two pixels would depend on the box. */
static void draw_part(const ImDrawData *whole, const ImRect &box)
{
    const float height = whole->DisplaySize.y;
    ImDrawData part = *whole;
    ImVector<ImDrawList *> list;
    ImVector<ImVec4> clip; /* of all commands, to restore them */
    for (int i = 0; i < whole->CmdListsCount; ++i) {
        bool is_seen = false;
        for (ImDrawCmd &command : whole->CmdLists[i]->CmdBuffer) {
            ImVec4 &c = command.ClipRect;
            clip.push_back(c);
            c = ImVec4(ImMax(whole_pixel(c.x), box.Min.x), ImMax(whole_pixel(c.y), box.Min.y),
                       ImMin(whole_pixel(c.z), box.Max.x), ImMin(whole_pixel(c.w), box.Max.y));
            is_seen |= c.x < c.z && c.y < c.w;
        }
        if (is_seen)
            list.push_back(whole->CmdLists[i]);
    }
    const ImVec4 ground = ImGui::ColorConvertU32ToFloat4(IM_COL32(
        THEME_STAGE >> 24 & 0xffu, THEME_STAGE >> 16 & 0xffu, THEME_STAGE >> 8 & 0xffu, 255));
    gl_end_scene(); /* a part that is cleared in the middle of a scene begins another one */
    glEnable(GL_SCISSOR_TEST);
    glScissor(static_cast<GLint>(box.Min.x), static_cast<GLint>(height - box.Max.y),
              static_cast<GLsizei>(box.GetWidth()), static_cast<GLsizei>(box.GetHeight()));
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClearColor(ground.x, ground.y, ground.z, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
    part.CmdLists = list.Data;
    part.CmdListsCount = list.Size;
    ImGui_ImplOpenGL3_RenderDrawData(&part);
    int at = 0;
    for (int i = 0; i < whole->CmdListsCount; ++i)
        for (ImDrawCmd &command : whole->CmdLists[i]->CmdBuffer)
            command.ClipRect = clip[at++];
}

/* Draws the parts that differ from the screen; false: all parts are equal. */
static bool draw_new(ui *self, const ImDrawData *data)
{
    if (self->screen.is_lost)
        ui_damage_forget(self->damage);
    const ui_damage_boxes boxes = ui_damage_find(self->damage, data, &self->images);
    for (int i = 0; i < boxes.count; ++i)
        draw_part(data, boxes.box[i]);
    if (boxes.count > 0)
        ui_damage_keep(self->damage, data, &self->images);
    return boxes.count > 0;
}

void ui_end(ui *self)
{
    order_panels(self);
    ui_close_left_popups();
    ui_notes_end(self->notes);
    if (self->cursor == UI_CURSOR_ARROW)
        self->cursor = cursor_of(ImGui::GetMouseCursor());
    ui_focus_end(&self->focus, ui_ink(self, THEME_ACCENT), ui_whole_px(self, 2.0f),
                 ui_px(self, 5.0f));
    if (self->focus.has_moved)
        ui_want_frame(self, 0.0);
    ImGui::Render();
    self->is_new = !self->screen.is_hidden && draw_new(self, ImGui::GetDrawData());
}

void ui_draw_again(ui *self)
{
    ui_damage_forget(self->damage);
    (void)draw_new(self, ImGui::GetDrawData());
}

bool ui_is_new(const ui *self)
{
    return self->is_new;
}

bool ui_is_hidden(const ui *self)
{
    return self->screen.is_hidden;
}

void ui_set_cursor(ui *self, ui_cursor cursor)
{
    self->cursor = cursor;
}

ui_cursor ui_cursor_wanted(const ui *self)
{
    return self->cursor;
}

/* ---- positions ---- */

void ui_panel_begin(ui *self, const char *id, ui_rectangle where, ui_ground ground)
{
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
        ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
        ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoBackground |
        ImGuiWindowFlags_NoFocusOnAppearing; /* Dear ImGui aborts beside a new question */
    ImRect box = ui_px_box(self, where);
    box.Min = ImFloor(box.Min + ImVec2(0.5f, 0.5f));
    box.Max = ImFloor(box.Max + ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowPos(box.Min);
    ImGui::SetNextWindowSize(ImMax(box.GetSize(), ImVec2(1.0f, 1.0f)));
    const float padding = ground == UI_GROUND_NONE ? 0.0f : ui_px(self, THEME_PADDING);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(padding, padding));
    ImGui::Begin(id, nullptr, flags);
    ImGui::PopStyleVar();
    if (self->panel_count < UI_PANELS_MAX)
        self->panel[self->panel_count++] = ImGui::GetCurrentWindow();
    ImGui::PushClipRect(box.Min, box.Max, false); /* to its edge, not to half its padding */
    self->surface = ui_notes_surface(self->notes, where, false);
    if (ground != UI_GROUND_NONE)
        ui_put_box(self, box, THEME_PANEL, 0.0f);
}

void ui_panel_end(ui *self)
{
    (void)self;
    ImGui::PopClipRect();
    ImGui::End();
}

static float size_px(const ui *self, float points)
{
    return points == 0.0f ? 0.0f : ui_whole_px(self, points);
}

void ui_scroll_begin(ui *self, const char *id, float width, float height)
{
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
    ImGui::BeginChild(id, ImVec2(size_px(self, width), size_px(self, height)), false,
                      ImGuiWindowFlags_NoNav);
    ImGui::PopStyleVar();
}

void ui_scroll_end(ui *self)
{
    (void)self;
    ImGui::EndChild();
}

void ui_scroll_to_end(ui *self)
{
    (void)self;
    ImGui::SetScrollHereY(1.0f);
}

void ui_scroll_to_row(ui *self)
{
    (void)self;
    if (!ImGui::IsItemVisible())
        ImGui::SetScrollHereY(0.5f);
}

void ui_same_line(ui *self)
{
    (void)self;
    ImGui::SameLine();
}

void ui_next_line(ui *self)
{
    (void)self;
    ImGui::NewLine();
}

void ui_at(ui *self, float x)
{
    const ImGuiWindow *window = ImGui::GetCurrentWindow();
    ImGui::SameLine();
    ImGui::SetCursorPosX(window->WindowPadding.x + ui_whole_px(self, x));
}

void ui_space(ui *self, float height)
{
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    window->DC.CursorPos.y += ui_whole_px(self, height);
    window->DC.CursorMaxPos.y =
        ImMax(window->DC.CursorMaxPos.y, window->DC.CursorPos.y - ImGui::GetStyle().ItemSpacing.y);
}

void ui_rule(ui *self)
{
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, thick = ImMax(1.0f, ui_px(self, 1.0f));
    ui_put_box(self, ImRect(at, at + ImVec2(width, thick)), THEME_RULE, 0.0f);
    ImGui::Dummy(ImVec2(width, thick));
}

void ui_width(ui *self, float width)
{
    self->next_width = size_px(self, width);
}

float ui_available_width(const ui *self)
{
    return ImGui::GetContentRegionAvail().x / self->scale;
}

float ui_available_height(const ui *self)
{
    return ImGui::GetContentRegionAvail().y / self->scale;
}

float ui_row_height(const ui *self)
{
    return ui_text_height(self, UI_STYLE_BODY) +
           2.0f * ImGui::GetStyle().FramePadding.y / self->scale;
}

void ui_id_begin(ui *self, const char *id)
{
    (void)self;
    ImGui::PushID(id);
}

void ui_id_end(ui *self)
{
    (void)self;
    ImGui::PopID();
}

void ui_disabled_begin(ui *self, bool is_disabled)
{
    ImGui::BeginDisabled(is_disabled);
    ImGui::PushStyleColor(ImGuiCol_Text, is_disabled ? ui_ink(self, THEME_DIM)
                                                     : ImGui::GetColorU32(ImGuiCol_Text));
    self->disabled_depth = (self->disabled_depth << 1) | (is_disabled ? 1 : 0);
}

void ui_disabled_end(ui *self)
{
    self->disabled_depth >>= 1;
    ImGui::PopStyleColor();
    ImGui::EndDisabled();
}

/* ---- what was drawn ---- */

void ui_note_words(ui *self, bool is_noting)
{
    ui_notes_set(self->notes, is_noting);
}

uint32_t ui_words(const ui *self, const ui_word **out)
{
    return ui_notes_words(self->notes, out);
}

uint32_t ui_controls(const ui *self, const ui_control **out)
{
    return ui_notes_controls(self->notes, out);
}
