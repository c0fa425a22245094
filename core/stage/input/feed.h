/* stage/input/feed.h - an input whose samples the program itself gives: the mouse on the face, a
 * virtual hand moved by keys or a gamepad, a test. It is an input plugin like any other to whoever
 * performs and records it. Leaves out what the channels mean (pointer.h, the window's virtual
 * hand). One giver [main]; threads else as marked in plugin.h. */
#ifndef MAROTTE_STAGE_FEED_H
#define MAROTTE_STAGE_FEED_H
#include "base/error.h"

typedef struct feed feed;

typedef struct feed_settings {
    const char *id, *name;       /* "org.marotte.pointer", "Mouse on the face"; until destroy */
    const mrt_channel *channels; /* copied */
    uint32_t channel_count;
    double rate_hz; /* of samples while it is active; 125 */
} feed_settings;

CHECKED mrt_result feed_create(feed **out, const feed_settings *settings, error *err);
void feed_destroy(feed *self); /* after the inputs that were made of it; NULL is fine */
/* For input_create; one instance at a time. */
const mrt_plugin_type *feed_type(const feed *self);

typedef enum feed_activity {
    FEED_RESTS = 0, /* one sample for this value, then silence */
    FEED_MOVES      /* the value is repeated at the rate: time goes on for what eases */
} feed_activity;
/* A sample of these values now. Never waits; values are made finite. */
void feed_give(feed *self, const float *value, feed_activity activity);

#endif
