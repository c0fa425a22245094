/* draw/system_font.h - which font of the system has a character that the fonts of the window and of
 * pictures lack: Chinese, Arabic, Devanagari and so on. The adapter of fontconfig, which is started
 * by the first question. [one thread] */
#ifndef MAROTTE_UI_DRAW_SYSTEM_FONT_H
#define MAROTTE_UI_DRAW_SYSTEM_FONT_H
#include <stdint.h>

typedef struct system_fonts system_fonts;

typedef struct system_font {
    const char *path; /* of the fonts that were asked */
    uint32_t index;   /* in a file of several fonts */
} system_font;

system_fonts *system_fonts_create(void); /* NULL: no memory */
void system_fonts_destroy(system_fonts *self);
/* Finds the best upright font with outlines that has the character. Returns {NULL, 0} where the
 * system has none, and in a program that was built without fontconfig. */
system_font system_fonts_find(system_fonts *self, uint32_t code_point);

#endif
