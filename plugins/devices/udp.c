#include "udp.h"
#include "device_io.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <linux/errqueue.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* Receive buffer for times when the reader is not scheduled; the system may give less. */
enum { RECEIVE_BYTES = 1 << 20 };

/* ---- addresses ---- */

static bool is_printable(const char *text)
{
    for (; *text; ++text)
        if ((unsigned char)*text <= ' ' || (unsigned char)*text > '~')
            return false;
    return true;
}

static bool parse_port(uint16_t *out, const char *text, size_t length)
{
    uint32_t port = 0;
    if (length == 0 || length > 5)
        return false;
    for (size_t i = 0; i < length; ++i) {
        if (text[i] < '0' || text[i] > '9')
            return false;
        port = port * 10 + (uint32_t)(text[i] - '0');
    }
    *out = (uint16_t)port;
    return port >= 1 && port <= 65535;
}

static bool parse_host(char *out, const char *text, size_t length)
{
    if (length >= 2 && text[0] == '[' && text[length - 1] == ']') {
        text += 1;
        length -= 2;
    } else if (memchr(text, ':', length)) {
        return false; /* IPv6 without brackets: the port is ambiguous */
    }
    if (length == 0 || length >= UDP_HOST)
        return false;
    memcpy(out, text, length);
    out[length] = '\0';
    if (strcmp(out, "localhost") == 0)
        snprintf(out, UDP_HOST, "127.0.0.1");
    return is_printable(out);
}

/* Returns the last ':' before `end`; NULL: none. */
static const char *last_colon(const char *text, const char *end)
{
    while (end > text)
        if (*--end == ':')
            return end;
    return NULL;
}

bool udp_address_parse(char out_host[UDP_HOST], uint16_t *out_port, const char *text, size_t length)
{
    const char *end = text + length;
    const char *colon = last_colon(text, end);
    const char *port = colon ? colon + 1 : text;
    if (!parse_port(out_port, port, (size_t)(end - port)))
        return false;
    return !colon || parse_host(out_host, text, (size_t)(colon - text));
}

static const uint8_t mapped[12] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

static bool is_same_peer(const udp_peer *a, const udp_peer *b)
{
    return a->port == b->port && memcmp(a->ip, b->ip, sizeof a->ip) == 0;
}

void udp_peer_text(const udp_peer *peer, char *out, size_t capacity)
{
    char ip[INET6_ADDRSTRLEN] = "?";
    if (memcmp(peer->ip, mapped, sizeof mapped) == 0) {
        inet_ntop(AF_INET, peer->ip + sizeof mapped, ip, sizeof ip);
        snprintf(out, capacity, "%s:%u", ip, (unsigned)peer->port);
    } else {
        inet_ntop(AF_INET6, peer->ip, ip, sizeof ip);
        snprintf(out, capacity, "[%s]:%u", ip, (unsigned)peer->port);
    }
}

/* ---- sockets ---- */

static struct addrinfo *find_address(const char *host, uint16_t number, int flags, char *out_reason)
{
    char port[8];
    snprintf(port, sizeof port, "%u", (unsigned)number);
    struct addrinfo hints = {
        .ai_family = AF_UNSPEC, .ai_socktype = SOCK_DGRAM, .ai_flags = flags | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    int error = getaddrinfo(host, port, &hints, &found);
    if (error == 0 && found)
        return found;
    snprintf(out_reason, UDP_REASON, "%.100s: %s", host, gai_strerror(error));
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
        return "another program or input already listens there: use the same address for all "
               "inputs, or another port";
    if (error == EADDRNOTAVAIL)
        return "this computer does not have this address: write 0.0.0.0 to listen on all its "
               "addresses";
    if (error == EACCES)
        return "you have no permission: choose port 1024 or above";
    return "choose another port";
}

int udp_bind(const char *host, uint16_t port, char out_reason[UDP_REASON])
{
    struct addrinfo *address = find_address(host, port, AI_PASSIVE | AI_NUMERICHOST, out_reason);
    if (!address) {
        snprintf(out_reason, UDP_REASON,
                 "%.100s is not a numeric address of this computer: write 0.0.0.0:%u to receive "
                 "from other computers, or only the port to receive from this one",
                 host, (unsigned)port);
        return -1;
    }
    int fd = open_socket(address);
    int receive_bytes = RECEIVE_BYTES;
    if (fd >= 0)
        (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    if (fd < 0 || bind(fd, address->ai_addr, address->ai_addrlen) != 0) {
        int error = errno;
        snprintf(out_reason, UDP_REASON, "cannot listen on %.100s port %u: %s: %s", host,
                 (unsigned)port, strerror(error), advice_for_bind(error));
        udp_close(fd);
        fd = -1;
    }
    freeaddrinfo(address);
    return fd;
}

int udp_connect(const char *host, uint16_t port, char out_reason[UDP_REASON])
{
    char why[UDP_REASON];
    struct addrinfo *address = find_address(host, port, 0, why);
    if (!address) {
        snprintf(out_reason, UDP_REASON,
                 "%.200s: write the other computer's address, as in 192.168.1.20:%u", why,
                 (unsigned)port);
        return -1;
    }
    int fd = open_socket(address);
    if (fd < 0 || connect(fd, address->ai_addr, address->ai_addrlen) != 0) {
        snprintf(out_reason, UDP_REASON, "cannot send to %.100s port %u: %s", host, (unsigned)port,
                 strerror(errno));
        udp_close(fd);
        fd = -1;
    }
    freeaddrinfo(address);
    return fd;
}

void udp_close(int socket)
{
    if (socket >= 0)
        close(socket);
}

static bool is_passing(int error)
{
    return error == EAGAIN || error == EINTR || error == ECONNREFUSED;
}

static udp_peer peer_of(const void *from, sa_family_t family)
{
    udp_peer out = {{0}, 0};
    if (family == AF_INET6) {
        struct sockaddr_in6 address;
        memcpy(&address, from, sizeof address);
        memcpy(out.ip, &address.sin6_addr, sizeof out.ip);
        out.port = ntohs(address.sin6_port);
    } else if (family == AF_INET) {
        struct sockaddr_in address;
        memcpy(&address, from, sizeof address);
        memcpy(out.ip, mapped, sizeof mapped);
        memcpy(out.ip + 12, &address.sin_addr, 4);
        out.port = ntohs(address.sin_port);
    }
    return out;
}

int64_t udp_receive(int socket, void *out, size_t capacity, udp_peer *out_peer, int64_t deadline_ns)
{
    for (;;) {
        struct sockaddr_storage from = {0};
        socklen_t from_size = sizeof from;
        ssize_t size = recvfrom(socket, out, capacity, 0, (struct sockaddr *)&from, &from_size);
        if (size >= 0) {
            *out_peer = peer_of(&from, from.ss_family);
            return size > 0 ? size : 1; /* an empty one counts as 1 byte: both are invalid */
        }
        if (!is_passing(errno))
            return UDP_FAILED;
        if (errno != EAGAIN) /* error report of an earlier datagram */
            continue;
        int64_t span_ns = deadline_ns - device_clock_ns();
        if (span_ns <= 0)
            return UDP_NOTHING;
        if (device_wait(socket, span_ns) < 0)
            return UDP_FAILED;
    }
}

int udp_send(int socket, const void *bytes, size_t size)
{
    if (send(socket, bytes, size, MSG_NOSIGNAL) >= 0)
        return 0;
    int error = errno;
    /* The error belongs to an earlier datagram, and this one was not sent. */
    if (error == ECONNREFUSED)
        (void)!send(socket, bytes, size, MSG_NOSIGNAL);
    return error;
}

/* Converts the address to the socket's family. Returns 0 if that family does not have it. */
static socklen_t address_of(struct sockaddr_storage *out, const udp_peer *peer, int socket)
{
    struct sockaddr_storage own = {0};
    socklen_t size = sizeof own;
    bool is_four = memcmp(peer->ip, mapped, sizeof mapped) == 0;
    if (getsockname(socket, (struct sockaddr *)&own, &size) != 0)
        return 0;
    *out = (struct sockaddr_storage){0};
    if (own.ss_family == AF_INET && is_four) {
        struct sockaddr_in four = {.sin_family = AF_INET, .sin_port = htons(peer->port)};
        memcpy(&four.sin_addr, peer->ip + sizeof mapped, sizeof four.sin_addr);
        memcpy(out, &four, sizeof four);
        return sizeof four;
    }
    if (own.ss_family != AF_INET6)
        return 0;
    struct sockaddr_in6 six = {.sin6_family = AF_INET6, .sin6_port = htons(peer->port)};
    memcpy(&six.sin6_addr, peer->ip, sizeof six.sin6_addr);
    memcpy(out, &six, sizeof six);
    return sizeof six;
}

int udp_send_to(int socket, const udp_peer *to, const void *bytes, size_t size)
{
    struct sockaddr_storage address;
    socklen_t address_size = address_of(&address, to, socket);
    if (address_size == 0)
        return EAFNOSUPPORT;
    for (int again = 1;; --again) {
        if (sendto(socket, bytes, size, MSG_NOSIGNAL, (struct sockaddr *)&address, address_size) >=
            0)
            return 0;
        /* The error belongs to an earlier datagram, to any receiver: this one was not sent. */
        if (again == 0 || (errno != ECONNREFUSED && errno != EHOSTUNREACH && errno != EHOSTDOWN))
            return errno == ECONNREFUSED ? 0 : errno;
    }
}

void udp_keep_failures(int socket)
{
    const int on = 1;
    (void)setsockopt(socket, IPPROTO_IP, IP_RECVERR, &on, sizeof on);
    (void)setsockopt(socket, IPPROTO_IPV6, IPV6_RECVERR, &on, sizeof on);
}

int udp_failure(int socket, udp_peer *out_to)
{
    struct sockaddr_storage to = {0};
    char start[1]; /* content of the datagram, which is not used */
    union {
        struct cmsghdr head;
        char bytes[512];
    } control;
    struct iovec data = {start, sizeof start};
    struct msghdr message = {.msg_name = &to,
                             .msg_namelen = sizeof to,
                             .msg_iov = &data,
                             .msg_iovlen = 1,
                             .msg_control = &control,
                             .msg_controllen = sizeof control};
    if (recvmsg(socket, &message, MSG_ERRQUEUE | MSG_DONTWAIT) < 0)
        return 0;
    *out_to = peer_of(&to, to.ss_family);
    for (struct cmsghdr *part = CMSG_FIRSTHDR(&message); part; part = CMSG_NXTHDR(&message, part)) {
        struct sock_extended_err why;
        bool is_why = (part->cmsg_level == IPPROTO_IP && part->cmsg_type == IP_RECVERR) ||
                      (part->cmsg_level == IPPROTO_IPV6 && part->cmsg_type == IPV6_RECVERR);
        if (!is_why || part->cmsg_len < CMSG_LEN(sizeof why))
            continue;
        memcpy(&why, CMSG_DATA(part), sizeof why);
        return why.ee_errno ? (int)why.ee_errno : EIO;
    }
    return EIO;
}

bool udp_peer_resolve(udp_peer *out, const char *host, uint16_t port, char out_reason[UDP_REASON])
{
    struct addrinfo *address = find_address(host, port, 0, out_reason);
    if (!address)
        return false;
    *out = peer_of(address->ai_addr, address->ai_addr->sa_family);
    freeaddrinfo(address);
    return true;
}

/* ---- near ---- */

bool udp_peer_is_in(const udp_peer *peer, const udp_net *net, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        int differs = 0;
        for (size_t k = 0; k < sizeof peer->ip; ++k)
            differs |= (peer->ip[k] ^ net[i].ip[k]) & net[i].mask[k];
        if (!differs)
            return true;
    }
    return false;
}

/* Reads the network of an interface that is up. Returns false if it has no internet address. */
static bool net_of(udp_net *out, const struct ifaddrs *interface)
{
    const struct sockaddr *address = interface->ifa_addr, *mask = interface->ifa_netmask;
    if (!address || !mask || !(interface->ifa_flags & IFF_UP) ||
        (address->sa_family != AF_INET && address->sa_family != AF_INET6))
        return false;
    udp_peer own = peer_of(address, address->sa_family);
    udp_peer covers = peer_of(mask, address->sa_family);
    memcpy(out->ip, own.ip, sizeof out->ip);
    memcpy(out->mask, covers.ip, sizeof out->mask);
    if (address->sa_family == AF_INET)
        memset(out->mask, 0xff, sizeof mapped);
    return true;
}

bool udp_peer_is_near(const udp_peer *peer)
{
    struct ifaddrs *all = NULL;
    bool is_near = false;
    if (getifaddrs(&all) != 0)
        return false;
    for (const struct ifaddrs *one = all; one && !is_near; one = one->ifa_next) {
        udp_net net;
        is_near = net_of(&net, one) && udp_peer_is_in(peer, &net, 1);
    }
    freeifaddrs(all);
    return is_near;
}

bool udp_is_own(const udp_peer *peer)
{
    char text[UDP_PEER_TEXT], reason[UDP_REASON];
    udp_peer any_port = {.port = 0};
    memcpy(any_port.ip, peer->ip, sizeof any_port.ip);
    udp_peer_text(&any_port, text, sizeof text);
    char *end = strrchr(text, ':'), *host = text[0] == '[' ? text + 1 : text;
    end[text[0] == '[' ? -1 : 0] = '\0';
    int fd = udp_bind(host, 0, reason);
    udp_close(fd);
    return fd >= 0;
}

/* ---- the owner of one kind of data ---- */

static const int64_t silence_ns = 1000000000;

bool udp_owner_is(const udp_owner *owner, const udp_peer *peer)
{
    return owner->known && is_same_peer(&owner->peer, peer);
}

void udp_owner_release(udp_owner *owner)
{
    *owner = (udp_owner){0};
}

static bool is_silent(int64_t heard_ns, int64_t now_ns)
{
    return now_ns - heard_ns > silence_ns;
}

bool udp_owner_admits(udp_owner *owner, const udp_peer *peer, int64_t now_ns)
{
    if (!udp_owner_is(owner, peer)) {
        if (owner->known && !is_silent(owner->heard_ns, now_ns))
            return false;
        *owner = (udp_owner){.known = true, .established = true, .peer = *peer};
    }
    owner->heard_ns = now_ns;
    return true;
}

static bool is_back(const udp_owner *owner, const udp_peer *peer, int64_t now_ns)
{
    return owner->former_known && is_same_peer(&owner->former, peer) &&
           !is_silent(owner->former_heard_ns, now_ns);
}

bool udp_owner_admits_single(udp_owner *owner, const udp_peer *peer, int64_t now_ns)
{
    bool holds = owner->known && !is_silent(owner->heard_ns, now_ns);
    if (udp_owner_is(owner, peer)) {
        owner->established = holds;
        owner->heard_ns = now_ns;
        return true;
    }
    if (holds && owner->established)
        return false;
    *owner = (udp_owner){.known = true,
                         .established = is_back(owner, peer, now_ns),
                         .former_known = holds,
                         .peer = *peer,
                         .former = owner->peer,
                         .heard_ns = now_ns,
                         .former_heard_ns = owner->heard_ns};
    return true;
}

/* ---- datagrams to one receiver ---- */

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
        device_log(
            self->host, MRT_LOG_ERROR,
            "\"%.100s\" is not an address to send to: expected HOST:PORT, as in 192.168.1.20:%u",
            address, (unsigned)port);
        return MRT_ERR_ARGUMENT;
    }
    self->socket = udp_connect(self->host_name, self->port, reason);
    if (self->socket < 0) {
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    trace_open(&self->trace, self->host, source);
    return MRT_OK;
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
    if (error == 0 || is_passing(error) || error == ENOBUFS) /* no space now, or no listener */
        return self->refused_ns && now_ns - self->refused_ns < unheard_ns ? MRT_TIMEOUT : MRT_OK;
    device_log(self->host, MRT_LOG_ERROR, "cannot reach %s port %u: %s", self->host_name,
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
