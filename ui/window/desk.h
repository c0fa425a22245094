/* window/desk.h - everything that is drawn, put together: the viewport, the bar, the dock with its
 * panels, the timeline, the help. A frame: desk_frame. [main], with the context. */
#ifndef MAROTTE_UI_WINDOW_DESK_H
#define MAROTTE_UI_WINDOW_DESK_H
#include "window/front.h"
#include "window/studio.h"

typedef struct desk desk;
CHECKED mrt_result desk_create(desk **out, studio *of, front *on, error *err);
void desk_destroy(desk *self);
ui *desk_ui(desk *self);            /* for whoever pushes events, and looks at words */
float desk_scale(const desk *self); /* pixels a point, of the last frame */
/* Events, update, panels, picture. False: it is to be closed. */
bool desk_frame(desk *self);

typedef struct desk_counts {
    uint64_t frame_count;
    studio_figures fast;
    double first_face_s; /* since the program started */
} desk_counts;
void desk_counted(const desk *self, desk_counts *out);

#endif
