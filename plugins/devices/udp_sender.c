#include "udp_sender.h"
#include "device_io.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const int64_t unheard_ns = 1000000000;

void udp_sender_init(udp_sender *self, const mrt_host *host)
{
    *self = (udp_sender){.host = host, .socket = -1, .trace = {.file = -1}};
}

mrt_result udp_sender_open(udp_sender *self, const char *address, uint16_t port, const char *source)
{
    char reason[UDP_REASON];
    udp_sender_close(self);
    (void)snprintf(self->host_name, sizeof self->host_name, "127.0.0.1");
    self->port = port;
    self->refused_ns = 0;
    if (address[0] && !udp_address_parse(self->host_name, &self->port, address, strlen(address))) {
        device_say(self->host, MRT_LOG_ERROR,
                   "\"%.100s\" is no address to send to: expected HOST:PORT, as in 192.168.1.20:%u",
                   address, (unsigned)port);
        return MRT_ERR_ARGUMENT;
    }
    self->socket = udp_connect(self->host_name, self->port, reason);
    if (self->socket < 0) {
        device_say(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    trace_open(&self->trace, self->host, source);
    return MRT_OK;
}

/* What only says that this datagram has no room now, or that nobody listens. */
static bool is_passing(int error)
{
    return error == EAGAIN || error == ENOBUFS || error == EINTR || error == ECONNREFUSED;
}

mrt_result udp_sender_send(udp_sender *self, const void *bytes, size_t size)
{
    if (self->socket < 0)
        return MRT_ERR_IO;
    int64_t now_ns = device_clock_ns();
    trace_sent(&self->trace, now_ns, bytes, size);
    int error = udp_send(self->socket, bytes, size);
    if (error == ECONNREFUSED)
        self->refused_ns = now_ns;
    if (error == 0 || is_passing(error))
        return self->refused_ns && now_ns - self->refused_ns < unheard_ns ? MRT_TIMEOUT : MRT_OK;
    device_say(self->host, MRT_LOG_ERROR, "nothing reaches %s port %u: %s", self->host_name,
               (unsigned)self->port, strerror(error));
    return MRT_ERR_IO;
}

void udp_sender_close(udp_sender *self)
{
    if (self->socket < 0)
        return;
    trace_close(&self->trace);
    udp_close(self->socket);
    self->socket = -1;
}
