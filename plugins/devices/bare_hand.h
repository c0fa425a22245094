/* plugins/devices/bare_hand.h - what inputs of a bare hand share, whoever sees it: the parameters,
 * the 22 channels, how the hand is turned, which one was shown last, and its samples. Leaves out
 * where its joints come from. One thread at a time. */
#ifndef MAROTTE_DEVICES_BARE_HAND_H
#define MAROTTE_DEVICES_BARE_HAND_H
#include <marotte/plugin.h>

/* Beside MRT_LEFT and MRT_RIGHT, of the first parameter: whichever is seen, as a right one. */
enum { BARE_HAND_EITHER = 2 };
enum { BARE_HAND_SIDE, BARE_HAND_WRIST, BARE_HAND_PARAMS };
#define BARE_HAND_SURE 0.5f /* a confidence below that may move no face: plugin.h */
/* One hand for the other: it is held so long that the face eases over to it. */
#define BARE_HAND_CHANGE_NS 300000000

extern const mrt_param bare_hand_params[BARE_HAND_PARAMS]; /* the table of such a plugin */

typedef struct bare_hand {
    const mrt_host *host;
    const mrt_landmark_reader *reader; /* NULL: this host reads no landmarks */
    uint32_t wanted;                   /* MRT_LEFT, MRT_RIGHT, BARE_HAND_EITHER */
    mrt_channel channel[MRT_ANGLES];
    char name[MRT_ANGLES][24];
    bool has_asked_to_restart, follows_wrist;
    bool is_begun[2];
    float first[2][4]; /* how each was turned when it was first seen: quaternion x y z w */

    mrt_hand_reading reading; /* what was believed last */
    uint32_t shown_side;      /* whose hand was shown last */
    bool has_shown;
    int64_t shown_ns;       /* device_clock_ns */
    int64_t host_offset_ns; /* the host's clock less device_clock_ns */

    bool has_given;
    int64_t last_ns;         /* of the sample given last */
    uint32_t sequence, lost; /* lost: before the next sample */
} bare_hand;

/* [main] For mrt_plugin_type.create. */
void bare_hand_init(bare_hand *out, const mrt_host *host);
/* [main] False, which is said: this host reads no landmarks. */
bool bare_hand_can_be_read(const bare_hand *self);
/* [main] As the parameters say: no hand has been seen. */
void bare_hand_begin(bare_hand *self, const double *params);
/* Before each reading. Channels are fixed while an input is open: asks to be opened again for
 * another hand. */
void bare_hand_follow(bare_hand *self, const double *params);
/* Writes the two angles of the wrist into what was read: how the fingers point, beside how they did
 * when that hand was first seen. No forearm is seen: whoever turns it nods too. */
void bare_hand_turn(bare_hand *self, uint32_t side, mrt_hand_reading *reading);
/* `reading` is this hand's, as it was seen at time_ns (device_clock_ns). */
void bare_hand_show(bare_hand *self, uint32_t side, int64_t time_ns);
/* The next sample, of `reading`. time_ns: the host's clock. */
void bare_hand_give(bare_hand *self, int64_t time_ns, mrt_sample *out);

#endif
