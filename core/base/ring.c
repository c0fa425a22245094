#include "base/ring.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct ring {
    size_t record_size;
    uint32_t mask;
    _Atomic uint32_t written, read;
    unsigned char records[];
};

ring *ring_create(size_t record_size, uint32_t record_count)
{
    uint32_t count = 1;
    while (count < record_count && count < 1u << 30)
        count *= 2;
    ring *self = calloc(1, sizeof *self + record_size * count);
    if (!self)
        return NULL;
    self->record_size = record_size;
    self->mask = count - 1;
    return self;
}

void ring_destroy(ring *self)
{
    free(self);
}

bool ring_push(ring *self, const void *record)
{
    uint32_t written = atomic_load_explicit(&self->written, memory_order_relaxed);
    if (written - atomic_load_explicit(&self->read, memory_order_acquire) > self->mask)
        return false;
    memcpy(self->records + (written & self->mask) * self->record_size, record, self->record_size);
    atomic_store_explicit(&self->written, written + 1, memory_order_release);
    return true;
}

bool ring_peek(ring *self, void *out_record)
{
    uint32_t read = atomic_load_explicit(&self->read, memory_order_relaxed);
    if (read == atomic_load_explicit(&self->written, memory_order_acquire))
        return false;
    memcpy(out_record, self->records + (read & self->mask) * self->record_size, self->record_size);
    return true;
}

bool ring_pop(ring *self, void *out_record)
{
    if (!ring_peek(self, out_record))
        return false;
    uint32_t read = atomic_load_explicit(&self->read, memory_order_relaxed);
    atomic_store_explicit(&self->read, read + 1, memory_order_release);
    return true;
}
