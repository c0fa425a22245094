/* stage/mapping/isolate_output.h - functions of the isolated face outputs of isolate.h. The process
 * starts with open and ends with close. If it crashes or hangs for a second, send returns an error.
 * Opening the output again starts a new process with the current library file. open, begin, send
 * and close must run on one thread, because the process ends with that thread. For isolate.c. */
#ifndef MAROTTE_STAGE_ISOLATE_OUTPUT_H
#define MAROTTE_STAGE_ISOLATE_OUTPUT_H
#include <marotte/plugin.h>

mrt_plugin *isolate_output_make(const mrt_host *host);
void isolate_output_unmake(mrt_plugin *self);
extern const mrt_face_output isolate_output_functions;

#endif
