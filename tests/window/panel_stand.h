/* panel_stand.h - one panel on a stage that is none: an application and a live stage whose every
 * word the test says (status, faces, refusals), real inputs and mappings, a screen without a
 * window. Tests click what is written on it. */
#ifndef MAROTTE_TESTS_WINDOW_PANEL_STAND_H
#define MAROTTE_TESTS_WINDOW_PANEL_STAND_H
#include "window/gui/window.h"
#include "window/panels/panels.h"
#include "window/viewport/viewport.h"

enum { STAND_INPUTS = 8, STAND_STEPS = 64 };

typedef struct stand {
    plugin_list plugins;
    log_queue *log;
    news_list *news;
    settings *settings;
    live_view view;
    live_status status;
    app_looks looks;
    app_notes notes;
    /* inputs */
    input *input[STAND_INPUTS];
    char input_text[STAND_INPUTS][256];
    mrt_sample sample[STAND_INPUTS];
    bool has_sample[STAND_INPUTS];
    uint32_t input_count;
    input_opening opening[INPUT_OPENINGS_MAX];
    uint32_t opening_count;
    const char *opening_trouble; /* "": none */
    uint64_t given_up;
    const char *refusal; /* of the next thing that is asked of live; NULL: it works */
    char calibration[2][1024];
    uint32_t rezero_pedal;
    /* tap */
    uint32_t tapped;
    mrt_sample tap[4096];
    uint32_t tap_count, tap_taken;
    /* mapping */
    instance mapping;
    bool has_mapping;
    const face_file *file; /* NULL: none */
    csrbf_settings solver;
    bool has_solver;
    uint32_t solver_count;
    patch patch;
    app_patch_aim aim;
    app_picture picture;
    /* from afar */
    char remote[APP_REMOTE_ADDRESS];
    /* undo */
    undo_change step[STAND_STEPS];
    uint32_t step_count, all_count; /* all: with those that were undone */
    action done;
    bool asked[APP_CALLS]; /* by a panel, of the others */
    /* the face */
    viewport_use use;
    viewport_stroke stroke;
    /* the screen */
    window *window;
    ui *ui;
    const panel_type *type;
    panel *panel;
    ui_rectangle where;
} stand;

/* Skips the test where there is no OpenGL. scale: pixels a point. */
void stand_open(stand *s, const panel_type *type, float scale);
/* The same, with these settings (a path, or "": none). */
void stand_open_with(stand *s, const panel_type *type, float scale, const char *settings_path);
void stand_close(stand *s);
/* The panel is closed and made again, as when the program starts anew. */
void stand_reopen_panel(stand *s);
/* Another panel instead of it. */
void stand_change_panel(stand *s, const panel_type *to);

void stand_plugin(stand *s, const char *file); /* "log": BUILD_DIR/plugins/log.so */
void stand_input(stand *s, const char *text);
void stand_mapping(stand *s, const char *text);
void stand_face(stand *s, const mrt_face *about);

void stand_frame(stand *s);
void stand_settle(stand *s);
/* Frames until the words are on the screen, for ten minutes at most. */
void stand_wait_for(stand *s, const char *words);
bool stand_shows(const stand *s, const char *words);         /* somewhere, as a part of a text */
const ui_word *stand_word(const stand *s, const char *text); /* exactly this; NULL */
void stand_click(stand *s, const char *text);                /* the first of them */
void stand_click_last(stand *s, const char *text); /* on top of others: of a list that is open */
void stand_click_at(stand *s, float x, float y);
void stand_drag(stand *s, float x0, float y0, float x1, float y1);
void stand_key(stand *s, uint32_t key);
void stand_type(stand *s, const char *text);
/* No word over another, none cut (but those listed, NULL-ended; may be NULL), all readable. */
void stand_check_words(stand *s, const char *const *may_be_cut);
void stand_picture(stand *s,
                   const char *name); /* draws; with MAROTTE_PICTURES BUILD_DIR/out/NAME.png */

#endif
