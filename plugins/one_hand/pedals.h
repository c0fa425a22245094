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

typedef struct pedals_events {
    bool anchor, revert, to_neutral; /* in this frame; at most one */
    bool lock_layer;                 /* in this frame */
    bool hold, other_layer;          /* as long as it lasts */
} pedals_events;

void pedals_reset(pedals *self);
pedals_events pedals_step(pedals *self, const mrt_frame *frame, double dt_s);

#endif
