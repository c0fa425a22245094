/* draw/sheet.h - a performance on one picture: the contact sheet of eight moments, front and
 * three-quarter view, with their times, beside the face at rest. It draws in the context that is
 * current, or in one of its own. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_SHEET_H
#define MAROTTE_UI_DRAW_SHEET_H
#include "io/export.h"

/* Renders and writes the PNG, SHEET_WIDTH by SHEET_HEIGHT. The moments: in each eighth of the clip
 * the frame that is furthest from rest; a clip without frames shows the rest face alone. `title`:
 * one line at the top, may be NULL. Where no font is found the sheet has no words: MRT_OK all the
 * same, and `err` says what to install; otherwise its text is "" on success. */
CHECKED mrt_result sheet_write(const char *path, const clip *c, const char *title, error *err);

enum { SHEET_WIDTH = 1920, SHEET_HEIGHT = 860 };

#endif
