/* plugins/osc/osc_owner.h - who may send one thing (a source, the angles of a hand, the pedals):
 * of two senders at a time the first, until it has been silent for a second. Pure. */
#ifndef MAROTTE_OSC_OWNER_H
#define MAROTTE_OSC_OWNER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct osc_peer {
    uint8_t ip[16]; /* IPv4 as ::ffff:a.b.c.d */
    uint16_t port;
} osc_peer;

bool osc_peer_equals(const osc_peer *a, const osc_peer *b);
enum { OSC_PEER_TEXT = 56 };
void osc_peer_text(const osc_peer *peer, char *out, size_t capacity); /* "10.0.0.2:4711" */

typedef struct osc_owner {
    bool known, established, former_known;
    osc_peer peer, former;
    int64_t heard_ns, former_heard_ns;
} osc_owner;

/* Whether what the peer sends now counts; if so it has been heard. */
bool osc_owner_admits(osc_owner *owner, const osc_peer *peer, int64_t now_ns);
/* As above, but a program that sends once and is gone, as `oscsend` does, holds nothing: a sender
 * is established when it has sent twice within the second. */
bool osc_owner_admits_single(osc_owner *owner, const osc_peer *peer, int64_t now_ns);
/* Whether the peer is the one that counts, without hearing it. */
bool osc_owner_is(const osc_owner *owner, const osc_peer *peer);
void osc_owner_release(osc_owner *owner);

#endif
