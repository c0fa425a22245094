/* stage/mapping/isolate_process.h - one child process with a mapping in it: started, asked, ended.
 * Leaves out what becomes of a performance when it fails (isolate.h). Threads as marked; [host] is
 * the thread that starts and ends it: the child dies with that thread. */
#ifndef MAROTTE_STAGE_ISOLATE_PROCESS_H
#define MAROTTE_STAGE_ISOLATE_PROCESS_H
#include "stage/mapping/isolate_wire.h"

#include <sys/types.h>
#include <time.h>

/* A type whose instances run in processes of their own. */
typedef struct isolate_outer {
    mrt_plugin_type type; /* first: types are found by it */
    const mrt_plugin_type *inner;
    char *library;
    mrt_interface interfaces[6];
} isolate_outer;

typedef struct isolate_process {
    isolate_block *block; /* NULL: none was started */
    pid_t pid;            /* 0: none runs */
    int pidfd;            /* readable once it has ended; -1 */
    clockid_t cpu;        /* its processor time */
    uint32_t log_seen;
} isolate_process;

/* [host] Of marotte-pluginhost: $MAROTTE_PLUGINHOST, beside this program, or in the build folder.
 */
CHECKED mrt_result isolate_process_start(isolate_process *out, const char *library,
                                         const char *type_id, error *err);
/* [host] Kills it. out_how: "was ended by signal 11 (Segmentation fault)"; may be NULL. */
void isolate_process_end(isolate_process *self, error *out_how);
/* [host] After the end: the memory. */
void isolate_process_finish(isolate_process *self);
/* [host] It was seen to end: whoever waits for its answer stops waiting. */
void isolate_process_tell_dead(isolate_process *self);

/* [any one thread] Hands the request over; the block is the child's until it has answered. */
void isolate_process_ask(isolate_process *self, uint32_t kind);
/* MRT_OK: it has answered, see block->result; MRT_TIMEOUT; MRT_ERR_IO: it has ended. Spins for some
 * microseconds before it sleeps. */
mrt_result isolate_process_wait_until_ns(isolate_process *self, int64_t time_ns);
/* [host] Asks and waits, and notices the child's end by itself. What it answered, or MRT_ERR_IO. */
mrt_result isolate_process_call(isolate_process *self, uint32_t kind, int64_t patience_ns);
/* [host] Waits for its end so long. */
bool isolate_process_has_ended(const isolate_process *self, int timeout_ms);
/* Processor time that it has used; 0 when that cannot be known. */
int64_t isolate_process_cpu_ns(const isolate_process *self);

/* Passes on what it has logged since the last call. */
void isolate_process_drain(isolate_process *self, const mrt_host *to);
/* The last error that it has logged; false: none, and `out` stays. */
bool isolate_process_why(const isolate_process *self, error *out);

#endif
