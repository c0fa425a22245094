/* stage/mapping/isolate_process.h - one child process that runs a plugin: start, requests, end.
 * Leaves out the reaction to a failure (isolate.h). Threads as marked; [host] is the thread that
 * starts and ends the process. The child process dies with that thread. */
#ifndef MAROTTE_STAGE_ISOLATE_PROCESS_H
#define MAROTTE_STAGE_ISOLATE_PROCESS_H
#include "stage/mapping/isolate_wire.h"

#include <sys/types.h>
#include <time.h>

/* A type whose instances run in their own processes. */
typedef struct isolate_outer {
    mrt_plugin_type type; /* must be first: the type is cast to isolate_outer */
    const mrt_plugin_type *inner;
    char *library;
    mrt_interface interfaces[6];
} isolate_outer;

typedef struct isolate_process {
    isolate_block *block; /* NULL: not started */
    pid_t pid;            /* 0: not running */
    int pidfd;            /* readable after the process has ended; -1: none */
    clockid_t cpu;        /* processor time of the process */
    uint32_t log_seen;
} isolate_process;

/* [host] Starts marotte-pluginhost from $MAROTTE_PLUGINHOST, the program's folder, or the build
 * folder. */
CHECKED mrt_result isolate_process_start(isolate_process *out, const char *library,
                                         const char *type_id, error *err);
/* [host] Kills the process. out_how (may be NULL): such as "was ended by signal 11 (Segmentation
 * fault)". */
void isolate_process_end(isolate_process *self, error *out_how);
/* [host] Call after isolate_process_end: frees the memory. */
void isolate_process_finish(isolate_process *self);
/* [host] Marks the process as ended, so that a thread that waits for its answer stops waiting. */
void isolate_process_mark_dead(isolate_process *self);

/* [any one thread] Sends a request. The child owns the block until it has answered. */
void isolate_process_send(isolate_process *self, uint32_t kind);
/* Waits for the answer. MRT_OK: see block->result; MRT_ERR_IO: the process has ended. Spins for
 * some microseconds before it sleeps. */
mrt_result isolate_process_wait_until_ns(isolate_process *self, int64_t time_ns);
/* [host] Sends a request and waits. Detects the end of the process itself. Returns the result of
 * the child, or MRT_ERR_IO. */
mrt_result isolate_process_call(isolate_process *self, uint32_t kind, int64_t patience_ns);
/* [host] Waits up to timeout_ms for the end of the process. */
bool isolate_process_has_ended(const isolate_process *self, int timeout_ms);
/* Returns the processor time of the process; 0: unknown. */
int64_t isolate_process_cpu_ns(const isolate_process *self);

/* Forwards the log lines since the last call. */
void isolate_process_drain(isolate_process *self, const mrt_host *to);
/* Copies the last error that the process logged. False: none, and `out` is unchanged. */
bool isolate_process_last_error(const isolate_process *self, error *out);

#endif
