/* window/virtual_hand_motion.h - a hand that is moved by keys or a gamepad: what is wished of it,
 * the angles that this means, and how they ease there as a hand's do. Leaves out who reads the keys
 * and where the angles go (virtual_hand.h). Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_VIRTUAL_HAND_MOTION_H
#define MAROTTE_UI_WINDOW_VIRTUAL_HAND_MOTION_H
#include "window/front.h"

typedef enum virtual_hand_key {
    VIRTUAL_THUMB_DOWN = 0, /* away from the fingers: a puppet's mouth opens */
    VIRTUAL_THUMB_UP,
    VIRTUAL_INDEX_DOWN, /* index .. little: bent */
    VIRTUAL_MIDDLE_DOWN,
    VIRTUAL_RING_DOWN,
    VIRTUAL_LITTLE_DOWN,
    VIRTUAL_INDEX_UP, /* index .. little: lifted */
    VIRTUAL_MIDDLE_UP,
    VIRTUAL_RING_UP,
    VIRTUAL_LITTLE_UP,
    VIRTUAL_SPREAD,
    VIRTUAL_NARROW,
    VIRTUAL_WRIST_UP, /* as seen in the picture */
    VIRTUAL_WRIST_DOWN,
    VIRTUAL_WRIST_LEFT,
    VIRTUAL_WRIST_RIGHT,
    VIRTUAL_KEYS
} virtual_hand_key;
extern const uint32_t virtual_hand_key_code[VIRTUAL_KEYS]; /* ui_key */

typedef struct virtual_hand_wish { /* -1 .. 1 each, 0: as at rest */
    float finger[5];               /* thumb to little: 1 down, -1 up */
    float spread;
    float pitch; /* 1: the hand bends down */
    float yaw;   /* 1: to the right in the picture */
    bool pedal[MRT_MAX_PEDALS];
} virtual_hand_wish;
/* Both add to a wish, which stays within its range. */
void virtual_hand_wish_keys(virtual_hand_wish *wish, const bool is_down[VIRTUAL_KEYS]);
void virtual_hand_wish_pad(virtual_hand_wish *wish, const front_gamepad *pad);
bool virtual_hand_pad_is_used(const front_gamepad *pad); /* something of it is pressed or moved */

/* The angles at rest, and those of a wish: MRT_ANGLES, rad, as in hand.h. to_radial: 1 where right
 * in the picture is the side of the thumb, else -1. */
void virtual_hand_rest(float out_rad[MRT_ANGLES]);
void virtual_hand_goal(float out_rad[MRT_ANGLES], const virtual_hand_wish *wish, float to_radial);

typedef struct virtual_hand_motion {
    float angle_rad[MRT_ANGLES], speed_rad_s[MRT_ANGLES];
} virtual_hand_motion;
void virtual_hand_motion_begin(virtual_hand_motion *out); /* at rest */
/* Towards the goal: most of a bend is done in 80 ms, of a lift in 120 ms; without overshoot, and
 * whatever the steps of time are. */
void virtual_hand_motion_step(virtual_hand_motion *self, const float goal_rad[MRT_ANGLES],
                              double dt_s);
/* It is at the goal, within what can be seen. */
bool virtual_hand_motion_is_still(const virtual_hand_motion *self,
                                  const float goal_rad[MRT_ANGLES]);

#endif
