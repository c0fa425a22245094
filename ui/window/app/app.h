/* window/app/app.h - what the window is about, without its looks: the show, the face, the stage,
 * the take that is chosen, and what a person can do to them. Panels read it and call its functions;
 * a test drives it with no window. Leaves out drawing (the panels) and contexts (window.h). [main]
 */
#ifndef MAROTTE_UI_WINDOW_APP_APP_H
#define MAROTTE_UI_WINDOW_APP_APP_H
#include "stage/live/live.h"
#include "stage/playback/sync.h"
#include "show/history.h"
#include "draw/scenery.h"
#include "window/app/kept_layouts.h"
#include "window/app/key_map.h"
#include "window/app/news_list.h"
#include "window/app/presets.h"
#include "window/app/settings.h"
#include "window/app/input_opener.h"
#include "window/app/undo.h"
#include "window/gui/theme.h"

#include <stdlib.h>
#include <string.h>

typedef struct app app;

/* Video for other programs: background of the output window and of streams, look of that window,
 * and targets of the streams. Kept between runs. */
typedef struct app_picture {
    char background[16]; /* "": the studio's wall; "transparent", "#00b140" */
    bool is_on_top;      /* the output window, above all others */
    bool is_window;      /* use a window even with a second monitor */
    char targets[512];   /* of streams, separated by spaces (stream/stream.h); "" */
    uint32_t width, height, fps;
    uint64_t edition; /* grows with each change; out */
} app_picture;

/* A face that is read and bound by a thread of its own while the window opens. */
typedef struct app_face_ahead app_face_ahead;
/* The face named, else the last one of these settings, else the puppet. NULL: the thread did not
 * start, and nothing is lost. */
app_face_ahead *app_face_ahead_start(const char *face_path, const settings *kept);
void app_face_ahead_destroy(app_face_ahead *self); /* waits for the thread; accepts NULL */

typedef struct app_options {
    const char *show_path;     /* NULL: the last one, or a new one in the documents folder */
    const char *face_path;     /* NULL: the show's, the last one, the puppet */
    const char *mapping;       /* NULL: as last time, or one_hand */
    const char *const *inputs; /* NULL: what is plugged in */
    uint32_t input_count;
    const char *settings_path;  /* NULL: the file of the user; "": no file */
    const char *remote;         /* "[HOST:]PORT"; NULL: as last time (remote.h) */
    const app_picture *picture; /* NULL: as last time */
    const char *note;           /* said to the person at the start; NULL: nothing */
    const sound_backend *sound; /* NULL: PortAudio */
    wake *changed;              /* as live_settings; NULL: not needed */
    bool lives;                 /* the face lives in a new show (kept_life.h) */
    app_face_ahead *ahead;      /* its face is taken if it is the one to begin with; NULL: none */
} app_options;

CHECKED mrt_result app_create(app **out, const app_options *options, error *err);
/* Saves the take that is being recorded, and writes the settings. < 0: part of the recording is
 * missing in the show file; stderr names it, and where it is stored. */
mrt_result app_destroy(app *self);
/* Once a frame, before panels are drawn. */
void app_update(app *self, double dt_s);
/* Requests a frame in at most that time, for an animation, a countdown or a result that the caller
 * waits for. 0: the next frame. The request holds for one frame. */
void app_want_frame(app *self, double in_s);
double app_wanted_s(const app *self); /* HUGE_VAL: none */

/* ---- parts of the application ---- */

const plugin_list *app_plugins(app *self);
log_queue *app_log(app *self);
live *app_live(app *self);
const live_view *app_view(const app *self);     /* never NULL; of this frame */
const live_status *app_status(const app *self); /* of this frame */
const face_file *app_face(const app *self);
const char *app_face_path(const app *self);
show *app_show(app *self); /* NULL: none could be opened */
settings *app_settings(app *self);
#define APP_CAMERA_PREVIEW "camera.preview"     /* of the settings: 0: no hand on the stage */
#define APP_REZERO_PEDAL   "hands.rezero_pedal" /* of the settings: 1..4; 0: none re-zeroes */
news_list *app_news(app *self); /* messages, for the panel Log and the status line */

/* Shows an error in the news, and returns `result`. All functions below do the same with their
 * errors, but those that have an `err`. */
mrt_result app_report(app *self, mrt_result result, const error *err);

/* ---- the show, and what is kept with it: how the surface is solved, the scene ---- */

CHECKED mrt_result app_open_show(app *self, const char *path);
/* Opens a new show in the folder for shows, named by today's date: 2026-11-28-2.marotte. */
CHECKED mrt_result app_new_show(app *self);
/* Copies the show to a new name, and opens the copy when it is complete. A message reports it. */
CHECKED mrt_result app_save_show_as(app *self, const char *path, error *err);

/* The solver settings that the show keeps; NULL: the rig's. radius 0: the rig's. */
const csrbf_settings *app_solver(const app *self);
CHECKED mrt_result app_set_solver(app *self, const csrbf_settings *solver, error *err);

/* Lights, wall and picture behind, camera views. */
typedef struct kept_scenery kept_scenery;
kept_scenery *app_scenery(const app *self); /* kept_scenery.h */

/* ---- the face and its rig ---- */

CHECKED mrt_result app_open_face(app *self, const char *path);
/* After a change of the rig, in memory (the rig panel) or on disk: the same inputs and mapping go
 * on with the new face. Takes the contents of `face` over and zeroes it, also on an error. */
CHECKED mrt_result app_change_face(app *self, face_file *face);

/* Reads the mesh of a face without a rig again with that unit and those axes, where its shape does
 * not tell them. mm_per_unit 0: the unit is not known. */
CHECKED mrt_result app_set_face_frame(app *self, const mesh_frame *frame);
double app_face_unit_mm(const app *self); /* as set so; 0: it was not */

/* Set by the owner of unsaved work (the panel Rig). The title then has a dot. Before the program
 * quits or opens another face, it asks the user to save, discard or cancel. */
typedef struct app_unsaved {
    void *owner;
    char words[EDIT_TEXT]; /* "the rig puppet.rig.json" */
    mrt_result (*save)(void *owner, error *err);
    void (*leave)(void *owner); /* it is given up */
} app_unsaved;
void app_set_unsaved(app *self, const app_unsaved *unsaved); /* copied; NULL: none */
const app_unsaved *app_unsaved_now(const app *self);         /* NULL: none */

/* Set by the editor of the rig: how the rig is saved under another name. */
typedef struct app_rig_saver {
    void *owner;
    const char *(*path)(void *owner); /* where it would be saved; NULL: the face has no rig */
    mrt_result (*save_as)(void *owner, const char *path, error *err);
} app_rig_saver;
void app_set_rig_saver(app *self, const app_rig_saver *saver); /* copied; NULL: none */
const char *app_rig_path(const app *self);                     /* NULL: no rig to save */
CHECKED mrt_result app_save_rig_as(app *self, const char *path, error *err);

/* ---- inputs ---- */

/* "cyberglove:/dev/ttyUSB0", "log:demo.csv,loop=1". Opens in the background; the input joins the
 * stage when it is open, but not before the end of a take that is being recorded. Its errors come
 * later, in the news and by app_opening_trouble. */
CHECKED mrt_result app_open_input(app *self, const char *text);
/* Writes the text of the input that repeats the recorded demo hand. False: it is not installed. */
enum { APP_DEMO_TEXT = 4096 + 16 };
CHECKED bool app_demo_hand(char out[APP_DEMO_TEXT]);
uint32_t app_openings(app *self, input_opening out[INPUT_OPENINGS_MAX]);
void app_give_up_opening(app *self, uint64_t id);
/* Why the input that was opened last did not join; "": it did. */
const char *app_opening_trouble(const app *self);

/* ---- outputs: where the face goes; kept between runs, and open from the start ---- */

/* "vmc:192.168.1.20:39540,names=arkit". Errors are reported as messages and by app_output_trouble.
 */
CHECKED mrt_result app_add_output(app *self, const char *text);
void app_remove_output(app *self, uint32_t index);
const char *app_output_trouble(const app *self); /* why the last one was not added; "" it was */

/* ---- the picture for other programs ---- */

const app_picture *app_picture_now(const app *self);
void app_set_picture(app *self, const app_picture *wanted);
/* Set by the streams: their error (or ""), and their number. */
void app_note_picture(app *self, const char *says, uint32_t streams);
const char *app_picture_says(const app *self, uint32_t *out_streams);

/* ---- the patch ---- */

/* The patch as set; the stage has it a moment later, but not before the end of a take that is being
 * recorded. Kept between runs, beside the settings. */
const patch *app_patch(const app *self);
void app_set_patch(app *self, const patch *p);
/* While the patch panel learns: the target that the person points at, a contact on the face or a
 * slider of the mapping panel. The patch panel takes it. */
typedef struct app_patch_aim {
    bool is_learning;
    patch_kind kind; /* PATCH_NOTHING: nothing was pointed at */
    char target[PATCH_NAME];
} app_patch_aim;
app_patch_aim *app_patch_aimed(app *self);

/* ---- remote control, poses that are played, time code ---- */

enum { APP_REMOTE_ADDRESS = 160 };
typedef struct app_remote_status {
    const char *address; /* "": off */
    bool is_listening;
    const char *code;    /* that every command needs; "": none, of this computer alone */
    const char *trouble; /* why it does not; "" */
    uint32_t clients;    /* WebSockets */
    const char *last;    /* what was done last, and what came of it; "" */
} app_remote_status;
app_remote_status app_remote_now(const app *self); /* texts until the next frame */
/* "[HOST:]PORT", "": off. Kept where it is of this computer alone. */
void app_set_remote(app *self, const char *address);
void app_renew_remote_code(app *self);     /* those who have the old one are out */
struct pose_palette *app_poses(app *self); /* pose_palette.h */
struct kept_life *app_life(app *self);     /* kept_life.h */

/* The current external time code; false: none is running. */
bool app_outside_code(const app *self, timecode_rate *out_rate, int64_t *out_frame);
/* Whether the selected take follows the external time code while it runs. A setting. */
bool app_chases(const app *self);
void app_set_chases(app *self, bool chases);

/* ---- takes: the list, and the one that is chosen ---- */

typedef struct app_take_line { /* of the list; what was deleted can be restored */
    int64_t id;
    char title[200]; /* "1/a 3 night ride" */
    char scene[TAKE_NAME], shot[TAKE_NAME], name[TAKE_NAME];
    uint32_t number;
    char note[512];
    uint32_t rating;
    int64_t duration_ns, created_ns;
    bool is_recording, is_deleted;
    int64_t over,
        over_at_ns; /* the take that it was performed over, and from which time; 0: none */
} app_take_line;
uint32_t app_takes(const app *self, const app_take_line **out); /* newest last; until the
                                                                            next update */
int64_t app_take_id(const app *self);                           /* 0: none */
CHECKED mrt_result app_choose_take(app *self, int64_t id);      /* 0: none; shows it on the stage */
/* Chooses it in the list. On the stage it replaces another take, but not the live hands. */
CHECKED mrt_result app_select_take(app *self, int64_t id);
bool app_is_take_shown(const app *self); /* the chosen take is on the stage */
const take *app_take(const app *self);   /* NULL: none; until the next edit */

/* What is chosen on the timeline: for split, remove, mute. */
typedef struct app_choice {
    uint32_t layer, clip; /* ids; 0: none */
    int32_t marker;       /* -1: none */
    bool is_take;         /* the take itself, in the list: for remove */
    uint32_t armed;       /* layer that recording over the take goes into
                             (overdub_plan.into_layer); 0: a new one */
} app_choice;
app_choice *app_chosen(app *self);

/* Of the chosen take, which is put on the stage for it. Does nothing while a take is recorded. */
void app_seek(app *self, int64_t at_ns);
void app_set_range(app *self, int64_t in_ns, int64_t out_ns); /* in >= out: none */
uint64_t app_take_edition(const app *self);                   /* grows with each change of it */

/* ---- its edits, and undo of all changes in the window (undo.h) ---- */

/* Selects the copy, and puts it on the stage if the original was there. One undo step. */
CHECKED mrt_result app_duplicate_take(app *self, int64_t id);
/* Edits of the selected take; NULL: none is selected. Valid until the next edit. */
const history *app_history(const app *self);
/* Undoes or redoes until edit `head` is the last applied one; 0: the unedited recording. */
CHECKED mrt_result app_history_go(app *self, int64_t head);
/* Several edits make one undo step. */
CHECKED mrt_result app_edit(app *self, const edit *e);
CHECKED mrt_result app_edit_all(app *self, const edit *const *e, uint32_t count);
/* Shows another version of the selected take on the stage while an edit of it is dragged, without
 * changing the show. NULL, and each edit, end it. Copies the take. Does nothing while the take is
 * not on the stage. */
void app_preview_take(app *self, const take *t);
/* Edits a take that may not be the selected one (rating, name in the list). */
CHECKED mrt_result app_edit_take(app *self, int64_t id, const edit *e);

/* Describes the next undo or redo, "trim 'mouth' ..."; "": none. */
const char *app_undo_words(const app *self);
const char *app_redo_words(const app *self);
/* Adds a change that is not an edit of a take: a parameter, a rig. Takes ownership of its values.
 */
void app_add_change(app *self, const undo_change *change);
/* The same with copies of both values. Without memory for them the change cannot be undone. */
static inline void app_add_copied_change(app *self, undo_change *change, const void *before,
                                         const void *after, size_t size)
{
    if (undo_change_copy(change, before, after, size))
        app_add_change(self, change);
}
void app_forget_changes(app *self, const void *owner);
size_t app_undo_bytes(const app *self); /* memory of all undo steps */

/* ---- recording ---- */

/* The wait before a recording begins, s, 0 to 60; kept between runs. During the count-in nothing
 * moves by itself, and R cancels it. Over a take, that take then plays for the pre-roll before the
 * hands take over. */
typedef struct app_lead_in {
    double count_in_s, preroll_s;
} app_lead_in;
app_lead_in app_lead_in_of(const app *self);
void app_set_lead_in(app *self, app_lead_in to);
/* The metronome, kept between runs. A message explains why it cannot play. */
live_click app_click(const app *self);
void app_set_click(app *self, const live_click *to);
double app_leads_in_s(const app *self); /* until the recording begins; 0: no count-in */

/* As a pedal does it: record only begins, stop only ends. False: nothing had to change. */
bool app_press(app *self, patch_action of);

/* Makes a take of what was performed between two instants of the host's clock; it is chosen in the
 * list once all of it is in the show. */
void app_keep(app *self, int64_t from_ns, int64_t to_ns);

/* Reads a sound file in the background, one at a time, and then attaches it to the chosen take. */
CHECKED mrt_result app_attach_voice(app *self, const char *path);
double app_voice_part(const app *self); /* 0..1: progress of reading a voice; < 0: none */

/* Marks of this run that were set while hands performed, oldest first, on the host's clock; the
 * newest APP_MARKS_MAX. They become markers of the takes that contain them. */
enum { APP_MARKS_MAX = 256 };
uint32_t app_marks_of(const app *self, const int64_t **out_at_ns);
/* ---- app_speech.c: the voice of the chosen take moves the mouth (stage/voice/voice_mouth.h) ----
 */

typedef struct app_speech_wish {
    const char *words; /* that are said; "": not known */
    double jaw, lips;  /* 0..VOICE_MOUTH_AXIS_MOST */
} app_speech_wish;
/* Finds the mouth in the background, one at a time, and then adds it to the take by one edit. A
 * failure is the result. */
CHECKED mrt_result app_speech_begin(app *self, const app_speech_wish *wish);
double app_speech_part(const app *self); /* 0..1: progress; < 0: none runs */
void app_speech_cancel(app *self);       /* it ends within seconds */
/* The line about the last one; "": none yet. Valid until the next frame. */
const char *app_speech_result(const app *self);

/* ---- app_sync.c: how late the mouth of the chosen take is (stage/playback/sync.h) ---- */

typedef struct app_sync_found {
    const sync_curves *curves; /* as they were measured */
    sync_offset offset;
    int64_t moved_ns; /* by app_sync_move; 0: not yet */
} app_sync_found;
/* Measures from_ns..to_ns of the timeline in the background, one at a time. A failure is the
 * result. If the take changes, what was found is dropped. */
CHECKED mrt_result app_sync_begin(app *self, int64_t from_ns, int64_t to_ns);
double app_sync_part(const app *self); /* 0..1: progress; < 0: none runs */
void app_sync_cancel(app *self);       /* it ends within seconds */
/* What was found; NULL: nothing. Valid until the next frame. */
const app_sync_found *app_sync_of(const app *self);
/* The line about it, or why nothing was found; "": none yet. Valid until the next frame. */
const char *app_sync_result(const app *self);
/* Moves the mouth by what was found, once, as one undo step. */
CHECKED mrt_result app_sync_move(app *self);

/* ---- exports ---- */

/* Exports in a process of its own, after the exports asked for before; the news tell how it ended.
 */
struct export_request;
CHECKED mrt_result app_export_take(app *self, int64_t id, const struct export_request *request);
struct exporter *app_exporter(const app *self); /* exporter.h: those that go on or wait */
uint32_t app_exports_failed(const app *self);   /* of this run; not those that were cancelled */

/* ---- actions, and how all of it is shown ---- */

typedef enum app_heat {
    APP_HEAT_NONE = 0,
    APP_HEAT_WEIGHTS,
    APP_HEAT_MOBILITY,
    APP_HEAT_STRAIN,
    APP_HEAT_PENETRATION,
    APP_HEATS
} app_heat;
typedef struct app_looks { /* how it is shown; kept between runs */
    bool shows_hands, shows_vectors, shows_supports, shows_contacts, shows_jaw, shows_card;
    bool is_mirrored, is_turning, is_face_only, is_helping;
    bool is_snapping, is_rippling; /* drags snap; what follows a clip moves with its edits */
    bool has_output, is_output_mirrored;
    bool is_painting;  /* not kept: the brush is on, [ and ] are its size */
    bool is_answering; /* not kept: Space belongs to the panel Hand */
    app_heat heat;
    kept_layouts layouts;
    float takes_width; /* of the list of takes; 0: as the window has room */
    theme theme;
    key_map keys;
    float text_size; /* how much larger than usual everything is: 0.8 .. 2 */
} app_looks;
app_looks *app_looks_of(app *self);

/* Consumes a request for an action that the window or a panel performs. Returns true once for each
 * request. */
bool app_take_request(app *self, action of);

bool app_can(app *self, action of, const char **out_why_not);
void app_do(app *self, action of);
bool app_wants_to_quit(const app *self);
void app_stay(app *self);                /* revokes the wish to quit */
bool app_has_hand_keys(const app *self); /* the keyboard is a hand now */

/* ---- what the pointer leaves on the live face ---- */

/* Something that the pointer pulled or kneaded stays, until Neutral or another face. */
bool app_is_held(const app *self);
uint32_t
app_pull_count(const app *self); /* how often the pointer took hold of the face in this run */
void app_begin_pull(app *self);  /* restores the face */
void app_hold(app *self, const char *words); /* what began stays: a step of undo */
/* Called before the rig changes: removes the held pulls of the pointer, which belong to the
 * previous rig, as a separate undo step. */
void app_clear_pulls(app *self);

/* ---- what one part of the window asks of the others, and tells them ---- */

/* A request of one part of the window to another; app_take_call is true once for each. */
typedef enum app_call {
    APP_CALL_CAMERA = 0, /* the camera and its page, of the card on the stage */
    APP_CALL_RECORDING,  /* the dialog that opens a recorded hand */
    APP_CALL_PICTURE,    /* the dialog that opens a picture behind the face */
    APP_CALL_DRAFT,      /* a first rig for the face, which has none, of the rig panel */
    APP_CALLS
} app_call;
void app_ask(app *self, app_call of);
bool app_take_call(app *self, app_call of);
/* Asks for a first rig. The mapping that did not fit, or else the usual one, performs on it. */
void app_ask_draft(app *self);

/* A head without a slit between its lips was drafted: the rig panel asks what to do, and takes the
 * answer once. */
#define APP_MOUTH_QUESTION  "The lips are joined."
#define APP_MOUTH_CUT_HINT  "Opens the edges between the lips and adds a dark mouth behind them."
#define APP_MOUTH_CLAY_HINT "Keeps the skin whole. The jaw stretches it, and the lips do not part."
typedef enum app_mouth { APP_MOUTH_UNANSWERED = 0, APP_MOUTH_CUT, APP_MOUTH_CLAY } app_mouth;

typedef struct app_figures {                 /* how fast the window is */
    double panels_p50_ms, panels_p99_ms;     /* CPU time of all panels, without the face */
    double interval_p50_ms, interval_p99_ms; /* from one drawn frame to the next */
    double draw_p50_ms, draw_p99_ms;         /* of that: until it is handed to the screen */
    double latency_p50_ms, latency_p99_ms; /* live sample measured to its face submitted; 0: none */
} app_figures;

typedef struct app_notes {
    char preset[PRESET_NAME]; /* of the mapping that performs, to be used: the mapping panel does,
                                 and takes it away; "": none */
    app_figures figures;      /* by the workspace, some times a second; zeroes at first */
    bool is_drafting;         /* by the rig panel: a first rig is being found */
    bool is_mouth_asked;      /* by the rig panel: it waits for mouth_answer */
    app_mouth mouth_answer;   /* set by the caller; the panel Rig clears it */
    bool has_tracker;         /* by the camera's card: its hand tracker is on this computer */
    bool is_camera_ready;     /* the same, and a browser for its page */
    bool is_camera_busy;      /* the same: it downloads, or opens the camera */
    uint16_t
        camera_port;     /* of the page that APP_CALL_CAMERA opens; 0: of the camera that is open */
    bool is_rig_pending; /* set by the panel Rig: the changed rig is not on the face yet, and pulls
                            wait for it */
} app_notes;
app_notes *app_notes_of(app *self);

/* The viewport on the screen, which panels ask for what the pointer does; NULL: none (a test of a
 * panel alone). */
struct viewport;
struct viewport *app_viewport(app *self);
void app_set_viewport(app *self, struct viewport *v);

#endif
