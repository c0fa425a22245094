/* stage/mapping/isolate_output.h - what the types of isolate.h for face outputs are made of. The
 * process begins with open and ends with close, so one that crashes or hangs for a second gives an
 * error from send, and whoever opens it again has a new one: of the library as it is then. open,
 * begin, send and close are called by one thread, and the process ends with that thread. For
 * isolate.c. */
#ifndef MAROTTE_STAGE_ISOLATE_OUTPUT_H
#define MAROTTE_STAGE_ISOLATE_OUTPUT_H
#include <marotte/plugin.h>

mrt_plugin *isolate_output_make(const mrt_host *host);
void isolate_output_unmake(mrt_plugin *self);
extern const mrt_face_output isolate_output_functions;

#endif
