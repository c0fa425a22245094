/* stage/mapping/isolate_state.h - what an isolated mapping is made of, and the thread that keeps
 * its process. Inside isolate*.c.
 *
 * Who has what: while RUNNING the thread that calls the plugin has all of it; from FAILED on the
 * keeper has all but the fallback, until READY, when the caller may take it back, or LOST. */
#ifndef MAROTTE_STAGE_ISOLATE_STATE_H
#define MAROTTE_STAGE_ISOLATE_STATE_H
#include "base/clock.h"
#include "stage/guard.h"
#include "stage/mapping/isolate_fallback.h"
#include "stage/mapping/isolate_link.h"
#include "stage/mapping/isolate_report.h"

#include <pthread.h>

enum { ISOLATE_RUNNING = 1, ISOLATE_FAILED, ISOLATE_READY, ISOLATE_LOST };

struct mrt_plugin {
    const mrt_host *host;
    const mrt_plugin_type *inner;
    const char *library;
    bool is_virtual, can_resume, writes_reports;
    int64_t deadline_ns;
    uint32_t param_count;

    _Atomic uint32_t phase;
    _Atomic uint32_t failed_count, restarted_count, late_count;
    _Atomic int32_t pid;

    isolate_link link;
    guard guard;
    mrt_pull held; /* by the child's last answer */
    bool has_held;
    bool is_to_reset; /* before the next request */
    uint32_t owed;    /* the request that the child still owes an answer to; 0: none */
    bool has_saved;   /* the block's bytes are the answer to saved_kind */
    uint32_t saved_kind;
    int32_t late_score;
    bool is_late_told;
    uint32_t held_frames; /* in a row, for one late answer */
    bool has_turn;        /* the layer knows that it comes back */
    int64_t asked_ns, asked_cpu_ns;
    double params[ISOLATE_PARAMS_MAX]; /* of the last frame */
    isolate_memory memory;
    char reason[160];       /* why it has failed; "ended": as the process did */
    char first_reason[160]; /* of the first failure; written before failed_count says so */

    unsigned char *resume; /* MRT_RESUME, and the pull held then; ISOLATE_BYTES of room */
    uint32_t resume_size;  /* 0: none */
    mrt_pull resume_pull;
    bool has_asked_resume;
    int64_t resume_asked_ns;

    isolate_fallback fallback; /* the caller's */
    bool is_forgotten;         /* the caller's: reset was called while the child was away */

    pthread_mutex_t busy; /* held by [main] functions, and by the keeper while it recovers */
    const mrt_face *face; /* under busy; NULL: not active */
    void *state;          /* under busy: MRT_STATE as loaded last */
    size_t state_size;

    /* the keeper's */
    pthread_t keeper;
    int wake_fd;
    pthread_mutex_t start_mutex;
    pthread_cond_t start_cond;
    int start; /* 0: not yet, 1: it runs, -1: failed */
    error start_error;
    _Atomic bool is_stopping;
    bool has_failed_before;
    int64_t failed_ns;
};

/* ---- isolate_call.c: by the caller, while it is running ---- */
bool isolate_call_runs(const mrt_plugin *self);
/* The block is the child's until it has answered. MRT_TIMEOUT: it owes that; MRT_ERR_IO: it ended.
 */
CHECKED mrt_result isolate_call_put(mrt_plugin *self, uint32_t kind, int64_t until_ns);
/* As put: the block is free, and a reset that was put off is done. An answer owed is dropped. */
CHECKED mrt_result isolate_call_settle(mrt_plugin *self, int64_t until_ns);
/* Both. */
CHECKED mrt_result isolate_call_settled(mrt_plugin *self, uint32_t kind, int64_t patience_ns);
/* Both, and no answer is a failure; the result is the child's. Not for process. */
mrt_result isolate_call_ask(mrt_plugin *self, uint32_t kind, int64_t patience_ns);
/* From here on the keeper has all but the fallback. frame: NULL: none. */
void isolate_call_fail(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *held,
                       const char *reason);
/* Pulls nothing. */
mrt_pull isolate_call_idle(void);

/* ---- isolate_keeper.c ---- */
/* [main] Returns when the child has created the plugin, or has not: that is logged. */
CHECKED mrt_result isolate_keeper_start(mrt_plugin *self);
/* [main] Ends the child, and the thread. */
void isolate_keeper_stop(mrt_plugin *self);
/* [any] wait-free: there is something to do. */
void isolate_keeper_wake(mrt_plugin *self);

#endif
