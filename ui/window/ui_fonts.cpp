#include "window/ui_fonts.hpp"

#include <cstdio>

/* A line of Inter is so much higher than its letters' em. */
constexpr float LINE_PER_EM = 1.21f;

static const char *const regular_paths[] = {
    "/usr/share/fonts/opentype/inter/Inter-Regular.otf",
    "/usr/share/fonts/truetype/inter/Inter-Regular.ttf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Regular.ttf", nullptr};
static const char *const strong_paths[] = {
    "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf",
    "/usr/share/fonts/truetype/inter/Inter-SemiBold.ttf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf",
    "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Medium.ttf", nullptr};
static const char *const sign_paths[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                         nullptr};

/* Latin with accents, Greek, Cyrillic, dashes, arrows, shapes, stars. */
static const ImWchar text_ranges[] = {
    0x20,   0x17f,  0x2c6,  0x2dd,  0x391,  0x3c9,  0x401,  0x45f,  0x2010, 0x203a, 0x20ac, 0x20ac,
    0x2122, 0x2122, 0x2190, 0x2193, 0x2212, 0x2212, 0x221e, 0x221e, 0x2248, 0x2265, 0};
static const ImWchar sign_ranges[] = {0x2190, 0x21ff, 0x2300, 0x2328, 0x23ce,
                                      0x23fa, 0x25a0, 0x25ff, 0x2605, 0x2606,
                                      0x2660, 0x266f, 0x2713, 0x2718, 0};
static const ImWchar large_ranges[] = {0x20,   0xff,   0x2012, 0x2014, 0x2026,
                                       0x2026, 0x2212, 0x2212, 0};
static const ImWchar large_sign_ranges[] = {0x25a0, 0x25a0, 0x25b6, 0x25b6, 0x25cb, 0x25cf, 0};

/* ImGui ends the process when a font is missing. */
static const char *readable(const char *const *paths)
{
    for (; *paths; ++paths) {
        FILE *file = std::fopen(*paths, "rb");
        if (!file)
            continue;
        std::fclose(file);
        return *paths;
    }
    return nullptr;
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

static ImFont *load(float size_px, const char *const *paths, const ImWchar *ranges,
                    const ImWchar *signs)
{
    ImFontAtlas *atlas = ImGui::GetIO().Fonts;
    const float line_px = ImFloorSigned(size_px * LINE_PER_EM + 0.5f);
    const char *path = readable(paths), *sign_path = readable(sign_paths);
    const ImFontConfig config = config_of(false), merged = config_of(true);
    ImFont *font = path ? atlas->AddFontFromFileTTF(path, line_px, &config, ranges) : nullptr;
    if (!font)
        return atlas->AddFontDefault();
    if (sign_path)
        atlas->AddFontFromFileTTF(sign_path, line_px, &merged, signs);
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

void ui_fonts_load(ui *self)
{
    ImFontAtlas *atlas = ImGui::GetIO().Fonts;
    const float body = THEME_BODY_POINTS * self->scale, title = THEME_TITLE_POINTS * self->scale,
                large = THEME_LARGE_POINTS * self->scale;
    atlas->Clear();
    atlas->Flags |= ImFontAtlasFlags_NoPowerOfTwoHeight;
    self->font[UI_FONT_BODY] = load(body, regular_paths, text_ranges, sign_ranges);
    self->font[UI_FONT_STRONG] = load(body, strong_paths, text_ranges, sign_ranges);
    self->font[UI_FONT_TITLE] = load(title, strong_paths, text_ranges, large_sign_ranges);
    self->font[UI_FONT_LARGE] = load(large, strong_paths, large_ranges, large_sign_ranges);
    self->font[UI_FONT_NUMBER] = load(body, regular_paths, large_ranges, large_sign_ranges);
    atlas->Build();
    make_digits_even(self->font[UI_FONT_LARGE]);
    make_digits_even(self->font[UI_FONT_NUMBER]);
}
