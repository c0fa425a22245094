/* A dispatcher of plugins/osc with a host that keeps what it is told, two peers, and a clock of the
 * test's own: packets in, samples out, no socket. */
#ifndef TESTS_DEVICE_OSC_ROOM_H
#define TESTS_DEVICE_OSC_ROOM_H
#include "osc_bytes.h"
#include "osc_dispatcher.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct osc_room {
    mrt_host host;
    int said[4]; /* by level */
    char last_text[512];
    osc_dispatcher dispatcher;
    osc_listener listener;
    int64_t now_ns;
} osc_room;

static const udp_peer osc_room_one = {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 10, 0, 0, 2},
                                      4711};
static const udp_peer osc_room_two = {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 10, 0, 0, 3},
                                      4712};

static inline void osc_room_log(const mrt_host *host, int32_t level, const char *text)
{
    osc_room *self = host->data;
    self->said[level] += 1;
    snprintf(self->last_text, sizeof self->last_text, "%s", text);
}

static inline osc_room *osc_room_create(void)
{
    osc_room *self = calloc(1, sizeof *self);
    self->host = (mrt_host){.data = self, .log = osc_room_log};
    self->now_ns = 1000000000000;
    osc_dispatcher_start(&self->dispatcher);
    return self;
}

static inline osc_room *osc_room_simple(uint32_t side, osc_content content)
{
    osc_room *self = osc_room_create();
    osc_listener_start_simple(&self->listener, side, content);
    osc_dispatcher_join(&self->dispatcher, &self->listener, self->now_ns);
    return self;
}

static inline osc_room *osc_room_forwarded(const char *wanted)
{
    osc_room *self = osc_room_create();
    osc_listener_start_forwarded(&self->listener, wanted);
    osc_dispatcher_join(&self->dispatcher, &self->listener, self->now_ns);
    return self;
}

/* Hands the packet over and empties it. */
static inline void osc_room_take(osc_room *self, const udp_peer *peer, osc_bytes *packet)
{
    osc_dispatcher_process(&self->dispatcher, packet->data, packet->size, peer, self->now_ns,
                           &self->host);
    packet->size = 0;
}

static inline uint32_t osc_room_faults(const osc_room *self)
{
    uint32_t sum = 0;
    for (int i = 0; i < OSC_FAULT_KINDS; ++i)
        sum += self->dispatcher.fault_count[i];
    return sum;
}

#endif
