#include "udp_owner.h"

static const int64_t silence_ns = 1000000000;

bool udp_owner_is(const udp_owner *owner, const udp_peer *peer)
{
    return owner->known && udp_peer_equals(&owner->peer, peer);
}

void udp_owner_release(udp_owner *owner)
{
    *owner = (udp_owner){0};
}

static bool is_silent(int64_t heard_ns, int64_t now_ns)
{
    return now_ns - heard_ns > silence_ns;
}

bool udp_owner_admits(udp_owner *owner, const udp_peer *peer, int64_t now_ns)
{
    if (!udp_owner_is(owner, peer)) {
        if (owner->known && !is_silent(owner->heard_ns, now_ns))
            return false;
        *owner = (udp_owner){.known = true, .established = true, .peer = *peer};
    }
    owner->heard_ns = now_ns;
    return true;
}

static bool is_back(const udp_owner *owner, const udp_peer *peer, int64_t now_ns)
{
    return owner->former_known && udp_peer_equals(&owner->former, peer) &&
           !is_silent(owner->former_heard_ns, now_ns);
}

bool udp_owner_admits_single(udp_owner *owner, const udp_peer *peer, int64_t now_ns)
{
    bool holds = owner->known && !is_silent(owner->heard_ns, now_ns);
    if (udp_owner_is(owner, peer)) {
        owner->established = holds;
        owner->heard_ns = now_ns;
        return true;
    }
    if (holds && owner->established)
        return false;
    *owner = (udp_owner){.known = true,
                         .established = is_back(owner, peer, now_ns),
                         .former_known = holds,
                         .peer = *peer,
                         .former = owner->peer,
                         .heard_ns = now_ns,
                         .former_heard_ns = owner->heard_ns};
    return true;
}
