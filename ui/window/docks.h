/* window/docks.h - the panels in their docks: tabs that are pressed, dragged and have a menu,
 * panels that float, the edges between the parts, and the switch of the three layouts. Leaves out
 * where each panel is (app/arrangement.h). [main] */
#ifndef MAROTTE_UI_WINDOW_DOCKS_H
#define MAROTTE_UI_WINDOW_DOCKS_H
#include "window/panels/panels.h"

typedef struct docks docks;
docks *docks_create(app *of); /* NULL: no memory */
void docks_destroy(docks *self);
panel *docks_panel(docks *self, app_panel of);
void docks_update(docks *self, double dt_s);
/* The timeline and both docks. */
void docks_draw(docks *self, ui *on, const arrangement_rectangles *at);
/* The edges and the switch, over the face, and the panels that float. */
void docks_draw_over(docks *self, ui *on, const arrangement_rectangles *at);

#endif
