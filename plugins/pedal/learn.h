/* pedal/learn.h - finds out which part of a device's reports is which switch, by watching while
 * each switch is pressed once, in order. Leaves out what is said to the person and where the result
 * goes. Works on the numbers that the report descriptor names; without one, on single bits. Pure
 * functions on one struct; no allocation. */
#ifndef PLUGINS_PEDAL_LEARN_H
#define PLUGINS_PEDAL_LEARN_H
#include "descriptor.h"
#include "layouts.h"

#include <stdbool.h>
#include <stdint.h>

enum { LEARN_FIELDS = 512, LEARN_REPORT = 64 };

typedef enum learn_stage {
    LEARN_OFF = 0,
    LEARN_REST, /* the feet are off: what moves now is noise */
    LEARN_WAIT, /* for the next switch, or the first again when that was all */
    LEARN_DOWN, /* a switch is down: how far does it go? */
    LEARN_DONE, /* `found` is complete */
    LEARN_FAILED
} learn_stage;

typedef struct learn_field {
    descriptor_field where;
    bool has_rest;
    int64_t rest_low, rest_high; /* what it did while nobody touched it */
    int64_t peak;                /* of this press: the value furthest from rest */
    double peak_way;             /* how far that was, in parts of its range */
} learn_field;

typedef struct learn {
    learn_stage stage;
    uint32_t field_count;
    learn_field field[LEARN_FIELDS];
    uint8_t key; /* of this press, 0: none */
    uint8_t first_report[LEARN_REPORT];
    size_t first_size; /* 0: none is kept */
    int64_t until_ns;  /* when this stage has waited enough */
    layout found;
} learn;

/* `of` names the device, its interface and endpoint. `fields` may be NULL. */
void learn_start(learn *self, const layout *of, const descriptor *fields, int64_t now_ns);
/* Both return true when the stage or the number of switches found has changed. */
bool learn_report(learn *self, const uint8_t *bytes, size_t size, int64_t time_ns);
bool learn_tick(learn *self, int64_t now_ns); /* call it at until_ns at the latest */
/* True between learn_start and LEARN_DONE or LEARN_FAILED. */
bool learn_is_running(const learn *self);

/* ---- contacts that chatter become one edge ---- */

enum { DEBOUNCE_SWITCHES = 4 };
typedef struct debounce {
    float raw[DEBOUNCE_SWITCHES], shown[DEBOUNCE_SWITCHES];
    int64_t quiet_until_ns[DEBOUNCE_SWITCHES]; /* end of the window after the last edge */
} debounce;

/* All up, and no edge lately. */
void debounce_reset(debounce *self);
/* When held back changes are due; INT64_MAX: there are none. */
int64_t debounce_due_ns(const debounce *self);
/* Shows what is due at time_ns; true: something changed. Call it before debounce_take of a later
 * time, with what debounce_due_ns says. */
bool debounce_settle(debounce *self, int64_t time_ns, int64_t window_ns);
/* Takes what the switches are at time_ns; bit n of `analogue`: switch n is passed on as it is.
 * True: `shown` changed. */
bool debounce_take(debounce *self, const float value[DEBOUNCE_SWITCHES], uint32_t analogue,
                   int64_t time_ns, int64_t window_ns);

#endif
