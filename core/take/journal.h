/* take/journal.h - lets go of what was recorded, is old, and no take holds on to: in small steps,
 * so that nobody waits for it, and giving the space back to the disk. Leaves out everything that a
 * span of a take needs, that of deleted takes too, what a replay needs to start there, and the next
 * samples on both sides of it. */
#ifndef MAROTTE_TAKE_JOURNAL_H
#define MAROTTE_TAKE_JOURNAL_H
#include "take/sqlite.h"

typedef struct journal {
    int64_t length_ns;
    int64_t looked_at_id; /* chunks up to this one were looked at: takes never need less later */
} journal;

/* One step, in the caller's transaction. now_ns: show time of the newest sample. *out_is_done:
 * there is nothing more to look at now. */
CHECKED mrt_result journal_step(journal *self, sqlite *db, int64_t now_ns, bool *out_is_done,
                                error *err);
/* One step, outside of a transaction: gives free pages back where there are many. */
CHECKED mrt_result journal_shrink(sqlite *db, error *err);

#endif
