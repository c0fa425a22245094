/* timeline_stand.h - the timeline alone on a screen without a window: an application whose takes
 * are made of edits in memory, a transport whose clock the test moves, curves and sound that are
 * computed. Tests press and drag where instants are, and see which edits that made. */
#ifndef MAROTTE_TESTS_WINDOW_TIMELINE_STAND_H
#define MAROTTE_TESTS_WINDOW_TIMELINE_STAND_H
#include "window/gui/window.h"
#include "window/timeline/timeline.h"

enum { STAND_STEPS = 16, STAND_TAKES = 5000, STAND_EDITS = 256, STAND_COMPS = 3 };

typedef struct stand {
    /* the application */
    take take; /* that is chosen; id 0: none */
    uint64_t edition;
    app_choice choice;
    app_take_line line[STAND_TAKES];
    uint32_t line_count;
    char edited[STAND_EDITS][160];   /* "clip.trim", in the order in which they were made */
    edit last;                       /* without what it owns */
    uint32_t edit_count, step_count; /* steps: of undo */
    take preview;                    /* on the stage while an edit is dragged; id 0: none */
    uint32_t preview_count;
    undo_change did;               /* the last step that is the panel's own */
    undo_change step[STAND_STEPS]; /* all of them */
    uint32_t did_count;
    error refused;           /* of the last edit that was not possible */
    int64_t duplicated;      /* the last take that was */
    int64_t selected_id;     /* with a click in the list */
    int64_t rated, rated_id; /* the last take that was edited from the list */
    action done, asked;
    live_status status;
    app_looks looks;
    news_list *news;
    transport transport;
    int64_t clock_ns, seeks;
    int64_t kept_from_ns, kept_to_ns;
    /* the inputs of the journal: what is moved */
    uint32_t input_count;
    /* the worker: comps[0..comp_count) */
    timeline_comps *comps;
    /* the screen */
    window *window;
    ui *ui;
    panel *panel;
    float width, height; /* points */
} stand;

/* The screen of a timeline; skips where there is no OpenGL. One at a time. */
void stand_open(stand *s, float width, float height, float scale);
void stand_close(stand *s);
void stand_frame(stand *s);
void stand_settle(stand *s); /* until all that was pushed is done */
/* Takes the take over. */
void stand_choose(stand *s, take t);
void stand_list(stand *s, uint32_t count);

/* ---- the pointer: points of the screen ---- */

float stand_x(const stand *s, double time_s); /* of an instant of the take */
float stand_y(const stand *s, uint32_t row);  /* the middle of a row, a little below */
void stand_move(stand *s, float x, float y);
void stand_button(stand *s, uint32_t button, bool is_down);
void stand_click(stand *s, float x, float y);
void stand_double_click(stand *s, float x, float y);
void stand_drag(stand *s, float x0, float y0, float x1, float y1);
void stand_wheel(stand *s, float x, float y, float notches);
void stand_key(stand *s, uint32_t key, bool is_down);
void stand_type(stand *s, const char *text);
/* A word that is on the screen; NULL. */
const ui_word *stand_word(stand *s, const char *text);
void stand_click_word(stand *s, const char *text);

/* ---- looking ---- */

/* Draws; with MAROTTE_PICTURES BUILD_DIR/out/timeline_NAME.png */
void stand_picture(stand *s, const char *name);
/* No two words overlap, none is cut off by an edge. */
void stand_check_words(stand *s);

#endif
