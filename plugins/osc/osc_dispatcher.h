/* plugins/osc/osc_dispatcher.h - where packets that come in at one port are opened, and what they
 * say is handed to who listens. Keeps the forwarded sources that speak there, and counts what was
 * wrong. Knows no socket: packets, peers and times are told. Not thread-safe: the port guards it.
 */
#ifndef MAROTTE_OSC_DISPATCHER_H
#define MAROTTE_OSC_DISPATCHER_H
#include "osc_listener.h"

enum { OSC_SOURCES_MAX = 16 };

typedef struct osc_dispatcher {
    osc_source source[OSC_SOURCES_MAX];
    osc_listener *listeners;
    uint32_t fault_count[OSC_FAULT_KINDS];
    uint32_t late_count, double_count, untold_count; /* samples that were dropped */

    osc_event event; /* of the packet being taken, and what follows */
    const udp_peer *peer;
    int64_t now_ns;
    const mrt_host *host; /* to whom the first fault of each kind is said */
} osc_dispatcher;

void osc_dispatcher_start(osc_dispatcher *self);
/* A listener that joins late learns what is known of the source that it wants. */
void osc_dispatcher_join(osc_dispatcher *self, osc_listener *listener, int64_t now_ns);
void osc_dispatcher_leave(osc_dispatcher *self, osc_listener *listener);
/* Takes one packet; `bytes` are not changed. Only host->log is used. */
void osc_dispatcher_take(osc_dispatcher *self, void *bytes, size_t size, const udp_peer *peer,
                         int64_t now_ns, const mrt_host *host);
/* "cyberglove ttyUSB0, pedal": who is forwarded here and not silent; "" nobody. */
void osc_dispatcher_name_sources(const osc_dispatcher *self, int64_t now_ns, char *out,
                                 size_t capacity);

#endif
