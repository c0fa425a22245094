/* phone/receivers.h - who gets the face of the output iFacialMocap. Receivers greet once, then they
 * listen, and a greeting may be forged: so one is forgotten when its computer reports that nobody
 * listens, or half a day after its newest greeting. Pure; times are device_clock_ns's. Leaves out
 * sockets. */
#ifndef PLUGINS_PHONE_RECEIVERS_H
#define PLUGINS_PHONE_RECEIVERS_H
#include "udp.h"

enum { RECEIVERS_MAX = 8 };
enum {
    RECEIVER_REFUSES_S = 3, /* that nobody listens is believed after so long: it may be starting */
    RECEIVER_LASTS_S = 12 * 3600
};

typedef struct receiver {
    udp_peer at;
    bool has_version_2, is_named; /* named by the person: never forgotten */
    int64_t greeted_ns;
    int64_t refused_since_ns, refused_ns; /* the reports that nobody listens; 0: none */
    int64_t absent_ns;                    /* that computer did not answer at all; 0: never */
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
/* A greeting. When all places are full, the receiver whose computer is away gives way; of several
 * the one that greeted longest ago. */
receiver_admission receivers_greeted(receivers *self, const udp_peer *at, bool has_version_2,
                                     int64_t now_ns);

/* What the system reports about a datagram that was sent there: an errno. */
void receivers_failed(receivers *self, const udp_peer *at, int error, int64_t now_ns);

typedef enum receiver_end { RECEIVER_STAYS = 0, RECEIVER_REFUSED, RECEIVER_EXPIRED } receiver_end;
/* Forgets one receiver whose time is over; again until RECEIVER_STAYS. */
receiver_end receivers_forget_one(receivers *self, int64_t now_ns, udp_peer *out_at);

#endif
