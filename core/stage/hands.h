/* stage/hands.h - step 3 of the frame: what the inputs' channels measured becomes two posed hands
 * and the pedals of a mrt_frame. Calibrated, filtered, carried from the wrist outwards. A function
 * of the samples alone. [frame] after create; no allocation then. */
#ifndef MAROTTE_STAGE_HANDS_H
#define MAROTTE_STAGE_HANDS_H
#include "hand/filter.h"
#include "hand/hand.h"

typedef struct hands hands;

/* [main] length_mm: of both, > 0. */
CHECKED mrt_result hands_create(hands **out, double length_mm, error *err);
void hands_destroy(hands *self); /* NULL is fine */

/* Which channel feeds what. Made once per input; calibration: counts or rad, by the unit. */
typedef struct channel_route {
    uint32_t count;
    uint32_t semantic[MRT_MAX_CHANNELS], hand[MRT_MAX_CHANNELS];
    hand_calibration calibration[2]; /* left, right */
} channel_route;
void channel_route_init(channel_route *out, const mrt_channel *channel, uint32_t count);

/* Changes what the sample speaks of in `frame`: hands, pedals. frame->time_ns is the sample's. */
void hands_read(hands *self, const channel_route *route, const mrt_sample *sample,
                mrt_frame *frame);

#endif
