/* one_hand/stored.h - neutral poses as bytes, for presets and takes. Little-endian, with a sum;
 * whatever else comes is refused. [main] */
#ifndef MAROTTE_PLUGINS_ONE_HAND_STORED_H
#define MAROTTE_PLUGINS_ONE_HAND_STORED_H
#include "reading.h"

typedef struct neutral {
    bool is_known;
    reading pose;
} neutral;

/* out may be NULL: the size it takes. Writes nothing when capacity is less. */
size_t stored_write(void *out, size_t capacity, const neutral hands[2]);
/* False: not bytes of stored_write; hands are untouched. */
bool stored_read(neutral hands[2], const void *bytes, size_t size);

#endif
