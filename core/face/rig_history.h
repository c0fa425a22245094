/* face/rig_history.h - a rig that is being edited, with what it was before each change: numbered
 * states, 0 the first. The newest RIG_HISTORY_MAX are kept. [any], one at a time */
#ifndef MAROTTE_FACE_RIG_HISTORY_H
#define MAROTTE_FACE_RIG_HISTORY_H
#include "face/rig.h"

enum { RIG_HISTORY_MAX = 256 };
typedef struct rig_history rig_history;

/* Takes `first` over, also on error. */
CHECKED mrt_result rig_history_create(rig_history **out, rig *first, error *err);
void rig_history_destroy(rig_history *self); /* NULL is fine */

const rig *rig_history_now(const rig_history *self); /* until the next change */
uint64_t rig_history_number(const rig_history *self);
/* The rig as changed (a rig_copy of the one now) becomes the next state, and is taken over. States
 * that were undone are forgotten. */
void rig_history_push(rig_history *self, rig *changed);
/* Goes to a state that is kept; false: it is not. */
bool rig_history_go(rig_history *self, uint64_t number);

#endif
