/* gamepad/evdev.h - Linux' input devices: which pads are plugged in, as /sys says without opening
 * one, and one of them opened for its events. Leaves out what the events mean. One thread at a
 * time; never waits. */
#ifndef PLUGINS_GAMEPAD_EVDEV_H
#define PLUGINS_GAMEPAD_EVDEV_H
#include "pad.h"

#include <linux/input.h>

enum { EVDEV_SEEN = 16, EVDEV_NAME = 64, EVDEV_IDENTITY = 96 };

typedef struct evdev_seen {
    uint32_t number; /* of /dev/input/eventN */
    char node[32], name[EVDEV_NAME];
    /* Where it is plugged in, or the address of its radio: stays when it comes again. */
    char identity[EVDEV_IDENTITY];
    pad_model model; /* without the ends of axes */
} evdev_seen;

/* Pads in the order in which they came, at most EVDEV_SEEN; returns how many. */
uint32_t evdev_look(evdev_seen out[EVDEV_SEEN]);

/* Completes the model, reads where everything stands. -1 and errno. Events are stamped by the
 * monotonic clock. Several programs may have a pad open. */
int evdev_open(evdev_seen *seen, pad_state *out_state);
void evdev_close(int descriptor);
/* Where everything stands, as after lost events. False: the device is gone. */
bool evdev_read_state(int descriptor, const pad_model *model, pad_state *out);
/* How many events have come: 0 none; -1: the device is gone. */
int evdev_read(int descriptor, struct input_event *out, uint32_t capacity);

#endif
