/* window/panels/hand_lights.h - which lines of a mapping's card are lit: those whose angles move.
 * A line's level is the change of its angles over the last quarter of a second, weighed as the line
 * says, so that no neutral pose is needed. Of lines that share angles the strongest are lit. Leaves
 * out drawing (hand_card.h). Pure; no allocation. */
#ifndef MAROTTE_UI_WINDOW_PANELS_HAND_LIGHTS_H
#define MAROTTE_UI_WINDOW_PANELS_HAND_LIGHTS_H
#include <marotte/plugin.h>

enum {
    HAND_LIGHTS_MAX = 32,    /* lines; further ones stay dark */
    HAND_LIGHTS_MOMENTS = 16 /* kept */
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
/* Once a drawn frame. An absent hand lights nothing. */
void hand_lights_look(hand_lights *self, const mrt_card_line *line, uint32_t count,
                      const mrt_hand *hand, double dt_s);

#endif
