/* pedal/debounce.h - contacts that chatter become one edge. The first edge passes at once; what a
 * switch does within the window after it is held back, and what it has come to is passed on when
 * the window ends. Leaves out analogue pedals: they are passed on as they are. Pure functions on
 * one struct; time is the samples'. */
#ifndef MAROTTE_PLUGINS_PEDAL_DEBOUNCE_H
#define MAROTTE_PLUGINS_PEDAL_DEBOUNCE_H
#include <stdbool.h>
#include <stdint.h>

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
