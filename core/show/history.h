/* show/history.h - the edits of a take as a list that is folded: what the take is now, undo and
 * redo without limit that survive closing, and each edit in words. Leaves out what an edit does
 * (edit.h) and where the list is kept: a history_store is the list, to be given by whoever keeps
 * it.
 *
 * LIST  Edits n <= 0 say how the take was made and cannot be undone; then come 1..last, of which
 *       1..head are in force. An edit that is made while head < last abandons those after head: the
 *       store may keep them, but they are no longer of the list.
 * One thread at a time. */
#ifndef MAROTTE_TAKE_HISTORY_H
#define MAROTTE_TAKE_HISTORY_H
#include "show/edit.h"

typedef struct history_extent {
    int64_t first, head, last; /* first <= 1; without base edits 1; 0 <= head <= last */
} history_extent;

typedef struct history_store {
    void *self;
    CHECKED mrt_result (*extent)(void *self, history_extent *out, error *err);
    /* Edit n, first..last, as JSON: out_text (out_size bytes) lives until the next call. */
    CHECKED mrt_result (*read)(void *self, int64_t n, const char **out_text, size_t *out_size,
                               error *err);
    /* All or none: the edit becomes head + 1, and head = last = that. `shows`: the recording that
     * it refers to; NULL: none. */
    CHECKED mrt_result (*append)(void *self, const char *text, const edit_reference *shows,
                                 error *err);
    CHECKED mrt_result (*set_head)(void *self, int64_t head, error *err);
    /* Before an edit is applied: what that costs, in steps as base/budget.h counts them. NULL:
     * nothing. */
    CHECKED mrt_result (*pay)(void *self, uint64_t steps, error *err);
} history_store;

/* `bare` with edits first..until applied. An edit that cannot be applied is named by its number,
 * and `out` is then the take before it: what can be shown of it; *out_reached (may be NULL) is the
 * last edit in force. Without memory for that, or when it cannot be paid, `out` is zeroed. */
CHECKED mrt_result history_fold(take *out, const take *bare, const history_store *store,
                                int64_t until, int64_t *out_reached, error *err);

typedef struct history history;

/* Folds 1..head; what is behind head is read for its words only. `store` is copied. */
CHECKED mrt_result history_open(history **out, const take *bare, const history_store *store,
                                error *err);
void history_close(history *self); /* accepts NULL */

const take *history_take(const history *self); /* until the next change */
int64_t history_head(const history *self);
int64_t history_last(const history *self);
/* Edit n of 1..last, "trim 'mouth' to 2.1 .. 8 s"; "" outside. Until the next change. */
const char *history_words(const history *self, int64_t n);

/* Applies the edit and appends it. On failure neither the take nor the list has changed. */
CHECKED mrt_result history_do(history *self, const edit *e, error *err);
/* MRT_END: there is nothing to undo or redo; nothing has changed. */
CHECKED mrt_result history_undo(history *self, error *err);
CHECKED mrt_result history_redo(history *self, error *err);
/* To 0..last at once. */
CHECKED mrt_result history_go(history *self, int64_t head, error *err);

#endif
