/* window/panels/engine_state.h - the state of the running stage as names and values, for debugging:
 * the section "State" of the panel Engine. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_ENGINE_STATE_H
#define MAROTTE_UI_WINDOW_PANELS_ENGINE_STATE_H
#include "window/gui/ui.h"

#include "stage/live/live.h"

/* A row for each field: "writer.backlog" is its path in live_status, "view." stands for live_view.
 */
void engine_state_draw(ui *on, const live_status *status, const live_view *view);

#endif
