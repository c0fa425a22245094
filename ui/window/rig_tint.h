/* window/rig_tint.h - the colours in which a rig is shown on its face: which bone a vertex rides
 * on, how freely it can be pulled, which a region selects. Linear, 0..1, as viewport_paint wants
 * them. Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_RIG_TINT_H
#define MAROTTE_UI_WINDOW_RIG_TINT_H
#include "face/bind.h"

void rig_tint_of_bone(float out[3], const rig *r, uint32_t bone); /* RIG_NONE: of mobility */
uint32_t rig_tint_chip(const rig *r, uint32_t bone);              /* the same as 0xRRGGBBAA */

/* rgb: vertex_count by 3. Bones mixed by weight, the paler the less a vertex can be pulled. */
void rig_tint_bones(float *rgb, const rig *r, const binding *b);
void rig_tint_mobility(float *rgb, const binding *b);
/* share: vertex_count, 0..1: the colour over what recedes. */
void rig_tint_share(float *rgb, const float *share, uint32_t vertex_count, const float colour[3]);
void rig_tint_plain(float *rgb, uint32_t vertex_count); /* of a face that could not be laid */
void rig_tint_mix(float rgb[3], const float colour[3], float share);

#endif
