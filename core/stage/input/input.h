/* stage/input/input.h - an input plugin as a source of samples in time order. Live, an own thread
 * reads it and writes to a ring. On a virtual clock it is called directly, as fast as possible. A
 * live device that is lost is opened again until it is back. [main] unless marked. */
#ifndef MAROTTE_STAGE_INPUT_H
#define MAROTTE_STAGE_INPUT_H
#include "stage/input/health.h"
#include "stage/input/sample_source.h"
#include "stage/input/wake.h"
#include "stage/mapping/instance.h"

typedef struct input input;

typedef enum input_state {
    INPUT_RUNNING = 0,
    INPUT_ENDED,  /* the recording has ended */
    INPUT_FAILED, /* a permanent error: an unreadable recording or a faulty plugin */
    INPUT_LOST    /* the device is disconnected; the thread tries to open it again */
} input_state;

typedef enum input_incident_kind {
    INPUT_NO_INCIDENT = 0,
    INPUT_WAS_LOST, /* the device was lost; its pedals are released */
    INPUT_IS_BACK   /* the device is connected again */
} input_incident_kind;

/* [main] Returns whether an input of that type and address is a recording (MRT_INPUT_RECORDED,
 * MRT_INPUT_FILES), which a virtual clock can run. */
bool input_is_recording(const mrt_plugin_type *type, const char *address);

typedef struct input_incident {
    input_incident_kind kind;
    int64_t time_ns;
    int64_t away_ns;     /* INPUT_IS_BACK: duration of the loss */
    char text[LOG_TEXT]; /* INPUT_WAS_LOST: error text of the plugin; "": none */
} input_incident;

/* Opens the address with the parameters "key=value,...". `log` must outlive the input. Returns an
 * error if the device cannot be opened now. */
CHECKED mrt_result input_create(input **out, const mrt_plugin_type *type, const char *address,
                                const char *params, instance_clock clock, log_queue *log,
                                error *err);
/* Same. Opening is cancelled soon after *stop becomes true, which a signal handler may set. */
CHECKED mrt_result input_create_stoppable(input **out, const mrt_plugin_type *type,
                                          const char *address, const char *params,
                                          instance_clock clock, log_queue *log,
                                          const _Atomic bool *stop, error *err);
enum { INPUT_NAME = 96 };
/* [any] Writes the name of an input of that type and address, such as "log demo_hand.csv". */
void input_name_of(char out[INPUT_NAME], const mrt_plugin_type *type, const char *address);
void input_destroy(input *self); /* stops its thread first; accepts NULL */

const char *input_name(const input *self); /* such as "log demo_hand.csv"; valid until destroy */
const mrt_plugin_type *input_plugin(const input *self);
/* [any] Returns the channels of the newest samples; valid until destroy. A restarted plugin or a
 * device that was connected again may have other channels. Use the version of a sample to get its
 * channels. */
const mrt_channel *input_channels(const input *self, uint32_t *out_count);
const mrt_channel *input_channels_of(const input *self, uint32_t version, uint32_t *out_count);

/* Call before input_start. Sets the object that is signalled after a sample, an incident or a
 * change of state. It must outlive the input. NULL: none. */
void input_set_wake(input *self, wake *signal);
/* Receives each sample on the thread of the input directly after the read, before the frame thread.
 * number: +1 each; version: of its channels. keep must not wait. */
typedef struct input_keeper {
    void (*keep)(void *data, uint32_t number, uint32_t version, const mrt_sample *sample);
    void *data;
} input_keeper;
/* Sets the keeper at any time; {0}: none. After this returns, the previous keeper is not called any
 * more. Not for a virtual clock, where samples do not arrive before they are performed. */
void input_set_keeper(input *self, input_keeper keeper);
/* [frame] Returns the number of the newest sample that input_pop removed, plus one. */
uint32_t input_popped_count(const input *self);

/* Call before input_start. Sets the time between two attempts to open a lost device: at first
 * (default 250 ms), and after eight attempts (default 500 ms). For tests that lose many devices. */
void input_set_patience_ns(input *self, int64_t first_ns, int64_t later_ns);

/* Sets a parameter, also while the input runs. `value` is its value, or "1" to press a button. */
CHECKED mrt_result input_set(input *self, const char *key, const char *value, error *err);

/* Returns the value that was set last. index: in the parameter table of input_plugin. */
double input_value(const input *self, uint32_t index);

/* [main] Call before input_start. Returns the length of a recording. < 0: a device, an endless
 * input, or unknown. */
double input_duration_s(input *self);

/* The sound file of a recording: it has the same name with the ending .flac, .ogg or .wav. Both
 * begin at the same time. */
typedef struct input_sound {
    char path[4096];
    double start_s; /* position in the sound at the first sample: the parameter "start" of the
                       recording */
} input_sound;
/* [main] Returns false if the input is not a recording, has no sound, or plays at another speed or
 * in a loop. */
bool input_find_sound(const input *self, input_sound *out);

/* CLOCK_REAL: starts the thread. CLOCK_VIRTUAL: does nothing. */
CHECKED mrt_result input_start(input *self, error *err);
/* Stops the input permanently. Takes at most 0.1 s, even while a device is being opened. The plugin
 * must respect its deadlines and give up when wait_until_ns returns early. */
void input_stop(input *self);

/* [frame] Copies the oldest sample in the ring. False: none now. On a virtual clock it reads the
 * plugin, and false means that the input has ended. */
bool input_peek(input *self, mrt_sample *out_sample);
void input_pop(input *self); /* [frame] removes the sample that input_peek returned */
/* [frame] The same functions for a reader of several sources. */
sample_source input_source(input *self);
/* [frame] Returns the version of the sample that input_peek returned last, at first 0. */
uint32_t input_version(const input *self);
uint32_t input_newest_version(const input *self); /* [any] version of the newest samples */
/* [frame] Removes the oldest incident. False: none now. */
bool input_pop_incident(input *self, input_incident *out);

/* [any] If the state is neither running nor lost and input_peek returns false, the input has
 * ended. */
input_state input_state_of(const input *self);
uint32_t input_dropped(const input *self); /* [any] samples lost in the ring */
/* [any] Returns the number of invalid samples: not finite, wrong count, or a time stamp too far
 * from now. */
uint32_t input_refused(const input *self);
/* [any but frame] Copies the newest report. All zero on a virtual clock. */
void input_health(const input *self, health_report *out);
const char *input_state_name(input_state state); /* "running" */
/* [any but frame] Copies the hand that a camera or a headset saw last. False: none yet. */
bool input_sight(input *self, hand_sight *out);

#endif
