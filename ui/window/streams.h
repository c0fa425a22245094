/* window/streams.h - the face alone, drawn at a size and rate of its own, read back without waiting
 * and handed to those who take pictures (stream/stream.h): what app_picture says. [main], with the
 * context. */
#ifndef MAROTTE_UI_WINDOW_STREAMS_H
#define MAROTTE_UI_WINDOW_STREAMS_H
#include "window/app/app.h"

typedef struct streams streams;
struct viewport;
streams *streams_create(app *of, struct viewport *from); /* NULL: no memory */
void streams_destroy(streams *self);                     /* NULL is fine */
/* Once a frame, when nothing is being drawn. */
void streams_update(streams *self, double dt_s);
bool streams_are_on(const streams *self);

/* "transparent", "#rrggbb" as straight RGBA of 0..1; false: anything else, the studio's wall. */
bool streams_ground(const char *text, float out[4]);

#endif
