/* show/edit_store.h - the edits of one take of a show, as a history_store for history.h. Reads a
 * take with its edits applied, and writes edits as rows. Leaves out what an edit does (edit.h). One
 * thread with its show [main]. */
#ifndef MAROTTE_TAKE_EDIT_STORE_H
#define MAROTTE_TAKE_EDIT_STORE_H
#include "show/history.h"
#include "show/show.h"

/* Reads a take with its effective edits applied. If an edit cannot be applied, the error names it,
 * and `out` is the take before it, as in history_fold. Call take_finish() on `out`. */
CHECKED mrt_result edit_store_take(take *out, show *s, int64_t take_id, error *err);
/* Does the same for a row that was just read. */
CHECKED mrt_result edit_store_take_of(take *out, show *s, const show_take *row, error *err);

/* Creates a copy of a take that is edited separately and has its own number. The copy begins as a
 * deleted take, and edit 1 of its list restores it. Undoing edit 1 removes the copy again. */
CHECKED mrt_result edit_store_duplicate(show *s, int64_t take_id, int64_t (*utc_ms)(void),
                                        int64_t *out_id, error *err);

typedef struct edit_store edit_store;

/* Opens the edits of a take, for history_open with edit_store_list and the bare take. The show must
 * outlive it. No other code may change the edits of that take meanwhile. utc_ms returns the time of
 * a new edit. */
CHECKED mrt_result edit_store_open(edit_store **out, show *s, int64_t take_id,
                                   int64_t (*utc_ms)(void), error *err);
void edit_store_close(edit_store *self); /* close its history first; accepts NULL */

history_store edit_store_list(edit_store *self);
const take *
edit_store_bare(const edit_store *self); /* the take before its edits; valid until close */

/* Lists the marks that were set while a take was recorded, as edits that add its markers, oldest
 * first. Edits need no edit_finish; the caller frees *out. */
CHECKED mrt_result edit_store_marks(show *s, const take *t, edit **out, uint32_t *out_count,
                                    error *err);
/* Makes them markers of the take, after its other edits. */
CHECKED mrt_result edit_store_add_marks(show *s, int64_t take_id, int64_t (*utc_ms)(void),
                                        error *err);
/* Does so for each take that was recovered after a crash and is not edited yet. */
CHECKED mrt_result edit_store_add_recovered_marks(show *s, int64_t (*utc_ms)(void), error *err);

/* Attaches recorded audio to a take as its sound, at the time of the recording, as one edit. */
CHECKED mrt_result edit_store_attach_audio(show *s, int64_t take_id, const show_audio *audio,
                                           int64_t (*utc_ms)(void), error *err);

#endif
