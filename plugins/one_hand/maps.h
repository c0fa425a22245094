/* one_hand/maps.h - the three ways to read a hand: muppet+, mask, layered waldo. Each is a function
 * of the hand's difference to its neutral pose; no difference gives the rest face exactly. Hands
 * are right ones here, and poses those of a right hand. Pure; source: research, peers.md 6. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_MAPS_H
#define MAROTTE_PLUGINS_ONE_HAND_MAPS_H
#include "pose.h"
#include "reading.h"

/* intensity: factor for brows, lids, corners, width, sneer. droop: how far the lids droop, 0 .. 1
 * (blink.h follows it in time). */
void maps_muppet(pose *out, const reading *difference, double intensity, double droop,
                 const double *params);
void maps_mask(pose *out, const reading *difference, const double *params);
/* Only the values of the layer are meant. */
void maps_waldo(pose *out, const reading *difference, int layer, const double *params);

/* What the middle finger asks of the lids, before it is followed in time. */
double maps_droop(const reading *difference, double intensity, const double *params);

#endif
