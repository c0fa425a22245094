/* check/child/fixture.h - what plugins are tried with: a host that listens to them, faces usual and
 * odd, and hands that move in many ways. The same seed gives the same. One thread. */
#ifndef MAROTTE_CHECK_CHILD_FIXTURE_H
#define MAROTTE_CHECK_CHILD_FIXTURE_H
#include <marotte/plugin.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- random numbers ---- */

uint32_t random_below(uint64_t *state, uint32_t count); /* count > 0 */
void random_bytes(uint64_t *state, void *out, size_t size);

/* ---- the host ---- */

typedef enum host_clock {
    HOST_REAL = 0, /* the monotonic clock */
    HOST_JUMPING,  /* goes to where the plugin waits, and only there */
    HOST_LATE,     /* as HOST_JUMPING, but overshoots by some ms: a busy machine */
    HOST_STOPPING  /* does not wait: the host is about to stop */
} host_clock;

typedef struct host {
    mrt_host plugin; /* what the plugin is given */
    host_clock clock;
    int64_t now_ns;        /* of a clock that is not real */
    int64_t latest_ask_ns; /* the furthest moment that it asked to wait for */
    uint32_t wait_count;
    uint32_t error_count; /* lines that explain: errors and warnings */
    char last_log[256];   /* the last of them; "" */
} host;

/* It must not move. */
void host_init(host *out, host_clock clock, int64_t start_ns);
int64_t host_now_ns(const host *self);
/* ": what it said last", or "": for the end of a sentence. */
const char *host_words(const host *self, char out[300]);

/* ---- faces ---- */

typedef enum face_kind {
    FACE_USUAL = 0, /* 27 contacts, jaw, eyes and lids: the names of rigs/README.md */
    FACE_BARE,      /* no contact, no degree of freedom: a mesh without a rig */
    FACE_ONE,       /* one contact, one degree of freedom */
    FACE_FULL,      /* 64 contacts, MRT_MAX_DOFS degrees of freedom */
    FACE_NO_JAW,    /* contacts, nothing of a jaw */
    FACE_FLAT,      /* no depth at all */
    FACE_TINY,      /* half a millimetre high */
    FACE_HUGE,      /* a hundred metres high */
    FACE_AWAY,      /* 2 m beside the origin */
    FACE_KINDS
} face_kind;

/* Static data: stays. */
const mrt_face *faces_of(face_kind kind);
const char *faces_name(face_kind kind); /* "a flat face" */

/* ---- poses of a rig ---- */

typedef struct face_poses {
    const mrt_rig_pose *pose;
    uint32_t count;
} face_poses;

/* Of one of these faces: of the mouth, of the upper half, of both; a mesh without a rig has none.
 * Static data: stays. */
face_poses faces_poses(const mrt_face *face);

/* A copy in pages of its own, that can be made unreadable. */
typedef struct posed_pages {
    void *pages; /* stay mapped */
    size_t size;
    face_poses poses;
} posed_pages;
/* The first `count` of them, with pulls and degrees of freedom times `scale`. Without any the
 * pointer is one that cannot be read. False: no memory. */
bool posed_pages_create(posed_pages *out, const mrt_face *face, uint32_t count, float scale);
void posed_pages_forbid(posed_pages *self); /* a read crashes */

/* The host's guard: nothing is pulled further from the face's centre than this, mm. */
double faces_reach_mm(const mrt_face *face, double out_centre[3]);

/* ---- hands ---- */

typedef enum stream_kind {
    STREAM_WALK = 0, /* both hands wander; pedals; hands come and go; parameters as they begin */
    STREAM_RESTLESS, /* and all parameters change at random, within their ranges */
    STREAM_EXTREMES, /* joints at the ends of their ranges and beyond, from one frame to the next */
    STREAM_CALM,     /* hands stay and move slowly; triggers and pedals are pressed */
    STREAM_ABSENT,   /* no hand at all; pedals and triggers */
    STREAM_ONE_HAND  /* the right hand alone comes and goes */
} stream_kind;

enum { STREAM_PARAMS_MAX = 1024, STREAM_INPUTS = 2 };
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
    uint64_t channel_random;
    float channel[STREAM_INPUTS][MRT_MAX_CHANNELS]; /* a fader box, a phone */
    mrt_channels input[STREAM_INPUTS];
} stream;

/* False: no memory. Allocates at the first call; with stepped_random the stepped parameters are
 * chosen at random and stay. */
bool stream_begin(stream *out, stream_kind kind, uint64_t seed, const mrt_plugin_type *type);
void stream_shuffle_choices(stream *self);
/* The next frame; near and dt_s included. frame.params points into the stream. */
void stream_next(stream *self, mrt_frame *out);
const char *stream_name(stream_kind kind); /* "a random walk" */

#endif
