/* base/ring.h - a ring buffer of fixed-size records with one producer thread and one consumer
 * thread; wait-free on both sides. A full ring rejects records. */
#ifndef MAROTTE_BASE_RING_H
#define MAROTTE_BASE_RING_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct ring ring;

/* `record_count` is rounded up to a power of two. NULL: no memory. */
ring *ring_create(size_t record_size, uint32_t record_count);
void ring_destroy(ring *self);

/* [producer] Appends a copy of the record. Returns false if the ring is full. */
bool ring_push(ring *self, const void *record);
/* [consumer] Copies the oldest record without removing it. Returns false if there is none. */
bool ring_peek(ring *self, void *out_record);
/* [consumer] The same, and removes the record. */
bool ring_pop(ring *self, void *out_record);

#endif
