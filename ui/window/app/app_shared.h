/* window/app/app_shared.h - what an application is made of, for its three files: app_main.c is its
 * life and what it is asked, app_open.c what is opened and kept, app_takes.c what is done to takes.
 * Nobody else includes it. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_APP_SHARED_H
#define MAROTTE_UI_WINDOW_APP_APP_SHARED_H
#include "window/app/app.h"
#include "window/app/exporter.h"
#include "window/app/pose_palette.h"
#include "window/app/kept_life.h"
#include "window/app/kept_scenery.h"
#include "window/app/presets.h"
#include "window/app/remote.h"

#include "stage/playback/kept_solver.h"
#include "show/edit_store.h"

enum { APP_PATH = 4096 };

/* Pulls of the live face before or after a change. */
typedef struct app_pulled {
    size_t size; /* 0: the face has no pulls */
    bool is_held;
    unsigned char bytes[];
} app_pulled;

/* The state of a take for which its line was made; the line is made again when it differs. */
typedef struct app_take_key {
    int32_t edit_head, edit_count;
    bool is_recording, is_stale;
    bool is_told; /* that it cannot be read */
} app_take_key;

/* The list of takes, and the selected one. */
typedef struct app_takes_state {
    app_take_line *line;
    app_take_key *key;
    uint32_t line_count, line_room;
    bool are_stale, has_failed; /* has_failed: the list could not be read, which was reported */
    edit_store *store;          /* of the selected take; NULL: none */
    history *history;
    int64_t chosen; /* the selected take; 0: none */
    uint64_t edition;
    app_choice choice;
    int64_t ranged; /* the take for which the range of the last run was restored */
    int64_t noted;  /* the take of which tell_note reported how it differs */
    take preview;   /* see app_preview_take; id 0: none */
    bool has_pending_preview, is_previewed; /* the stage has still to show it; shows one */
} app_takes_state;

/* A take that is not yet completely stored. */
typedef struct app_awaited {
    int64_t take; /* 0: none */
    bool is_kept; /* from the journal; else it was recorded */
    double age_s;
} app_awaited;

typedef struct app_undo_state {
    undo_list *list;
    bool is_rig_shown;   /* the dock showed the rig panel at the last update */
    uint64_t rig_number; /* undo_change.number of the newest change when it was opened */
} app_undo_state;

typedef struct app_recording {
    int64_t leads_in_until_ns; /* clock; 0: none */
    bool counts_in;            /* a take of the live hands begins then; false: it has begun */
    bool was_recording, had_problem;
    int64_t over_take;   /* the take that is performed over; 0: none */
    bool over_is_ended;  /* the user ended it */
    double over_ended_s; /* > 0: it ended by itself just now; R is ignored for this time */
    int64_t played_from_ns;
} app_recording;

/* Pulls that the pointer made on the live face. */
typedef struct app_pulls {
    app_pulled *begun; /* before the current drag; NULL: none */
    bool is_held;      /* a pull stays on the face */
    uint32_t count;    /* since the start of the program */
} app_pulls;

/* A sound that is read into the show. */
typedef struct app_audio {
    struct audio_import *import; /* NULL: none */
    int64_t take;                /* the take that gets it */
} app_audio;

/* A mouth that is found from a voice. */
typedef struct app_speech {
    struct mouth_job *job; /* NULL: none */
    char result[600];      /* about the last one */
} app_speech;

/* The mouth of a take, measured against its sound. */
typedef struct app_sync {
    struct sync_job *job; /* that runs, or has found something; NULL: none */
    char result[600];     /* about the last one */
} app_sync;

/* Time code that comes in and moves the take. */
typedef struct app_chasing {
    bool is_on;
    int64_t synchronised_ns; /* host clock */
} app_chasing;

typedef struct app_patching {
    patch patch;
    bool waits; /* it is not on the stage yet */
    app_patch_aim aim;
    uint32_t pressed[PATCH_ACTIONS]; /* presses that were obeyed */
} app_patching;

/* What the last run and this one keep in the settings. */
typedef struct app_saving {
    bool is_on;
    double wait_s;
    bool has_failed; /* reported */
} app_saving;

typedef struct app_marks {        /* those of this run, oldest first; the show has them as events */
    int64_t at_ns[APP_MARKS_MAX]; /* host's clock */
    uint32_t count;
} app_marks;

struct app {
    plugin_list plugins;
    log_queue *log;
    news_list *news;
    settings *settings;
    app_saving saving;
    const sound_backend *sound;
    wake *changed;
    double wanted_s; /* when the next frame is wanted */

    show *show;
    face_file *face;
    char *face_path;
    double face_unit_mm;          /* of a mesh without a rig, as the user set it; 0: not set */
    char resting[PRESET_MAPPING]; /* the mapping that the face did not fit; "": none */
    live *live;
    const live_view *view;
    live_status status;
    kept_solver solver;
    app_patching patching;

    app_takes_state takes;
    app_awaited awaited;
    app_marks marks;
    app_undo_state undo;
    app_recording recording;
    app_chasing chase;
    app_pulls pulls;
    app_audio audio;
    app_speech speech;
    app_sync sync;

    kept_scenery *scenery;
    app_picture picture;
    char picture_says[256]; /* the last message of window and streams */
    uint32_t stream_count;
    pose_palette *poses;
    kept_life *life;
    remote *remote;
    struct viewport *viewport;
    app_looks looks;
    app_notes notes;
    bool asked[ACTION_COUNT], is_called[APP_CALLS];
    bool wants_to_quit, has_hand_keys;
    app_unsaved unsaved;
    bool has_unsaved;
    app_rig_saver rig_saver;
    struct show_copier *copier; /* saves the show under another name; NULL: not now */

    input_opener *inputs; /* those that are being opened */
    error input_trouble, output_trouble;
    exporter *exports;
    uint32_t exports_failed;
};

/* ---- app_main.c ---- */

__attribute__((format(printf, 3, 4))) void app_say(app *self, int32_t level, const char *format,
                                                   ...);

/* Drops the result of a call that shows its errors in the news itself. */
static inline void app_reported(mrt_result result)
{
    (void)result;
}

/* For another face: releases all pulls, and drops their undo steps. */
void app_forget_pulls(app *self);
/* Saves the current pulls as the value after, if the change is a pull. */
void app_save_pulled(app *self, undo_change *of);

/* ---- app_open.c ---- */

void app_looks_read(app *self);              /* from the settings */
bool *app_look_switch(app *self, action of); /* the switch that the action toggles; NULL: none */
/* Writes the settings: every few seconds, and at the end. */
void app_keep_settings(app *self, double dt_s);
void app_keep_settings_last(app *self);
/* Opens show, face, plugins and stage, as the options or else the last run say. */
CHECKED mrt_result app_open_first(app *self, const app_options *options, error *err);
/* Opens a copy of the show when it is complete. Called in each frame. */
void app_follow_copy(app *self);
void app_drop_copy(app *self);    /* waits for it */
void app_follow_audio(app *self); /* once a frame: attaches a sound that has been read */
void app_chase(app *self);        /* once a frame: follows time code that comes in */
void app_drop_audio(app *self);   /* cancels reading it */

/* ---- app_speech.c ---- */

void app_follow_speech(app *self); /* once a frame: adds a mouth that was found */
void app_drop_speech(app *self);   /* cancels and waits for it */

/* ---- app_sync.c ---- */

void app_follow_sync(app *self); /* once a frame: what was found, unless the take has changed */
void app_drop_sync(app *self);   /* cancels and waits for it */

/* ---- app_takes.c ---- */

/* app_edit_all; the undo step has these words. NULL: those of the last edit. */
CHECKED mrt_result app_edit_all_as(app *self, const edit *const *e, uint32_t count,
                                   const char *words);

void app_takes_update(app *self, double dt_s);
CHECKED mrt_result app_pick_take(app *self, int64_t id); /* in the list alone */
void app_keep_range(app *self); /* of the take on the stage, in the settings */
void app_drop_take(app *self);  /* none is chosen */
CHECKED mrt_result app_undo(app *self);
CHECKED mrt_result app_redo(app *self);
void app_forget_takes(app *self);  /* drops the undo steps of all takes: another show is opened */
void app_forget_pulled(app *self); /* drops those of pulls */
/* Once a frame, before anything is undone. */
void app_undo_update(app *self);
const char *app_undo_why_not(const app *self); /* NULL: it can be undone */
bool app_can_redo(const app *self);

void app_record_update(app *self);
/* Closes the show, NULL is fine. One whose file has been deleted or replaced is saved first; < 0:
 * not beside it. */
mrt_result app_close_show(app *self, show *of);
/* Ends a recording over a take and makes it a part of that, before its show is closed. */
void app_record_finish_over(app *self);
void app_record_toggle(app *self);
void app_mark(app *self);

/* The transport. */
void app_play_do(app *self, action of);

/* The edit actions, on the choice. */
const char *app_edit_why_not(app *self, action of); /* NULL: it can be done */
void app_edit_do(app *self, action of);

#endif
