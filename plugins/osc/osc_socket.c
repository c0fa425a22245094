#include "osc_socket.h"
#include "osc_clock.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* Room for what comes while the reader is not scheduled; the system may give less. */
enum { RECEIVE_BYTES = 1 << 20 };
static const int64_t ns_per_ms = 1000000;

static struct addrinfo *find_address(const osc_place *place, int flags, char *out_reason)
{
    char port[8];
    snprintf(port, sizeof port, "%u", (unsigned)place->port);
    struct addrinfo hints = {
        .ai_family = AF_UNSPEC, .ai_socktype = SOCK_DGRAM, .ai_flags = flags | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    int error = getaddrinfo(place->host, port, &hints, &found);
    if (error == 0 && found)
        return found;
    snprintf(out_reason, OSC_REASON, "%.100s: %s", place->host, gai_strerror(error));
    return NULL;
}

static int open_socket(const struct addrinfo *address)
{
    int fd = socket(address->ai_family, SOCK_DGRAM, 0);
    if (fd < 0)
        return -1;
    if (fcntl(fd, F_SETFD, FD_CLOEXEC) == 0 && fcntl(fd, F_SETFL, O_NONBLOCK) == 0)
        return fd;
    close(fd);
    return -1;
}

static const char *advice_for_bind(int error)
{
    if (error == EADDRINUSE)
        return "another program, or another input under another address, listens there: write the "
               "same address for all inputs, or another port";
    if (error == EADDRNOTAVAIL)
        return "this computer has no such address: write 0.0.0.0 for all that it has";
    if (error == EACCES)
        return "this user may not: choose a port from 1024 on";
    return "choose another port";
}

int osc_socket_bind(const osc_place *place, char *out_reason)
{
    struct addrinfo *address = find_address(place, AI_PASSIVE | AI_NUMERICHOST, out_reason);
    if (!address) {
        snprintf(out_reason, OSC_REASON,
                 "%.100s is no address of this computer in numbers: write 0.0.0.0:%u to hear other "
                 "computers, or the port alone to hear this one",
                 place->host, (unsigned)place->port);
        return -1;
    }
    int fd = open_socket(address);
    int receive_bytes = RECEIVE_BYTES;
    if (fd >= 0)
        (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    if (fd < 0 || bind(fd, address->ai_addr, address->ai_addrlen) != 0) {
        int error = errno;
        snprintf(out_reason, OSC_REASON, "cannot listen at %.100s port %u: %s: %s", place->host,
                 (unsigned)place->port, strerror(error), advice_for_bind(error));
        osc_socket_close(fd);
        fd = -1;
    }
    freeaddrinfo(address);
    return fd;
}

int osc_socket_connect(const osc_place *place, char *out_reason)
{
    char why[OSC_REASON];
    struct addrinfo *address = find_address(place, 0, why);
    if (!address) {
        snprintf(out_reason, OSC_REASON,
                 "%.200s: write the other computer's address, as in 192.168.1.20:%u", why,
                 OSC_PORT);
        return -1;
    }
    int fd = open_socket(address);
    if (fd < 0 || connect(fd, address->ai_addr, address->ai_addrlen) != 0) {
        snprintf(out_reason, OSC_REASON, "cannot send to %.100s port %u: %s", place->host,
                 (unsigned)place->port, strerror(errno));
        osc_socket_close(fd);
        fd = -1;
    }
    freeaddrinfo(address);
    return fd;
}

void osc_socket_close(int socket)
{
    if (socket >= 0)
        close(socket);
}

static bool is_passing(int error)
{
    return error == EAGAIN || error == EINTR || error == ECONNREFUSED;
}

static osc_peer peer_of(const struct sockaddr_storage *from)
{
    osc_peer out = {{0}, 0};
    if (from->ss_family == AF_INET6) {
        struct sockaddr_in6 address;
        memcpy(&address, from, sizeof address);
        memcpy(out.ip, &address.sin6_addr, sizeof out.ip);
        out.port = ntohs(address.sin6_port);
    } else if (from->ss_family == AF_INET) {
        struct sockaddr_in address;
        memcpy(&address, from, sizeof address);
        out.ip[10] = out.ip[11] = 0xff;
        memcpy(out.ip + 12, &address.sin_addr, 4);
        out.port = ntohs(address.sin_port);
    }
    return out;
}

int64_t osc_socket_receive(int socket, void *out, size_t capacity, osc_peer *out_peer,
                           int64_t deadline_ns)
{
    for (;;) {
        struct sockaddr_storage from = {0};
        socklen_t from_size = sizeof from;
        ssize_t size = recvfrom(socket, out, capacity, 0, (struct sockaddr *)&from, &from_size);
        if (size >= 0) {
            *out_peer = peer_of(&from);
            return size > 0 ? size : 1; /* an empty datagram is no OSC, as one of a byte is none */
        }
        if (!is_passing(errno))
            return OSC_SOCKET_FAILED;
        /* Whole ms, rounded down: rather early than late. */
        int64_t left_ms = (deadline_ns - osc_clock_ns()) / ns_per_ms;
        struct pollfd ready = {.fd = socket, .events = POLLIN};
        int count = poll(&ready, 1, left_ms <= 0 ? 0 : left_ms > 1000 ? 1000 : (int)left_ms);
        if (count < 0 && errno != EINTR)
            return OSC_SOCKET_FAILED;
        if (count <= 0 && left_ms <= 1000)
            return OSC_SOCKET_NOTHING;
    }
}

int osc_socket_send(int socket, const void *bytes, size_t size)
{
    if (send(socket, bytes, size, MSG_NOSIGNAL) >= 0)
        return 0;
    int error = errno;
    /* What is reported is an earlier datagram's error, and this one has not been sent yet. */
    if (error == ECONNREFUSED)
        (void)!send(socket, bytes, size, MSG_NOSIGNAL);
    return error;
}
