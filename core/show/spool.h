/* show/spool.h - a ring of records from one thread to another, as base/ring.h, in memory that the
 * system keeps when the program is killed: what had not been committed then is found again. It is a
 * file in /dev/shm, which touches no disk; without one it is a ring like any other, and a kill
 * loses what was in it. Beside the ring are lanes: the newest records of other threads, which only
 * a kill makes of use. For the writer. */
#ifndef MAROTTE_TAKE_SPOOL_H
#define MAROTTE_TAKE_SPOOL_H
#include "base/error.h"

#include <sys/stat.h>

typedef struct spool spool;

typedef struct spool_shape {
    size_t record_size, lane_record_size;
    uint32_t record_count, lane_record_count; /* powers of two; of a lane 0: there are no lanes */
} spool_shape;
enum { SPOOL_LANES = 16 };

/* For the show that is this file at this path; one at a time, as there is one writer. `context`
 * comes back with the records. NULL: no memory. Removes what other shows left, too:
 * spool_remove_abandoned. */
spool *spool_create(const struct stat *of, const char *path, const spool_shape *shape,
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

/* ---- lanes: each the newest records of one thread. What has been dealt with otherwise is said by
 * a number that the records carry; whose they are, by a mark, 0: nobody's ---- */

/* [no producer of the lane] Empties it, and it is nobody's. */
void spool_lane_clear(spool *self, uint32_t lane);
/* [producer of the lane] Wait-free; the oldest record makes room. */
void spool_lane_push(spool *self, uint32_t lane, const void *record);
/* [any one thread] */
void spool_lane_mark(spool *self, uint32_t lane, int64_t whose);
void spool_lane_done(spool *self, uint32_t lane, uint32_t done);

/* Of one that was found: what was marked last, and so many records. */
typedef struct spool_lane {
    int64_t whose;
    uint32_t done, count;
} spool_lane;
spool_lane spool_lane_of(const spool *self, uint32_t lane);
void spool_lane_read(const spool *self, uint32_t lane, uint32_t index, void *out_record);

/* What a program left for the show that was killed, or could not write; NULL: nothing that can be
 * used; counts of the shape do not matter. The records that were not settled are popped in order;
 * destroy removes the file, abandon leaves it for the next time. */
spool *spool_find(const struct stat *of, const spool_shape *shape, int64_t *out_context);
void spool_abandon(spool *self);

/* Removes this user's spools that no program uses and nobody will ask for: all in it is settled, or
 * its show was deleted and it has been unused for an hour. A show that was renamed in its folder,
 * or lies on a disk that is not there now, keeps its spool. now_s: UTC. */
void spool_remove_abandoned(int64_t now_s);

#endif
