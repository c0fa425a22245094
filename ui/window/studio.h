/* window/studio.h - what the window is about, without its looks: the show, the face, the stage, the
 * take that is chosen, and what a person can do to them. Panels read it and call its functions; a
 * test drives it with no window. Leaves out drawing (the panels) and contexts (front.h). [main] */
#ifndef MAROTTE_UI_WINDOW_STUDIO_H
#define MAROTTE_UI_WINDOW_STUDIO_H
#include "stage/live.h"
#include "take/history.h"
#include "window/action.h"
#include "window/news_list.h"
#include "window/settings.h"
#include "window/studio_inputs.h"

typedef struct studio studio;

typedef struct studio_options {
    const char *show_path;     /* NULL: the last one, or a new one in the documents folder */
    const char *face_path;     /* NULL: the show's, the last one, the puppet */
    const char *mapping;       /* NULL: as last time, or one_hand */
    const char *const *inputs; /* NULL: what is plugged in */
    uint32_t input_count;
    const char *settings_path;  /* NULL: the user's; "": none is read or written */
    const char *note;           /* said to the person at the start; NULL: nothing */
    const sound_backend *sound; /* NULL: PortAudio */
} studio_options;

CHECKED mrt_result studio_create(studio **out, const studio_options *options, error *err);
/* A take that is being recorded is kept; settings are written. */
void studio_destroy(studio *self);
/* Once a frame, before panels are drawn. */
void studio_update(studio *self, double dt_s);

/* ---- what there is ---- */

const plugin_list *studio_plugins(studio *self);
log_queue *studio_log(studio *self);
live *studio_live(studio *self);
const live_view *studio_view(const studio *self);     /* never NULL; of this frame */
const live_status *studio_status(const studio *self); /* of this frame */
const face_file *studio_face(const studio *self);
const char *studio_face_path(const studio *self);
show *studio_show(studio *self); /* NULL: none could be opened */
settings *studio_settings(studio *self);
news_list *studio_news(studio *self); /* what was said, for the log panel and the last line */

/* ---- what is done: errors are said in the news and come back ---- */

CHECKED mrt_result studio_open_show(studio *self, const char *path);
CHECKED mrt_result studio_open_face(studio *self, const char *path);
/* The face's rig was changed in memory (the rig panel) or on disk: the same inputs and mapping go
 * on with it. Takes what is in `face` over, also when it fails: `face` is zeroed. */
CHECKED mrt_result studio_change_face(studio *self, face_file *face);

/* "cyberglove:/dev/ttyUSB0", "log:demo.csv,loop=1": opened beside the window; it joins the stage
 * when it is open, behind a take that is being recorded. What goes wrong then is said in the news
 * and by studio_opening_trouble. */
CHECKED mrt_result studio_open_input(studio *self, const char *text);
uint32_t studio_openings(studio *self, studio_opening out[STUDIO_OPENINGS_MAX]);
void studio_give_up_opening(studio *self, uint64_t id);
/* Why the last one that came did not join; "" it did. */
const char *studio_opening_trouble(const studio *self);

/* As a file for other programs, in a process beside the window; the news say how it ended. */
struct export_wish;
CHECKED mrt_result studio_export_take(studio *self, const struct export_wish *wish);
uint32_t studio_exports_going(const studio *self);
uint32_t studio_exports_failed(const studio *self); /* of this run; not those that were cancelled */
/* studio_export.h: index 0..studio_exports_going - 1. */
struct export_going studio_export_now(const studio *self, uint32_t index);
void studio_cancel_export(studio *self, uint32_t index);

/* How the surface is solved, kept with the show; NULL: as the rig says. radius 0: the rig's. Not
 * said in the news. */
const csrbf_settings *studio_solver(const studio *self);
CHECKED mrt_result studio_set_solver(studio *self, const csrbf_settings *solver, error *err);

/* ---- the take that is chosen ---- */

typedef struct studio_take_line { /* of the list; what was deleted can be restored */
    int64_t id;
    char title[200]; /* "1/a 3 night ride" */
    char note[512];
    uint32_t rating;
    int64_t duration_ns, created_ns;
    bool is_recording, is_deleted;
} studio_take_line;
uint32_t studio_takes(const studio *self, const studio_take_line **out); /* newest last; until the
                                                                            next update */
int64_t studio_take_id(const studio *self);                              /* 0: none */
CHECKED mrt_result studio_choose_take(studio *self,
                                      int64_t id); /* 0: none; shows it on the stage */
const take *studio_take(const studio *self);       /* NULL: none; until the next edit */
/* Of the chosen take, which comes to the stage if it is not there. Nothing while one is recorded.
 */
void studio_seek(studio *self, int64_t at_ns);
void studio_set_range(studio *self, int64_t in_ns, int64_t out_ns); /* in >= out: none */
uint64_t studio_take_edition(const studio *self); /* grows with each change of it */
/* The copy is chosen, and on the stage if that one was; one step of undo. */
CHECKED mrt_result studio_duplicate_take(studio *self, int64_t id);
/* Its edits, for a list of them; NULL: none is chosen. Until the next edit. */
const history *studio_history(const studio *self);
/* Undoes or redoes until its edit `head` is the last in force; 0: as it was recorded. */
CHECKED mrt_result studio_history_go(studio *self, int64_t head);
/* Several edits that are one step of undo. */
CHECKED mrt_result studio_edit(studio *self, const edit *e);
CHECKED mrt_result studio_edit_all(studio *self, const edit *const *e, uint32_t count);
/* Another take than the chosen one (rating, name in the list). */
CHECKED mrt_result studio_edit_take(studio *self, int64_t id, const edit *e);
/* Of the chosen take, and of everything else that is done in the window. "trim 'mouth' ..."; "". */
const char *studio_undo_words(const studio *self);
const char *studio_redo_words(const studio *self);
/* A step that somebody else undoes and redoes: a parameter, a rig. `self` of the step must stay
 * valid until studio_forget_steps(owner). */
typedef struct studio_step {
    void *owner;
    char words[EDIT_TEXT];
    void (*undo)(void *owner, uint64_t number);
    void (*redo)(void *owner, uint64_t number);
    uint64_t number; /* the owner's */
} studio_step;
void studio_did(studio *self, const studio_step *step);
void studio_forget_steps(studio *self, const void *owner);

/* Work that is not on the disk yet (a rig): whoever has some says so. The title has a dot then, and
 * before the program ends or another face is opened the person is asked: save, leave it, stay. */
typedef struct studio_unsaved {
    void *owner;
    char words[EDIT_TEXT]; /* "the rig puppet.rig.json" */
    mrt_result (*save)(void *owner, error *err);
    void (*leave)(void *owner); /* it is given up */
} studio_unsaved;
void studio_set_unsaved(studio *self, const studio_unsaved *unsaved); /* copied; NULL: none */
const studio_unsaved *studio_unsaved_now(const studio *self);         /* NULL: none */

/* What is chosen on the timeline: for split, remove, mute. */
typedef struct studio_choice {
    uint32_t layer, clip; /* ids; 0: none */
    int32_t marker;       /* -1: none */
    uint32_t armed;       /* layer that recording over the take goes into (live_over.into_layer); 0:
                             a new one */
} studio_choice;
studio_choice *studio_chosen(studio *self);

/* ---- how fast the window is: the desk says it some times a second, the engine panel shows it ----
 */

typedef struct studio_figures {
    double panels_p50_ms, panels_p99_ms;     /* CPU time of all panels, without the face */
    double interval_p50_ms, interval_p99_ms; /* from one drawn frame to the next */
    double draw_p50_ms, draw_p99_ms;         /* of that: until it is handed to the screen */
    double latency_p50_ms, latency_p99_ms; /* live sample measured to its face submitted; 0: none */
} studio_figures;
void studio_note_figures(studio *self, const studio_figures *figures);
const studio_figures *studio_figures_of(const studio *self); /* never NULL; zeroes at first */

/* ---- actions ---- */

typedef enum studio_heat {
    STUDIO_HEAT_NONE = 0,
    STUDIO_HEAT_WEIGHTS,
    STUDIO_HEAT_MOBILITY,
    STUDIO_HEAT_STRAIN,
    STUDIO_HEAT_PENETRATION,
    STUDIO_HEATS
} studio_heat;
typedef enum studio_panel {
    STUDIO_DEVICES = 0,
    STUDIO_MAPPING,
    STUDIO_RIG,
    STUDIO_ENGINE,
    STUDIO_LOG,
    STUDIO_PANELS
} studio_panel;
typedef struct studio_looks { /* how it is shown; kept between runs */
    bool shows_hands, shows_vectors, shows_supports, shows_contacts, shows_jaw;
    bool is_mirrored, is_turning, is_face_only, has_timeline, is_helping;
    bool has_output, is_output_mirrored;
    bool is_painting; /* not kept: the brush is on, [ and ] are its size */
    studio_heat heat;
    studio_panel panel;
    float timeline_height, dock_width;
} studio_looks;
studio_looks *studio_looks_of(studio *self);
/* What actions ask of the window and the panels, taken by them: true once. */
bool studio_asked(studio *self, action of);

bool studio_can(studio *self, action of, const char **out_why_not);
void studio_do(studio *self, action of);
bool studio_wants_to_quit(const studio *self);
void studio_stay(studio *self);                /* it is not to be quit after all */
bool studio_has_hand_keys(const studio *self); /* the keyboard is a hand now */

#endif
