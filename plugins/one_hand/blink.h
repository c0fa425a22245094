/* one_hand/blink.h - lids in time: a quick bend of the middle finger blinks, a slow one droops.
 * Depends on dt_s alone. [frame] */
#ifndef MAROTTE_PLUGINS_ONE_HAND_BLINK_H
#define MAROTTE_PLUGINS_ONE_HAND_BLINK_H
#include "settings.h"

typedef enum blink_phase { BLINK_NONE = 0, BLINK_CLOSING, BLINK_OPENING } blink_phase;

typedef struct blink {
    blink_phase phase;
    double time_s;  /* in the phase */
    double from;    /* closure at its begin */
    double closure; /* 0 .. 1 */
    double droop;   /* follows what is asked */

    bool has_bend, is_spent; /* spent: this stroke has blinked */
    double bend_deg, speed_deg_s;
    double stroke_from_deg;
} blink;

/* For a list of memory.h. */
#define BLINK_MEMORY(blink)                                                                        \
    MEMORY_WHOLES((blink).phase, BLINK_OPENING), MEMORY_DOUBLES((blink).time_s),                   \
        MEMORY_DOUBLES((blink).from), MEMORY_DOUBLES((blink).closure),                             \
        MEMORY_DOUBLES((blink).droop), MEMORY_BOOLS((blink).has_bend),                             \
        MEMORY_BOOLS((blink).is_spent), MEMORY_DOUBLES((blink).bend_deg),                          \
        MEMORY_DOUBLES((blink).speed_deg_s), MEMORY_DOUBLES((blink).stroke_from_deg)

void blink_reset(blink *self);
/* The hand is another one or was away: what it did before says nothing of its speed. */
void blink_forget_hand(blink *self);
/* bend_deg: of the middle finger's knuckle, whatever is neutral. True when it was quick enough. */
bool blink_is_struck(blink *self, double bend_deg, double dt_s, const double *params);
void blink_start(blink *self);
/* droop: what the hand asks for now; it waits while a blink is under way. */
void blink_step(blink *self, double droop, double dt_s, const double *params);

#endif
