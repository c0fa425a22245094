/* check/child/stream.h - the frames of a performance that never was: hands at random within what
 * hands can do, pedals, triggers, parameters. A function of its seed: a copy goes on as the
 * original does. Positions come from the host's own kinematics. */
#ifndef MAROTTE_CHECK_CHILD_STREAM_H
#define MAROTTE_CHECK_CHILD_STREAM_H
#include <marotte/plugin.h>

typedef enum stream_kind {
    STREAM_WALK = 0, /* both hands wander; pedals; hands come and go; parameters as they begin */
    STREAM_RESTLESS, /* and all parameters change at random, within their ranges */
    STREAM_EXTREMES, /* joints at the ends of their ranges and beyond, from one frame to the next */
    STREAM_CALM,     /* hands stay and move slowly; triggers and pedals are pressed */
    STREAM_ABSENT,   /* no hand at all; pedals and triggers */
    STREAM_ONE_HAND  /* the right hand alone comes and goes */
} stream_kind;

enum { STREAM_PARAMS_MAX = 1024 };
typedef struct stream_hand {
    double angle[MRT_ANGLES], goal[MRT_ANGLES]; /* rad */
    double wrist_mm[3], wrist_goal_mm[3];
    double speed; /* share of the way to the goal in a frame */
    int64_t time_ns;
    bool present;
} stream_hand;
typedef struct stream {
    stream_kind kind;
    uint64_t random;
    const mrt_plugin_type *type;
    int64_t time_ns;
    uint32_t index;
    uint32_t next_press; /* STREAM_CALM */
    stream_hand hand[2];
    float pedal[MRT_MAX_PEDALS];
    double param[STREAM_PARAMS_MAX];
} stream;

/* False: no memory. Allocates at the first call; with stepped_random the stepped parameters are
 * chosen at random and stay. */
bool stream_begin(stream *out, stream_kind kind, uint64_t seed, const mrt_plugin_type *type);
void stream_shuffle_choices(stream *self);
/* The next frame; near and dt_s included. frame.params points into the stream. */
void stream_next(stream *self, mrt_frame *out);
const char *stream_name(stream_kind kind); /* "a random walk" */

#endif
