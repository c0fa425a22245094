/* stage/mapping/isolate.h - a mapping or a face output in a process of its own, as a type like any
 * other: whoever uses it sees no difference, and the same bits. Of outputs isolate_output.h says
 * more. While the answer of a mapping is late, calls give MRT_HOLD, and it goes on from there when
 * it comes. When it crashes, gives nonsense or hangs (owes an answer for a second, or for three if
 * its process had no turn), the face is held, what it saw is written down (isolate_report.h), and a
 * new process takes over once (ISOLATE_TAKEOVER). A second failure within a minute: the face stays
 * held. */
#ifndef MAROTTE_STAGE_ISOLATE_H
#define MAROTTE_STAGE_ISOLATE_H
#include "stage/mapping/instance.h"

typedef struct isolate isolate;

typedef enum isolate_which {
    ISOLATE_FOREIGN = 0, /* what did not come with the program */
    ISOLATE_ALL,
    ISOLATE_NONE
} isolate_which;
/* Whether a type of that library is to be isolated. NULL, "": it is part of the program. */
bool isolate_is_wanted(isolate_which which, const char *library);

typedef struct isolate_settings {
    instance_clock clock; /* virtual: nobody waits for it, its deadline is that of a hang */
    int64_t deadline_ns;  /* that a frame waits at most, in real time; 0: 3 ms */
    bool writes_reports;
} isolate_settings;

/* [main] library: from which `inner` was loaded; the child loads it again. Only instances made by
 * instance_create can be of the type that comes out. */
CHECKED mrt_result isolate_create_mapping(isolate **out, const mrt_plugin_type *inner,
                                          const char *library, const isolate_settings *settings,
                                          error *err);
CHECKED mrt_result isolate_create_output(isolate **out, const mrt_plugin_type *inner,
                                         const char *library, error *err);
void isolate_destroy(isolate *self); /* after its instances; NULL is fine */
/* Until destroy. */
const mrt_plugin_type *isolate_type(const isolate *self);

/* An interface of these types alone: the layer has to know when a new process takes over, so that
 * the face is blended from one to the other. */
#define ISOLATE_TAKEOVER "marotte.stage.takeover/1"
typedef struct isolate_takeover {
    /* [frame] Before process, unless a blend is still going on: whether another process fills the
     * pull from this call on. `pull` is what process will be given; it may be changed to what that
     * one held last. */
    bool (*take_over)(mrt_plugin *self, mrt_pull *pull);
    const mrt_plugin_type *(*inner)(const mrt_plugin_type *outer); /* the type that was wrapped */
} isolate_takeover;

/* The type that was wrapped, or the type itself. */
const mrt_plugin_type *isolate_inner(const mrt_plugin_type *type);

typedef struct isolate_counts {
    uint32_t failed, restarted; /* processes */
    uint32_t late;              /* frames that were held because it had not answered */
    bool is_away;               /* no process answers now: the face is held */
} isolate_counts;
/* [any] Of an instance of such a type, a mapping. */
isolate_counts isolate_counted(const mrt_plugin *self);
/* [any] Why it failed first, "gave a radius that is not a length"; "": it has not. */
const char *isolate_first_reason(const mrt_plugin *self);
/* [main] Offline nothing is to go on as if nothing had happened: an error that says why its process
 * failed first, if it has. MRT_OK for any other instance. */
CHECKED mrt_result isolate_check(const instance *of, error *err);
int32_t isolate_pid(const mrt_plugin *self); /* of its child, which tests kill; 0: none is in use */

#endif
