/* check/child/fixture.h - test data for plugins: a host that records messages, usual and unusual
 * faces, and hands that move in many ways. The same seed gives the same data. One thread. */
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
    HOST_JUMPING,  /* jumps to the time that the plugin waits for */
    HOST_LATE,     /* like HOST_JUMPING, but some ms late: a busy machine */
    HOST_STOPPING  /* does not wait: the host is stopping */
} host_clock;

typedef struct host {
    mrt_host plugin; /* the host for the plugin */
    host_clock clock;
    int64_t now_ns;        /* of a simulated clock */
    int64_t latest_ask_ns; /* latest time that the plugin waited for */
    uint32_t wait_count;
    uint32_t error_count; /* number of logged errors and warnings */
    char last_log[256];   /* the last of these lines; "" */
} host;

/* Must not move. */
void host_init(host *out, host_clock clock, int64_t start_ns);
int64_t host_now_ns(const host *self);
/* Returns ": last message", or "", to append to a text. */
const char *host_words(const host *self, char out[300]);

/* ---- faces ---- */

typedef enum face_kind {
    FACE_USUAL = 0, /* 27 contacts, jaw, eyes and lids: the names of rigs/README.md */
    FACE_BARE,      /* no contact, no degree of freedom: a mesh without a rig */
    FACE_ONE,       /* one contact, one degree of freedom */
    FACE_FULL,      /* 64 contacts, MRT_MAX_DOFS degrees of freedom */
    FACE_NO_JAW,    /* contacts, but no jaw */
    FACE_FLAT,      /* without depth */
    FACE_TINY,      /* half a millimetre high */
    FACE_HUGE,      /* a hundred metres high */
    FACE_AWAY,      /* 2 m away from the origin */
    FACE_KINDS
} face_kind;

/* Returns static data. */
const mrt_face *faces_of(face_kind kind);
const char *faces_name(face_kind kind); /* "a flat face" */

/* ---- poses of a rig ---- */

typedef struct face_poses {
    const mrt_rig_pose *pose;
    uint32_t count;
} face_poses;

/* Returns poses for one of these faces: of the mouth, of the upper half, of both. A mesh without a
 * rig has none. Static data. */
face_poses faces_poses(const mrt_face *face);

/* A copy in separate pages, which can be made unreadable. */
typedef struct posed_pages {
    void *pages; /* stay mapped */
    size_t size;
    face_poses poses;
} posed_pages;
/* Copies the first `count` poses, with pulls and degrees of freedom times `scale`. If count is 0,
 * the pointer is unreadable. Returns false if there is no memory. */
bool posed_pages_create(posed_pages *out, const mrt_face *face, uint32_t count, float scale);
void posed_pages_forbid(posed_pages *self); /* makes the pages unreadable: reading crashes */

/* Returns the limit of the host's guard: the greatest distance of a pull from the centre of the
 * face, mm. */
double faces_reach_mm(const mrt_face *face, double out_centre[3]);

/* ---- hands ---- */

typedef enum stream_kind {
    STREAM_WALK = 0, /* both hands wander; pedals; hands come and go; initial parameters */
    STREAM_RESTLESS, /* and all parameters change at random, within their ranges */
    STREAM_EXTREMES, /* joints at and beyond the ends of their ranges, different in each frame */
    STREAM_CALM,     /* hands stay and move slowly; triggers and pedals are pressed */
    STREAM_ABSENT,   /* no hand; pedals and triggers */
    STREAM_ONE_HAND  /* only the right hand, which comes and goes */
} stream_kind;

enum { STREAM_PARAMS_MAX = 1024, STREAM_INPUTS = 2 };
typedef struct stream_hand {
    double angle[MRT_ANGLES], goal[MRT_ANGLES]; /* rad */
    double wrist_mm[3], wrist_goal_mm[3];
    double speed; /* share of the distance to the goal in each frame */
    int64_t time_ns;
    bool present;
} stream_hand;
typedef struct stream {
    stream_kind kind;
    uint64_t random;
    const mrt_plugin_type *type;
    int64_t time_ns;
    uint32_t index;
    uint32_t next_press; /* for STREAM_CALM */
    stream_hand hand[2];
    float pedal[MRT_MAX_PEDALS];
    double param[STREAM_PARAMS_MAX];
    uint64_t channel_random;
    float channel[STREAM_INPUTS][MRT_MAX_CHANNELS]; /* of a fader box and a phone */
    mrt_channels input[STREAM_INPUTS];
} stream;

/* Returns false if there is no memory. Allocates at the first call. With stepped_random, stepped
 * parameters get random values, which then stay. */
bool stream_begin(stream *out, stream_kind kind, uint64_t seed, const mrt_plugin_type *type);
void stream_shuffle_choices(stream *self);
/* Makes the next frame, with near and dt_s. frame.params points into the stream. */
void stream_next(stream *self, mrt_frame *out);
const char *stream_name(stream_kind kind); /* "a random walk" */

#endif
