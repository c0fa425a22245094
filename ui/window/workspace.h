/* window/workspace.h - everything that is drawn, put together: the viewport, the bar, the dock with
 * its panels, the timeline, the help. A frame: workspace_frame. [main], with the context. */
#ifndef MAROTTE_UI_WINDOW_WORKSPACE_H
#define MAROTTE_UI_WINDOW_WORKSPACE_H
#include "window/gui/window.h"
#include "window/app/app.h"

typedef struct workspace workspace;
CHECKED mrt_result workspace_create(workspace **out, app *of, window *on, error *err);
void workspace_destroy(workspace *self);
ui *workspace_ui(workspace *self);                  /* to push events and to read the drawn text */
float workspace_scale(const workspace *self);       /* pixels a point, of the last frame */
ui_rectangle workspace_face(const workspace *self); /* where it was drawn in the last frame */
/* One frame: events, update, panels, picture. False: the window must be closed. */
bool workspace_frame(workspace *self);

typedef struct workspace_counts {
    uint64_t frame_count, drawn_count; /* drawn: something of them was new */
    uint64_t face_count;               /* how often the face in space was drawn */
    app_figures fast;
    double first_face_s; /* since the program started */
} workspace_counts;
void workspace_counted(const workspace *self, workspace_counts *out);

#endif
