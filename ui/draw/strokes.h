/* draw/strokes.h - lines and dots over a picture. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_STROKES_H
#define MAROTTE_UI_DRAW_STROKES_H
#include "draw/draw.h"

typedef struct strokes strokes;

strokes *strokes_create(error *err); /* NULL: failed */
void strokes_destroy(strokes *self);
/* As draw_strokes. */
void strokes_draw(strokes *self, draw_target *target, const draw_stroke *stroke, uint32_t count);

#endif
