/* plugins/osc/osc_port.h - one UDP port of this computer and its listeners. Several inputs of one
 * program can use the same port. A datagram goes to one socket only, so they share it, and the
 * input that waits receives for all. There is no separate thread: packets are processed while an
 * input reads. The list of open ports is the only state that instances of this plugin share. */
#ifndef MAROTTE_OSC_PORT_H
#define MAROTTE_OSC_PORT_H
#include "osc_dispatcher.h"
#include "udp.h"

#include <stdbool.h>

/* Address of an input or output in the user's format: [udp:][HOST:]PORT[/SOURCE], HOST a name, an
 * IPv4 or a bracketed IPv6 address. "" is port 9105 of this computer. */
enum { OSC_PORT = 9105 };

typedef struct osc_address {
    char host[UDP_HOST]; /* without brackets; 127.0.0.1 by default */
    uint16_t port;       /* 1..65535 */
    bool has_source;     /* the address had a '/' */
    char source[OSC_SOURCE_LENGTH];
} osc_address;

/* Returns false for any other text. Pure. */
bool osc_address_parse(osc_address *out, const char *address);

typedef struct osc_port osc_port;

/* Shortest wait. */
enum { OSC_PORT_WAIT_LEAST_NS = 1000000 };

/* Returns the port at this address; the first call opens it. Returns NULL on failure, with the
 * reason in out_reason (UDP_REASON). With MAROTTE_TRACE (trace.h) received packets are logged; a
 * failure of that is logged through `host`. */
osc_port *osc_port_open(const osc_address *address, const mrt_host *host, char *out_reason);
/* Closes the socket when its last user closes it. Accepts NULL. */
void osc_port_close(osc_port *port);

void osc_port_join(osc_port *port, osc_listener *listener);
void osc_port_leave(osc_port *port, osc_listener *listener);

/* Access a joined listener only between these two. */
void osc_port_lock(osc_port *port);
void osc_port_unlock(osc_port *port);

/* Receives until the listener has an item in its queue, gets the channels of its source, or its
 * sender ends; or until the deadline (device_clock_ns), never longer. Returns false if the socket
 * failed. Logs faulty packets through `host`. */
bool osc_port_wait(osc_port *port, const osc_listener *listener, int64_t deadline_ns,
                   const mrt_host *host);

/* Lists the sources forwarded to this port now. */
void osc_port_name_sources(osc_port *port, char *out, size_t capacity);
/* Describes the messages dropped since the port was opened, for the log; "": nothing to report. */
void osc_port_summary(osc_port *port, char *out, size_t capacity);

#endif
