#include "osc_port.h"
#include "device_io.h"
#include "trace.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- addresses ---- */

bool osc_address_parse(osc_address *out, const char *address)
{
    *out = (osc_address){.host = "127.0.0.1", .port = OSC_PORT};
    if (!address)
        return true;
    if (strncmp(address, "udp:", 4) == 0)
        address += 4;
    const char *end = address + strcspn(address, "/");
    if (*end == '/') {
        out->has_source = true;
        if (!osc_table_is_text(end + 1, OSC_SOURCE_LENGTH))
            return false;
        snprintf(out->source, sizeof out->source, "%s", end + 1);
    }
    return end == address ||
           udp_address_parse(out->host, &out->port, address, (size_t)(end - address));
}

/* ---- ports ---- */

struct osc_port {
    osc_port *next;
    uint32_t user_count;
    osc_address address;
    int socket;
    pthread_mutex_t mutex;
    pthread_cond_t changed; /* signalled after a packet, and when no input receives any more */
    bool is_receiving;      /* an input waits at the socket, without the mutex */
    osc_dispatcher dispatcher;
    trace trace;
    unsigned char packet[OSC_PACKET_MAX]; /* buffer of the receiving input */
};

static pthread_mutex_t ports_mutex = PTHREAD_MUTEX_INITIALIZER;
static osc_port *ports; /* guarded by ports_mutex */

/* ---- opening ---- */

static osc_port *find_port(const osc_address *address)
{
    for (osc_port *p = ports; p; p = p->next)
        if (p->address.port == address->port && strcmp(p->address.host, address->host) == 0)
            return p;
    return NULL;
}

static osc_port *make_port(const osc_address *address, const mrt_host *host, char *out_reason)
{
    osc_port *self = calloc(1, sizeof *self);
    if (!self) {
        snprintf(out_reason, UDP_REASON, "out of memory for port %u", (unsigned)address->port);
        return NULL;
    }
    self->address = *address;
    self->socket = udp_bind(address->host, address->port, out_reason);
    if (self->socket < 0) {
        free(self);
        return NULL;
    }
    osc_dispatcher_start(&self->dispatcher);
    trace_open(&self->trace, host, "osc");
    pthread_mutex_init(&self->mutex, NULL);
    device_condition_init(&self->changed);
    return self;
}

osc_port *osc_port_open(const osc_address *address, const mrt_host *host, char *out_reason)
{
    pthread_mutex_lock(&ports_mutex);
    osc_port *found = find_port(address);
    if (!found) {
        found = make_port(address, host, out_reason);
        if (found) {
            found->next = ports;
            ports = found;
        }
    }
    if (found)
        found->user_count += 1;
    pthread_mutex_unlock(&ports_mutex);
    return found;
}

static void take_off_list(const osc_port *port)
{
    for (osc_port **at = &ports; *at; at = &(*at)->next)
        if (*at == port) {
            *at = port->next;
            return;
        }
}

void osc_port_close(osc_port *port)
{
    if (!port)
        return;
    pthread_mutex_lock(&ports_mutex);
    bool is_last = --port->user_count == 0;
    if (is_last)
        take_off_list(port);
    pthread_mutex_unlock(&ports_mutex);
    if (!is_last)
        return;
    udp_close(port->socket);
    trace_close(&port->trace);
    pthread_cond_destroy(&port->changed);
    pthread_mutex_destroy(&port->mutex);
    free(port);
}

void osc_port_lock(osc_port *port)
{
    pthread_mutex_lock(&port->mutex);
}

void osc_port_unlock(osc_port *port)
{
    pthread_mutex_unlock(&port->mutex);
}

void osc_port_join(osc_port *port, osc_listener *listener)
{
    osc_port_lock(port);
    osc_dispatcher_join(&port->dispatcher, listener, device_clock_ns());
    osc_port_unlock(port);
}

void osc_port_leave(osc_port *port, osc_listener *listener)
{
    osc_port_lock(port);
    osc_dispatcher_leave(&port->dispatcher, listener);
    osc_port_unlock(port);
}

/* ---- receiving ---- */

/* Waits at the socket without the mutex, and processes the received packet with it. Returns false
 * if the socket failed. */
static bool receive(osc_port *self, int64_t deadline_ns, const mrt_host *host)
{
    udp_peer peer;
    self->is_receiving = true;
    osc_port_unlock(self);
    int64_t size = udp_receive(self->socket, self->packet, sizeof self->packet, &peer, deadline_ns);
    int64_t now_ns = device_clock_ns();
    osc_port_lock(self);
    self->is_receiving = false;
    if (size > 0) {
        trace_received(&self->trace, now_ns, self->packet, (size_t)size);
        osc_dispatcher_process(&self->dispatcher, self->packet, (size_t)size, &peer, now_ns, host);
    }
    pthread_cond_broadcast(&self->changed);
    return size != UDP_FAILED;
}

bool osc_port_wait(osc_port *port, const osc_listener *listener, int64_t deadline_ns,
                   const mrt_host *host)
{
    bool works = true;
    osc_port_lock(port);
    bool had_channels = listener->table.count > 0;
    bool is_first = true; /* process waiting packets even if there is no time to wait */
    while (works && listener->count == 0 && !listener->has_ended && !listener->has_other_channels &&
           had_channels == (listener->table.count > 0)) {
        if (!is_first && deadline_ns - device_clock_ns() < OSC_PORT_WAIT_LEAST_NS)
            break;
        if (port->is_receiving)
            (void)device_condition_wait(&port->changed, &port->mutex, deadline_ns);
        else
            works = receive(port, deadline_ns, host);
        is_first = false;
    }
    osc_port_unlock(port);
    return works;
}

/* ---- reports ---- */

void osc_port_name_sources(osc_port *port, char *out, size_t capacity)
{
    osc_port_lock(port);
    osc_dispatcher_name_sources(&port->dispatcher, device_clock_ns(), out, capacity);
    osc_port_unlock(port);
}

void osc_port_summary(osc_port *port, char *out, size_t capacity)
{
    osc_port_lock(port);
    const osc_dispatcher *dispatcher = &port->dispatcher;
    uint32_t faulty = 0;
    for (int i = 0; i < OSC_FAULT_KINDS; ++i)
        faulty += dispatcher->fault_count[i];
    out[0] = '\0';
    if (faulty + dispatcher->late_count > 0) /* samples before the channels are normal */
        snprintf(out, capacity,
                 "port %u: dropped %u late samples, %u samples without a channel list, %u faulty "
                 "messages",
                 (unsigned)port->address.port, dispatcher->late_count, dispatcher->untold_count,
                 faulty);
    osc_port_unlock(port);
}
