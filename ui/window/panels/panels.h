/* window/panels/panels.h - the panels of the workspace. Each panel is independent of the others, is
 * created once and draws into a given rectangle in each frame. The application owns the effects of
 * their actions. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_PANELS_H
#define MAROTTE_UI_WINDOW_PANELS_PANELS_H
#include "draw/draw.h"
#include "window/app/app.h"
#include "window/gui/ui.h"

typedef struct panel panel;
typedef struct panel_type {
    panel *(*create)(app *of);    /* NULL: no memory */
    void (*destroy)(panel *self); /* NULL is fine */
    /* [main] in each frame in which the panel is visible */
    void (*draw)(panel *self, ui *on, ui_rectangle where);
    /* [main] in each frame, also while the panel is hidden; may be NULL */
    void (*update)(panel *self, double dt_s);
} panel_type;
extern const panel_type panel_devices, panel_mapping, panel_rig, panel_engine, panel_log,
    panel_patch, panel_output, panel_scene, panel_hand, panel_poses, panel_timeline;

#endif
