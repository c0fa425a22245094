/* draw/sheet.h - the contact sheet of a performance: eight moments with their times, each in front
 * and three-quarter view, beside the face at rest. It draws in the current context, or creates one.
 * [thread of the context] */
#ifndef MAROTTE_UI_DRAW_SHEET_H
#define MAROTTE_UI_DRAW_SHEET_H
#include "draw/scenery.h"
#include "io/export.h"

typedef struct sheet_about {
    const char *title; /* one line at the top; NULL: none */
    /* How to make the performance again: the command, inputs, parameters. Lines end with \n; long
     * lines are wrapped. NULL: none. */
    const char *made_from;
    uint32_t width, height;         /* pixels; 0: SHEET_WIDTH by SHEET_HEIGHT */
    const scenery *scene;           /* lights; NULL: studio */
    const scenery_picture *picture; /* behind the faces; NULL: the wall */
} sheet_about;
enum { SHEET_WIDTH = 1920, SHEET_HEIGHT = 960 };

/* Layout of the sheet in pixels. made_px: height of made_from. */
typedef struct sheet_grid {
    float unit, margin;         /* scale of all sizes; margin at each edge */
    float title, legend, label; /* heights of letters; 0: no room for text */
    float header, top;          /* end of the text in the header; beginning of the views */
    uint32_t columns, rows;     /* of moments, each a pair of views */
    uint32_t rest_across;       /* number of views at rest side by side, at the left: 1 or 2 */
    uint32_t view_width, view_height, row_height;
    float gap; /* left of each column of moments */
} sheet_grid;
/* Chooses the number of columns with the largest views. */
sheet_grid sheet_lay_out(uint32_t width, uint32_t height, float made_px);
enum { SHEET_REST = 8 }; /* index of the face at rest, instead of a moment */
/* Computes the top left corner of a view: 0 from the front, 1 turned. */
void sheet_place(uint32_t out[2], const sheet_grid *of, uint32_t which, uint32_t view);

/* Renders and writes the PNG. Each moment is the frame of one eighth of the clip that is furthest
 * from rest. A clip without frames gives only the face at rest. The number of columns is the one
 * with the largest views. Text shrinks with the sheet while it is readable, and is then cut. If no
 * font is found, the sheet has no text: the result is MRT_OK, and `err` names the package to
 * install. Otherwise err->text is "" on success. */
CHECKED mrt_result sheet_write(const char *path, const clip *c, const sheet_about *about,
                               error *err);

/* Chooses the most distinctive frames of a performance: in each eighth of the clip the frame that
 * is furthest from rest. In a long clip it examines a few dozen frames of each eighth. [main] or a
 * worker. */
enum { THUMBNAILS_MAX = 8 };

typedef struct thumbnail {
    uint32_t frame;
    double distance_mm; /* distance from rest: root mean square over the vertices */
} thumbnail;

/* The results are in time order, one per eighth with a frame: fewer than eight if the clip has
 * fewer frames. The earliest of equal frames is chosen. */
CHECKED mrt_result thumbnails_choose(thumbnail out[THUMBNAILS_MAX], uint32_t *out_count,
                                     const clip *c, error *err);

#endif
