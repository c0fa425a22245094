/* gamepad/pad.h - meaning of a gamepad's events: maps Linux codes of axes and buttons
 * (linux/input.h) to named channels, which are the same for every pad. Pure functions on one
 * struct; no allocation. Leaves out the source of the events. */
#ifndef PLUGINS_GAMEPAD_PAD_H
#define PLUGINS_GAMEPAD_PAD_H
#include <stdbool.h>
#include <stdint.h>

typedef enum pad_channel {
    PAD_LEFT_X, /* sticks: -1..1, right and up are positive */
    PAD_LEFT_Y,
    PAD_RIGHT_X,
    PAD_RIGHT_Y,
    PAD_LEFT_TRIGGER, /* 0..1 */
    PAD_RIGHT_TRIGGER,
    PAD_CROSS_X, /* -1, 0, 1 */
    PAD_CROSS_Y,
    PAD_BUTTONS, /* this and all later ones: 0 or 1 */
    PAD_SOUTH = PAD_BUTTONS,
    PAD_EAST,
    PAD_WEST,
    PAD_NORTH,
    PAD_LEFT_SHOULDER,
    PAD_RIGHT_SHOULDER,
    PAD_SELECT,
    PAD_START,
    PAD_MODE,
    PAD_LEFT_STICK,
    PAD_RIGHT_STICK,
    PAD_CHANNELS
} pad_channel;
extern const char *const pad_name[PAD_CHANNELS];

enum { PAD_AXES = 64, PAD_KEYS = 768 };
typedef struct pad_axis {
    bool is_there;
    int32_t low, high;
} pad_axis;

/* Axes and buttons that a device reports. */
typedef struct pad_model {
    uint16_t vendor;
    pad_axis axis[PAD_AXES];
    uint8_t key[PAD_KEYS / 8]; /* bit n: code n */
} pad_model;

/* Returns true for a pad or joystick, false for a mouse, keyboard, tablet or a pad's motion
 * sensor. */
bool pad_is_pad(const pad_model *model);

typedef struct pad_state {
    int32_t axis[PAD_AXES];
    uint8_t key[PAD_KEYS / 8];
} pad_state;

/* Ignores codes out of range. */
void pad_set_axis(pad_state *state, uint16_t code, int32_t value);
void pad_set_key(pad_state *state, uint16_t code, bool is_down);
/* Writes the channel values. dead: radius of a stick, or length of a trigger, that counts as rest:
 * 0..0.9. Beyond it the value starts at 0 and still reaches the end. */
void pad_read(const pad_model *model, const pad_state *state, float dead, float out[PAD_CHANNELS]);

#endif
