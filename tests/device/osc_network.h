/* The plugin org.marotte.osc as a host loads it, on real sockets of this computer alone: a free
 * port, and a socket that sends raw bytes. */
#ifndef TESTS_DEVICE_OSC_NETWORK_H
#define TESTS_DEVICE_OSC_NETWORK_H
#include "input_host.h"
#include "osc_bytes.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

enum { OSC_HAND, OSC_CONTENT, OSC_SILENCE };

static inline input_host *osc_node_create(void)
{
    input_host *self = input_host_create(BUILD_DIR "/plugins/osc.so");
    assert(self->output);
    return self;
}

static inline mrt_result osc_node_open_output(input_host *self, const char *address)
{
    return self->output->open(self->plugin, address, self->params);
}

/* A socket bound to this computer; its port. -1: sockets are refused here. */
static inline int osc_network_socket(uint16_t *out_port)
{
    int fd = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    socklen_t size = sizeof address;
    if (fd < 0 || bind(fd, (struct sockaddr *)&address, sizeof address) != 0 ||
        getsockname(fd, (struct sockaddr *)&address, &size) != 0) {
        if (fd >= 0)
            close(fd);
        return -1;
    }
    *out_port = ntohs(address.sin_port);
    return fd;
}

/* A port that was free a moment ago; 0: sockets are refused here. */
static inline uint16_t osc_network_free_port(void)
{
    uint16_t port = 0;
    int fd = osc_network_socket(&port);
    if (fd >= 0)
        close(fd);
    return port;
}

static inline void osc_network_send(int fd, uint16_t port, osc_bytes *packet)
{
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_port = htons(port),
                             .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    (void)sendto(fd, packet->data, packet->size, 0, (struct sockaddr *)&to, sizeof to);
    packet->size = 0;
}

#endif
