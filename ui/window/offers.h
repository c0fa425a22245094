/* window/offers.h - what an empty stage offers to perform with, one click each: the camera, the
 * keyboard, a recorded hand to try, the mouse, gone as soon as anything performs; and a first rig
 * for a mesh that has none, where the mapping needs one. [main] */
#ifndef MAROTTE_UI_WINDOW_OFFERS_H
#define MAROTTE_UI_WINDOW_OFFERS_H
#include "window/app/app.h"
#include "window/gui/ui.h"

/* At the lower edge of the face. is_gone: it was answered; of this run. */
void offers_draw(app *of, ui *on, ui_rectangle over, bool *is_gone);

#endif
