/* show/edit_store.h - the edits of one take of a show, as the list that history.h works on. The one
 * place that knows both: what it reads is a take as its edits made it, what it writes is rows.
 * One thread with its show [main]. */
#ifndef MAROTTE_TAKE_EDIT_STORE_H
#define MAROTTE_TAKE_EDIT_STORE_H
#include "show/history.h"
#include "show/show.h"

/* A take of a show as its edits in force make it. An edit that cannot be applied is named, and
 * `out` is the take before it, as by history_fold. take_finish() it. */
CHECKED mrt_result edit_store_take(take *out, show *s, int64_t take_id, error *err);
/* The same, of a row that was just read. */
CHECKED mrt_result edit_store_take_of(take *out, show *s, const show_take *row, error *err);

/* Another take that shows the same and is edited by itself, with a number of its own. It begins as
 * a deleted one, and is there by the edit 1 of its list: undoing that takes it away again. */
CHECKED mrt_result edit_store_duplicate(show *s, int64_t take_id, int64_t (*utc_ms)(void),
                                        int64_t *out_id, error *err);

typedef struct edit_store edit_store;

/* To edit a take: history_open with edit_store_list and the bare take. The show outlives it, and
 * nobody else changes the edits of that take meanwhile. utc_ms says when an edit is made. */
CHECKED mrt_result edit_store_open(edit_store **out, show *s, int64_t take_id,
                                   int64_t (*utc_ms)(void), error *err);
void edit_store_close(edit_store *self); /* its history first; accepts NULL */

history_store edit_store_list(edit_store *self);
const take *edit_store_bare(const edit_store *self); /* as it was made, until close */

/* What was recorded beside a take becomes its sound, where it was: one edit. */
CHECKED mrt_result edit_store_attach_audio(show *s, int64_t take_id, const show_audio *audio,
                                           int64_t (*utc_ms)(void), error *err);

#endif
