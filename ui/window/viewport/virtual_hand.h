/* window/viewport/virtual_hand.h - a hand for whom no glove is at hand: the keyboard (while
 * app_has_hand_keys) or a gamepad moves it, and it performs and is recorded as any other input.
 * It joins the stage when it is first used. [main]; how it moves is pure. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_VIRTUAL_HAND_H
#define MAROTTE_UI_WINDOW_VIEWPORT_VIRTUAL_HAND_H
#include "window/gui/window.h"
#include "window/app/app.h"

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

typedef struct virtual_hand_intent { /* -1 .. 1 each, 0: as at rest */
    float finger[5];                 /* thumb to little: 1 down, -1 up */
    float spread;
    float pitch; /* 1: the hand bends down */
    float yaw;   /* 1: to the right in the picture */
    bool pedal[MRT_MAX_PEDALS];
} virtual_hand_intent;
/* Both add to an intent, which stays within its range. */
void virtual_hand_add_keys(virtual_hand_intent *intent, const bool is_down[VIRTUAL_KEYS]);
void virtual_hand_add_pad(virtual_hand_intent *intent, const window_gamepad *pad);
bool virtual_hand_pad_is_used(const window_gamepad *pad); /* something of it is pressed or moved */

/* The angles at rest, and those of an intent: MRT_ANGLES, rad, as in hand.h. to_radial: 1 where
 * right in the picture is the side of the thumb, else -1. */
void virtual_hand_rest(float out_rad[MRT_ANGLES]);
void virtual_hand_goal(float out_rad[MRT_ANGLES], const virtual_hand_intent *intent,
                       float to_radial);

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

typedef struct virtual_hand virtual_hand;

/* The window's setting "virtual_hand.side" says which hand it is: 0 left, 1 right (the usual one);
 * Shift+Y changes it. */
virtual_hand *virtual_hand_create(app *of); /* NULL: no memory */
/* Takes it off the stage: a take that is being recorded ends and is kept. NULL is fine. */
void virtual_hand_destroy(virtual_hand *self);
/* Each frame. pad NULL: there is none. */
void virtual_hand_update(virtual_hand *self, const ui *keys, const window_gamepad *pad,
                         double dt_s);

/* Which key does what, and what is pressed now, along the upper edge of the face; while the
 * keyboard is the hand. How high that is in so wide a picture; 0: it is not there. */
void virtual_hand_draw_keys(const virtual_hand *self, ui *on, ui_rectangle where);
float virtual_hand_keys_height(const virtual_hand *self, const ui *on, float width);

#endif
