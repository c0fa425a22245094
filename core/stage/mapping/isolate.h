/* stage/mapping/isolate.h - runs a mapping or a face output in its own process. The isolated type
 * is used like any other type and gives the same bits; isolate_output.h has more about outputs.
 * While a mapping's answer is late, calls return MRT_HOLD, and the answer is used when it arrives.
 * The mapping fails if it crashes, returns an invalid pull, or hangs. It hangs if it owes an answer
 * for one second, or for three seconds if its process got no processor time. After a failure the
 * face keeps its last pose and a report of the last inputs is written (isolate_report.h). A new
 * process replaces the failed one once (ISOLATE_TAKEOVER). After a second failure within a minute,
 * the face keeps its last pose. */
#ifndef MAROTTE_STAGE_ISOLATE_H
#define MAROTTE_STAGE_ISOLATE_H
#include "stage/mapping/instance.h"

typedef struct isolate isolate;

typedef enum isolate_which {
    ISOLATE_FOREIGN = 0, /* plugins that are not shipped with the program */
    ISOLATE_ALL,
    ISOLATE_NONE
} isolate_which;
/* Returns whether a type of that library must be isolated. library NULL or "": built in. */
bool isolate_is_wanted(isolate_which which, const char *library);

typedef struct isolate_settings {
    instance_clock clock; /* CLOCK_VIRTUAL: calls wait for the answer until the hang timeout */
    int64_t deadline_ns;  /* longest wait of a frame in real time; 0: 3 ms */
    bool writes_reports;
} isolate_settings;

/* [main] Wraps a type. library: the file of `inner`, which the child process loads again. Create
 * instances of the wrapped type with instance_create only. */
CHECKED mrt_result isolate_create_mapping(isolate **out, const mrt_plugin_type *inner,
                                          const char *library, const isolate_settings *settings,
                                          error *err);
CHECKED mrt_result isolate_create_output(isolate **out, const mrt_plugin_type *inner,
                                         const char *library, error *err);
void isolate_destroy(isolate *self); /* call after its instances are destroyed; accepts NULL */
/* Valid until destroy. */
const mrt_plugin_type *isolate_type(const isolate *self);

/* An interface that only these types have. The layer uses it to crossfade when another process
 * takes over. */
#define ISOLATE_TAKEOVER "marotte.stage.takeover/1"
typedef struct isolate_takeover {
    /* [frame] Call before process, except during a crossfade. Returns whether the pull comes from
     * another process from this call on. May set `pull`, the input of process, to the last pull of
     * that process. */
    bool (*take_over)(mrt_plugin *self, mrt_pull *pull);
    const mrt_plugin_type *(*inner)(const mrt_plugin_type *outer); /* returns the wrapped type */
} isolate_takeover;

/* Returns the wrapped type, or the type itself if it is not isolated. */
const mrt_plugin_type *isolate_inner(const mrt_plugin_type *type);

typedef struct isolate_counts {
    uint32_t failed, restarted; /* number of processes */
    uint32_t late;              /* frames that kept the last pose because the answer was late */
    bool is_away;               /* the process is not available: the face keeps its last pose */
} isolate_counts;
/* [any] self: an instance of an isolated mapping. */
isolate_counts isolate_counted(const mrt_plugin *self);
/* [any] Returns the reason of the first failure, such as "gave a radius that is not a length". "":
 * no failure. */
const char *isolate_first_reason(const mrt_plugin *self);
/* [main] For offline use, where a failure must not be hidden. Returns an error with the reason of
 * the first failure. MRT_OK for an instance that is not isolated. */
CHECKED mrt_result isolate_check(const instance *of, error *err);
int32_t isolate_pid(const mrt_plugin *self); /* of its child process, for tests; 0: none */

#endif
