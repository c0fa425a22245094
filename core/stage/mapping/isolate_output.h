/* stage/mapping/isolate_output.h - a face output in a process of its own, as a type like any other.
 * The process begins with open and ends with close, so one that crashes or hangs for a second gives
 * an error from send, and whoever opens it again has a new one: of the library as it is then. Only
 * instances made by instance_create can be of the type that comes out; open, begin, send and close
 * are called by one thread, and the process ends with that thread. */
#ifndef MAROTTE_STAGE_ISOLATE_OUTPUT_H
#define MAROTTE_STAGE_ISOLATE_OUTPUT_H
#include "stage/mapping/instance.h"

typedef struct isolate_output isolate_output;

/* [main] library: from which `inner` was loaded; the child loads it again. */
CHECKED mrt_result isolate_output_create(isolate_output **out, const mrt_plugin_type *inner,
                                         const char *library, error *err);
void isolate_output_destroy(isolate_output *self); /* after its instances; NULL is fine */
/* Until destroy. */
const mrt_plugin_type *isolate_output_type(const isolate_output *self);

#endif
