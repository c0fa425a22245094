/* stage/mapping/instance.h - one instance of a plugin: its `self`, the host functions that it
 * calls, and the values of its parameters, which the host owns. Leaves out the specific parts of
 * inputs (input.h) and mappings (performer.h). An instance must not move in memory between create
 * and destroy. Threads as marked. */
#ifndef MAROTTE_STAGE_INSTANCE_H
#define MAROTTE_STAGE_INSTANCE_H
#include "base/log.h"
#include "stage/mapping/services.h"

#include <pthread.h>
#include <stdatomic.h>

/* Clock that the plugin sees. */
typedef enum instance_clock {
    CLOCK_REAL = 0, /* the monotonic clock */
    CLOCK_VIRTUAL   /* starts at 0 and jumps to the end of each wait of the plugin: as fast as
                       possible */
} instance_clock;

/* A hand as an input saw it last: landmarks that it had converted to angles. */
typedef struct hand_sight {
    mrt_landmarks seen;
    float confidence; /* of the conversion, 0..1 */
    int64_t time_ns;  /* of the conversion, of the real clock; 0: none yet */
} hand_sight;

typedef struct instance {
    const mrt_plugin_type *type; /* must be first, see services.h */
    mrt_plugin *self;
    mrt_host host;
    services_reader reader; /* created when the plugin requests it */
    hand_sight sight;       /* guarded by `mutex` */
    log_queue *log;         /* borrowed */
    instance_clock clock;
    int64_t virtual_ns;
    _Atomic double *wanted;     /* current parameter values, set by [any] */
    double *params;             /* values for the plugin, copied by instance_latch */
    _Atomic uintptr_t listener; /* thread that captures the plugin's log; 0: none */
    error *heard;               /* of the listener: last error; or NULL */
    log_once *already_logged;   /* of the listener: texts that are not logged again; or NULL */
    bool can_restart;           /* the caller uses instance_pop_restart */
    _Atomic bool restart_asked;
    pthread_mutex_t mutex; /* guards `sight`, and `stopping` during a wait */
    pthread_cond_t wake;
    bool stopping;
    const _Atomic bool *stop; /* borrowed; like `stopping`, but polled; or NULL */
} instance;

/* [main] `log` must outlive the instance. On failure the error contains the text that the plugin
 * logged. */
CHECKED mrt_result instance_create(instance *out, const mrt_plugin_type *type, instance_clock clock,
                                   log_queue *log, error *err);
/* [main] Accepts a zeroed instance. */
void instance_destroy(instance *self);

/* [main] Sets a parameter: "gain" or "placement.up", to a number such as "1.5" or to a label of a
 * stepped parameter. The error lists the alternatives. The key is the name in lower case with '_'
 * for blanks. If two parameters share a name, the key begins with the group and a '.'. */
CHECKED mrt_result instance_set_text(instance *self, const char *key, const char *value,
                                     error *err);
/* [main] Sets all of "key=value,key=value". "" sets nothing. */
CHECKED mrt_result instance_set_list(instance *self, const char *list, error *err);
/* [any] Sets a parameter by its index in the type's table. Limits the value to its range and steps.
 * Ignores NaN. */
void instance_set_value(instance *self, uint32_t index, double value);
/* [any] Returns the last set value. The plugin sees it with its next call. */
double instance_value(const instance *self, uint32_t index);
/* [any] Copies the values of another version of the plugin, matched by parameter id. Buttons are
 * not copied. */
void instance_copy_values(instance *to, const instance *from);
/* [any] Writes the key of a parameter for instance_set_text, with its group if needed. Shortened to
 * fit any capacity. */
void instance_key(const mrt_plugin_type *type, uint32_t index, char *out, size_t capacity);
/* [any] Presses a trigger parameter: it is 1 for exactly one call. */
void instance_trigger(instance *self, uint32_t index);

/* [thread that calls the plugin] Call before each call of the plugin: copies the wanted values to
 * params. A trigger is copied once and returns to its initial value. */
void instance_latch(instance *self);

/* [thread that calls the plugin] Call before and after calls of the plugin. In between, the last
 * error that it logs from this thread goes to out_heard instead of the log. Its other texts are
 * logged except those in `already_logged` (NULL: none). Both must stay valid until
 * instance_listen_end. */
void instance_listen(instance *self, error *out_heard, log_once *already_logged);
void instance_listen_end(instance *self);

/* The face as the mapping sees it. */
typedef struct mapped_face {
    mrt_face about;
    const mrt_rig_pose *pose; /* all poses of the rig */
    uint32_t pose_count;
} mapped_face;
/* [main] Activates a mapping on this face, which must stay valid until deactivation. The error
 * contains the text that the plugin logged. */
CHECKED mrt_result instance_activate(instance *self, const mapped_face *mapped, error *err);
void instance_deactivate(instance *self);

/* [thread that calls the plugin] Returns whether the plugin requested a restart since the last
 * call. */
bool instance_pop_restart(instance *self);

/* [any] Copies the last hand that the plugin had converted (MRT_LANDMARKS). False: none yet. */
bool instance_sight(instance *self, hand_sight *out);

/* [any] Ends the current wait of the plugin and all later ones immediately. A wait that returns
 * early tells the plugin that the host is stopping. */
void instance_stop_waiting(instance *self);
bool instance_is_stopping(instance *self);
/* [thread that calls the plugin] Same as the plugin's own wait_until_ns. */
int64_t instance_wait_until_ns(instance *self, int64_t time_ns);

#endif
