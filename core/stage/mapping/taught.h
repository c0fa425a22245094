/* stage/mapping/taught.h - what a mapping was taught (MRT_STATE: poses, gestures), kept: with each
 * state of a performance that is recorded (playback/replay.h), with presets, and as a note of the show,
 * from which the next session goes on. [main], or any one thread that may read the show and has the
 * mapping.
 */
#ifndef MAROTTE_STAGE_TAUGHT_H
#define MAROTTE_STAGE_TAUGHT_H
#include "stage/mapping/instance.h"
#include "show/show.h"

enum { TAUGHT_BYTES_MAX = 1 << 16 };

/* As mrt_state; 0: it cannot be taught, or it is more than TAUGHT_BYTES_MAX. */
size_t taught_save(const instance *mapping, void *bytes, size_t capacity);
/* An error: it refuses it, and is as before. */
CHECKED mrt_result taught_load(const instance *mapping, const void *bytes, size_t size, error *err);

/* The bytes in hexadecimal, for a note or a preset. To be freed; NULL: no memory. */
char *taught_text(const void *bytes, size_t size);
/* In place; the bytes, at the beginning of `text`, are counted. 0: it is no such text. */
size_t taught_of_text(char *text);

/* What it was taught by now is what another session of the show goes on from. Does nothing to a
 * show that cannot be written. */
CHECKED mrt_result taught_keep(show *into, const mrt_plugin_type *type, const void *bytes,
                               size_t size, error *err);
/* The same of a mapping that no thread performs with now; what goes wrong is logged. */
void taught_keep_now(show *into, const instance *mapping, log_queue *log);
/* The mapping is taught what was kept; what it refuses is logged. of: NULL: nothing. */
void taught_recall(show *of, const instance *mapping, log_queue *log);

#endif
