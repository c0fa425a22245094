/* window/app/undo.h - the undo list: every change made in the window, as a value before and a value
 * after. Undo sets the value before, redo the value after. Leaves out what a value means: its owner
 * sets it. Edits of takes are in the list, too; their values are positions in the history of a
 * take, which is stored in the show (show/history.h). [main] */
#ifndef MAROTTE_UI_WINDOW_APP_UNDO_H
#define MAROTTE_UI_WINDOW_APP_UNDO_H
#include "base/error.h"
#include "show/edit.h"

enum { UNDO_CHANGES_MAX = 1024, UNDO_BYTES_MAX = 512 << 20 };

typedef struct undo_change {
    void *owner;           /* must stay valid until undo_list_forget(owner) */
    char words[EDIT_TEXT]; /* describes the change: "engine: radius 40 mm" */
    /* Sets the value, and reports errors itself. It may add no change. */
    mrt_result (*set)(void *owner, const void *value);
    void *before, *after; /* values, from malloc; the list frees them */
    size_t bytes;         /* memory that the change keeps, about */
    uint64_t number;      /* assigned by the list; increases from change to change */
} undo_change;

typedef struct undo_list undo_list;
undo_list *undo_list_create(void); /* NULL: no memory */
void undo_list_destroy(undo_list *self);

/* Appends the change and takes ownership of its values. Changes that were undone are dropped, and
 * the oldest ones that exceed UNDO_CHANGES_MAX or UNDO_BYTES_MAX. */
void undo_list_add(undo_list *self, const undo_change *change);
/* Inserts a change that is older than all others, as one that was undone. */
void undo_list_add_undone(undo_list *self, const undo_change *change);
/* Copies both values of `size` bytes into the change. Returns false without memory: the change
 * cannot be undone then. */
CHECKED bool undo_change_copy(undo_change *change, const void *before, const void *after,
                              size_t size);

/* The change that undo, or redo, would set next; NULL: none. */
undo_change *undo_list_next(undo_list *self);
undo_change *undo_list_next_redo(undo_list *self);
/* MRT_END: nothing to undo or redo; else the result of the change's `set`. */
CHECKED mrt_result undo_list_undo(undo_list *self);
CHECKED mrt_result undo_list_redo(undo_list *self);

/* Drops the changes of an owner for which `is_dropped` returns true; NULL: all of them. */
void undo_list_forget_if(undo_list *self, const void *owner,
                         bool (*is_dropped)(const undo_change *of, const void *data),
                         const void *data);
static inline void undo_list_forget(undo_list *self, const void *owner)
{
    undo_list_forget_if(self, owner, NULL, NULL);
}

size_t undo_list_bytes(const undo_list *self); /* of all changes */

#endif
