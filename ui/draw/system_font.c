#include "draw/system_font.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#ifdef MAROTTE_HAS_FONTCONFIG
#include <fontconfig/fontconfig.h>

struct system_fonts {
    bool is_asked;
    FcConfig *config;
    FcFontSet *fonts; /* best first; NULL: none */
};

system_fonts *system_fonts_create(void)
{
    return calloc(1, sizeof(system_fonts));
}

void system_fonts_destroy(system_fonts *self)
{
    if (!self)
        return;
    if (self->fonts)
        FcFontSetDestroy(self->fonts);
    if (self->config)
        FcConfigDestroy(self->config);
    free(self);
}

static void sort_fonts(system_fonts *self)
{
    self->is_asked = true;
    self->config = FcInitLoadConfigAndFonts();
    FcPattern *wanted = FcNameParse((const FcChar8 *)"sans-serif:slant=0:weight=80");
    FcResult result;
    if (self->config && wanted) {
        FcConfigSubstitute(self->config, wanted, FcMatchPattern);
        FcDefaultSubstitute(wanted);
        self->fonts = FcFontSort(self->config, wanted, FcFalse, NULL, &result);
    }
    if (wanted)
        FcPatternDestroy(wanted);
}

/* Both users draw outlines of TrueType and of CFF, in one colour. */
static bool is_usable(const FcPattern *font)
{
    FcBool is_outline = FcFalse, is_coloured = FcFalse, is_variable = FcFalse;
    FcChar8 *format = NULL;
    FcPatternGetBool(font, FC_OUTLINE, 0, &is_outline);
    FcPatternGetBool(font, FC_COLOR, 0, &is_coloured);
    FcPatternGetBool(font, FC_VARIABLE, 0, &is_variable);
    if (FcPatternGetString(font, FC_FONTFORMAT, 0, &format) != FcResultMatch)
        return false;
    return is_outline && !is_coloured && !is_variable &&
           (strcmp((const char *)format, "TrueType") == 0 ||
            strcmp((const char *)format, "CFF") == 0);
}

system_font system_fonts_find(system_fonts *self, uint32_t code_point)
{
    if (!self->is_asked)
        sort_fonts(self);
    for (int i = 0; self->fonts && i < self->fonts->nfont; ++i) {
        const FcPattern *font = self->fonts->fonts[i];
        FcCharSet *characters = NULL;
        FcChar8 *path = NULL;
        int index = 0;
        if (FcPatternGetCharSet(font, FC_CHARSET, 0, &characters) == FcResultMatch &&
            FcCharSetHasChar(characters, code_point) && is_usable(font) &&
            FcPatternGetString(font, FC_FILE, 0, &path) == FcResultMatch &&
            FcPatternGetInteger(font, FC_INDEX, 0, &index) == FcResultMatch)
            return (system_font){(const char *)path, (uint32_t)index & 0xffffu};
    }
    return (system_font){NULL, 0};
}

#else
system_fonts *system_fonts_create(void)
{
    return malloc(1);
}

void system_fonts_destroy(system_fonts *self)
{
    free(self);
}

system_font system_fonts_find(system_fonts *self, uint32_t code_point)
{
    (void)self, (void)code_point;
    return (system_font){NULL, 0};
}
#endif
