#include "listener.h"
#include "device_io.h"

#include <stdio.h>

void listener_close(listener *self)
{
    microphone_close(self->from);
    self->from = NULL;
}

mrt_result listener_open(listener *self, const char *address, const char *called)
{
    char reason[MICROPHONE_REASON];
    listener_close(self);
    self->from = microphone_open(address ? address : "", reason);
    if (!self->from) {
        if (!self->has_told_loss)
            device_say(self->host, MRT_LOG_ERROR, "%s", reason[0] ? reason : "no memory");
        return MRT_ERR_IO;
    }
    self->device = (mrt_device){.state = MRT_DEVICE_READY};
    (void)snprintf(self->device.address, sizeof self->device.address, "%s",
                   address && address[0] ? address : "default");
    (void)snprintf(self->device.name, sizeof self->device.name, "%.13s %.48s", called,
                   self->device.address);
    clock_map_reset(&self->clock);
    self->frames = 0;
    self->has_told_loss = false;
    return MRT_OK;
}

static mrt_result lose(listener *self)
{
    device_say(self->host, MRT_LOG_ERROR, "%.100s went away: plug it in again", self->device.name);
    self->has_told_loss = true;
    listener_close(self);
    return MRT_ERR_IO;
}

mrt_result listener_read(listener *self, int64_t deadline_ns, int16_t *out, uint32_t capacity,
                         uint32_t *out_count)
{
    *out_count = 0;
    while (self->from) {
        const int count = microphone_read(self->from, out, capacity);
        const int64_t now_ns = self->host->now_ns(self->host);
        if (count > 0) {
            *out_count = (uint32_t)count;
            self->frames += count;
            self->time_ns = clock_map_to_host(&self->clock,
                                              self->frames * 1000000000 / MICROPHONE_RATE, now_ns);
            return MRT_OK;
        }
        if (count == 0 && now_ns >= deadline_ns)
            return MRT_TIMEOUT;
        if (count < 0 || !microphone_wait(self->from, deadline_ns - now_ns))
            return lose(self);
    }
    return MRT_ERR_IO;
}

uint32_t listener_list(const char *prefix, mrt_device *out, uint32_t capacity)
{
    const uint32_t count = microphone_list(out, capacity);
    for (uint32_t i = 0; i < count && i < capacity; ++i) {
        char name[sizeof out[i].name];
        (void)snprintf(name, sizeof name, "%s%.48s", prefix, out[i].name);
        (void)snprintf(out[i].name, sizeof out[i].name, "%s", name);
    }
    return count;
}

bool listener_current(const listener *self, mrt_device *out)
{
    *out = self->device;
    return self->from != NULL;
}
