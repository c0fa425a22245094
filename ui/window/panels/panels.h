/* window/panels/panels.h - the panels of the workspace, each a room of its own: made once, drawn
 * each frame into the rectangle it is given. What they have done is the application's. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_PANELS_H
#define MAROTTE_UI_WINDOW_PANELS_PANELS_H
#include "draw/draw.h"
#include "window/app/app.h"
#include "window/gui/ui.h"

typedef struct panel panel;
typedef struct panel_type {
    panel *(*create)(app *of);    /* NULL: no memory */
    void (*destroy)(panel *self); /* NULL is fine */
    /* [main] each frame in which it is seen */
    void (*draw)(panel *self, ui *on, ui_rectangle where);
    /* [main] each frame, seen or not; may be NULL */
    void (*update)(panel *self, double dt_s);
} panel_type;
extern const panel_type panel_devices, panel_mapping, panel_rig, panel_engine, panel_log,
    panel_patch, panel_output, panel_scene, panel_hand, panel_timeline;

#endif
