/* cyberglove/glove_port.h - bytes to and from a glove, over a serial port or TCP: every wait has a
 * deadline, a port that is gone says so and never spins. Times are of CLOCK_MONOTONIC: a wait for
 * a device must end whatever the host's clock does. Leaves out what the bytes mean. [main] [input],
 * one at a time. */
#ifndef MAROTTE_CYBERGLOVE_PORT_H
#define MAROTTE_CYBERGLOVE_PORT_H
#include "trace.h"

#include <marotte/plugin.h>

#include <stddef.h>
#include <termios.h>

/* ---- one line that says what failed and what to do ---- */

typedef struct glove_why {
    char text[800];
} glove_why;

/* Writes the text, cut if too long, and returns `code`. */
__attribute__((format(printf, 3, 4))) mrt_result glove_why_set(glove_why *out, mrt_result code,
                                                               const char *format, ...);
/* "53 12 ff": as many of the bytes as fit, "nothing" if there are none. */
void glove_why_hex(char *out, size_t capacity, const unsigned char *bytes, size_t count);

typedef struct glove_port {
    int file; /* -1: closed */
    trace *trace;
    char name[192]; /* "/dev/ttyUSB0", "192.168.1.5:80": for messages */
    uint32_t baud;  /* 0: no serial line */
    bool is_exclusive, has_before;
    struct termios before;
    int empty_reads;
    char
        latency_file[192]; /* the adapter collects bytes for latency_ms, and this could be mended */
    uint32_t latency_ms;   /* there; 0: it does not, or nobody knows */
} glove_port;

/* traced: open, or off; must outlive the port. */
mrt_result glove_port_open_serial(glove_port *self, const char *path, uint32_t baud, trace *traced,
                                  glove_why *why);
/* address: "192.168.1.5:3000", "[fe80::1]:3000", "localhost:3000". Waits until the deadline. */
mrt_result glove_port_open_tcp(glove_port *self, const char *address, int64_t deadline_ns,
                               trace *traced, glove_why *why);
void glove_port_close(glove_port *self); /* accepts a closed one */

/* Waits for bytes. > 0: how many were read; 0: none before the deadline; -1: the port is gone. */
int glove_port_read(glove_port *self, unsigned char *out, size_t capacity, int64_t deadline_ns);
/* False: gone, or not taken within 0.25 s. */
bool glove_port_write(glove_port *self, const void *bytes, size_t size);
/* Throws away what has come and what has not gone. */
void glove_port_flush(glove_port *self);
/* Waits until what was written has gone, 0.1 s at most. */
void glove_port_drain(const glove_port *self);
/* How long `bytes` are on the line, at least; 0 where that is unknown. */
int64_t glove_port_wire_ns(const glove_port *self, size_t bytes);

#endif
