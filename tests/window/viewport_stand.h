/* viewport_stand.h - the viewport on a stage that is none: a real face, deformed by the pull that
 * the test says, and what the viewport tells the stage written down. A screen without a window. */
#ifndef MAROTTE_TESTS_WINDOW_VIEWPORT_STAND_H
#define MAROTTE_TESTS_WINDOW_VIEWPORT_STAND_H
#include "stage/perform/composer.h"
#include "stage/live/live_board.h"
#include "window/gui/window.h"
#include "window/panels/panels.h"
#include "window/viewport/viewport.h"

enum { STAND_TOLD = 256 };
typedef struct stand_told { /* one call of live_point */
    pointer_grip grip;
    float rest[3], at[3];
    bool stays;
    double radius_mm;
} stand_told;

typedef struct viewport_stand {
    face_file file;
    composer *composer;
    live_board board;
    live_view view;
    app_looks looks;
    settings *settings;
    news_list *news;
    log_queue *log;
    bool asked[ACTION_COUNT];
    bool has_hand_keys;
    bool pulls; /* what the pointer holds is pulled, as the stage does */
    stand_told told[STAND_TOLD];
    uint32_t told_count;
    input *made; /* of the virtual hand */
    window *window;
    ui *ui;
    viewport *viewport;
    window_gamepad pad;
    bool has_pad;
    ui_rectangle where; /* of the viewport */
    bool is_drawn;      /* false: it is not asked to draw */
    bool is_away;       /* the window: frames are drawn for pictures alone */
} viewport_stand;

/* Skips the test where there is no OpenGL. The window is put away: nothing is drawn before it is
 * shown. face: "rigs/puppet/puppet.rig.json". */
void stand_open(viewport_stand *s, const char *face, uint32_t width, uint32_t height, float scale);
/* The same on a renderer that takes so long for a frame; else it is 1/60 s. */
void stand_open_slow(viewport_stand *s, const char *face, uint32_t width, uint32_t height,
                     float scale, double dt_s);
void stand_close(viewport_stand *s);
/* From now on each frame is drawn. */
void stand_show(viewport_stand *s);
/* The viewport is made again, as when the program starts anew. */
void stand_reopen(viewport_stand *s);
/* view.pull becomes the shape. */
void stand_perform(viewport_stand *s);
uint32_t stand_contact(const viewport_stand *s, const char *name); /* index; fails: none */
/* view.pull gets a vector of this contact; stand_perform then. */
void stand_pull(viewport_stand *s, const char *contact, float x, float y, float z);

void stand_frame(viewport_stand *s);
void stand_frames(viewport_stand *s, uint32_t count);
void stand_move(viewport_stand *s, float x, float y); /* points of the screen */
void stand_button(viewport_stand *s, uint32_t button, bool is_down);
void stand_wheel(viewport_stand *s, float notches);
void stand_key(viewport_stand *s, uint32_t key, bool is_down);
void stand_drag(viewport_stand *s, uint32_t button, float x0, float y0, float x1, float y1);
/* Where a place is on the screen as the viewport shows it from the front, points. */
void stand_place(const viewport_stand *s, const float at[3], float *out_x, float *out_y);
void stand_picture(viewport_stand *s,
                   const char *name); /* a frame; with MAROTTE_PICTURES BUILD_DIR/out/NAME.png */

#endif
