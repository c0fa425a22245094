/* plugins/devices/udp_owner.h - who may send one thing (a face, the angles of a hand, the pedals):
 * of two senders at a time the first, until it has been silent for a second. Pure. Shared by input
 * plugins. */
#ifndef MAROTTE_DEVICES_UDP_OWNER_H
#define MAROTTE_DEVICES_UDP_OWNER_H
#include "udp.h"

typedef struct udp_owner {
    bool known, established, former_known;
    udp_peer peer, former;
    int64_t heard_ns, former_heard_ns;
} udp_owner;

/* Whether what the peer sends now counts; if so it has been heard. */
bool udp_owner_admits(udp_owner *owner, const udp_peer *peer, int64_t now_ns);
/* As above, but a program that sends once and is gone, as `oscsend` does, holds nothing: a sender
 * is established when it has sent twice within the second. */
bool udp_owner_admits_single(udp_owner *owner, const udp_peer *peer, int64_t now_ns);
/* Whether the peer is the one that counts, without hearing it. */
bool udp_owner_is(const udp_owner *owner, const udp_peer *peer);
void udp_owner_release(udp_owner *owner);

#endif
