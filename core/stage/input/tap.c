#include "stage/input/tap.h"

#include "base/ring.h"

#include <stdatomic.h>
#include <stdlib.h>

typedef struct tap_record {
    mrt_sample sample;
    uint64_t request;
} tap_record;

struct tap {
    ring *records;
    _Atomic uint64_t request; /* index of the input in the lower 32 bits, number of the request in
                                 the upper 32 bits */
};

static uint64_t request_of(uint64_t number, uint32_t input)
{
    return number << 32 | input;
}

tap *tap_create(void)
{
    tap *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->records = ring_create(sizeof(tap_record), TAP_SAMPLES);
    atomic_init(&self->request, request_of(0, UINT32_MAX));
    if (self->records)
        return self;
    free(self);
    return NULL;
}

void tap_destroy(tap *self)
{
    if (!self)
        return;
    ring_destroy(self->records);
    free(self);
}

void tap_select(tap *self, uint32_t input)
{
    uint64_t number = atomic_load(&self->request) >> 32;
    atomic_store(&self->request, request_of(number + 1, input));
}

bool tap_pop(tap *self, mrt_sample *out)
{
    tap_record record;
    uint64_t request = atomic_load(&self->request);
    while (ring_pop(self->records, &record)) {
        if (record.request != request)
            continue;
        *out = record.sample;
        return true;
    }
    return false;
}

void tap_push(tap *self, uint32_t input, const mrt_sample *sample)
{
    uint64_t request = atomic_load_explicit(&self->request, memory_order_relaxed);
    if ((uint32_t)request != input || input == UINT32_MAX)
        return;
    const tap_record record = {*sample, request};
    (void)ring_push(self->records, &record);
}
