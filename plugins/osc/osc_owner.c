#include "osc_owner.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>

static const int64_t silence_ns = 1000000000;

bool osc_peer_equals(const osc_peer *a, const osc_peer *b)
{
    return a->port == b->port && memcmp(a->ip, b->ip, sizeof a->ip) == 0;
}

void osc_peer_text(const osc_peer *peer, char *out, size_t capacity)
{
    static const uint8_t mapped[12] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
    char ip[INET6_ADDRSTRLEN] = "?";
    if (memcmp(peer->ip, mapped, sizeof mapped) == 0) {
        inet_ntop(AF_INET, peer->ip + sizeof mapped, ip, sizeof ip);
        snprintf(out, capacity, "%s:%u", ip, (unsigned)peer->port);
    } else {
        inet_ntop(AF_INET6, peer->ip, ip, sizeof ip);
        snprintf(out, capacity, "[%s]:%u", ip, (unsigned)peer->port);
    }
}

bool osc_owner_is(const osc_owner *owner, const osc_peer *peer)
{
    return owner->known && osc_peer_equals(&owner->peer, peer);
}

void osc_owner_release(osc_owner *owner)
{
    *owner = (osc_owner){0};
}

static bool is_silent(int64_t heard_ns, int64_t now_ns)
{
    return now_ns - heard_ns > silence_ns;
}

bool osc_owner_admits(osc_owner *owner, const osc_peer *peer, int64_t now_ns)
{
    if (!osc_owner_is(owner, peer)) {
        if (owner->known && !is_silent(owner->heard_ns, now_ns))
            return false;
        *owner = (osc_owner){.known = true, .established = true, .peer = *peer};
    }
    owner->heard_ns = now_ns;
    return true;
}

static bool is_back(const osc_owner *owner, const osc_peer *peer, int64_t now_ns)
{
    return owner->former_known && osc_peer_equals(&owner->former, peer) &&
           !is_silent(owner->former_heard_ns, now_ns);
}

bool osc_owner_admits_single(osc_owner *owner, const osc_peer *peer, int64_t now_ns)
{
    bool holds = owner->known && !is_silent(owner->heard_ns, now_ns);
    if (osc_owner_is(owner, peer)) {
        owner->established = holds;
        owner->heard_ns = now_ns;
        return true;
    }
    if (holds && owner->established)
        return false;
    *owner = (osc_owner){.known = true,
                         .established = is_back(owner, peer, now_ns),
                         .former_known = holds,
                         .peer = *peer,
                         .former = owner->peer,
                         .heard_ns = now_ns,
                         .former_heard_ns = owner->heard_ns};
    return true;
}
