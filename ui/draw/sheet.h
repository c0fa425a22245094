/* draw/sheet.h - a performance on one picture: the contact sheet of eight moments, front and
 * three-quarter view, with their times, beside the face at rest. It draws in the context that is
 * current, or in one of its own. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_SHEET_H
#define MAROTTE_UI_DRAW_SHEET_H
#include "draw/scenery.h"
#include "io/export.h"

typedef struct sheet_about {
    const char *title; /* one line at the top; NULL: none */
    /* What it was made from, so that it can be made again: the command, inputs, parameters. Lines
     * ended by \n, wrapped where they are too long; NULL: none. */
    const char *made_from;
    uint32_t width, height;         /* pixels; 0: SHEET_WIDTH by SHEET_HEIGHT */
    const scenery *scene;           /* how it is lit; NULL: in the studio */
    const scenery_picture *picture; /* behind the faces; NULL: the wall */
} sheet_about;
enum { SHEET_WIDTH = 1920, SHEET_HEIGHT = 960 };

/* Where everything stands, pixels. made_px: how high what it was made from is written. */
typedef struct sheet_grid {
    float unit, margin;         /* of the sizes; at each edge */
    float title, legend, label; /* heights of letters; 0: no room for words */
    float header, top;          /* where the header's own words end; where the views begin */
    uint32_t columns, rows;     /* of moments, a pair of views each */
    uint32_t rest_across;       /* views at rest side by side, at the left: 1 or 2 */
    uint32_t view_width, view_height, row_height;
    float gap; /* before each column of moments */
} sheet_grid;
/* In as many columns as let the views be largest. */
sheet_grid sheet_lay_out(uint32_t width, uint32_t height, float made_px);
enum { SHEET_REST = 8 }; /* in the place of a moment */
/* The top left corner of a view: 0 from the front, 1 turned. */
void sheet_place(uint32_t out[2], const sheet_grid *of, uint32_t which, uint32_t view);

/* Renders and writes the PNG. The moments: in each eighth of the clip the frame that is furthest
 * from rest; a clip without frames shows the rest face alone. They stand in as many columns as show
 * them largest; words shrink with the sheet as long as they can be read, and are cut then. Where no
 * font is found the sheet has no words: MRT_OK all the same, and `err` says what to install;
 * otherwise its text is "" on success. */
CHECKED mrt_result sheet_write(const char *path, const clip *c, const sheet_about *about,
                               error *err);

/* Which frames of a performance show it best: in each eighth of the clip the one that is furthest
 * from rest. Of a long clip a few dozen of each eighth are looked at. [main] or a worker. */
enum { THUMBNAILS_MAX = 8 };

typedef struct thumbnail {
    uint32_t frame;
    double distance_mm; /* from rest: root of the mean square over the vertices */
} thumbnail;

/* In time order, one per eighth that has a frame: fewer than eight for clips of fewer frames. The
 * earliest of equals. */
CHECKED mrt_result thumbnails_choose(thumbnail out[THUMBNAILS_MAX], uint32_t *out_count,
                                     const clip *c, error *err);

#endif
