#include "receivers.h"

#include <errno.h>
#include <string.h>

static const int64_t ns_per_s = 1000000000;
/* While datagrams are refused, the other computer reports it at least once per second. An address
 * without a computer is reported by this computer every three seconds. */
static const int64_t refusal_lasts_ns = 2500000000, absence_lasts_ns = 10000000000;

receiver *receivers_find(receivers *self, const udp_peer *at)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->of[i].at.port == at->port &&
            memcmp(self->of[i].at.ip, at->ip, sizeof at->ip) == 0)
            return &self->of[i];
    return NULL;
}

static bool is_absent(const receiver *r, int64_t now_ns)
{
    return r->absent_ns != 0 && now_ns - r->absent_ns <= absence_lasts_ns;
}

static bool is_refusing(const receiver *r, int64_t now_ns)
{
    return r->refused_ns != 0 && now_ns - r->refused_ns <= refusal_lasts_ns;
}

static receiver *find_absent(receivers *self, int64_t now_ns)
{
    receiver *found = NULL;
    for (receiver *r = self->of; r < self->of + self->count; ++r)
        if (!r->is_named && is_absent(r, now_ns) && (!found || r->greeted_ns < found->greeted_ns))
            found = r;
    return found;
}

receiver_admission receivers_greeted(receivers *self, const udp_peer *at, bool has_version_2,
                                     int64_t now_ns)
{
    receiver *known = receivers_find(self, at);
    if (known) {
        known->has_version_2 = has_version_2;
        known->greeted_ns = now_ns;
        return RECEIVER_IS_KNOWN;
    }
    receiver *place =
        self->count < RECEIVERS_MAX ? &self->of[self->count++] : find_absent(self, now_ns);
    if (!place)
        return RECEIVER_HAS_NO_PLACE;
    *place = (receiver){.at = *at, .has_version_2 = has_version_2, .greeted_ns = now_ns};
    return RECEIVER_IS_NEW;
}

void receivers_failed(receivers *self, const udp_peer *at, int error, int64_t now_ns)
{
    receiver *r = receivers_find(self, at);
    if (!r)
        return;
    if (error == EHOSTUNREACH || error == EHOSTDOWN || error == ENETUNREACH)
        r->absent_ns = now_ns;
    if (error != ECONNREFUSED)
        return;
    if (!is_refusing(r, now_ns))
        r->refused_since_ns = now_ns;
    r->refused_ns = now_ns;
}

static receiver_end end_of(const receiver *r, int64_t now_ns)
{
    if (r->is_named)
        return RECEIVER_STAYS;
    if (now_ns - r->greeted_ns >= RECEIVER_LASTS_S * ns_per_s)
        return RECEIVER_EXPIRED;
    return is_refusing(r, now_ns) &&
                   r->refused_ns - r->refused_since_ns >= RECEIVER_REFUSES_S * ns_per_s
               ? RECEIVER_REFUSED
               : RECEIVER_STAYS;
}

receiver_end receivers_forget_one(receivers *self, int64_t now_ns, udp_peer *out_at)
{
    for (receiver *r = self->of; r < self->of + self->count; ++r) {
        const receiver_end end = end_of(r, now_ns);
        if (end == RECEIVER_STAYS)
            continue;
        *out_at = r->at;
        *r = self->of[--self->count];
        return end;
    }
    return RECEIVER_STAYS;
}
