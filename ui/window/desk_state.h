/* window/desk_state.h - what a desk is made of. Inside desk*.c, bar.c, help.c. [main] */
#ifndef MAROTTE_UI_WINDOW_DESK_STATE_H
#define MAROTTE_UI_WINDOW_DESK_STATE_H
#include "window/desk.h"
#include "window/desk_figures.h"
#include "window/desk_folder.h"
#include "window/panels.h"
#include "window/studio_export.h"
#include "window/theme.h"

typedef enum desk_open_kind {
    DESK_OPENS_SHOW = 0,
    DESK_OPENS_FACE,
    DESK_OPENS_KINDS
} desk_open_kind;

typedef struct desk_opening { /* the dialog that opens shows and faces */
    desk_open_kind kind;
    folder at[DESK_OPENS_KINDS];
    char name[FOLDER_PATH];
    char trouble[1024];
} desk_opening;

typedef struct desk_exporting {
    export_wish wish;
    uint32_t format, rate;
    bool only_range;
    char replaced[EXPORT_FILE]; /* the file that the person was told is there already */
    char trouble[EXPORT_FILE + 64];
} desk_exporting;

typedef enum desk_leaving { /* what waits for the answer about unsaved work, and exports */
                            DESK_STAYS = 0,
                            DESK_QUITS,
                            DESK_CHANGES_FACE
} desk_leaving;

struct desk {
    studio *studio;
    front *front;
    ui *ui;
    viewport *viewport;
    panel *dock[STUDIO_PANELS], *timeline;
    ui_screen screen;

    desk_opening opening;
    desk_exporting exporting;
    desk_leaving leaving;
    char next_face[FOLDER_PATH]; /* DESK_CHANGES_FACE */
    bool asks, asks_exports;     /* the question is on the screen */
    bool waits_for_exports;      /* it was answered: then the program ends */
    uint32_t failed_exports;     /* when it was asked */
    bool is_over;                /* the program is to end */

    int32_t news_level; /* of the line that is shown */
    char news[1200];
    double news_left_s; /* < 0: until it is clicked */
    uint64_t news_seen; /* of news_list_said */

    double held_s; /* of the key that repeats */
    uint32_t held_key;

    char title[600];
    figures panels_ms, interval_ms, draw_ms, latency_ms;
    uint64_t frame_count, face_shown;
    double figures_wait_s, first_face_s;
    int64_t began_ns; /* the last drawn frame */
};

/* ---- parts of the screen; each a room of its own ---- */

void bar_draw(desk *self, ui_rectangle where);
/* With the panels away: what is being recorded, over the face. */
void bar_draw_alone(desk *self, ui_rectangle over);
void help_draw(desk *self, ui_rectangle where);

void desk_dispatch_keys(desk *self);
void desk_update_news(desk *self, double dt_s);
void desk_draw_news(desk *self, ui_rectangle over);

/* ---- dialogs ---- */

void desk_open_ask(desk *self, desk_open_kind kind);
void desk_open_draw(desk *self);
void desk_export_ask(desk *self);
void desk_export_draw(desk *self);
void desk_exports_ask(desk *self);  /* those that go on */
void desk_exports_list(desk *self); /* in a dialog: how far each is, to be cancelled */
/* At once, or after the questions about what is not saved and what goes on. */
void desk_quit(desk *self);
void desk_change_face(desk *self, const char *path);
void desk_leave_draw(desk *self);

#endif
