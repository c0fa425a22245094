/* stage/mapping/instance.h - one plugin at work: its self, the host that it sees, and the values of
 * its parameters, which the host owns. Leaves out what is particular to inputs (input.h) and
 * mappings (performer.h). It must not move in memory between create and destroy. Threads as marked.
 */
#ifndef MAROTTE_STAGE_INSTANCE_H
#define MAROTTE_STAGE_INSTANCE_H
#include "base/log.h"
#include "stage/mapping/services.h"

#include <pthread.h>
#include <stdatomic.h>

/* What clock the plugin lives by. */
typedef enum instance_clock {
    CLOCK_REAL = 0, /* the monotonic clock */
    CLOCK_VIRTUAL   /* starts at 0 and jumps to wherever the plugin waits: as fast as possible */
} instance_clock;

typedef struct instance {
    const mrt_plugin_type *type; /* first: services.h */
    mrt_plugin *self;
    mrt_host host;
    services_reader reader; /* made when the plugin asks for it */
    log_queue *log;         /* the caller's */
    instance_clock clock;
    int64_t virtual_ns;
    _Atomic double *wanted;     /* parameter values as set by [any] */
    double *params;             /* as the plugin sees them: latched by the thread that calls it */
    _Atomic uintptr_t listener; /* the thread that listens to what the plugin logs; 0: none */
    error *heard;               /* the listener's: the last error; or NULL */
    log_once *already_logged;   /* the listener's: what it need not hear again; or NULL */
    bool can_restart;           /* whether anybody asks instance_take_restart */
    _Atomic bool restart_asked;
    pthread_mutex_t mutex; /* guards stopping, for the wait */
    pthread_cond_t wake;
    bool stopping;
    const _Atomic bool *stop; /* the caller's, as `stopping` but looked at now and then; or NULL */
} instance;

/* [main] `log` must outlive it. On failure the plugin's own words are in the error. */
CHECKED mrt_result instance_create(instance *out, const mrt_plugin_type *type, instance_clock clock,
                                   log_queue *log, error *err);
/* [main] Accepts a zeroed instance. */
void instance_destroy(instance *self);

/* [main] "gain" / "placement.up" and "1.5" or a label of a stepped parameter. The error lists what
 * there is. The key is the parameter's name in lower case with '_' for blanks; with its group and a
 * '.' before it where two share a name. */
CHECKED mrt_result instance_set_text(instance *self, const char *key, const char *value,
                                     error *err);
/* [main] "key=value,key=value": every one of them; "" sets nothing. */
CHECKED mrt_result instance_set_list(instance *self, const char *list, error *err);
/* [any] The same by its index in the type's table: made a value that it may have. What is no number
 * changes nothing. */
void instance_set_value(instance *self, uint32_t index, double value);
/* [any] As set last; the plugin sees it from its next call on. */
double instance_value(const instance *self, uint32_t index);
/* [any] The values of another version of it, by the ids of the parameters; buttons stay. */
void instance_copy_values(instance *to, const instance *from);
/* [any] Writes the key of a parameter as instance_set_text takes it: with its group where it must
 * be. Any capacity; cut where it does not fit. */
void instance_key(const mrt_plugin_type *type, uint32_t index, char *out, size_t capacity);
/* [any] A press of the trigger parameter: 1 for exactly one call. */
void instance_trigger(instance *self, uint32_t index);

/* [the thread that calls the plugin] Before each call: takes the wanted values over; after a call
 * of process, triggers fall back to 0. */
void instance_latch(instance *self);

/* [the thread that calls the plugin] Around calls into the plugin: the last error that it logs from
 * this thread goes to out_heard instead of the log, and of its other lines those that
 * `already_logged` remembers are dropped (NULL: none). Both must live until instance_listen_end. */
void instance_listen(instance *self, error *out_heard, log_once *already_logged);
void instance_listen_end(instance *self);

/* The face as a mapping sees it. */
typedef struct mapped_face {
    mrt_face about;
    const mrt_rig_pose *pose; /* of the rig, complete */
    uint32_t pose_count;
} mapped_face;
/* [main] Activates a mapping on this face, which must outlive the activation. An error quotes the
 * plugin. */
CHECKED mrt_result instance_activate(instance *self, const mapped_face *mapped, error *err);
void instance_deactivate(instance *self);

/* [the thread that calls the plugin] Whether it asked to be closed and opened since the last call.
 */
bool instance_take_restart(instance *self);

/* [any] Ends every wait of the plugin at once, and every later one: a wait that returns early says
 * that the host is stopping. */
void instance_stop_waiting(instance *self);
/* [any] */
bool instance_is_stopping(instance *self);
/* [the thread that calls the plugin] As the plugin's own wait_until_ns. */
int64_t instance_wait_until_ns(instance *self, int64_t time_ns);

#endif
