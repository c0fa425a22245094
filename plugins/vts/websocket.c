#include "websocket.h"
#include "web.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <nettle/base64.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { HEAD_MAX = 14, ROOM = WEBSOCKET_MESSAGE + 64 };

bool websocket_init(websocket *self)
{
    *self = (websocket){.fd = -1};
    self->in = malloc(ROOM);
    self->out = malloc(ROOM);
    self->text = malloc(ROOM);
    return self->in && self->out && self->text;
}

void websocket_finish(websocket *self)
{
    websocket_close(self);
    free(self->in);
    free(self->out);
    free(self->text);
    *self = (websocket){.fd = -1};
}

void websocket_close(websocket *self)
{
    if (self->fd >= 0)
        close(self->fd);
    self->fd = -1;
    self->state = WEBSOCKET_CLOSED;
    self->in_size = self->out_size = 0;
}

/* Random masks and keys need not be secret, only different. */
static uint32_t some(websocket *self)
{
    self->seed = self->seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(self->seed >> 32);
}

/* ---- connecting ---- */

bool websocket_connect(websocket *self, const char *host, uint16_t port)
{
    char service[8];
    struct addrinfo *found = NULL;
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    struct timespec now;
    int one = 1;
    websocket_close(self);
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    self->seed ^= (uint64_t)now.tv_nsec << 20 ^ (uint64_t)now.tv_sec;
    (void)snprintf(self->host, sizeof self->host, "%s", host);
    (void)snprintf(service, sizeof service, "%u", (unsigned)port);
    self->port = port;
    if (getaddrinfo(host, service, &hints, &found) != 0)
        return false;
    self->fd = socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    bool is_begun = self->fd >= 0 && (connect(self->fd, found->ai_addr, found->ai_addrlen) == 0 ||
                                      errno == EINPROGRESS);
    if (is_begun)
        (void)setsockopt(self->fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    freeaddrinfo(found);
    if (!is_begun)
        websocket_close(self);
    else
        self->state = WEBSOCKET_CONNECTING;
    return is_begun;
}

static void ask_for_upgrade(websocket *self)
{
    uint8_t raw[16];
    char key[BASE64_ENCODE_RAW_LENGTH(16) + 1] = "";
    for (size_t i = 0; i < sizeof raw; ++i)
        raw[i] = (uint8_t)some(self);
    base64_encode_raw(key, sizeof raw, raw);
    web_accept_key(key, self->expected);
    int size =
        snprintf((char *)self->out, ROOM,
                 "GET / HTTP/1.1\r\nHost: %s:%u\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                 "Sec-WebSocket-Key: %s\r\nSec-WebSocket-Version: 13\r\n\r\n",
                 self->host, (unsigned)self->port, key);
    self->out_size = size > 0 ? (size_t)size : 0;
    self->state = WEBSOCKET_UPGRADING;
}

/* ---- bytes ---- */

static bool flush(websocket *self)
{
    while (self->out_size > 0) {
        ssize_t sent = send(self->fd, self->out, self->out_size, MSG_NOSIGNAL);
        if (sent < 0)
            return errno == EAGAIN || errno == EINTR;
        memmove(self->out, self->out + sent, self->out_size - (size_t)sent);
        self->out_size -= (size_t)sent;
    }
    return true;
}

static bool fill(websocket *self)
{
    while (self->in_size < ROOM - 1) {
        ssize_t came = recv(self->fd, self->in + self->in_size, ROOM - 1 - self->in_size, 0);
        if (came == 0)
            return false;
        if (came < 0)
            return errno == EAGAIN || errno == EINTR;
        self->in_size += (size_t)came;
    }
    return true;
}

static void drop(websocket *self, size_t size)
{
    memmove(self->in, self->in + size, self->in_size - size);
    self->in_size -= size;
}

/* Returns false if the answer is not a WebSocket upgrade. */
static bool read_upgrade(websocket *self)
{
    self->in[self->in_size] = '\0';
    const char *head = (const char *)self->in, *end = strstr(head, "\r\n\r\n");
    if (!end)
        return self->in_size < 8192;
    if (strncmp(head, "HTTP/1.1 101", 12) != 0)
        return false;
    for (const char *line = strstr(head, "\r\n"); line && line < end;
         line = strstr(line + 2, "\r\n")) {
        static const char name[] = "Sec-WebSocket-Accept:";
        const char *at = line + 2;
        if (strncasecmp(at, name, sizeof name - 1) != 0)
            continue;
        at += sizeof name - 1;
        at += strspn(at, " \t");
        if (strncmp(at, self->expected, strlen(self->expected)) != 0)
            return false;
        drop(self, (size_t)(end + 4 - head));
        self->state = WEBSOCKET_OPEN;
        return true;
    }
    return false;
}

static bool is_connected(const websocket *self, bool *out_failed)
{
    struct pollfd wanted = {self->fd, POLLOUT, 0};
    int code = 0;
    socklen_t size = sizeof code;
    if (poll(&wanted, 1, 0) <= 0)
        return false;
    *out_failed = getsockopt(self->fd, SOL_SOCKET, SO_ERROR, &code, &size) != 0 || code != 0;
    return true;
}

bool websocket_step(websocket *self)
{
    bool has_failed = self->state == WEBSOCKET_CLOSED;
    if (self->state == WEBSOCKET_CONNECTING && is_connected(self, &has_failed) && !has_failed)
        ask_for_upgrade(self);
    if (!has_failed && self->state >= WEBSOCKET_UPGRADING)
        has_failed = !flush(self) || !fill(self);
    if (!has_failed && self->state == WEBSOCKET_UPGRADING)
        has_failed = !read_upgrade(self);
    if (has_failed)
        websocket_close(self);
    return !has_failed;
}

bool websocket_is_idle(const websocket *self)
{
    return self->out_size == 0;
}

/* ---- frames ---- */

static bool put_frame(websocket *self, uint32_t op, const void *text, size_t size)
{
    unsigned char head[HEAD_MAX] = {(unsigned char)(0x80u | op)}, mask[4];
    size_t used = 2;
    if (size > WEBSOCKET_MESSAGE || self->out_size + size + HEAD_MAX > ROOM)
        return false;
    if (size < 126) {
        head[1] = (unsigned char)(0x80u | size);
    } else {
        int bytes = size <= UINT16_MAX ? 2 : 8;
        head[1] = (unsigned char)(0x80u | (bytes == 2 ? 126u : 127u));
        for (int i = bytes - 1; i >= 0; --i)
            head[used++] = (unsigned char)((uint64_t)size >> (8 * i));
    }
    uint32_t word = some(self);
    for (int i = 0; i < 4; ++i)
        head[used++] = mask[i] = (unsigned char)(word >> (8 * i));
    unsigned char *out = self->out + self->out_size;
    memcpy(out, head, used);
    for (size_t i = 0; i < size; ++i)
        out[used + i] = ((const unsigned char *)text)[i] ^ mask[i % 4];
    self->out_size += used + size;
    return true;
}

bool websocket_send(websocket *self, const char *text, size_t size)
{
    return self->state == WEBSOCKET_OPEN && put_frame(self, WEB_TEXT, text, size);
}

/* Reads the frame at the front of the buffer. Returns false if it is incomplete or (*out_broken)
 * invalid. */
static bool look(const websocket *self, size_t *out_head, size_t *out_size, bool *out_broken)
{
    const unsigned char *in = self->in;
    size_t head = 2;
    if (self->in_size < head)
        return false;
    uint64_t size = in[1] & 0x7fu;
    int bytes = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (self->in_size < head + (size_t)bytes)
        return false;
    if (bytes > 0)
        size = 0;
    for (int i = 0; i < bytes; ++i)
        size = size << 8 | in[head++];
    /* Only unfragmented texts without a mask, which is all that the supported programs send. */
    *out_broken = size > WEBSOCKET_MESSAGE || (in[1] & 0x80u) || !(in[0] & 0x80u);
    *out_head = head;
    *out_size = (size_t)size;
    return !*out_broken && self->in_size >= head + size;
}

const char *websocket_receive(websocket *self)
{
    size_t head, size;
    bool is_broken = false;
    while (self->state == WEBSOCKET_OPEN && look(self, &head, &size, &is_broken)) {
        uint32_t op = self->in[0] & 0xfu;
        if (op == WEB_TEXT) {
            memcpy(self->text, self->in + head, size);
            self->text[size] = '\0';
            drop(self, head + size);
            return self->text;
        }
        if (op == WEB_PING)
            (void)put_frame(self, WEB_PONG, self->in + head, size);
        is_broken = op == WEB_CLOSE;
        drop(self, head + size);
        if (is_broken)
            break;
    }
    if (is_broken)
        websocket_close(self);
    return NULL;
}
