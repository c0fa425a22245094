/* show/show.h - the show file NAME.marotte, an SQLite database with all recordings and all takes;
 * show_format.md describes its tables. Leaves out how recordings are written (writer.h) and what an
 * edit does (edit.h): here edits are lines of text.
 *
 * Only one program writes a show at a time. Other programs can read it and see what is committed.
 * Recorded data never changes. Only the journal deletes rows (writer_store.h).
 *
 * One show object belongs to one thread at a time [main]. A second thread that reads opens its own
 * object. Times are show time (take.h). The caller frees the lists that a function returns. */
#ifndef MAROTTE_TAKE_SHOW_H
#define MAROTTE_TAKE_SHOW_H
#include "show/take.h"

typedef struct show show;

typedef enum show_mode {
    SHOW_READ = 0,
    SHOW_WRITE,
    SHOW_RECORD /* SHOW_WRITE, and running statements finish even if the user cancels (cancel.h) */
} show_mode;

/* Creates a show. The file must not exist. */
CHECKED mrt_result show_create(show **out, const char *path, error *err);
/* Opens a show, which may come from an untrusted source. A file whose tables are not those of a
 * show is refused before anything is written. Values in rows are checked when they are read. Texts
 * for display are made printable (base/text.h). SHOW_WRITE opens the show read-only, with a notice
 * that gives the reason and the remedy, in three cases: another program writes it, its folder or
 * file cannot be written, or a newer version made it. Takes that a killed program left open are
 * ended at their last sample. */
CHECKED mrt_result show_open(show **out, const char *path, show_mode mode, error *err);
/* Limits all further work on the show to one budget (base/budget.h), for a command that ends.
 * Without this call each query has its own budget. */
void show_limit_work(show *self);
/* Pays for work on data that was read from the show; steps as in base/budget.h. */
CHECKED mrt_result show_spend(show *self, uint64_t steps, error *err);
/* Opens a second object of a show that is open and writable in this program, for a thread that
 * writes at the same time as the owner. Close it before the owner's. */
CHECKED mrt_result show_join(show **out, show *owner, error *err);
void show_close(show *self); /* close its readers and its writer first; accepts NULL */

const char *show_path(const show *self);
uint64_t show_file_size(
    const show *self); /* size in bytes when it was opened, including its write-ahead log */
bool show_is_writable(const show *self);
const char *show_notice(const show *self); /* "", or one line for the user */

/* Returns true if the show's file was deleted, moved or replaced. Recording continues into the open
 * file, which is lost when the program ends: see show_rescue. */
bool show_is_missing(const show *self);
/* Returns true if `path` is the file that is open, under any name. */
bool show_is_file(const show *self, const char *path);
/* Writes a complete copy of the committed data to a new file. Recording may continue. */
CHECKED mrt_result show_rescue(show *self, const char *out_path, error *err);
/* Saves a missing show when it is closed. The complete copy is placed beside the original path,
 * under the first unused name (night.rescued.marotte, night.rescued-2.marotte). If that fails, it
 * is placed in $XDG_DATA_HOME/marotte/rescued/. out_sentence names all paths; it is "" with
 * SHOW_RESCUE_NONE. */
typedef enum show_rescue_state {
    SHOW_RESCUE_NONE = 0, /* the show is not missing */
    SHOW_RESCUE_BESIDE,
    SHOW_RESCUE_HOME,
    SHOW_RESCUE_LOST /* no copy could be made */
} show_rescue_state;
show_rescue_state show_rescue_missing(show *self, error *out_sentence);
/* Reads the whole show and reports the first damage. This takes as long as reading the file. */
CHECKED mrt_result show_check(show *self, error *err);
/* Copies all readable rows of a damaged show into a new file. The damaged file is not changed. */
typedef struct show_recovery {
    int64_t row_count;     /* copied rows */
    int64_t damaged_count; /* rows that were left out because they are damaged; others may be lost
                              without being noticed */
    bool is_cut; /* true if the work budget ran out, for example in a loop of pages; only a part was
                    read */
} show_recovery;
CHECKED mrt_result show_recover(show_recovery *out, const char *path, const char *out_path,
                                error *err);

/* ---- takes ---- */

typedef struct show_span { /* a span of recording that a take needs; the journal never removes it */
    int64_t performance;   /* 0: all tracks of that time */
    int64_t from_ns, to_ns;
    bool is_shown; /* true: the take shows it before any edit; false: an edit refers to it */
} show_span;

/* Origin of a take that was performed over another take: the id of that take, and ms on its
 * timeline. */
#define SHOW_ORIGIN_OVER "performed over take %lld at %lld ms"

typedef struct show_take { /* a take before its edits; edit.h applies them */
    int64_t id;
    int64_t created_ns; /* UTC */
    int64_t start_ns, end_ns;
    bool is_recording; /* its end is not written; end_ns is the time of the last sample */
    bool is_recovered; /* the program ended during the recording, and the take was ended at the last
                          sample */
    char scene[TAKE_NAME], shot[TAKE_NAME];
    uint32_t number;
    char origin[96];
    int64_t over, over_at_ns; /* the take that it was performed over, and the time there; 0: none */
    int32_t edit_head;        /* number of the edits 1..edit_count that are in effect */
    int32_t edit_count;
    int32_t base_edit_count; /* edits with n <= 0, which created the take and cannot be undone */
} show_take;

/* Begins a read transaction: all reads until show_read_end see the same state, and are faster. Keep
 * it short. */
CHECKED mrt_result show_read_begin(show *self, error *err);
void show_read_end(show *self);

/* Reads all takes, sorted by id, which is the order of their creation. */
CHECKED mrt_result show_takes(show *self, show_take **out, size_t *out_count, error *err);
CHECKED mrt_result show_take_read(show *self, int64_t id, show_take *out, error *err);
/* Returns the take before its edits: one layer with a clip for each span that is shown. Call
 * take_finish() on it. For tests; the program also needs the edits: edit_store_take. */
CHECKED mrt_result show_take_base(show *self, int64_t id, take *out, error *err);
/* Does the same for a row that was just read. */
CHECKED mrt_result show_take_base_of(show *self, const show_take *row, take *out, error *err);
CHECKED mrt_result show_take_spans(show *self, int64_t id, show_span **out, size_t *out_count,
                                   error *err);

typedef struct show_new_take {
    int64_t created_ns, start_ns, end_ns;
    const char *scene, *shot, *origin; /* may be "" */
    uint32_t number;                   /* 0: the next number of scene and shot */
    const show_span *spans;
    size_t span_count;
    const char *const *base_edits; /* JSON; they get n = 1 - count .. 0 */
    size_t base_edit_count;
    int64_t utc_ms; /* time of the base edits */
} show_new_take;
/* Creates a take that is not being recorded: an imported one, or a recording through another
 * mapping. */
CHECKED mrt_result show_take_create(show *self, const show_new_take *made, int64_t *out_id,
                                    error *err);

/* ---- notes: short texts about the whole show, each with a key such as "solver" ---- */

/* out: "" if there is no such note. */
CHECKED mrt_result show_note_read(show *self, const char *key, char *out, size_t capacity,
                                  error *err);
CHECKED mrt_result show_note_write(show *self, const char *key, const char *text, error *err);

/* ---- pictures that a note refers to: unchanged files, identified by their SHA-256 ---- */

enum { SHOW_PICTURE_BYTES = 32 << 20 };
/* Reads the picture with this hash, and checks the hash. The caller frees it. MRT_END: there is
 * none. */
CHECKED mrt_result show_picture_read(show *self, const char *hash, void **out, size_t *out_size,
                                     error *err);
CHECKED mrt_result show_picture_write(show *self, const char *hash, const void *bytes, size_t size,
                                      error *err);
/* Removes all pictures except this one; "": all. */
CHECKED mrt_result show_pictures_forget(show *self, const char *but, error *err);

/* ---- edits: rows of text. The first edit_head are in effect. Edits are never deleted. ---- */

typedef struct show_edit {
    int32_t n;      /* 1..edit_count; <= 0: an edit that created the take */
    int64_t utc_ms; /* time of the edit */
    char *json;
} show_edit;
typedef struct show_edits {
    show_edit *edit; /* sorted by n, base edits first, without abandoned edits */
    size_t count;
    int32_t head;
} show_edits;
CHECKED mrt_result show_edits_read(show *self, int64_t take, show_edits *out, error *err);
CHECKED mrt_result show_edits_of(show *self, const show_take *row, show_edits *out, error *err);
void show_edits_finish(show_edits *edits);

/* Appends an edit after those in effect. Undone edits are abandoned: their rows move to another
 * branch. `spans`: the spans of other performances that the edit refers to; the take keeps them. */
CHECKED mrt_result show_edit_append(show *self, int64_t take, const char *json, int64_t utc_ms,
                                    const show_span *spans, size_t span_count, error *err);
/* Undoes or redoes: `head` edits are in effect afterwards, 0..edit_count. */
CHECKED mrt_result show_edit_head(show *self, int64_t take, int32_t head, error *err);

/* ---- recorded data ---- */

typedef struct show_track {
    take_track track;
    int64_t from_ns, to_ns; /* times of its first and last sample; both 0: it has no samples */
} show_track;
CHECKED mrt_result show_track_read(show *self, int64_t id, show_track *out, error *err);
void show_track_finish(show_track *track);
CHECKED mrt_result show_track_ids(show *self, int64_t **out, size_t *out_count, error *err);

typedef struct show_performance {
    take_performance performance;
    int64_t from_ns, to_ns; /* to_ns of a running performance is the time of its last sample */
} show_performance;
CHECKED mrt_result show_performance_read(show *self, int64_t id, show_performance *out, error *err);
void show_performance_finish(show_performance *performance);
/* Creates a performance that performs the tracks of p->again.of again, with the same span. Sets the
 * id. */
CHECKED mrt_result show_performance_create(show *self, take_performance *p, error *err);
/* Samples that were computed, not measured, such as the mouth of a voice. They become a track and a
 * performance of it, which no mapping performs in any run. `next` delivers the samples in time
 * order, `time_ns` from 0 on, and returns false after the last one. Computed samples have no time
 * of their own: 0 becomes SHOW_COMPUTED_NS, decades ago, so that what is kept from the journal
 * never has them. The take keeps them, as if one of its edits referred to them. Sets the ids. The
 * caller owns the texts. On failure the show holds nothing of it. */
#define SHOW_COMPUTED_NS INT64_C(1000000000)
typedef struct show_computed {
    int64_t take;
    const char *program; /* "marotte 0.2.0" */
    take_track *track;
    take_performance *performance; /* its track is set */
    int64_t length_ns;
    bool (*next)(void *data, mrt_sample *out);
    void *data;
} show_computed;
CHECKED mrt_result show_computed_create(show *self, const show_computed *made, error *err);
CHECKED mrt_result show_performance_ids(show *self, int64_t **out, size_t *out_count, error *err);

/* Reads the events of [from_ns, to_ns], sorted by time. */
CHECKED mrt_result show_events(show *self, int64_t from_ns, int64_t to_ns, take_event **out,
                               size_t *out_count, error *err);

typedef struct show_checkpoint {
    int64_t time_ns;
    uint32_t version; /* format version of the bytes, defined by the stage */
    void *bytes;
    size_t size;
} show_checkpoint;
/* Reads the last checkpoint of the performance at or before time_ns; bytes is NULL if there is
 * none. A checkpoint that would unpack to more than `most` bytes counts as damaged. With 0 any size
 * is unpacked, at the cost of the show's budget. */
CHECKED mrt_result show_checkpoint_before(show *self, int64_t performance, int64_t time_ns,
                                          size_t most, show_checkpoint *out, error *err);
void show_checkpoint_finish(show_checkpoint *checkpoint);

/* ---- samples of one track in time order, with one chunk in memory ---- */

typedef struct show_reader show_reader;

/* Opens a reader of the samples of [from_ns, to_ns]. */
CHECKED mrt_result show_reader_open(show_reader **out, show *s, int64_t track, int64_t from_ns,
                                    int64_t to_ns, error *err);
void show_reader_close(show_reader *self); /* accepts NULL */
/* Reads the next sample. MRT_END: no sample is left now; a track that is being recorded may get
 * more, so call again later. < 0: the next chunk is damaged or missing, and the next call continues
 * after it. */
CHECKED mrt_result show_reader_next(show_reader *self, mrt_sample *out, error *err);
/* Moves the reader to its first sample at or after time_ns, which must not be before the span of
 * the reader. After the end of the span there is no sample. */
CHECKED mrt_result show_reader_seek(show_reader *self, int64_t time_ns, error *err);

/* ---- audio: interleaved frames in pieces ---- */

typedef struct show_audio {
    int64_t id;
    char name[96];    /* name of its source file or device */
    int64_t start_ns; /* show time of its first frame; 0: from a file */
    uint32_t rate_hz, channel_count;
    char format[8];      /* "s16", "s24" in 3 bytes, "f32": little-endian */
    int64_t frame_count; /* frames written so far */
} show_audio;
CHECKED mrt_result show_audio_create(show *self, const show_audio *audio, int64_t *out_id,
                                     error *err);
/* Appends whole frames. time_ns: when the first of them was measured; 0: unknown. */
CHECKED mrt_result show_audio_write(show *self, int64_t id, int64_t time_ns, const void *frames,
                                    size_t size, error *err);
CHECKED mrt_result show_audio_info(show *self, int64_t id, show_audio *out, error *err);
CHECKED mrt_result show_audio_ids(show *self, int64_t **out, size_t *out_count, error *err);
/* Reads whole frames from first_frame on, at most `capacity` bytes. *out_size is 0 if there are
 * none. */
CHECKED mrt_result show_audio_read(show *self, int64_t id, int64_t first_frame, void *out,
                                   size_t capacity, size_t *out_size, error *err);
typedef struct show_audio_anchor { /* for measuring the drift against the clock of the samples */
    int64_t frame, time_ns;
} show_audio_anchor;
/* Reads one anchor for each piece with a known time. */
CHECKED mrt_result show_audio_anchors(show *self, int64_t id, show_audio_anchor **out,
                                      size_t *out_count, error *err);

#endif
