/* draw/sheet.h - a performance on one picture: the contact sheet of eight moments, front and
 * three-quarter view, with their times. */
#ifndef MAROTTE_UI_DRAW_SHEET_H
#define MAROTTE_UI_DRAW_SHEET_H
#include "io/export.h"

/* Renders and writes the PNG. The moments: in each eighth of the clip the frame that is furthest
 * from rest. `title`: one line at the top, may be NULL. */
CHECKED mrt_result sheet_write(const char *path, const clip *c, const char *title, error *err);

#endif
