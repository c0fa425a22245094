/* one_hand/attach.h - the face shown, hanging on the hand: live, held, or easing from one to the
 * other. No change of what it hangs on makes it jump: the difference at that moment fades away.
 * Depends on dt_s alone. [frame] */
#ifndef MAROTTE_PLUGINS_ONE_HAND_ATTACH_H
#define MAROTTE_PLUGINS_ONE_HAND_ATTACH_H
#include "pose.h"

/* Why a layer does not follow the hand; 0: it does. */
enum { HELD_BY_LAYER = 1, HELD_BY_PEDAL = 2, HELD_BY_ABSENCE = 4 };

typedef struct attach {
    pose shown;  /* what is to be seen, before limits */
    pose offset; /* what an anchor has kept: added to what the hand says */
    pose held;   /* of layers that do not follow */
    pose rest;   /* what was shown less what should have been, at the last change */
    unsigned held_by[LAYER_COUNT];
    bool has_changed; /* the next step starts a way anew */
    double time_s, duration_s;
} attach;

/* For a list of memory.h. */
#define ATTACH_MEMORY(attach)                                                                      \
    MEMORY_DOUBLES((attach).shown), MEMORY_DOUBLES((attach).offset),                               \
        MEMORY_DOUBLES((attach).held), MEMORY_DOUBLES((attach).rest),                              \
        MEMORY_WHOLES((attach).held_by, HELD_BY_LAYER | HELD_BY_PEDAL | HELD_BY_ABSENCE),          \
        MEMORY_BOOLS((attach).has_changed), MEMORY_DOUBLES((attach).time_s),                       \
        MEMORY_DOUBLES((attach).duration_s)

void attach_reset(attach *self);
/* From the next step on something else is followed: ease to it. */
void attach_change(attach *self, double duration_s);
/* What is shown stays as it is when the hand's target falls to zero in the next step. most_mm, low,
 * high (DOF_COUNT): beyond them nothing is seen, so nothing is kept. */
void attach_keep(attach *self, double most_mm, const double *low, const double *high);
/* Everything eases to rest, but for what the hand says. */
void attach_forget(attach *self, double duration_s);
/* held_by: per layer. reattach_s: the way back after a hold. */
void attach_step(attach *self, const pose *target, const unsigned held_by[LAYER_COUNT],
                 double reattach_s, double dt_s);

#endif
