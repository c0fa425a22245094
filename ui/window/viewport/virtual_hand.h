/* window/viewport/virtual_hand.h - a hand without a glove. The keyboard (while app_has_hand_keys)
 * or a gamepad moves it. It performs and is recorded like any other input, and joins the stage at
 * its first use. [main]; the motion functions are pure. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_VIRTUAL_HAND_H
#define MAROTTE_UI_WINDOW_VIEWPORT_VIRTUAL_HAND_H
#include "window/gui/window.h"
#include "window/app/app.h"

typedef enum virtual_hand_key {
    VIRTUAL_THUMB_DOWN = 0, /* away from the fingers; opens the mouth of a hand puppet */
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
    VIRTUAL_WRIST_UP, /* direction in the picture */
    VIRTUAL_WRIST_DOWN,
    VIRTUAL_WRIST_LEFT,
    VIRTUAL_WRIST_RIGHT,
    VIRTUAL_KEYS
} virtual_hand_key;

typedef struct virtual_hand_intent { /* each value -1..1; 0: rest */
    float finger[5];                 /* thumb to little: 1 down, -1 up */
    float spread;
    float pitch; /* 1: bends down */
    float yaw;   /* 1: to the right in the picture */
    bool pedal[MRT_MAX_PEDALS];
} virtual_hand_intent;
/* Both functions add to an intent and clamp it. */
void virtual_hand_add_keys(virtual_hand_intent *intent, const bool is_down[VIRTUAL_KEYS]);
void virtual_hand_add_pad(virtual_hand_intent *intent, const window_gamepad *pad);
bool virtual_hand_pad_is_used(
    const window_gamepad *pad); /* whether a button is pressed or a stick moved */

/* Write the angles of the rest pose and of an intent: MRT_ANGLES, rad, as in hand.h. to_radial: 1
 * if the thumb is at the right in the picture, otherwise -1. */
void virtual_hand_rest(float out_rad[MRT_ANGLES]);
void virtual_hand_goal(float out_rad[MRT_ANGLES], const virtual_hand_intent *intent,
                       float to_radial);

typedef struct virtual_hand_motion {
    float angle_rad[MRT_ANGLES], speed_rad_s[MRT_ANGLES];
} virtual_hand_motion;
void virtual_hand_motion_begin(virtual_hand_motion *out); /* at rest */
/* Moves towards the goal: most of a bend takes 80 ms, of a lift 120 ms. The motion has no overshoot
 * and does not depend on the time steps. */
void virtual_hand_motion_step(virtual_hand_motion *self, const float goal_rad[MRT_ANGLES],
                              double dt_s);
/* Returns whether the hand is at the goal, within a visible tolerance. */
bool virtual_hand_motion_is_still(const virtual_hand_motion *self,
                                  const float goal_rad[MRT_ANGLES]);

typedef struct virtual_hand virtual_hand;

/* Creates the virtual hand. The setting "virtual_hand.side" selects the hand: 0 left, 1 right
 * (default). Shift+Y changes it. */
virtual_hand *virtual_hand_create(app *of); /* NULL: no memory */
/* Removes the hand from the stage. Ends and saves a take that is being recorded. Accepts NULL. */
void virtual_hand_destroy(virtual_hand *self);
/* Updates the hand. Call it in each frame. pad NULL: no gamepad. */
void virtual_hand_update(virtual_hand *self, const ui *keys, const window_gamepad *pad,
                         double dt_s);

bool virtual_hand_has_key(uint32_t key); /* moves the hand while the keyboard controls it */

/* The strip above the picture while the keyboard controls the hand: the keys, lit while they are
 * pressed, and what each moves in the face. height: of strip and picture; if the strip would take
 * too much of it, it names the fingers only. Returns the height of the strip; 0: hidden. */
float virtual_hand_keys_height(const virtual_hand *self, const ui *on, float width, float height);
void virtual_hand_draw_keys(const virtual_hand *self, ui *on, ui_rectangle where, float height);

#endif
