/* draw/annotations.h - text, lines and dots over a picture. The adapter of FreeType. One font,
 * and fonts of the system for characters that it lacks; left to right, no kerning, no joined
 * letters. Without a font it draws no text, and letters_font returns NULL. [thread of
 * the context] */
#ifndef MAROTTE_UI_DRAW_ANNOTATIONS_H
#define MAROTTE_UI_DRAW_ANNOTATIONS_H
#include "draw/draw.h"

typedef struct letters letters;

/* Usual paths of fonts, best first; ends with NULL. */
extern const char *const letters_fonts[];

/* Uses the first readable font; having none is not an error. NULL: failed. */
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
