/* stage/mapping/taught.h - saves and restores the taught values of a mapping (MRT_STATE: poses,
 * gestures). They are stored in each state of a recording (playback/replay.h), in presets, and as a
 * note of the show for the next session. [main], or any one thread that may read the show and owns
 * the mapping. */
#ifndef MAROTTE_STAGE_TAUGHT_H
#define MAROTTE_STAGE_TAUGHT_H
#include "stage/mapping/instance.h"
#include "show/show.h"

enum { TAUGHT_BYTES_MAX = 1 << 16 };

/* Like mrt_state. 0: the mapping cannot be taught, or the values exceed TAUGHT_BYTES_MAX. */
size_t taught_save(const instance *mapping, void *bytes, size_t capacity);
/* Returns an error if the mapping refuses the bytes; it is unchanged then. */
CHECKED mrt_result taught_load(const instance *mapping, const void *bytes, size_t size, error *err);

/* Returns the bytes in hexadecimal, for a note or a preset. The caller frees it. NULL: out of
 * memory. */
char *taught_text(const void *bytes, size_t size);
/* Decodes in place: the bytes replace the beginning of `text`. Returns their count. 0: invalid
 * text. */
size_t taught_parse_text(char *text);

/* Stores the taught values in the show, for its next session. Does nothing if the show is
 * read-only. */
CHECKED mrt_result taught_keep(show *into, const mrt_plugin_type *type, const void *bytes,
                               size_t size, error *err);
/* Same for a mapping that no other thread uses now. Errors are logged. */
void taught_keep_now(show *into, const instance *mapping, log_queue *log);
/* Restores the values that the show has. Errors are logged. of NULL: does nothing. */
void taught_restore(show *of, const instance *mapping, log_queue *log);

#endif
