#include "osc_sender.h"

#include <string.h>

enum { HEAD = 16, SIZE_FIELD = 4 };
static const uint64_t epoch_s = 2208988800; /* from 1900 to 1970 */
static const uint64_t ns_per_s = 1000000000;

static void put_big_endian(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; ++i)
        at[i] = (unsigned char)(value >> (24 - 8 * i));
}

static void flush(osc_sender *self)
{
    if (self->size <= HEAD)
        return;
    mrt_result result = udp_sender_send(&self->to, self->bundle, self->size);
    if (result < 0 || self->worst == MRT_OK)
        self->worst = result;
    self->size = 0;
}

static void start(osc_sender *self)
{
    memcpy(self->bundle, "#bundle", 8);
    put_big_endian(self->bundle + 8, (uint32_t)(self->tag >> 32));
    put_big_endian(self->bundle + 12, (uint32_t)self->tag);
    self->size = HEAD;
}

void osc_sender_begin(osc_sender *self, int64_t utc_ns)
{
    uint64_t ns = utc_ns > 0 ? (uint64_t)utc_ns : 0;
    self->tag = utc_ns > 0 ? (ns / ns_per_s + epoch_s) << 32 | ((ns % ns_per_s) << 32) / ns_per_s
                           : 1; /* immediately */
    self->size = 0;
    self->worst = MRT_OK;
}

void osc_sender_add(osc_sender *self, osc_builder *message, const char *address)
{
    unsigned char bytes[OSC_BUNDLE_MAX - HEAD - SIZE_FIELD];
    size_t size = osc_builder_finish(message, address, bytes, sizeof bytes);
    if (size == 0)
        return; /* no memory: the next frame says it again */
    if (self->size > HEAD && self->size + SIZE_FIELD + size > OSC_BUNDLE_MAX)
        flush(self);
    if (self->size == 0)
        start(self);
    put_big_endian(self->bundle + self->size, (uint32_t)size);
    memcpy(self->bundle + self->size + SIZE_FIELD, bytes, size);
    self->size += SIZE_FIELD + size;
}

mrt_result osc_sender_end(osc_sender *self)
{
    flush(self);
    return self->worst;
}
