/* plugins/osc/osc_port.h - one UDP port of this computer and those who listen there. Several inputs
 * of one program may have the same port: a datagram goes to one socket only, so they share it, and
 * whichever of them waits receives for all. There is no thread: packets are taken while some input
 * reads. The list of open ports is the one thing in this plugin that is shared between instances.
 */
#ifndef MAROTTE_OSC_PORT_H
#define MAROTTE_OSC_PORT_H
#include "osc_dispatcher.h"
#include "udp.h"

#include <stdbool.h>

/* The address of an input or output as the user writes it: [udp:][HOST:]PORT[/SOURCE], HOST a name,
 * an IPv4 or a bracketed IPv6 address. "" is the port 9105 of this computer. */
enum { OSC_PORT = 9105 };

typedef struct osc_address {
    char host[UDP_HOST]; /* without brackets; 127.0.0.1 when none was given */
    uint16_t port;       /* 1..65535 */
    bool has_source;     /* there was a '/' */
    char source[OSC_SOURCE_LENGTH];
} osc_address;

/* False: it is no such address. Pure. */
bool osc_address_parse(osc_address *out, const char *address);

typedef struct osc_port osc_port;

/* Less is not waited for. */
enum { OSC_PORT_WAIT_LEAST_NS = 1000000 };

/* The port at this address, opened by the first who asks. NULL: out_reason (UDP_REASON) says why.
 * With MAROTTE_TRACE (trace.h) what comes in is written down; `host` is told if that cannot be. */
osc_port *osc_port_open(const osc_address *address, const mrt_host *host, char *out_reason);
/* The last one closes the socket. NULL is fine. */
void osc_port_close(osc_port *port);

void osc_port_join(osc_port *port, osc_listener *listener);
void osc_port_leave(osc_port *port, osc_listener *listener);

/* A listener that has joined is read and written between these two. */
void osc_port_lock(osc_port *port);
void osc_port_unlock(osc_port *port);

/* Receives until the listener has an item in its queue, or channels of its source when it had none,
 * or its sender ended; or until the deadline (device_clock_ns), never past it. False: the socket
 * failed. `host` is told what is wrong with packets. */
bool osc_port_wait(osc_port *port, const osc_listener *listener, int64_t deadline_ns,
                   const mrt_host *host);

/* Who forwards to this port now. */
void osc_port_name_sources(osc_port *port, char *out, size_t capacity);
/* What was dropped since the port is open, for the log; "" when nothing worth a word was. */
void osc_port_summary(osc_port *port, char *out, size_t capacity);

#endif
