/* base/ring.h - a ring of fixed-size records from exactly one producing thread to exactly one
 * consuming thread; wait-free on both sides. A full ring refuses. */
#ifndef MAROTTE_BASE_RING_H
#define MAROTTE_BASE_RING_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct ring ring;

/* `record_count` is rounded up to a power of two. NULL: no memory. */
ring *ring_create(size_t record_size, uint32_t record_count);
void ring_destroy(ring *self);

/* [producer] Copies the record in; false when the ring is full. */
bool ring_push(ring *self, const void *record);
/* [consumer] Copies the oldest record out and keeps it; false when there is none. */
bool ring_peek(ring *self, void *out_record);
/* [consumer] As ring_peek, and removes it. */
bool ring_pop(ring *self, void *out_record);

#endif
