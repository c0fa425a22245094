#include "camera_port.h"
#include "device_io.h"
#include "trace.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { CONNECTIONS = 24, OUT_MAX = 2048, SEND_AT_ONCE = 256 * 1024, BACKLOG = 16 };
static const int64_t ns_per_s = 1000000000;
/* Time limits: for a complete request, and for progress in sending. */
static const int64_t request_span_ns = 5000000000, stall_span_ns = 10000000000;
/* Largest plausible age of a picture on arrival. */
static const int64_t past_most_ns = 2000000000;
static const int64_t file_most = 64 << 20;

typedef enum connection_state {
    FREE = 0,
    ASKING,    /* receiving the head of a request */
    ANSWERING, /* sending an answer, then closing */
    PAGE       /* the WebSocket */
} connection_state;

typedef struct connection {
    connection_state state;
    int socket, file; /* file to send after `out`; -1: none */
    int64_t until_ns; /* deadline for progress; not for PAGE */
    unsigned char in[WEB_HEAD_MAX], out[OUT_MAX];
    size_t in_size, out_size, out_sent;
    const unsigned char *body; /* data to send after `out`, if there is no file */
    size_t body_size, body_sent;
    off_t file_sent, file_size;
    bool is_ending; /* PAGE: closed when everything is sent */
} connection;

struct camera_port {
    camera_port *next;
    uint32_t user_count;
    uint16_t number;
    char token[CAMERA_TOKEN + 1], package[CAMERA_PATH];
    int listening;
    pthread_mutex_t mutex;
    pthread_cond_t changed; /* a new frame, or no input handles the sockets any more */
    bool is_working;        /* an input waits in ppoll, without the mutex */
    connection connection[CONNECTIONS];
    int page;        /* index of the page's connection; -1: none */
    clock_map clock; /* from the page's clock to ours, from its pings */
    int64_t last_ns;
    camera_listener *listeners;
    trace trace; /* messages of the page, unmasked */
};

static pthread_mutex_t ports_mutex = PTHREAD_MUTEX_INITIALIZER;
static camera_port *ports; /* guarded by ports_mutex */

void camera_port_address(uint16_t port, const char *token, char out[CAMERA_ADDRESS])
{
    (void)snprintf(out, CAMERA_ADDRESS, "http://127.0.0.1:%u/%s/", (unsigned)port, token);
}

/* ---- the files of the package ---- */

static const struct {
    const char *name, *type;
} package_file[] = {{"hands.js", "text/javascript"},
                    {"hands.binarypb", "application/octet-stream"},
                    {"hands_solution_packed_assets.data", "application/octet-stream"},
                    {"hands_solution_packed_assets_loader.js", "text/javascript"},
                    {"hands_solution_simd_wasm_bin.js", "text/javascript"},
                    {"hands_solution_simd_wasm_bin.wasm", "application/wasm"},
                    {"hands_solution_wasm_bin.js", "text/javascript"},
                    {"hands_solution_wasm_bin.wasm", "application/wasm"},
                    {"hand_landmark_full.tflite", "application/octet-stream"},
                    {"hand_landmark_lite.tflite", "application/octet-stream"}};

static bool has_package(const camera_port *self)
{
    char path[CAMERA_PATH + 16];
    (void)snprintf(path, sizeof path, "%s/hands.js", self->package);
    return access(path, R_OK) == 0;
}

/* ---- a connection ---- */

static void drop(camera_port *self, connection *c)
{
    if (c->state == FREE)
        return;
    if (self->page >= 0 && c == &self->connection[self->page])
        self->page = -1;
    close(c->socket);
    if (c->file >= 0)
        close(c->file);
    c->state = FREE;
    c->file = -1;
}

static void answer_begin(connection *c, const char *status, const char *type, size_t size,
                         uint16_t port, int64_t now_ns)
{
    c->state = ANSWERING;
    c->until_ns = now_ns + stall_span_ns;
    int length = snprintf(
        (char *)c->out, sizeof c->out,
        "HTTP/1.1 %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\nConnection: close\r\n"
        "Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\n"
        "X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n"
        "Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n"
        "Content-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; "
        "worker-src 'self'; style-src 'self'; img-src 'self' data:; media-src 'self' blob:; "
        "connect-src 'self' ws://127.0.0.1:%u; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'\r\n\r\n",
        status, type, size, (unsigned)port);
    c->out_size = (size_t)length;
    c->out_sent = 0;
}

static void refuse(camera_port *self, connection *c, int status, int64_t now_ns)
{
    const char *words = status == 403   ? "403 Forbidden"
                        : status == 404 ? "404 Not Found"
                        : status == 405 ? "405 Method Not Allowed"
                        : status == 431 ? "431 Request Header Fields Too Large"
                                        : "400 Bad Request";
    answer_begin(c, words, "text/plain", 0, self->number, now_ns);
}

static void answer_page(camera_port *self, connection *c, const camera_file *file, int64_t now_ns)
{
    answer_begin(c, "200 OK", file->type, file->size, self->number, now_ns);
    c->body = file->data;
    c->body_size = file->size;
    c->body_sent = 0;
}

static bool answer_package(camera_port *self, connection *c, const char *name, const char *type,
                           int64_t now_ns)
{
    char path[CAMERA_PATH + 64];
    struct stat about;
    (void)snprintf(path, sizeof path, "%s/%s", self->package, name);
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0)
        return false;
    if (fstat(file, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size > file_most) {
        close(file);
        return false;
    }
    answer_begin(c, "200 OK", type, (size_t)about.st_size, self->number, now_ns);
    c->file = file;
    c->file_sent = 0;
    c->file_size = about.st_size;
    return true;
}

static void answer_file(camera_port *self, connection *c, const char *name, int64_t now_ns)
{
    static const char folder[] = "hands/";
    for (const camera_file *file = camera_page; file->name; ++file)
        if (strcmp(file->name, name) == 0) {
            answer_page(self, c, file, now_ns);
            return;
        }
    if (strncmp(name, folder, sizeof folder - 1) == 0)
        for (size_t i = 0; i < sizeof package_file / sizeof package_file[0]; ++i)
            if (strcmp(package_file[i].name, name + sizeof folder - 1) == 0 &&
                answer_package(self, c, package_file[i].name, package_file[i].type, now_ns))
                return;
    refuse(self, c, 404, now_ns);
}

/* ---- the page's WebSocket ---- */

/* Returns false if the connection does not accept the data. */
static bool send_frame(connection *c, int opcode, const void *payload, size_t size)
{
    if (c->out_sent == c->out_size)
        c->out_sent = c->out_size = 0;
    if (c->out_size + size + 4 > sizeof c->out)
        return false;
    c->out_size += web_frame_write(c->out + c->out_size, opcode, payload, size);
    return true;
}

static bool send_state(camera_port *self, connection *c)
{
    char text[128];
    uint32_t hands = 0;
    for (const camera_listener *l = self->listeners; l; l = l->next)
        hands += l->hands_wanted;
    int length = snprintf(text, sizeof text, "{\"type\":\"state\",\"hands\":%u,\"package\":%s}",
                          hands > 2 ? 2 : hands, has_package(self) ? "true" : "false");
    return send_frame(c, WEB_TEXT, text, (size_t)length);
}

static void send_all(camera_port *self, connection *c, int64_t now_ns);

/* Closes the page's connection: of two pages the newer one is used. */
static void part_with_page(camera_port *self, int64_t now_ns)
{
    static const char bye[] = "{\"type\":\"bye\"}";
    static const unsigned char normal[2] = {1000 >> 8, 1000 & 255};
    if (self->page < 0)
        return;
    connection *old = &self->connection[self->page];
    self->page = -1;
    old->is_ending = true;
    old->until_ns = now_ns + request_span_ns;
    if (!send_frame(old, WEB_TEXT, bye, sizeof bye - 1) ||
        !send_frame(old, WEB_CLOSE, normal, sizeof normal))
        drop(self, old);
    else
        send_all(self, old, now_ns);
}

static void begin_page(camera_port *self, connection *c, const web_request *request, int64_t now_ns,
                       const mrt_host *host)
{
    char accept[WEB_ACCEPT];
    const int on = 1;
    part_with_page(self, now_ns);
    web_accept_key(request->key, accept);
    c->state = PAGE;
    c->is_ending = false;
    c->out_sent = 0;
    c->out_size = (size_t)snprintf((char *)c->out, sizeof c->out,
                                   "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                                   "Connection: Upgrade\r\nSec-WebSocket-Accept: %s\r\n"
                                   "Sec-WebSocket-Protocol: " CAMERA_PROTOCOL "\r\n\r\n",
                                   accept);
    (void)setsockopt(c->socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    self->page = (int)(c - self->connection);
    clock_map_reset(&self->clock);
    (void)send_state(self, c);
    device_log(host, MRT_LOG_INFO, "the camera's page is connected");
}

static void hear(camera_port *self, const camera_message *message, int64_t now_ns)
{
    camera_frame frame = {.time_ns = now_ns, .hand_count = message->hand_count};
    if (self->clock.running)
        frame.time_ns = message->time_ns + self->clock.offset_ns;
    if (frame.time_ns > now_ns || frame.time_ns < now_ns - past_most_ns)
        frame.time_ns = now_ns;
    if (frame.time_ns < self->last_ns)
        frame.time_ns = self->last_ns;
    self->last_ns = frame.time_ns;
    memcpy(frame.hand, message->hand, sizeof frame.hand);
    for (camera_listener *l = self->listeners; l; l = l->next) {
        if (l->count == CAMERA_QUEUE) { /* full: drop the oldest frame */
            l->first = (l->first + 1) % CAMERA_QUEUE;
            l->count -= 1;
            l->lost += 1;
        }
        l->item[(l->first + l->count++) % CAMERA_QUEUE] = frame;
    }
}

/* Returns false if the connection must be closed with this code. */
static bool take_frame(camera_port *self, connection *c, const web_frame *frame, int64_t now_ns,
                       int *out_code)
{
    camera_message message;
    *out_code = 1000;
    if (frame->opcode == WEB_CLOSE)
        return false;
    if (frame->opcode == WEB_PONG)
        return true;
    if (frame->opcode == WEB_PING)
        return send_frame(c, WEB_PONG, frame->payload, frame->size);
    if (frame->opcode == WEB_TEXT) /* hello, repeated while the package is missing */
        return send_state(self, c);
    *out_code = 1003;
    trace_received(&self->trace, now_ns, frame->payload, frame->size);
    if (!camera_message_parse(&message, frame->payload, frame->size))
        return false;
    if (message.kind == CAMERA_SEEN) {
        hear(self, &message, now_ns);
        return true;
    }
    unsigned char answer[CAMERA_ANSWER_SIZE];
    (void)clock_map_to_host(&self->clock, message.time_ns, now_ns);
    camera_answer_write(answer, message.time_ms, now_ns);
    return send_frame(c, WEB_BINARY, answer, sizeof answer);
}

static void end_page(camera_port *self, connection *c, int code, int64_t now_ns,
                     const mrt_host *host)
{
    const unsigned char bytes[2] = {(unsigned char)(code >> 8), (unsigned char)code};
    if (self->page >= 0 && c == &self->connection[self->page]) {
        self->page = -1;
        device_log(host, code == 1000 ? MRT_LOG_INFO : MRT_LOG_WARNING,
                   code == 1000 ? "the camera's page is disconnected: the hand is held"
                                : "the camera's page sent an invalid message and was disconnected");
    }
    c->is_ending = true;
    c->until_ns = now_ns + request_span_ns;
    if (!send_frame(c, WEB_CLOSE, bytes, sizeof bytes))
        drop(self, c);
}

static void take_from_page(camera_port *self, connection *c, int64_t now_ns, const mrt_host *host)
{
    size_t used = 0;
    while (c->state == PAGE && !c->is_ending) {
        web_frame frame;
        int code, size = web_frame_parse(&frame, c->in + used, c->in_size - used);
        if (size == 0)
            break;
        if (size < 0) {
            end_page(self, c, -size, now_ns, host);
            return;
        }
        used += (size_t)size;
        if (!take_frame(self, c, &frame, now_ns, &code))
            end_page(self, c, code, now_ns, host);
    }
    memmove(c->in, c->in + used, c->in_size - used);
    c->in_size -= used;
}

/* ---- bytes in ---- */

static void take_request(camera_port *self, connection *c, int64_t now_ns, const mrt_host *host)
{
    web_request request;
    const char *name;
    int size = web_request_parse(&request, c->in, c->in_size, CAMERA_PROTOCOL);
    if (size == 0)
        return;
    if (size < 0) {
        refuse(self, c, -size, now_ns);
        return;
    }
    memmove(c->in, c->in + size, c->in_size - (size_t)size);
    c->in_size -= (size_t)size;
    int status = camera_request_judge(&request, self->number, self->token, &name);
    if (status == 101)
        begin_page(self, c, &request, now_ns, host);
    else if (status == 200)
        answer_file(self, c, name, now_ns);
    else
        refuse(self, c, status, now_ns);
}

static void receive(camera_port *self, connection *c, int64_t now_ns, const mrt_host *host)
{
    ssize_t size = recv(c->socket, c->in + c->in_size, sizeof c->in - c->in_size, 0);
    if (size < 0 && (errno == EAGAIN || errno == EINTR))
        return;
    if (size <= 0) {
        if (c->state == PAGE && self->page >= 0 && c == &self->connection[self->page])
            device_log(host, MRT_LOG_INFO, "the camera's page is disconnected: the hand is held");
        drop(self, c);
        return;
    }
    c->in_size += (size_t)size;
    if (c->state == ASKING)
        take_request(self, c, now_ns, host);
    if (c->state == PAGE)
        take_from_page(self, c, now_ns, host);
    if (c->state == ANSWERING)
        c->in_size = 0; /* one request per connection: ignore the rest */
}

/* ---- bytes out ---- */

static bool has_more(const connection *c)
{
    return c->out_sent < c->out_size || c->body_sent < c->body_size ||
           (c->file >= 0 && c->file_sent < c->file_size);
}

static ssize_t send_some(connection *c)
{
    if (c->out_sent < c->out_size)
        return send(c->socket, c->out + c->out_sent, c->out_size - c->out_sent, MSG_NOSIGNAL);
    if (c->file >= 0)
        return sendfile(c->socket, c->file, &c->file_sent, SEND_AT_ONCE);
    return send(c->socket, c->body + c->body_sent, c->body_size - c->body_sent, MSG_NOSIGNAL);
}

static void send_all(camera_port *self, connection *c, int64_t now_ns)
{
    while (has_more(c)) {
        bool is_head = c->out_sent < c->out_size, is_file = c->file >= 0;
        ssize_t size = send_some(c);
        if (size < 0 && (errno == EAGAIN || errno == EINTR))
            return;
        if (size <= 0) { /* connection lost, or the file has become shorter */
            drop(self, c);
            return;
        }
        if (is_head)
            c->out_sent += (size_t)size;
        else if (!is_file)
            c->body_sent += (size_t)size;
        if (c->state == ANSWERING)
            c->until_ns = now_ns + stall_span_ns;
        if (is_file && !is_head)
            return; /* lets other connections run in between */
    }
    if (c->state == ANSWERING || (c->state == PAGE && c->is_ending)) {
        (void)shutdown(c->socket, SHUT_WR);
        drop(self, c);
    }
}

/* ---- accepting connections ---- */

static connection *find_room(camera_port *self)
{
    connection *oldest = NULL;
    for (int i = 0; i < CONNECTIONS; ++i) {
        connection *c = &self->connection[i];
        if (c->state == FREE)
            return c;
        if (i != self->page && (!oldest || c->until_ns < oldest->until_ns))
            oldest = c;
    }
    drop(self, oldest);
    return oldest;
}

static void welcome(camera_port *self, int64_t now_ns)
{
    for (int i = 0; i < BACKLOG; ++i) {
        int socket = accept4(self->listening, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (socket < 0)
            return;
        connection *c = find_room(self);
        c->state = ASKING;
        c->socket = socket;
        c->file = -1;
        c->until_ns = now_ns + request_span_ns;
        c->in_size = c->out_size = c->out_sent = c->body_size = c->body_sent = 0;
        c->file_sent = c->file_size = 0;
        c->is_ending = false;
    }
}

/* ---- working ---- */

static bool has_limit(const camera_port *self, int i)
{
    return self->connection[i].state != FREE && i != self->page;
}

static void drop_stalled(camera_port *self, int64_t now_ns)
{
    for (int i = 0; i < CONNECTIONS; ++i)
        if (has_limit(self, i) && self->connection[i].until_ns <= now_ns)
            drop(self, &self->connection[i]);
}

static int gather(const camera_port *self, struct pollfd *out, int *out_of, int64_t *wake_ns)
{
    int count = 0;
    out[count++] = (struct pollfd){self->listening, POLLIN, 0};
    for (int i = 0; i < CONNECTIONS; ++i) {
        const connection *c = &self->connection[i];
        if (c->state == FREE)
            continue;
        out_of[count] = i;
        out[count++] = (struct pollfd){c->socket, (short)(POLLIN | (has_more(c) ? POLLOUT : 0)), 0};
        if (has_limit(self, i) && c->until_ns < *wake_ns)
            *wake_ns = c->until_ns;
    }
    return count;
}

/* Handles the sockets. Called with the mutex, which is released while waiting. Returns false if the
 * port failed. */
static bool work(camera_port *self, int64_t deadline_ns, const mrt_host *host)
{
    struct pollfd wanted[1 + CONNECTIONS];
    int of[1 + CONNECTIONS];
    int count = gather(self, wanted, of, &deadline_ns);
    self->is_working = true;
    pthread_mutex_unlock(&self->mutex);
    int64_t left_ns = deadline_ns - device_clock_ns();
    left_ns = left_ns > 0 ? left_ns : 0;
    const struct timespec span = {(time_t)(left_ns / ns_per_s), (long)(left_ns % ns_per_s)};
    int ready = ppoll(wanted, (nfds_t)count, &span, NULL);
    int64_t now_ns = device_clock_ns();
    pthread_mutex_lock(&self->mutex);
    self->is_working = false;
    for (int i = 1; ready > 0 && i < count; ++i) {
        connection *c = &self->connection[of[i]];
        /* While waiting, this slot may have been freed and reused for another connection. */
        if (c->state == FREE || c->socket != wanted[i].fd)
            continue;
        if (wanted[i].revents & (POLLIN | POLLHUP | POLLERR))
            receive(self, c, now_ns, host);
        if (c->state != FREE && (has_more(c) || c->is_ending))
            send_all(self, c, now_ns);
    }
    if (ready > 0 && wanted[0].revents & POLLIN)
        welcome(self, now_ns);
    drop_stalled(self, now_ns);
    pthread_cond_broadcast(&self->changed);
    return ready >= 0 || errno == EINTR;
}

bool camera_port_wait(camera_port *port, const camera_listener *listener, int64_t deadline_ns,
                      const mrt_host *host)
{
    bool works = true;
    pthread_mutex_lock(&port->mutex);
    do {
        if (port->is_working)
            (void)device_condition_wait(&port->changed, &port->mutex, deadline_ns);
        else
            works = work(port, deadline_ns, host);
    } while (works && listener->count == 0 && device_clock_ns() < deadline_ns);
    pthread_mutex_unlock(&port->mutex);
    return works;
}

bool camera_port_pop(camera_port *port, camera_listener *listener, camera_frame *out)
{
    pthread_mutex_lock(&port->mutex);
    bool found = listener->count > 0;
    if (found) {
        *out = listener->item[listener->first];
        out->lost = listener->lost;
        listener->lost = 0;
        listener->first = (listener->first + 1) % CAMERA_QUEUE;
        listener->count -= 1;
    }
    pthread_mutex_unlock(&port->mutex);
    return found;
}

static void send_to_page(camera_port *port)
{
    if (port->page >= 0)
        (void)send_state(port, &port->connection[port->page]);
}

void camera_port_join(camera_port *port, camera_listener *listener)
{
    pthread_mutex_lock(&port->mutex);
    listener->first = listener->count = listener->lost = 0;
    listener->next = port->listeners;
    port->listeners = listener;
    send_to_page(port);
    pthread_mutex_unlock(&port->mutex);
}

void camera_port_leave(camera_port *port, camera_listener *listener)
{
    pthread_mutex_lock(&port->mutex);
    for (camera_listener **at = &port->listeners; *at; at = &(*at)->next)
        if (*at == listener) {
            *at = listener->next;
            break;
        }
    send_to_page(port);
    pthread_mutex_unlock(&port->mutex);
}

/* ---- opening ---- */

static int listen_at(uint16_t port, char *out_reason)
{
    const struct sockaddr_in at = {.sin_family = AF_INET,
                                   .sin_port = htons(port),
                                   .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    const int on = 1;
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd >= 0)
        (void)setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (fd >= 0 && bind(fd, (const struct sockaddr *)&at, sizeof at) == 0 &&
        listen(fd, BACKLOG) == 0)
        return fd;
    if (errno == EADDRINUSE)
        (void)snprintf(out_reason, CAMERA_REASON,
                       "port %u is in use by another program or another marotte: close it, or "
                       "choose another port, as in camera:%u",
                       (unsigned)port, port < 65535 ? port + 1u : port - 1u);
    else
        (void)snprintf(out_reason, CAMERA_REASON, "cannot listen on port %u of 127.0.0.1: %s",
                       (unsigned)port, strerror(errno));
    if (fd >= 0)
        close(fd);
    return -1;
}

static camera_port *make_port(uint16_t number, const char *token, const char *package,
                              const mrt_host *host, char *out_reason)
{
    camera_port *self = calloc(1, sizeof *self);
    if (!self) {
        (void)snprintf(out_reason, CAMERA_REASON, "out of memory for port %u", (unsigned)number);
        return NULL;
    }
    self->number = number;
    self->page = -1;
    (void)snprintf(self->token, sizeof self->token, "%s", token);
    (void)snprintf(self->package, sizeof self->package, "%s", package);
    for (int i = 0; i < CONNECTIONS; ++i)
        self->connection[i].file = -1;
    self->listening = listen_at(number, out_reason);
    if (self->listening < 0) {
        free(self);
        return NULL;
    }
    trace_open(&self->trace, host, "camera");
    pthread_mutex_init(&self->mutex, NULL);
    device_condition_init(&self->changed);
    return self;
}

camera_port *camera_port_open(uint16_t port, const char *token, const char *package,
                              const mrt_host *host, char *out_reason)
{
    pthread_mutex_lock(&ports_mutex);
    camera_port *found = ports;
    while (found && found->number != port)
        found = found->next;
    if (!found) {
        found = make_port(port, token, package, host, out_reason);
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

static void take_off_list(const camera_port *port)
{
    for (camera_port **at = &ports; *at; at = &(*at)->next)
        if (*at == port) {
            *at = port->next;
            return;
        }
}

void camera_port_close(camera_port *port)
{
    if (!port)
        return;
    pthread_mutex_lock(&ports_mutex);
    bool is_last = --port->user_count == 0;
    if (is_last) {
        take_off_list(port);
        for (int i = 0; i < CONNECTIONS; ++i)
            drop(port, &port->connection[i]);
        close(port->listening);
    }
    pthread_mutex_unlock(&ports_mutex);
    if (!is_last)
        return;
    trace_close(&port->trace);
    pthread_cond_destroy(&port->changed);
    pthread_mutex_destroy(&port->mutex);
    free(port);
}
