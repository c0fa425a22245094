/* show/show.h - the show file NAME.marotte: an SQLite database that holds everything that was
 * recorded and what was made of it; README.md describes its tables. Leaves out how it gets there
 * while it happens (writer.h) and what an edit means (edit.h): here edits are lines of text.
 *
 * A show is written by one program at a time; others read it, and see what is committed. What was
 * recorded is never changed. Nothing is deleted but what the journal lets go (writer_store.h).
 *
 * One show object belongs to one thread at a time [main]; a thread that reads beside it opens its
 * own. Times are show time (take.h). Lists that a function gives are the caller's to free. */
#ifndef MAROTTE_TAKE_SHOW_H
#define MAROTTE_TAKE_SHOW_H
#include "show/take.h"

typedef struct show show;

typedef enum show_mode {
    SHOW_READ = 0,
    SHOW_WRITE,
    SHOW_RECORD /* SHOW_WRITE, and what is under way is kept though the person cancels (cancel.h) */
} show_mode;

/* The file must not exist. */
CHECKED mrt_result show_create(show **out, const char *path, error *err);
/* Anybody may have made the file: one that is no show of ours, table by table, is refused before
 * anything is written, what its rows say is checked when they are read, and texts that are shown
 * are printable (base/text.h). SHOW_WRITE gives a show that can only be read, and a notice that
 * says why and what to do, when another program writes it, its folder or file cannot be written, or
 * a newer version made it. What a program that was killed left behind is closed: takes end at their
 * last sample. */
CHECKED mrt_result show_open(show **out, const char *path, show_mode mode, error *err);
/* All that is asked of it from now on is paid out of one budget (base/budget.h), as fits a command
 * that ends; without, each question has one of its own. */
void show_limit_work(show *self);
/* Pays for work that is done with what was read of it; steps as in base/budget.h. */
CHECKED mrt_result show_spend(show *self, uint64_t steps, error *err);
/* Another object of a show that is open and writable here, for a thread that writes beside its
 * owner: closed before the owner's. */
CHECKED mrt_result show_join(show **out, show *owner, error *err);
void show_close(show *self); /* its readers and its writer first; NULL is fine */

const char *show_path(const show *self);
uint64_t show_file_size(const show *self); /* bytes, when it was opened; its log's too */
bool show_is_writable(const show *self);
const char *show_notice(const show *self); /* "", or one line for the person in front of it */

/* The file under that name is not the one that is open: it was deleted, moved or replaced. What is
 * recorded goes on into the open one, which is lost when the program ends: see show_rescue. */
bool show_is_missing(const show *self);
/* The file under that name is the one that is open, whatever the name. */
bool show_is_file(const show *self, const char *path);
/* A whole copy of what is committed, as a new file, while recording goes on. */
CHECKED mrt_result show_rescue(show *self, const char *out_path, error *err);
/* Of a show that is missing as it is closed: a whole copy beside where it lay, under the first name
 * that is free (night.rescued.marotte, night.rescued-2.marotte), or in
 * $XDG_DATA_HOME/marotte/rescued/ where none can be made there. out_sentence names all paths; ""
 * with SHOW_RESCUE_NONE. */
typedef enum show_rescue_state {
    SHOW_RESCUE_NONE = 0, /* it is not missing */
    SHOW_RESCUE_BESIDE,
    SHOW_RESCUE_HOME,
    SHOW_RESCUE_LOST /* no copy could be made */
} show_rescue_state;
show_rescue_state show_rescue_missing(show *self, error *out_sentence);
/* Reads everything, and says the first thing that is not whole. Takes as long as reading the file.
 */
CHECKED mrt_result show_check(show *self, error *err);
/* Copies all that can be read of a damaged show into a new file, row by row. The damaged one is not
 * touched. */
typedef struct show_recovery {
    int64_t row_count; /* copied */
    int64_t
        damaged_count; /* rows that were found damaged and left out; others may be gone unseen */
    bool is_cut;       /* it leads in circles: not all of it was looked at */
} show_recovery;
CHECKED mrt_result show_recover(show_recovery *out, const char *path, const char *out_path,
                                error *err);

/* ---- takes ---- */

typedef struct show_span { /* what a take holds on to: the journal never lets go of it */
    int64_t performance;   /* 0: all tracks of that time */
    int64_t from_ns, to_ns;
    bool is_shown; /* the take as it was made shows it; false: an edit refers to it */
} show_span;

/* What the origin of a take says that was performed over another one: its id, ms of its timeline.
 */
#define SHOW_ORIGIN_OVER "performed over take %lld at %lld ms"

typedef struct show_take { /* how a take was made; what its edits make of it: edit.h */
    int64_t id;
    int64_t created_ns; /* UTC */
    int64_t start_ns, end_ns;
    bool is_recording; /* its end was never written; end_ns is that of the last sample */
    bool is_recovered; /* the program ended while it recorded: it was closed at the last sample */
    char scene[TAKE_NAME], shot[TAKE_NAME];
    uint32_t number;
    char origin[96];
    int64_t over, over_at_ns; /* performed over that take, from there on; 0: over none */
    int32_t edit_head;        /* so many of the edits 1..edit_count are in force */
    int32_t edit_count;
    int32_t base_edit_count; /* edits with n <= 0: part of how it was made, not to be undone */
} show_take;

/* What is read until then is as of one instant, and read faster: for a short look at many rows. */
CHECKED mrt_result show_look_begin(show *self, error *err);
void show_look_end(show *self);

/* All takes, by id: the order in which they were made. */
CHECKED mrt_result show_takes(show *self, show_take **out, size_t *out_count, error *err);
CHECKED mrt_result show_take_read(show *self, int64_t id, show_take *out, error *err);
/* One layer with a clip per span shown: what the edits start from. take_finish() it. For tests;
 * the program wants the edits too: edit_store_take. */
CHECKED mrt_result show_take_base(show *self, int64_t id, take *out, error *err);
/* The same, of a row that was just read. */
CHECKED mrt_result show_take_base_of(show *self, const show_take *row, take *out, error *err);
CHECKED mrt_result show_take_spans(show *self, int64_t id, show_span **out, size_t *out_count,
                                   error *err);

typedef struct show_new_take {
    int64_t created_ns, start_ns, end_ns;
    const char *scene, *shot, *origin; /* "" or text */
    uint32_t number;                   /* 0: the next one of scene and shot */
    const show_span *spans;
    size_t span_count;
    const char *const *base_edits; /* JSON; they become n = 1 - count .. 0 */
    size_t base_edit_count;
    int64_t utc_ms; /* of the base edits */
} show_new_take;
/* A take that was not recorded just now: another one through another mapping, an imported one. */
CHECKED mrt_result show_take_create(show *self, const show_new_take *made, int64_t *out_id,
                                    error *err);

/* ---- notes: short texts about the show as a whole, by a key: "solver" ---- */

/* out: "" when there is none. */
CHECKED mrt_result show_note_read(show *self, const char *key, char *out, size_t capacity,
                                  error *err);
CHECKED mrt_result show_note_write(show *self, const char *key, const char *text, error *err);

/* ---- pictures that a note refers to, as their files were: known by their SHA-256 ---- */

enum { SHOW_PICTURE_BYTES = 32 << 20 };
/* MRT_END: it has none of this hash. What it gives back has that hash; to be freed. */
CHECKED mrt_result show_picture_read(show *self, const char *hash, void **out, size_t *out_size,
                                     error *err);
CHECKED mrt_result show_picture_write(show *self, const char *hash, const void *bytes, size_t size,
                                      error *err);
/* All but this one are removed; "": all. */
CHECKED mrt_result show_pictures_forget(show *self, const char *but, error *err);

/* ---- edits: rows of text, of which the first edit_head are in force; none is ever deleted ---- */

typedef struct show_edit {
    int32_t n;      /* 1..edit_count; <= 0: how the take was made */
    int64_t utc_ms; /* when it was made */
    char *json;
} show_edit;
typedef struct show_edits {
    show_edit *edit; /* by n; base edits first, abandoned ones left out */
    size_t count;
    int32_t head;
} show_edits;
CHECKED mrt_result show_edits_read(show *self, int64_t take, show_edits *out, error *err);
CHECKED mrt_result show_edits_of(show *self, const show_take *row, show_edits *out, error *err);
void show_edits_finish(show_edits *edits);

/* Puts an edit after those in force; edits that were undone are abandoned: they stay as rows of
 * another branch. `spans`: what it refers to in other performances, held on to from now on. */
CHECKED mrt_result show_edit_append(show *self, int64_t take, const char *json, int64_t utc_ms,
                                    const show_span *spans, size_t span_count, error *err);
/* Undo and redo: so many edits are in force, 0..edit_count. */
CHECKED mrt_result show_edit_head(show *self, int64_t take, int32_t head, error *err);

/* ---- what was recorded ---- */

typedef struct show_track {
    take_track track;
    int64_t from_ns, to_ns; /* of what is recorded of it; both 0: nothing */
} show_track;
CHECKED mrt_result show_track_read(show *self, int64_t id, show_track *out, error *err);
void show_track_finish(show_track *track);
CHECKED mrt_result show_track_ids(show *self, int64_t **out, size_t *out_count, error *err);

typedef struct show_performance {
    take_performance performance;
    int64_t from_ns, to_ns; /* to_ns of one that goes on: of its last sample */
} show_performance;
CHECKED mrt_result show_performance_read(show *self, int64_t id, show_performance *out, error *err);
void show_performance_finish(show_performance *performance);
/* The tracks of another performance, performed anew: p->again.of; the span is that one's. Fills in
 * the id. */
CHECKED mrt_result show_performance_create(show *self, take_performance *p, error *err);
CHECKED mrt_result show_performance_ids(show *self, int64_t **out, size_t *out_count, error *err);

/* Events of [from_ns, to_ns] in the order of their time. */
CHECKED mrt_result show_events(show *self, int64_t from_ns, int64_t to_ns, take_event **out,
                               size_t *out_count, error *err);

typedef struct show_checkpoint {
    int64_t time_ns;
    uint32_t version; /* of what the bytes mean: the stage's */
    void *bytes;
    size_t size;
} show_checkpoint;
/* The last one of the performance at or before time_ns; bytes NULL: there is none. One that would
 * unpack to more than `most` bytes is damaged; 0: all are unpacked, out of the show's budget. */
CHECKED mrt_result show_checkpoint_before(show *self, int64_t performance, int64_t time_ns,
                                          size_t most, show_checkpoint *out, error *err);
void show_checkpoint_finish(show_checkpoint *checkpoint);

/* ---- samples of one track in time order, one chunk in memory ---- */

typedef struct show_reader show_reader;

/* Samples of [from_ns, to_ns]. */
CHECKED mrt_result show_reader_open(show_reader **out, show *s, int64_t track, int64_t from_ns,
                                    int64_t to_ns, error *err);
void show_reader_close(show_reader *self); /* NULL is fine */
/* MRT_OK: a sample; MRT_END: none left now (a track that is being recorded may go on: ask again);
 * < 0: the next chunk is damaged or missing. The call after that goes on behind it. */
CHECKED mrt_result show_reader_next(show_reader *self, mrt_sample *out, error *err);
/* The next sample will be the first of the reader's span at or after time_ns, which is not before
 * it; behind its end: none. */
CHECKED mrt_result show_reader_seek(show_reader *self, int64_t time_ns, error *err);

/* ---- audio: interleaved frames in pieces ---- */

typedef struct show_audio {
    int64_t id;
    char name[96];    /* of the file or device that it came from */
    int64_t start_ns; /* show time of its first frame; 0: it came from a file */
    uint32_t rate_hz, channel_count;
    char format[8];      /* "s16", "s24" in 3 bytes, "f32": little-endian */
    int64_t frame_count; /* as written */
} show_audio;
CHECKED mrt_result show_audio_create(show *self, const show_audio *audio, int64_t *out_id,
                                     error *err);
/* Appends whole frames. time_ns: when their first was measured; 0: not said. */
CHECKED mrt_result show_audio_write(show *self, int64_t id, int64_t time_ns, const void *frames,
                                    size_t size, error *err);
CHECKED mrt_result show_audio_info(show *self, int64_t id, show_audio *out, error *err);
CHECKED mrt_result show_audio_ids(show *self, int64_t **out, size_t *out_count, error *err);
/* Up to `capacity` bytes of whole frames from first_frame on; *out_size 0: there are none. */
CHECKED mrt_result show_audio_read(show *self, int64_t id, int64_t first_frame, void *out,
                                   size_t capacity, size_t *out_size, error *err);
typedef struct show_audio_anchor { /* so the drift against the samples' clock can be seen */
    int64_t frame, time_ns;
} show_audio_anchor;
/* Of each piece that said its time. */
CHECKED mrt_result show_audio_anchors(show *self, int64_t id, show_audio_anchor **out,
                                      size_t *out_count, error *err);

#endif
