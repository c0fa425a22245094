/* plugins/devices/trace.h - a log of all bytes to and from a device, to find out how it really
 * behaves. Lines are appended to the file named by the environment variable MAROTTE_TRACE, one line
 * per transfer: "TIME_NS SOURCE > 47" (to the device) or "TIME_NS SOURCE < 47 ff 00" (from it).
 * Several plugins can write to one file. Off if the variable is unset or the file cannot be
 * written. One thread at a time. Shared by input plugins. */
#ifndef MAROTTE_DEVICES_TRACE_H
#define MAROTTE_DEVICES_TRACE_H
#include <marotte/plugin.h>

typedef struct trace {
    int file; /* -1: off */
    char source[24];
} trace;

/* Opens the trace. source: "cyberglove". If the file cannot be opened, logs one warning. */
void trace_open(trace *self, const mrt_host *host, const char *source);
void trace_sent(trace *self, int64_t time_ns, const void *bytes, size_t size);
void trace_received(trace *self, int64_t time_ns, const void *bytes, size_t size);
/* Writes a line of text: "opened /dev/ttyUSB0", "refused T". */
void trace_note(trace *self, int64_t time_ns, const char *text);
void trace_close(trace *self); /* accepts a trace that is off */

#endif
