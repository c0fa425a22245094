/* window/panels/engine_state.h - the state of the running stage as names and values, for debugging:
 * the section "State" of the panel Engine. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_ENGINE_STATE_H
#define MAROTTE_UI_WINDOW_PANELS_ENGINE_STATE_H
#include "window/gui/ui.h"

#include "stage/live/live.h"

enum { ENGINE_STATE_TEXT = 64 };

typedef struct engine_state_value {
    const char *name; /* "writer.backlog": the path of the field in live_status or live_view */
    char value[ENGINE_STATE_TEXT];
} engine_state_value;

/* The number of values. */
uint32_t engine_state_count(void);
/* The value at `index`, which must be less than engine_state_count(). */
engine_state_value engine_state_at(const live_status *status, const live_view *view,
                                   uint32_t index);
/* A row for each value. */
void engine_state_draw(ui *on, const live_status *status, const live_view *view);

#endif
