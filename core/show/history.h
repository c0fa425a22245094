/* show/history.h - the list of edits of a take. Computes the current take, offers unlimited undo
 * and redo that survive closing, and describes each edit. Leaves out what an edit does (edit.h) and
 * the storage of the list: the caller provides it as a history_store.
 *
 * LIST  Edits n <= 0 created the take and cannot be undone. Edits 1..last follow, of which 1..head
 * are in effect. A new edit while head < last abandons the edits after head. The store may keep
 * them, but they are no longer in the list. One thread at a time. */
#ifndef MAROTTE_TAKE_HISTORY_H
#define MAROTTE_TAKE_HISTORY_H
#include "show/edit.h"

typedef struct history_extent {
    int64_t first, head, last; /* first <= 1, and 1 without base edits; 0 <= head <= last */
} history_extent;

typedef struct history_store {
    void *self;
    CHECKED mrt_result (*extent)(void *self, history_extent *out, error *err);
    /* Reads edit n, first..last, as JSON. out_text has out_size bytes and is valid until the next
     * call. */
    CHECKED mrt_result (*read)(void *self, int64_t n, const char **out_text, size_t *out_size,
                               error *err);
    /* Appends the edit as head + 1, and sets head = last = that number. On failure nothing changes.
     * `shows`: the recording that it refers to; NULL: none. */
    CHECKED mrt_result (*append)(void *self, const char *text, const edit_reference *shows,
                                 error *err);
    CHECKED mrt_result (*set_head)(void *self, int64_t head, error *err);
    /* Pays for an edit before it is applied; steps as in base/budget.h. NULL: edits cost nothing.
     */
    CHECKED mrt_result (*pay)(void *self, uint64_t steps, error *err);
} history_store;

/* Computes `bare` with the edits first..until applied. If an edit cannot be applied, the error
 * gives its number, and `out` is the take before it. *out_reached (may be NULL) is the last edit
 * that was applied. If memory runs out or the budget is spent, `out` is zeroed. */
CHECKED mrt_result history_fold(take *out, const take *bare, const history_store *store,
                                int64_t until, int64_t *out_reached, error *err);

typedef struct history history;

/* Applies the edits up to head; later edits are only described. `store` is copied. */
CHECKED mrt_result history_open(history **out, const take *bare, const history_store *store,
                                error *err);
void history_close(history *self); /* accepts NULL */

const take *history_take(const history *self); /* valid until the next change */
int64_t history_head(const history *self);
int64_t history_last(const history *self);
/* Describes edit n of 1..last: "trim 'mouth' to 2.1 .. 8 s". Returns "" outside that range. Valid
 * until the next change. */
const char *history_words(const history *self, int64_t n);

/* Applies the edit and appends it. On failure the take and the list are unchanged. */
CHECKED mrt_result history_do(history *self, const edit *e, error *err);
/* MRT_END: no edit to undo or redo; the take is unchanged. */
CHECKED mrt_result history_undo(history *self, error *err);
CHECKED mrt_result history_redo(history *self, error *err);
/* Undoes or redoes to `head`, 0..last, in one call. */
CHECKED mrt_result history_go(history *self, int64_t head, error *err);

#endif
