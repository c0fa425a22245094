/* draw/offscreen.h - what a picture of one face is painted on without a window: context, target,
 * renderer, face and pixels, made and given back together. It leaves out what is painted (draw.h).
 * The thread that made it. */
#ifndef MAROTTE_UI_DRAW_OFFSCREEN_H
#define MAROTTE_UI_DRAW_OFFSCREEN_H
#include "draw/draw.h"
#include "draw/scenery.h"

typedef struct offscreen {
    draw_context *context; /* NULL: somebody else's is in use */
    draw_target *target;
    draw_renderer *renderer;
    draw_face *face;
    draw_backdrop *backdrop; /* NULL: the wall */
    uint8_t *pixels;         /* width by height, RGBA */
    uint32_t width, height;
} offscreen;

/* In the context that is current, or in one of its own. On error there is nothing to finish. */
CHECKED mrt_result offscreen_init(offscreen *out, const mesh *m, uint32_t width, uint32_t height,
                                  error *err);
void offscreen_finish(offscreen *self); /* accepts NULL and zeroed */
/* What is drawn from now on is lit as the scene says, and stands before the picture or the wall. */
CHECKED mrt_result offscreen_set_scene(offscreen *self, const scenery *scene,
                                       const scenery_picture *picture, error *err);

/* draw_text in at most width_px, cut with an ellipsis. */
void offscreen_words(offscreen *self, const char *words, float x, float y, float size_px,
                     float width_px, const float rgba[4]);
/* The same in lines below each other, broken at blanks and behind commas, else where it must be;
 * the last of at most max_lines is cut. Returns how many lines there are; rgba NULL: only counts.
 */
uint32_t offscreen_paragraph(offscreen *self, const char *words, float x, float y, float size_px,
                             float width_px, uint32_t max_lines, const float rgba[4]);
/* From one of its lines to the next. */
float offscreen_line_px(float size_px);
/* Writes what is painted as a PNG. */
CHECKED mrt_result offscreen_save(offscreen *self, const char *path, error *err);

#endif
