/* base/slot.h - a publish slot (triple buffer): one thread publishes complete values, another
 * receives the newest one, and neither waits. The caller owns the three buffers. */
#ifndef MAROTTE_BASE_SLOT_H
#define MAROTTE_BASE_SLOT_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct publish_slot {
    _Atomic uint32_t middle; /* index of the middle buffer, + 4 if it is fresh */
    uint32_t back;           /* buffer of the publisher */
    uint32_t front;          /* buffer of the receiver */
} publish_slot;

void slot_init(publish_slot *slot);
/* [publisher] Returns the index (0..2) of the buffer to fill. */
uint32_t slot_back(const publish_slot *slot);
/* [publisher] Publishes the filled buffer as the newest. */
void slot_publish(publish_slot *slot);
/* [receiver] Moves the newest value to the front. Returns false if there is no new one. */
bool slot_receive(publish_slot *slot);
/* [receiver] Returns the index of the buffer to read. */
uint32_t slot_front(const publish_slot *slot);

#endif
