/* stage/input/feed.h - an input whose samples come from the program. Examples: the mouse on the
 * face, a virtual hand moved by keys or a gamepad, a test. Performance and recording use it like
 * any other input plugin. Leaves out the meaning of the channels (pointer.h, the window's virtual
 * hand). One writer [main]; the other threads as in plugin.h. */
#ifndef MAROTTE_STAGE_FEED_H
#define MAROTTE_STAGE_FEED_H
#include "base/error.h"

typedef struct feed feed;

typedef struct feed_settings {
    const char *id, *name; /* such as "org.marotte.pointer", "Mouse on the face"; must stay valid
                              until destroy */
    const mrt_channel *channels; /* copied */
    uint32_t channel_count;
    double rate_hz; /* sample rate while it is active; default 125 */
} feed_settings;

CHECKED mrt_result feed_create(feed **out, const feed_settings *settings, error *err);
void feed_destroy(feed *self); /* call after its inputs are destroyed; accepts NULL */
/* Returns the plugin type for input_create. One instance at a time. */
const mrt_plugin_type *feed_type(const feed *self);

typedef enum feed_activity {
    FEED_RESTS = 0, /* one sample of this value, then no further samples */
    FEED_MOVES      /* the value repeats at the rate, so that smoothing and easing continue */
} feed_activity;
/* Adds a sample of these values with the current time. Never waits. Values that are not finite
 * become 0. */
void feed_push(feed *self, const float *value, feed_activity activity);

#endif
