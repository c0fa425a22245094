/* pedal/learn.h - finds the part of a device's reports that is each switch, while the user presses
 * each switch once, in order. Leaves out the messages to the user and the storage of the result.
 * Uses the fields of the report descriptor; without one, single bits. Pure functions on one struct;
 * no allocation. */
#ifndef PLUGINS_PEDAL_LEARN_H
#define PLUGINS_PEDAL_LEARN_H
#include "descriptor.h"
#include "layouts.h"

#include <stdbool.h>
#include <stdint.h>

enum { LEARN_FIELDS = 512, LEARN_REPORT = 64 };

typedef enum learn_stage {
    LEARN_OFF = 0,
    LEARN_REST, /* no foot on the device: all movement is noise */
    LEARN_WAIT, /* waiting for the next switch, or for a learned one to finish */
    LEARN_DOWN, /* a switch is down: measuring its range */
    LEARN_DONE, /* `found` is complete */
    LEARN_FAILED
} learn_stage;

typedef struct learn_field {
    descriptor_field where;
    bool has_rest;
    int64_t rest_low, rest_high; /* range while no foot was on it */
    int64_t peak;                /* value furthest from rest in this press */
    double peak_way;             /* its distance from rest, as a share of the range */
} learn_field;

typedef struct learn {
    learn_stage stage;
    uint32_t field_count;
    learn_field field[LEARN_FIELDS];
    uint8_t key; /* of this press, 0: none */
    uint8_t first_report[LEARN_REPORT];
    size_t first_size; /* 0: none */
    int64_t until_ns;  /* end of this stage */
    layout found;
} learn;

/* Starts learning. `of`: the device, its interface and endpoint. `fields` may be NULL. */
void learn_start(learn *self, const layout *of, const descriptor *fields, int64_t now_ns);
/* Both return true if the stage or the number of switches found changed. */
bool learn_report(learn *self, const uint8_t *bytes, size_t size, int64_t time_ns);
bool learn_tick(learn *self, int64_t now_ns); /* call at until_ns at the latest */
/* Returns true between learn_start and LEARN_DONE or LEARN_FAILED. */
bool learn_is_running(const learn *self);

/* ---- debouncing ---- */

enum { DEBOUNCE_SWITCHES = 4 };
typedef struct debounce {
    float raw[DEBOUNCE_SWITCHES], shown[DEBOUNCE_SWITCHES];
    int64_t quiet_until_ns[DEBOUNCE_SWITCHES]; /* end of the window after the last edge */
} debounce;

/* Resets to all up, without a recent edge. */
void debounce_reset(debounce *self);
/* Returns the time at which held-back changes are due; INT64_MAX: none. */
int64_t debounce_due_ns(const debounce *self);
/* Applies the changes due at time_ns. Returns true if something changed. Call it, at the time from
 * debounce_due_ns, before debounce_update of a later time. */
bool debounce_settle(debounce *self, int64_t time_ns, int64_t window_ns);
/* Processes the switch values at time_ns. Bit n of `analogue`: switch n is not debounced. Returns
 * true if `shown` changed. */
bool debounce_update(debounce *self, const float value[DEBOUNCE_SWITCHES], uint32_t analogue,
                     int64_t time_ns, int64_t window_ns);

#endif
