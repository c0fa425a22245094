/* window/panels/hand_lights.h - computes which lines of a hand card are lit: those whose angles
 * move. The level of a line is the weighted change of its angles over the last 0.25 s, so it needs
 * no rest pose. Of the lines that share angles, only the strongest are lit. Leaves out drawing
 * (hand_card.h). Pure; no allocation. */
#ifndef MAROTTE_UI_WINDOW_PANELS_HAND_LIGHTS_H
#define MAROTTE_UI_WINDOW_PANELS_HAND_LIGHTS_H
#include <marotte/plugin.h>

enum {
    HAND_LIGHTS_MAX = 32,    /* lines; any others stay dark */
    HAND_LIGHTS_MOMENTS = 16 /* stored moments */
};

typedef struct hand_lights {
    uint32_t count, next; /* of the ring of moments */
    double time_s, last_s;
    struct hand_moment {
        double time_s;
        float angle_rad[MRT_ANGLES];
    } moment[HAND_LIGHTS_MOMENTS];
    float level[HAND_LIGHTS_MAX]; /* 0 dark .. 1 lit, eased */
} hand_lights;

void hand_lights_begin(hand_lights *self);
/* Updates the levels. Call it once for each drawn frame. Without a hand no line is lit. */
void hand_lights_update(hand_lights *self, const mrt_card_line *line, uint32_t count,
                        const mrt_hand *hand, double dt_s);

#endif
