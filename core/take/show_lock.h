/* take/show_lock.h - who may write a show: an advisory lock on NAME.marotte-lock, which says who
 * holds it. The system lets go of it when the holder ends, however it ends, so it is never stale.
 */
#ifndef MAROTTE_TAKE_SHOW_LOCK_H
#define MAROTTE_TAKE_SHOW_LOCK_H
#include "base/error.h"

typedef struct show_lock {
    int fd; /* -1: not held */
    char *path;
} show_lock;

typedef enum show_lock_state {
    SHOW_LOCK_HELD = 0,
    SHOW_LOCK_OTHERS, /* `who` says whose: "process 4711 on studio since 2026-11-21 18:54:23 UTC" */
    SHOW_LOCK_REFUSED, /* the lock file cannot be made here: `who` says why */
} show_lock_state;

/* Never waits. `out` is to be let go whatever comes back. */
show_lock_state show_lock_take(show_lock *out, const char *show_path, char who[256]);
void show_lock_let_go(show_lock *lock); /* accepts one that was never taken, zeroed or with fd -1 */

#endif
