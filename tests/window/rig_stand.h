/* rig_stand.h - the rig panel beside the viewport on a stage that is none (viewport_stand.h): what
 * it gives to the application is taken, and written down. */
#ifndef MAROTTE_TESTS_WINDOW_RIG_STAND_H
#define MAROTTE_TESTS_WINDOW_RIG_STAND_H
#include "viewport_stand.h"

enum { RIG_STAND_STEPS = 64 };
typedef struct rig_stand {
    viewport_stand of;
    panel *panel;
    ui_rectangle dock;
    char face_path[1024];
    char opened[1024]; /* by the panel */
    undo_change step[RIG_STAND_STEPS];
    uint32_t step_count;
    app_unsaved unsaved;
    bool has_unsaved;
    uint32_t change_count;     /* faces that came from the panel */
    double update_ms, draw_ms; /* CPU of the panel alone, the most of a frame */
    bool is_panel_seen;
} rig_stand;

/* face: an absolute path. Skips the test where there is no OpenGL. settings "": none. */
void rig_stand_open(rig_stand *s, const char *face, const char *settings, uint32_t width,
                    uint32_t height, float scale);
void rig_stand_close(rig_stand *s);
void rig_stand_frames(rig_stand *s, uint32_t count);
/* Until the stage has got a face, at most a minute. */
void rig_stand_wait_for_change(rig_stand *s, uint32_t change_count);
void rig_stand_move(rig_stand *s, float x, float y);
void rig_stand_button(rig_stand *s, bool is_down);
void rig_stand_click(rig_stand *s, float x, float y);
void rig_stand_key(rig_stand *s, uint32_t key, bool is_down);
/* On what the panel wrote there; fails where it is not to be seen. */
void rig_stand_click_on(rig_stand *s, const char *text);
bool rig_stand_says(rig_stand *s, const char *text); /* some word drawn begins with it */
/* Where a vertex at rest is on the screen, from the front. */
void rig_stand_place(const rig_stand *s, uint32_t vertex, float *out_x, float *out_y);
/* A place of space, likewise. */
void rig_stand_place_at(const rig_stand *s, vec3 at, float *out_x, float *out_y);
/* A frame; with MAROTTE_PICTURES BUILD_DIR/out/NAME.png */
void rig_stand_picture(rig_stand *s, const char *name);
/* No word of the panel is cut, lies over another, or leaves the panel. */
void rig_stand_check_words(rig_stand *s);

#endif
