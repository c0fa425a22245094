/* window/panels/calibrate.h - the dialog that calibrates a glove or a bare hand. It shows each pose
 * with instructions and live bars, then the quality of the result. The saved calibration is used
 * immediately. Part of the devices panel. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_CALIBRATE_H
#define MAROTTE_UI_WINDOW_PANELS_CALIBRATE_H
#include "window/app/app.h"
#include "window/gui/ui.h"

typedef struct calibrate_panel calibrate_panel;
calibrate_panel *calibrate_panel_create(app *of);    /* NULL: no memory */
void calibrate_panel_destroy(calibrate_panel *self); /* NULL is fine */

/* Opens the dialog. index: of live_input. Returns false, with the reason in out_why, if this input
 * cannot be calibrated. */
bool calibrate_panel_open(calibrate_panel *self, uint32_t index, uint32_t side, error *out_why);
/* Reads the new samples of the glove. Call it in each frame, also while the dialog is hidden. */
void calibrate_panel_update(calibrate_panel *self);
/* Draws the dialog. Call it in each frame of the devices panel. */
void calibrate_panel_draw(calibrate_panel *self, ui *on);
/* Returns the path of a newly saved calibration once, then NULL. Valid until the next call. */
const char *calibrate_panel_pop_saved(calibrate_panel *self, uint32_t *out_side);

#endif
