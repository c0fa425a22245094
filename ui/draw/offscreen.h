/* draw/offscreen.h - everything to draw a picture of one face without a window: context, target,
 * renderer, face and pixels, created and freed together. Leaves out what is drawn (draw.h). [thread
 * that created it] */
#ifndef MAROTTE_UI_DRAW_OFFSCREEN_H
#define MAROTTE_UI_DRAW_OFFSCREEN_H
#include "draw/draw.h"
#include "draw/scenery.h"

typedef struct offscreen {
    draw_context *context; /* NULL: the context of the caller is used */
    draw_target *target;
    draw_renderer *renderer;
    draw_face *face;
    draw_backdrop *backdrop; /* NULL: the wall */
    uint8_t *pixels;         /* width by height, RGBA */
    uint32_t width, height;
} offscreen;

/* Uses the current context, or creates one. On error there is nothing to finish. */
CHECKED mrt_result offscreen_init(offscreen *out, const mesh *m, uint32_t width, uint32_t height,
                                  error *err);
void offscreen_finish(offscreen *self); /* accepts NULL and a zeroed struct */
/* Sets the lights, and the picture or wall, for all later drawing. */
CHECKED mrt_result offscreen_set_scene(offscreen *self, const scenery *scene,
                                       const scenery_picture *picture, error *err);

/* Draws text that is at most width_px wide; longer text ends with an ellipsis. */
void offscreen_words(offscreen *self, const char *words, float x, float y, float size_px,
                     float width_px, const float rgba[4]);
/* Draws text in several lines. Lines break at blanks and after commas, or anywhere if necessary.
 * Line max_lines is cut. Returns the number of lines. rgba NULL: only counts them. */
uint32_t offscreen_paragraph(offscreen *self, const char *words, float x, float y, float size_px,
                             float width_px, uint32_t max_lines, const float rgba[4]);
/* Returns the distance between two lines. */
float offscreen_line_px(float size_px);
/* Writes the picture as a PNG. */
CHECKED mrt_result offscreen_save(offscreen *self, const char *path, error *err);

#endif
