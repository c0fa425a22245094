/* window/panels/calibrate.h - the guided calibration of a glove or a bare hand as a dialog over the
 * workspace: its poses with words and live bars, then how well it fits, a name, and it is used at
 * once. Part of the devices panel. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_CALIBRATE_H
#define MAROTTE_UI_WINDOW_PANELS_CALIBRATE_H
#include "window/app/app.h"
#include "window/gui/ui.h"

typedef struct calibrate_panel calibrate_panel;
calibrate_panel *calibrate_panel_create(app *of);    /* NULL: no memory */
void calibrate_panel_destroy(calibrate_panel *self); /* NULL is fine */

/* index: of live_input. False: that cannot be calibrated; out_why says it. */
bool calibrate_panel_open(calibrate_panel *self, uint32_t index, uint32_t side, error *out_why);
/* Each frame, seen or not: takes what the glove gave. */
void calibrate_panel_update(calibrate_panel *self);
/* Each frame of the panel that it belongs to. */
void calibrate_panel_draw(calibrate_panel *self, ui *on);
/* Once after one was kept: its path, until the next call; NULL: none. */
const char *calibrate_panel_take_kept(calibrate_panel *self, uint32_t *out_side);

#endif
