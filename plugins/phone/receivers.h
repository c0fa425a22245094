/* phone/receivers.h - receivers of the output iFacialMocap. A receiver sends one greeting and then
 * listens, and a greeting can be forged. So a receiver is removed when its computer reports that no
 * program listens, or 12 hours after its newest greeting. Pure; times are device_clock_ns's. Leaves
 * out sockets. */
#ifndef PLUGINS_PHONE_RECEIVERS_H
#define PLUGINS_PHONE_RECEIVERS_H
#include "udp.h"

enum { RECEIVERS_MAX = 8 };
enum {
    RECEIVER_REFUSES_S = 3, /* time after which a report that no program listens is accepted: the
                               program may be starting */
    RECEIVER_LASTS_S = 12 * 3600
};

typedef struct receiver {
    udp_peer at;
    bool has_version_2, is_named; /* is_named: set by the user, never removed */
    int64_t greeted_ns;
    int64_t refused_since_ns,
        refused_ns;    /* first and last report that no program listens; 0: none */
    int64_t absent_ns; /* last time that the computer did not answer; 0: never */
} receiver;

typedef struct receivers {
    receiver of[RECEIVERS_MAX];
    uint32_t count;
} receivers;

typedef enum receiver_admission {
    RECEIVER_HAS_NO_PLACE = 0,
    RECEIVER_IS_NEW,
    RECEIVER_IS_KNOWN
} receiver_admission;

receiver *receivers_find(receivers *self, const udp_peer *at); /* NULL: unknown */
/* Adds or renews a receiver after a greeting. If all places are used, replaces a receiver whose
 * computer does not answer; of several, the one with the oldest greeting. */
receiver_admission receivers_greeted(receivers *self, const udp_peer *at, bool has_version_2,
                                     int64_t now_ns);

/* Records the system's error report for a datagram to this receiver: an errno. */
void receivers_failed(receivers *self, const udp_peer *at, int error, int64_t now_ns);

typedef enum receiver_end { RECEIVER_STAYS = 0, RECEIVER_REFUSED, RECEIVER_EXPIRED } receiver_end;
/* Removes one receiver whose time is over. Call again until RECEIVER_STAYS. */
receiver_end receivers_forget_one(receivers *self, int64_t now_ns, udp_peer *out_at);

#endif
