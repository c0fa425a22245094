/* take_edit.h - edits made by subcommands: a list of edits that a subcommand asks for, applied to
 * a take through its history. [main] */
#ifndef MAROTTE_UI_TAKE_EDIT_H
#define MAROTTE_UI_TAKE_EDIT_H
#include "take.h"
#include "take/edit_store.h"

enum { TAKE_CHANGE_MAX = 4 };
typedef struct take_change {
    edit edit[TAKE_CHANGE_MAX];
    uint32_t count;
} take_change;

/* Comma-separated patterns, or names of regions: into own of the edit. */
CHECKED mrt_result take_read_own(take_call *call, const char *text, edit *out, error *err);
/* What a take shows, as material for an edit: the clip that is shown at from_ns. */
CHECKED mrt_result take_read_regions(take_call *call, const char *text, uint32_t *out, error *err);

#endif
