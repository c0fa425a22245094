/* plugins/osc/osc_sender.h - OSC messages to one place, in bundles that fit a datagram of any
 * network. One thread at a time. */
#ifndef MAROTTE_OSC_SENDER_H
#define MAROTTE_OSC_SENDER_H
#include "osc_wire.h"
#include "udp.h"

enum { OSC_BUNDLE_MAX = 1400 }; /* bytes: under an Ethernet frame's 1 500 with its headers */

typedef struct osc_sender {
    udp_sender to; /* opened and closed as such */
    unsigned char bundle[OSC_BUNDLE_MAX];
    size_t size; /* 0: no bundle is begun */
    uint64_t tag;
    mrt_result worst; /* of the bundles of this frame */
} osc_sender;

/* A frame begins; utc_ns: of its bundles' time tags, ns since 1970; OSC_NO_TIME: immediately. */
void osc_sender_begin(osc_sender *self, int64_t utc_ns);
/* Ends the message. A bundle that it does not fit into is sent before it. */
void osc_sender_add(osc_sender *self, osc_builder *message, const char *address);
/* Sends what is left: as udp_sender_send, the worst of the frame. */
mrt_result osc_sender_end(osc_sender *self);

#endif
