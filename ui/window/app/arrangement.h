/* window/app/arrangement.h - where each panel is: in the left or the right dock, floating, or
 * hidden; its order, and the sizes. Also the three layouts as they are at first, their text in the
 * settings, and the rectangles on a screen. Leaves out drawing (docks.c) and what is kept of it
 * (kept_layouts.h). Pure; points. */
#ifndef MAROTTE_UI_WINDOW_APP_ARRANGEMENT_H
#define MAROTTE_UI_WINDOW_APP_ARRANGEMENT_H
#include "window/gui/ui_types.h"

#include <stddef.h>

typedef enum app_panel { /* in the order of ACTION_PANEL_DEVICES .. */
                         APP_DEVICES = 0,
                         APP_MAPPING,
                         APP_RIG,
                         APP_ENGINE,
                         APP_LOG,
                         APP_PATCH,
                         APP_OUTPUT,
                         APP_SCENE,
                         APP_HAND,
                         APP_POSES,
                         APP_PANELS
} app_panel;

/* In the order of ACTION_LAYOUT_PERFORM .. */
typedef enum app_layout { LAYOUT_PERFORM = 0, LAYOUT_EDIT, LAYOUT_RIG, LAYOUTS } app_layout;

typedef enum panel_place {
    PLACE_HIDDEN = 0,
    PLACE_LEFT,
    PLACE_RIGHT,
    PLACE_FLOATING,
    PLACES
} panel_place;

typedef struct panel_spot {
    panel_place place;
    uint32_t order;       /* among those of its place: of the tabs, or from back to front */
    ui_rectangle floated; /* where it floats, or floated last; width 0: nowhere yet */
} panel_spot;

typedef struct arrangement {
    panel_spot panel[APP_PANELS];
    app_panel front[PLACES]; /* of a dock that has panels: the one whose tab is open */
    app_panel current;       /* the panel that was asked for last */
    float width[PLACES];     /* of the docks */
    float timeline_height;
    bool has_timeline;
} arrangement;

/* A layout as it is at first. */
void arrangement_init(arrangement *self, app_layout of);
/* The panels of a place, in order; returns their number. */
uint32_t arrangement_panels(const arrangement *self, panel_place at, app_panel out[APP_PANELS]);
/* Opens the panel's tab, or brings it to the front. A hidden one goes to the right dock. */
void arrangement_show(arrangement *self, app_panel of);
/* Moves a panel to a place, before another panel there (APP_PANELS: last), and shows it. */
void arrangement_move(arrangement *self, app_panel of, panel_place to, app_panel before);

/* ---- as text: "timeline 220 right 330 devices* mapping hidden log float 40 90 330 400 poses" ----
 */

enum { ARRANGEMENT_TEXT = 1024 };
void arrangement_write(const arrangement *self, char out[ARRANGEMENT_TEXT]);
/* Over the layout as it is at first. Ignores unknown words and numbers out of range, so that any
 * text gives an arrangement that has each panel once. */
void arrangement_read(arrangement *self, app_layout of, const char *text);

/* ---- on a screen ---- */

typedef struct arrangement_dock {
    ui_rectangle where; /* width 0: none */
    app_panel panel[APP_PANELS], front;
    uint32_t count;
} arrangement_dock;

typedef struct arrangement_rectangles {
    ui_rectangle bar, face, timeline; /* width 0: none */
    arrangement_dock left, right;
    struct {
        app_panel panel;
        ui_rectangle where;
    } floating[APP_PANELS]; /* from back to front, whole on the screen */
    uint32_t floating_count;
} arrangement_rectangles;

float arrangement_dock_width(float width); /* in its range */
/* Where two docks leave too little of the face, the tabs of the left one are behind those of the
 * right one. */
void arrangement_lay_out(const arrangement *self, float width, float height,
                         arrangement_rectangles *out);

#endif
