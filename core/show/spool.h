/* show/spool.h - a ring of records from one thread to another, like base/ring.h, in memory that
 * survives a kill of the program. Records that were not committed can then be restored. The ring is
 * a file in /dev/shm, which uses no disk. Without that file it is an ordinary ring, and a kill
 * loses its records. Beside the ring are lanes with the newest records of other threads, which are
 * read only after a kill. Leaves out the meaning of the records (writer_store.h). Threads: see the
 * tags. */
#ifndef MAROTTE_TAKE_SPOOL_H
#define MAROTTE_TAKE_SPOOL_H
#include "base/error.h"
#include "base/os.h"

typedef struct spool spool;

typedef struct spool_shape {
    size_t record_size, lane_record_size;
    uint32_t record_count, lane_record_count; /* powers of two; lane_record_count 0: no lanes */
} spool_shape;
enum { SPOOL_LANES = 16 };

/* Creates the spool of the show file at this path. A show has one spool at a time, since it has one
 * writer. `context` is stored with the records. NULL: no memory. Also removes the spools of other
 * shows: spool_remove_abandoned. */
spool *spool_create(const os_file_id *of, const char *path, const spool_shape *shape,
                    int64_t context);
void spool_destroy(
    spool *self); /* removes its file too; all records are committed, or reported as lost */

/* [producer] Appends a record. Wait-free. Returns false if the ring is full, and counts the loss.
 */
bool spool_push(spool *self, const void *record);
/* [consumer] Pops the oldest record. Returns false if there is none. */
bool spool_pop(spool *self, void *out_record);
/* [consumer] Marks all popped records as committed. */
void spool_settle(spool *self);
/* [consumer] Returns the number of uncommitted records that survive a kill. */
uint32_t spool_left_count(const spool *self);
/* [any] Returns the number of records refused since creation. For tests: spool_push reports each
 * loss. */
uint32_t spool_loss_count(const spool *self);

/* ---- lanes: each holds the newest records of one thread. A number in each record shows whether it
 * has been processed elsewhere. A mark names the owner of a lane; 0: no owner ---- */

/* [any, while the lane has no producer] Empties the lane and removes its owner. */
void spool_lane_clear(spool *self, uint32_t lane);
/* [producer of the lane] Appends a record and overwrites the oldest. Wait-free. */
void spool_lane_push(spool *self, uint32_t lane, const void *record);
/* [any one thread] */
void spool_lane_mark(spool *self, uint32_t lane, int64_t whose);
void spool_lane_done(spool *self, uint32_t lane, uint32_t done);

/* State of a lane of a found spool: its last mark, and its number of records. */
typedef struct spool_lane {
    int64_t whose;
    uint32_t done, count;
} spool_lane;
spool_lane spool_lane_of(const spool *self, uint32_t lane);
void spool_lane_read(const spool *self, uint32_t lane, uint32_t index, void *out_record);

/* Finds the spool that a program left for the show because it was killed or could not write. NULL:
 * there is no usable one. The counts in `shape` are ignored. Uncommitted records are popped in
 * order. spool_destroy removes the file; spool_abandon keeps it for the next program. */
spool *spool_find(const os_file_id *of, const spool_shape *shape, int64_t *out_context);
void spool_abandon(spool *self);

/* Removes the user's spools that no program uses and none will need. Either all their records are
 * committed, or their show was deleted and they are unused for an hour. A spool is kept if its show
 * was renamed in its folder, or is on a disk that is not mounted. now_s: UTC. */
void spool_remove_abandoned(int64_t now_s);

#endif
