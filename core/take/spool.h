/* take/spool.h - a ring of records from one thread to another, as base/ring.h, in memory that the
 * system keeps when the program is killed: what had not been committed then is found again. It is a
 * file in /dev/shm, which touches no disk; without one it is a ring like any other, and a kill
 * loses what was in it. For the writer. */
#ifndef MAROTTE_TAKE_SPOOL_H
#define MAROTTE_TAKE_SPOOL_H
#include "base/error.h"

#include <sys/stat.h>

typedef struct spool spool;

/* For the show that is this file; one at a time, as there is one writer. `record_count` is a power
 * of two; `context` comes back with the records. NULL: no memory. */
spool *spool_create(const struct stat *of, size_t record_size, uint32_t record_count,
                    int64_t context);
void spool_destroy(spool *self); /* with its file: all is committed, or said to be lost */

/* [producer] Wait-free; false, and one more loss, when it is full. */
bool spool_push(spool *self, const void *record);
/* [consumer] Takes the oldest record; false when there is none. */
bool spool_pop(spool *self, void *out_record);
/* [consumer] All that was taken is committed. */
void spool_settle(spool *self);
/* [consumer] Records that are not settled, as far as they outlive the program. */
uint32_t spool_left_count(const spool *self);
/* [any] Records refused since creation; for tests: spool_push says it of each. */
uint32_t spool_loss_count(const spool *self);

/* What a program left for the show that was killed, or could not write; NULL: nothing that can be
 * used. The records that were not settled are popped in order; destroy removes the file, abandon
 * leaves it for the next time. */
spool *spool_find(const struct stat *of, size_t record_size, int64_t *out_context);
void spool_abandon(spool *self);

#endif
