/* window/devices_panel_inside.h - what the files of the devices panel share. No other file includes
 * it. [main] */
#ifndef MAROTTE_UI_WINDOW_DEVICES_PANEL_INSIDE_H
#define MAROTTE_UI_WINDOW_DEVICES_PANEL_INSIDE_H
#include "window/calibrate_panel.h"
#include "window/devices_panel_search.h"
#include "window/studio.h"
#include "window/ui.h"

enum { DEVICES_PATH = 1024 };

typedef struct devices_panel {
    studio *studio;
    devices_search *search; /* NULL: nothing can be looked for */
    calibrate_panel *calibrate;
    devices_seen seen; /* of this frame */
    char path[DEVICES_PATH], osc[128];
    studio_opening opening[STUDIO_OPENINGS_MAX]; /* of this frame */
    uint32_t opening_count, input_count;
    bool repeats;          /* a recording begins again at its end */
    char trouble[1024];    /* why the last thing that was asked for did not happen; "" */
    rezero_counts rezeros; /* as of the frame before */
    bool was_refused;
} devices_panel;

/* devices_panel_card.c: an input that is open; returns false when it is to be removed. */
bool devices_card_draw(devices_panel *self, ui *on, uint32_t index);
/* One that is being opened; returns false when it is to be given up. */
bool devices_card_draw_opening(ui *on, const studio_opening *one);
/* devices_panel_open.c: what could be opened. */
void devices_open_draw(devices_panel *self, ui *on);
/* Opens it beside the window. */
void devices_panel_add(devices_panel *self, const char *text);
void devices_panel_say(devices_panel *self, const char *text); /* in the panel and in the news */
/* path "": shipped defaults. */
void devices_panel_calibrate(devices_panel *self, uint32_t side, const char *path);

#endif
