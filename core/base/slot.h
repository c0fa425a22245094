/* base/slot.h - a publish slot (triple buffer): one thread publishes whole values, another takes
 * the newest; neither ever waits. The values live in the caller's three buffers. */
#ifndef MAROTTE_BASE_SLOT_H
#define MAROTTE_BASE_SLOT_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct publish_slot {
    _Atomic uint32_t middle; /* index of the buffer in the middle, + 4 when it is fresh */
    uint32_t back;           /* the publisher's */
    uint32_t front;          /* the taker's */
} publish_slot;

void slot_init(publish_slot *slot);
/* [publisher] Index (0..2) of the buffer to fill. */
uint32_t slot_back(const publish_slot *slot);
/* [publisher] The buffer filled becomes the newest. */
void slot_publish(publish_slot *slot);
/* [taker] Makes the newest value the front one; false when nothing new came. */
bool slot_take(publish_slot *slot);
/* [taker] Index of the buffer to read. */
uint32_t slot_front(const publish_slot *slot);

#endif
