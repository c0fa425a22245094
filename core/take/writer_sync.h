/* take/writer_sync.h - a thread that waits for the disk, so that no one else does: once a second it
 * brings what was committed to the disk, moves it from the log into the show where the log has
 * grown long, and looks whether the file is still there. For the writer. */
#ifndef MAROTTE_TAKE_WRITER_SYNC_H
#define MAROTTE_TAKE_WRITER_SYNC_H
#include "take/show_file.h"

typedef struct writer_sync writer_sync;

CHECKED mrt_result writer_sync_start(writer_sync **out, const show *s, error *err);
void writer_sync_stop(writer_sync *self); /* NULL is fine */
/* [any] The file under the show's name is not the one that is open. */
bool writer_sync_is_missing(const writer_sync *self);

#endif
