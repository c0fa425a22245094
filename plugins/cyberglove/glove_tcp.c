/* The wireless CyberGlove III: a TCP connection. Numeric addresses, because looking up a name can
 * take half a minute. */
#include "glove_port.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

typedef struct tcp_address {
    char host[96], service[8];
} tcp_address;

/* "HOST:PORT", "[HOST]:PORT" */
static bool split(const char *address, tcp_address *out)
{
    const char *colon = strrchr(address, ':');
    if (!colon || colon == address)
        return false;
    size_t host_length = (size_t)(colon - address);
    size_t digits = strspn(colon + 1, "0123456789");
    if (digits == 0 || digits > 5 || colon[1 + digits] != '\0')
        return false;
    long port = strtol(colon + 1, NULL, 10);
    if (port < 1 || port > 65535)
        return false;
    if (address[0] == '[') {
        if (host_length < 3 || address[host_length - 1] != ']')
            return false;
        address += 1;
        host_length -= 2;
    }
    if (host_length >= sizeof out->host)
        return false;
    memcpy(out->host, address, host_length);
    out->host[host_length] = '\0';
    memcpy(out->service, colon + 1, digits + 1);
    if (strcmp(out->host, "localhost") == 0)
        snprintf(out->host, sizeof out->host, "127.0.0.1");
    return true;
}

/* 0: connected; else an errno. */
static int connect_by(int file, const struct addrinfo *to, int64_t deadline_ns)
{
    if (connect(file, to->ai_addr, to->ai_addrlen) == 0)
        return 0;
    if (errno != EINPROGRESS)
        return errno;
    int64_t wait_ns = deadline_ns - glove_port_now_ns();
    struct pollfd wanted = {.fd = file, .events = POLLOUT};
    if (poll(&wanted, 1, wait_ns > 0 ? (int)(wait_ns / 1000000) + 1 : 0) <= 0)
        return ETIMEDOUT;
    int failure = 0;
    socklen_t size = sizeof failure;
    if (getsockopt(file, SOL_SOCKET, SO_ERROR, &failure, &size) != 0)
        return errno;
    return failure;
}

static int open_socket(const struct addrinfo *to)
{
    int file = socket(to->ai_family, SOCK_STREAM, 0);
    if (file < 0)
        return -1;
    int one = 1;
    setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    if (fcntl(file, F_SETFD, FD_CLOEXEC) != 0 || fcntl(file, F_SETFL, O_NONBLOCK) != 0) {
        close(file);
        return -1;
    }
    return file;
}

mrt_result glove_port_open_tcp(glove_port *self, const char *address, int64_t deadline_ns,
                               trace *traced, glove_why *why)
{
    *self = (glove_port){.file = -1, .trace = traced};
    snprintf(self->name, sizeof self->name, "%s", address);
    tcp_address parts;
    if (!split(address, &parts))
        return glove_why_set(why, MRT_ERR_ARGUMENT,
                             "tcp:%.80s: expected tcp:ADDRESS:PORT, as in tcp:192.168.1.5:3000",
                             address);
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM,
                             .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *to = NULL;
    if (getaddrinfo(parts.host, parts.service, &hints, &to) != 0)
        return glove_why_set(
            why, MRT_ERR_ARGUMENT,
            "tcp:%.80s: write the glove's address as numbers, as in tcp:192.168.1.5:3000", address);
    int file = open_socket(to);
    int failure = file < 0 ? errno : connect_by(file, to, deadline_ns);
    freeaddrinfo(to);
    if (failure == 0) {
        self->file = file;
        return MRT_OK;
    }
    if (file >= 0)
        close(file);
    return glove_why_set(why, MRT_ERR_IO,
                         "%.80s: no connection (%s): is the glove on, and in this network?",
                         address, strerror(failure));
}
