/* stage/input/input.h - an input plugin as a source of samples in time order: read by a thread of
 * its own through a ring (live), or called directly on a virtual clock (as fast as possible). A
 * device that goes away while it is read live is opened again until it is back. [main] unless
 * marked. */
#ifndef MAROTTE_STAGE_INPUT_H
#define MAROTTE_STAGE_INPUT_H
#include "stage/input/health.h"
#include "stage/input/sample_source.h"
#include "stage/input/wake.h"
#include "stage/mapping/instance.h"

typedef struct input input;

typedef enum input_state {
    INPUT_RUNNING = 0,
    INPUT_ENDED,  /* the take is over */
    INPUT_FAILED, /* it cannot go on: a record that cannot be read, a plugin that makes no sense */
    INPUT_LOST    /* the device went away: its thread tries to open it again */
} input_state;

typedef enum input_incident_kind {
    INPUT_NO_INCIDENT = 0,
    INPUT_WENT, /* the device went away; its pedals are up */
    INPUT_CAME  /* it is back */
} input_incident_kind;

typedef struct input_incident {
    input_incident_kind kind;
    int64_t time_ns;
    int64_t away_ns;     /* INPUT_CAME: how long it was away */
    char text[LOG_TEXT]; /* INPUT_WENT: what the plugin said of it; "" */
} input_incident;

/* Opens the address with the parameters "key=value,..."; the log must outlive it. A device that
 * cannot be opened now is an error. */
CHECKED mrt_result input_create(input **out, const mrt_plugin_type *type, const char *address,
                                const char *params, instance_clock clock, log_queue *log,
                                error *err);
/* The same; opening is given up soon after *stop is true, as a signal handler may set it. */
CHECKED mrt_result input_create_stoppable(input **out, const mrt_plugin_type *type,
                                          const char *address, const char *params,
                                          instance_clock clock, log_queue *log,
                                          const _Atomic bool *stop, error *err);
enum { INPUT_NAME = 96 };
/* [any] "log demo_hand.csv": what an input of that type and address will be called. */
void input_name_of(char out[INPUT_NAME], const mrt_plugin_type *type, const char *address);
void input_destroy(input *self); /* stops its thread first; NULL is fine */

const char *input_name(const input *self); /* "log demo_hand.csv"; until destroy */
const mrt_plugin_type *input_plugin(const input *self);
/* [any] Of the newest samples; valid until destroy. A plugin that asked to be restarted may have
 * other channels then, and so may a device that comes back: those of a sample are the ones of its
 * version. */
const mrt_channel *input_channels(const input *self, uint32_t *out_count);
const mrt_channel *input_channels_of(const input *self, uint32_t version, uint32_t *out_count);

/* Before input_start. What is signalled when there is a sample, an incident or another state; it
 * must outlive the input. NULL: nothing. */
void input_set_wake(input *self, wake *signal);
/* Who is given each sample on the input's own thread as soon as it has been read, before the frame
 * thread sees it. number: +1 each; version: of its channels. It must not wait. */
typedef struct input_keeper {
    void (*keep)(void *data, uint32_t number, uint32_t version, const mrt_sample *sample);
    void *data;
} input_keeper;
/* At any time; {0}: nobody. The one before is not called any more when this returns. Not on a
 * virtual clock: there nothing arrives before it is performed. */
void input_set_keeper(input *self, input_keeper keeper);
/* [frame] The number behind the newest sample that input_take took. */
uint32_t input_taken(const input *self);

/* Before input_start. How long to wait between two attempts to open a lost device: at first (250
 * ms), and after eight attempts (500 ms). For tests that lose many devices. */
void input_set_patience_ns(input *self, int64_t first_ns, int64_t later_ns);

/* Sets a parameter, also while it runs: its value, or "1" to press a button. */
CHECKED mrt_result input_set(input *self, const char *key, const char *value, error *err);

/* Its value as set last; index: in the table of input_plugin. */
double input_value(const input *self, uint32_t index);

/* [main] Before input_start: how long it plays; below 0: it is a device, does not end, or its
 * plugin does not say. */
double input_duration_s(input *self);

/* The sound that belongs to a recording: a file beside it of the same name that ends with .flac,
 * .ogg or .wav. Both begin at the same moment. */
typedef struct input_sound {
    char path[4096];
    double start_s; /* of the sound, at the first sample: the recording's parameter "start" */
} input_sound;
/* [main] False: it is no recording, has no sound, or plays at another speed or in a loop. */
bool input_find_sound(const input *self, input_sound *out);

/* CLOCK_REAL: starts the thread. CLOCK_VIRTUAL: nothing to do. */
CHECKED mrt_result input_start(input *self, error *err);
/* For good. Takes at most 0.1 s, even while a device is being opened, as far as the plugin keeps to
 * its deadlines and gives up when wait_until_ns returns early. */
void input_stop(input *self);

/* [frame] The oldest sample that has not been taken; false: none now. On a virtual clock this
 * reads the plugin, and false means that the input is over. */
bool input_peek(input *self, mrt_sample *out_sample);
void input_take(input *self); /* [frame] drops what input_peek gave */
/* [frame] The same, for whoever asks several. */
sample_source input_source(input *self);
/* [frame] Of the sample that input_peek gave last: 0 at first. */
uint32_t input_version(const input *self);
uint32_t input_newest_version(const input *self); /* [any] of what it delivers now */
/* [frame] The oldest incident that has not been taken; false: none now. */
bool input_take_incident(input *self, input_incident *out);

/* [any] When it is neither running nor lost and input_peek gives nothing, the input is over. */
input_state input_state_of(const input *self);
uint32_t input_dropped(const input *self); /* [any] samples lost in the ring */
/* [any] Samples that were not finite, misshapen, or not of this time. */
uint32_t input_refused(const input *self);
/* [any but frame] How it is doing; all zero on a virtual clock. */
void input_health(const input *self, health_report *out);
const char *input_state_name(input_state state); /* "running" */

#endif
