/* check/child/host.h - the host that a plugin under examination sees: it listens to what the plugin
 * says, and its clock is the real one, or one that jumps to wherever the plugin waits. */
#ifndef MAROTTE_CHECK_CHILD_HOST_H
#define MAROTTE_CHECK_CHILD_HOST_H
#include <marotte/plugin.h>

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
    char said[256];       /* the last of them; "" */
} host;

/* It must not move. */
void host_init(host *out, host_clock clock, int64_t start_ns);
int64_t host_now_ns(const host *self);
/* ": what it said last", or "": for the end of a sentence. */
const char *host_words(const host *self, char out[300]);

#endif
