/* one_hand/card.h - MRT_HAND_CARD: what each part of the hand does, in the performer's words. Pure;
 * any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_CARD_H
#define MAROTTE_PLUGINS_ONE_HAND_CARD_H
#include "joints.h"

const mrt_card_line *card_lines(const double *params, const mrt_channels *input, uint32_t side,
                                uint32_t *out_count);

#endif
