/* one_hand/pedals.h - what the feet and the buttons ask for. Immediate: nothing waits to see
 * whether a second tap follows. Leaves out what is done about it. Depends on dt_s alone. [frame] */
#ifndef MAROTTE_PLUGINS_ONE_HAND_PEDALS_H
#define MAROTTE_PLUGINS_ONE_HAND_PEDALS_H
#include "settings.h"

enum { PEDAL_ANCHOR = 0, PEDAL_HOLD, PEDAL_LAYER, PEDAL_COUNT };

typedef struct pedal {
    bool is_down;
    double since_press_s; /* at most a minute */
} pedal;

typedef struct pedals {
    pedal pedal[PEDAL_COUNT];
    bool is_latched;     /* the hold goes on without a foot */
    bool is_hold_spent;  /* this press of the hold pedal was part of a chord */
    bool is_layer_spent; /* this press of the layer pedal has locked the layer */
    bool can_revert;     /* the next tap of the anchor pedal may be the second of two */
    double intensity;    /* of the intensity pedal, smoothed; 1 without one */
    bool has_intensity;
} pedals;

/* For a list of memory.h. */
#define PEDAL_MEMORY(pedal) MEMORY_BOOLS((pedal).is_down), MEMORY_DOUBLES((pedal).since_press_s)
#define PEDALS_MEMORY(pedals)                                                                      \
    PEDAL_MEMORY((pedals).pedal[PEDAL_ANCHOR]), PEDAL_MEMORY((pedals).pedal[PEDAL_HOLD]),          \
        PEDAL_MEMORY((pedals).pedal[PEDAL_LAYER]), MEMORY_BOOLS((pedals).is_latched),              \
        MEMORY_BOOLS((pedals).is_hold_spent), MEMORY_BOOLS((pedals).is_layer_spent),               \
        MEMORY_BOOLS((pedals).can_revert), MEMORY_DOUBLES((pedals).intensity),                     \
        MEMORY_BOOLS((pedals).has_intensity)

typedef struct pedals_events {
    bool anchor, revert, to_neutral; /* in this frame; at most one */
    bool lock_layer;                 /* in this frame */
    bool hold, other_layer;          /* as long as it lasts */
} pedals_events;

void pedals_reset(pedals *self);
pedals_events pedals_step(pedals *self, const mrt_frame *frame, double dt_s);

#endif
