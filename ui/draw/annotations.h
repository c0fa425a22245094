/* draw/annotations.h - words, lines and dots over a picture. Words by FreeType: the adapter. One
 * font, left to right, no kerning beyond the font's advances; without a font it draws nothing and
 * says so when asked. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_ANNOTATIONS_H
#define MAROTTE_UI_DRAW_ANNOTATIONS_H
#include "draw/draw.h"

typedef struct letters letters;

/* Where fonts are usually found, best first; ends with NULL. */
extern const char *const letters_fonts[];

/* Takes the first font that can be read; none is no error. NULL: failed. */
letters *letters_create(const char *const *paths, error *err);
void letters_destroy(letters *self);
const char *letters_font(const letters *self); /* the path of the font in use, or NULL */
float letters_width(letters *self, const char *words, float size_px);
/* As draw_text. */
void letters_draw(letters *self, draw_target *target, const char *words, float x, float y,
                  float size_px, const float rgba[4]);

typedef struct strokes strokes;

strokes *strokes_create(error *err); /* NULL: failed */
void strokes_destroy(strokes *self);
/* As draw_strokes. */
void strokes_draw(strokes *self, draw_target *target, const draw_stroke *stroke, uint32_t count);

#endif
