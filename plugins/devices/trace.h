/* plugins/devices/trace.h - what went over the wire, both ways, for whoever has to find out how a
 * device really behaves: appended to the file named by the environment variable MAROTTE_TRACE, one
 * line a transfer: "TIME_NS SOURCE > 47" (to the device) or "TIME_NS SOURCE < 47 ff 00" (from it).
 * Several plugins may write to one file. Off when the variable is unset or the file cannot be
 * written. Any one thread at a time. Shared by input plugins. */
#ifndef MAROTTE_DEVICES_TRACE_H
#define MAROTTE_DEVICES_TRACE_H
#include <marotte/plugin.h>

typedef struct trace {
    int file; /* -1: off */
    char source[24];
} trace;

/* source: "cyberglove"; a file that cannot be opened is said once as a warning. */
void trace_open(trace *self, const mrt_host *host, const char *source);
void trace_sent(trace *self, int64_t time_ns, const void *bytes, size_t size);
void trace_received(trace *self, int64_t time_ns, const void *bytes, size_t size);
/* A line of text: "opened /dev/ttyUSB0", "refused T". */
void trace_note(trace *self, int64_t time_ns, const char *text);
void trace_close(trace *self); /* accepts one that is off */

#endif
