/* window/studio_state.h - what a studio is made of. Inside studio*.c. [main] */
#ifndef MAROTTE_UI_WINDOW_STUDIO_STATE_H
#define MAROTTE_UI_WINDOW_STUDIO_STATE_H
#include "take/edit_store.h"
#include "window/panels.h"
#include "window/studio.h"
#include "window/studio_export.h"

enum { STUDIO_UNDO_MAX = 256, STUDIO_PATH = 4096 };

/* One line of undo: so many edits of a take, or somebody else's step. */
typedef struct studio_done {
    char words[EDIT_TEXT];
    int64_t take; /* 0: somebody else's */
    int64_t head_before, head_after;
    int64_t copied_from; /* the take is a copy of it, which this step has made; 0: it is none */
    studio_step step;
} studio_done;

/* What a take looked like when its line was made: it is folded again when that is no more so. */
typedef struct studio_take_key {
    int32_t edit_head, edit_count;
    bool is_recording, is_stale;
    bool is_told; /* that it cannot be read */
} studio_take_key;

struct studio {
    plugin_list plugins;
    log_queue *log;
    news_list *news;
    settings *settings;
    const sound_backend *sound;

    show *show;
    face_file *face;
    char *face_path;
    live *live;
    const live_view *view;
    live_status status;

    csrbf_settings solver; /* radius 0: the rig's */
    bool has_solver;       /* false: all of it is the rig's */

    /* ---- takes ---- */
    studio_take_line *line;
    studio_take_key *key;
    uint32_t line_count, line_room;
    bool takes_are_stale, takes_failed; /* failed: it was said */
    edit_store *store;                  /* of the take that is chosen; NULL: none */
    history *history;
    int64_t chosen;
    uint64_t edition;
    studio_choice choice;
    int64_t awaited;      /* a take that the writer has not got to yet; 0: none */
    bool awaited_is_kept; /* from the journal; else it was recorded */
    double awaited_s;
    int64_t noted; /* what is not as it was recorded has been said of it */

    /* ---- undo: done[0..done_count) can be taken back, those up to all_count done again ---- */
    studio_done done[STUDIO_UNDO_MAX];
    uint32_t done_count, all_count;

    /* ---- recording and playing ---- */
    bool was_recording, had_problem;
    int64_t over_take; /* that is performed over; 0: none */
    int64_t played_from_ns;

    /* ---- looks and wishes ---- */
    studio_looks looks, looks_kept;
    bool asked[ACTION_COUNT];
    bool wants_to_quit, has_hand_keys, keeps_settings;
    viewport *viewport;
    studio_figures figures;
    studio_unsaved unsaved;
    bool has_unsaved;
    double settings_wait_s;
    bool settings_failed; /* it was said */

    studio_inputs *inputs; /* that are being opened */
    error input_trouble;
    studio_export *exports;
    uint32_t exports_failed;
};

/* ---- saying things (studio.c) ---- */

/* An error is said in the news, once; the result comes back. */
mrt_result studio_said(studio *self, mrt_result result, const error *err);
__attribute__((format(printf, 3, 4))) void studio_say(studio *self, int32_t level,
                                                      const char *format, ...);

/* What failed is in the news: there is nothing more to do about it here. */
static inline void studio_heard(mrt_result result)
{
    (void)result;
}

/* ---- studio_takes.c ---- */

void studio_takes_update(studio *self, double dt_s);
/* It is chosen in the list as soon as all of it is in the show. */
void studio_await_take(studio *self, int64_t id, bool is_kept);
/* In the list alone: the stage stays what it is. */
CHECKED mrt_result studio_pick_take(studio *self, int64_t id);
void studio_drop_take(studio *self); /* none is chosen */
/* In the list, and on the stage if the chosen one is. */
CHECKED mrt_result studio_choose_instead(studio *self, int64_t id);
const studio_take_line *studio_line_of(const studio *self, int64_t id);
/* After each change of the chosen take: the list and the stage follow. */
void studio_take_changed(studio *self);
CHECKED mrt_result studio_show_chosen(studio *self);

/* ---- studio_undo.c ---- */

void studio_undo_note_take(studio *self, int64_t head_before);
/* The chosen take is a copy of that one, and was made just now. */
void studio_undo_note_copy(studio *self, int64_t of, const char *words);
CHECKED mrt_result studio_undo(studio *self);
CHECKED mrt_result studio_redo(studio *self);
bool studio_can_undo(const studio *self);
bool studio_can_redo(const studio *self);

/* ---- studio_record.c ---- */

void studio_record_update(studio *self);
/* Of a show whose file was taken away under it all is saved beside; closes it. NULL is fine. */
void studio_close_show(studio *self, show *of);
/* What is performed over a take ends, and becomes a part of it while its show is there. */
void studio_record_finish_over(studio *self);
/* It is in the show. */
void studio_tell_kept(studio *self, int64_t id);
void studio_record_toggle(studio *self);
void studio_keep(studio *self);
void studio_mark(studio *self);

/* ---- studio_play.c: the transport ---- */

void studio_play_do(studio *self, action of);

/* ---- studio_edit.c: what the edit actions do to what is chosen ---- */

const char *studio_edit_why_not(studio *self, action of); /* NULL: it can be done */
void studio_edit_do(studio *self, action of);

/* ---- studio_solver.c ---- */

/* What the show says of it. */
void studio_solver_read(studio *self);

/* ---- studio_open.c ---- */

/* The show, the face and what else is there at the start. */
CHECKED mrt_result studio_open_first(studio *self, const studio_options *options, error *err);

/* ---- studio_looks.c ---- */

void studio_looks_read(studio *self);
/* Into the settings, and those to the disk some times a minute. */
void studio_keep_settings(studio *self, double dt_s);
void studio_keep_settings_now(studio *self);

#endif
