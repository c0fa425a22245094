/* plugins/devices/bare_hand.h - common part of inputs that track a bare hand: the parameters, the
 * 22 channels, the turn of the hand, the side shown last, and the samples. Leaves out the source of
 * the joints. One thread at a time. */
#ifndef MAROTTE_DEVICES_BARE_HAND_H
#define MAROTTE_DEVICES_BARE_HAND_H
#include <marotte/plugin.h>

/* Third value of the first parameter, after MRT_LEFT and MRT_RIGHT: the visible hand, used as a
 * right one. */
enum { BARE_HAND_EITHER = 2 };
enum { BARE_HAND_SIDE, BARE_HAND_WRIST, BARE_HAND_PARAMS };
#define BARE_HAND_SURE 0.5f /* a confidence below that may move no face: plugin.h */
/* After a change of hands the pose is held long enough for the face to ease to it. */
#define BARE_HAND_CHANGE_NS 300000000

extern const mrt_param bare_hand_params[BARE_HAND_PARAMS]; /* parameter table of such a plugin */

typedef struct bare_hand {
    const mrt_host *host;
    const mrt_landmark_reader *reader; /* NULL: the host does not convert landmarks */
    uint32_t wanted;                   /* MRT_LEFT, MRT_RIGHT, BARE_HAND_EITHER */
    mrt_channel channel[MRT_ANGLES];
    char name[MRT_ANGLES][24];
    bool has_asked_to_restart, follows_wrist;
    bool is_begun[2];
    float first[2][4]; /* orientation of each hand when first seen: quaternion x y z w */

    mrt_hand_reading reading; /* last accepted reading */
    uint32_t shown_side;      /* side of the hand shown last */
    bool has_shown;
    int64_t shown_ns;       /* device_clock_ns */
    int64_t host_offset_ns; /* the host's clock less device_clock_ns */

    bool has_given;
    int64_t last_ns;         /* of the last sample */
    uint32_t sequence, lost; /* lost: samples lost before the next one */
} bare_hand;

/* [main] For mrt_plugin_type.create. */
void bare_hand_init(bare_hand *out, const mrt_host *host);
/* [main] Returns false and logs an error if the host does not convert landmarks. */
bool bare_hand_has_reader(const bare_hand *self);
/* [main] Resets the state from the parameters, without any hand. */
void bare_hand_begin(bare_hand *self, const double *params);
/* Call before each reading. Channels are fixed while an input is open, so a changed hand parameter
 * requests a restart of the input. */
void bare_hand_follow(bare_hand *self, const double *params);
/* Writes the two wrist angles into the reading: the direction of the fingers, relative to when that
 * hand was first seen. The forearm is not visible, so turning the whole arm counts too. */
void bare_hand_turn(bare_hand *self, uint32_t side, mrt_hand_reading *reading);
/* Records that `reading` is of this hand, seen at time_ns (device_clock_ns). */
void bare_hand_show(bare_hand *self, uint32_t side, int64_t time_ns);
/* Writes the next sample, from `reading`. time_ns: the host's clock. */
void bare_hand_write_sample(bare_hand *self, int64_t time_ns, mrt_sample *out);

#endif
