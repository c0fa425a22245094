/* cyberglove/glove_port.h - bytes to and from a glove, over a serial port or TCP. Every wait has a
 * deadline, and reading a closed port returns an error without spinning. Times are of
 * CLOCK_MONOTONIC, because a wait for a device must end whatever the host's clock does. Leaves out
 * the meaning of the bytes. [main] [input], one at a time. */
#ifndef MAROTTE_CYBERGLOVE_PORT_H
#define MAROTTE_CYBERGLOVE_PORT_H
#include "trace.h"

#include <marotte/plugin.h>

#include <stddef.h>
#include <termios.h>

/* ---- one-line error message with the failure and the advice ---- */

typedef struct glove_error {
    char text[800];
} glove_error;

/* Writes the text, truncated if too long, and returns `code`. */
__attribute__((format(printf, 3, 4))) mrt_result glove_error_set(glove_error *out, mrt_result code,
                                                                 const char *format, ...);
/* Writes the bytes as "53 12 ff", at most as many as fit; "nothing" if count is 0. */
void glove_error_hex(char *out, size_t capacity, const unsigned char *bytes, size_t count);

typedef struct glove_port {
    int file; /* -1: closed */
    trace *trace;
    char name[192]; /* "/dev/ttyUSB0", "192.168.1.5:80": for messages */
    uint32_t baud;  /* 0: not a serial line */
    bool is_exclusive, has_before;
    struct termios before;
    int empty_reads;
    char latency_file[192]; /* file that changes latency_ms; the adapter collects bytes for that
                               time */
    uint32_t latency_ms;    /* 0: no delay, or unknown */
} glove_port;

/* traced: open or off; must outlive the port. */
mrt_result glove_port_open_serial(glove_port *self, const char *path, uint32_t baud, trace *traced,
                                  glove_error *why);
/* address: "192.168.1.5:3000", "[fe80::1]:3000", "localhost:3000". Waits until the deadline. */
mrt_result glove_port_open_tcp(glove_port *self, const char *address, int64_t deadline_ns,
                               trace *traced, glove_error *why);
void glove_port_close(glove_port *self); /* accepts a closed port */

/* Waits for bytes. Returns the number read, 0 if none arrived before the deadline, -1 if the port
 * was lost. */
int glove_port_read(glove_port *self, unsigned char *out, size_t capacity, int64_t deadline_ns);
/* Returns false if the port was lost, or did not accept the bytes within 0.25 s. */
bool glove_port_write(glove_port *self, const void *bytes, size_t size);
/* Discards received and unsent bytes. */
void glove_port_flush(glove_port *self);
/* Waits until written bytes are sent, at most 0.1 s. */
void glove_port_drain(const glove_port *self);
/* Returns the minimum transfer time of `bytes`; 0 if unknown. */
int64_t glove_port_wire_ns(const glove_port *self, size_t bytes);

#endif
