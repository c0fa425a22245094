/* Sockets are polled in each frame. Commands are executed immediately, and answered when the frame
 * has shown their effect. */
#include "window/app/remote.h"
#include "window/app/app.h"
#include "window/app/pose_palette.h"
#include "window/app/presets.h"
#include "window/app/remote_wire.h"

#include "base/json.h"
#include "udp.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

enum { CLIENTS = 8, OUT_MAX = 16384, SAYS = 320, DATAGRAM_MAX = 2048, OSC_MESSAGE_LEAST = 24 };
/* All that one look reads waits for its answer. Of datagrams these are the commands of one that is
 * full of them, after REMOTE_DATAGRAMS_A_LOOK others. */
enum {
    OSC_ANSWERS = REMOTE_DATAGRAMS_A_LOOK + DATAGRAM_MAX / OSC_MESSAGE_LEAST,
    ANSWERS = OSC_ANSWERS + CLIENTS * REMOTE_MESSAGES_A_LOOK
};
static const double retry_s = 2.0;     /* a port that was taken */
static const double handshake_s = 5.0; /* incomplete requests are dropped after this time */
static const double complaint_s = 5.0; /* one line about nonsense in so long */

typedef struct client {
    int fd; /* -1: free */
    bool is_socket, is_ending;
    uint64_t number;
    double age_s;
    unsigned char in[WEB_HEAD_MAX], out[OUT_MAX];
    size_t in_size, out_size, out_sent;
} client;

typedef struct asker {
    uint64_t client; /* number; 0: an OSC sender */
    udp_peer peer;
} asker;

typedef struct answer { /* waits for the frame's end */
    asker to;
    remote_command command;
    bool is_refused;
    char says[SAYS];
    uint64_t news_before;
} answer;

struct remote {
    app *of;
    char address[APP_REMOTE_ADDRESS], host[UDP_HOST];
    uint16_t port;
    char code[REMOTE_CODE + 1]; /* "": of this computer alone */
    int udp, tcp;               /* -1: closed */
    double wait_s, quiet_s;
    char trouble[UDP_REASON], last[SAYS];
    client client[CLIENTS];
    uint64_t client_count; /* ever */
    answer answer[ANSWERS];
    uint32_t answer_count;
    uint64_t news_told;
    bool was_recording;
    asker from; /* of the datagram that is being read */
    bool from_stranger;
};

/* ---- sending ---- */

static void drop(client *c)
{
    if (c->fd >= 0)
        close(c->fd);
    c->fd = -1;
}

static void send_frame(client *c, int opcode, const void *payload, size_t size)
{
    c->out_size -= c->out_sent;
    memmove(c->out, c->out + c->out_sent, c->out_size);
    c->out_sent = 0;
    if (c->out_size + size + 4 > sizeof c->out) { /* it does not read what it is sent */
        drop(c);
        return;
    }
    c->out_size += web_frame_write(c->out + c->out_size, opcode, payload, size);
}

static void close_client(client *c, int code)
{
    const unsigned char bytes[2] = {(unsigned char)(code >> 8), (unsigned char)code};
    send_frame(c, WEB_CLOSE, bytes, sizeof bytes);
    c->is_ending = true;
}

static void send_json(client *c, json_t *object)
{
    char *text = object ? json_dumps(object, JSON_COMPACT) : NULL;
    if (text)
        send_frame(c, WEB_TEXT, text, strlen(text));
    free(text);
}

static void flush(client *c)
{
    while (c->fd >= 0 && c->out_sent < c->out_size) {
        const ssize_t sent =
            send(c->fd, c->out + c->out_sent, c->out_size - c->out_sent, MSG_NOSIGNAL);
        if (sent < 0 && (errno == EAGAIN || errno == EINTR))
            return;
        if (sent < 0)
            drop(c);
        else
            c->out_sent += (size_t)sent;
    }
    if (c->fd >= 0 && c->is_ending)
        drop(c);
}

static void send_osc(const remote *self, const answer *a)
{
    char bytes[1024];
    osc_builder builder = osc_builder_start();
    osc_builder_text(&builder, a->command.word);
    osc_builder_int32(&builder, !a->is_refused);
    osc_builder_text(&builder, a->says);
    const size_t size =
        osc_builder_finish(&builder, REMOTE_OSC_PREFIX "answer", bytes, sizeof bytes);
    if (size > 0)
        (void)udp_send_to(self->udp, &a->to.peer, bytes, size); /* gone: its affair */
}

/* ---- doing ---- */

static const char *refusal_of(app *of, action what)
{
    const char *why;
    return app_can(of, what, &why) ? NULL : why;
}

static void refuse(answer *a, const char *why)
{
    a->is_refused = true;
    (void)snprintf(a->says, sizeof a->says, "%s", why);
}

static void do_action(remote *self, answer *a, action what, const char *says)
{
    const char *why = refusal_of(self->of, what);
    if (why) {
        refuse(a, why);
        return;
    }
    app_do(self->of, what);
    (void)snprintf(a->says, sizeof a->says, "%s", says);
}

static void do_transport(remote *self, answer *a, bool begins)
{
    const char *why = refusal_of(self->of, ACTION_RECORD);
    if (why)
        refuse(a, why);
    else if (!app_press(self->of, begins ? PATCH_RECORD : PATCH_STOP))
        refuse(a, "a take is being recorded already");
    else
        (void)snprintf(a->says, sizeof a->says,
                       begins ? "a take is being recorded" : "the take has ended");
}

static void do_preset(remote *self, answer *a)
{
    char name[PRESET_NAME], why[SAYS];
    const instance *mapping = live_mapping(app_live(self->of));
    if (!mapping) {
        refuse(a, "no mapping performs");
        return;
    }
    if (!presets_clean_name(name, a->command.name) ||
        !presets_kept(app_settings(self->of), mapping->type, name)) {
        (void)snprintf(why, sizeof why, "%.60s has no preset \"%.60s\"", mapping->type->name,
                       a->command.name);
        refuse(a, why);
        return;
    }
    (void)snprintf(app_notes_of(self->of)->preset, PRESET_NAME, "%s", name);
    (void)snprintf(a->says, sizeof a->says, "preset \"%.60s\" of %.60s", name, mapping->type->name);
}

static void do_expression(remote *self, answer *a)
{
    error err = {""};
    const remote_command *c = &a->command;
    if (!c->name[0]) {
        pose_palette_release_all(app_poses(self->of), c->fade_s);
        (void)snprintf(a->says, sizeof a->says, "all poses fade out");
        return;
    }
    if (pose_palette_set(app_poses(self->of), c->name, c->amount, c->fade_s, &err) < 0)
        refuse(a, err.text);
    else
        (void)snprintf(a->says, sizeof a->says, "%s to %g in %g s", c->name, c->amount, c->fade_s);
}

static void obey(remote *self, answer *a)
{
    const remote_command *c = &a->command;
    const bool is_recording = app_status(self->of)->is_recording;
    switch (c->verb) {
    case REMOTE_NOTHING:
        break;
    case REMOTE_RECORD:
        do_transport(self, a, true);
        break;
    case REMOTE_STOP:
        if (is_recording)
            do_transport(self, a, false);
        else
            do_action(self, a, ACTION_STOP, "it is paused");
        break;
    case REMOTE_MARK:
        do_action(self, a, ACTION_MARK, "marker added");
        break;
    case REMOTE_EXPRESSION:
        do_expression(self, a);
        break;
    case REMOTE_PRESET:
        do_preset(self, a);
        break;
    case REMOTE_STATUS:
        (void)snprintf(a->says, sizeof a->says, is_recording ? "recording" : "not recording");
        break;
    case REMOTE_ACTION:
        do_action(self, a, c->of, action_of(c->of)->help);
        break;
    }
}

/* NULL: too many wait already. */
static answer *answer_to(remote *self, const asker *to)
{
    if (self->answer_count == ANSWERS)
        return NULL;
    answer *a = &self->answer[self->answer_count++];
    *a = (answer){.to = *to, .news_before = news_list_total(app_news(self->of))};
    return a;
}

static void complain(remote *self, const char *why)
{
    char words[SAYS];
    if (self->quiet_s > 0.0)
        return;
    self->quiet_s = complaint_s;
    (void)snprintf(words, sizeof words, "remote control: %s", why);
    news_list_add(app_news(self->of), MRT_LOG_WARNING, "remote", words);
}

static void take_command(remote *self, const asker *from, const remote_command *command,
                         const char *why)
{
    if (!why && command->verb == REMOTE_NOTHING)
        return;
    answer *a = answer_to(self, from);
    if (!a)
        return;
    a->command = *command;
    if (why) {
        refuse(a, why);
        complain(self, why);
    } else {
        obey(self, a);
    }
}

/* ---- answers ---- */

static const news_item *newest_word(const remote *self, uint64_t since)
{
    const news_list *news = app_news(self->of);
    const news_item *found = NULL;
    for (uint32_t i = news_list_first_after(news, since); i < news_list_count(news); ++i) {
        const news_item *item = news_list_at(news, i);
        if (strcmp(item->source, "stage") == 0 || strcmp(item->source, "mapping") == 0)
            found = item;
    }
    return found;
}

static json_t *json_of_status(const remote *self, json_t *out)
{
    const pose_palette *of = app_poses(self->of);
    const instance *mapping = live_mapping(app_live(self->of));
    json_t *poses = json_array(), *names = json_array();
    char **preset = NULL;
    for (uint32_t i = 0; i < pose_palette_count(of); ++i)
        (void)json_array_append_new(poses, json_text(pose_palette_name(of, i)));
    const uint32_t count =
        mapping ? presets_list(app_settings(self->of), mapping->type, &preset) : 0;
    for (uint32_t i = 0; i < count; ++i)
        (void)json_array_append_new(names, json_text(preset[i]));
    free(preset);
    (void)json_object_set_new(out, "mapping", json_text(mapping ? mapping->type->name : ""));
    (void)json_object_set_new(out, "expressions", poses);
    (void)json_object_set_new(out, "presets", names);
    return out;
}

static json_t *json_of_answer(const remote *self, const answer *a)
{
    json_t *out = json_object();
    (void)json_object_set_new(out, "did", json_text(a->command.word));
    (void)json_object_set_new(out, "ok", json_boolean(!a->is_refused));
    (void)json_object_set_new(out, "says", json_text(a->says));
    (void)json_object_set_new(out, "recording", json_boolean(app_status(self->of)->is_recording));
    if (a->command.has_id)
        (void)json_object_set_new(out, "id", json_integer(a->command.id));
    return a->command.verb == REMOTE_STATUS ? json_of_status(self, out) : out;
}

static void tell_answer(remote *self, answer *a)
{
    const news_item *newest = newest_word(self, a->news_before);
    if (newest && !a->is_refused) {
        a->is_refused = newest->level >= MRT_LOG_WARNING;
        (void)snprintf(a->says, sizeof a->says, "%.300s", newest->text);
    }
    (void)snprintf(self->last, sizeof self->last, "%s: %.280s",
                   a->command.word[0] ? a->command.word : "refused", a->says);
    if (a->to.client == 0) {
        send_osc(self, a);
        return;
    }
    for (int i = 0; i < CLIENTS; ++i)
        if (self->client[i].fd >= 0 && self->client[i].number == a->to.client) {
            json_t *object = json_of_answer(self, a);
            send_json(&self->client[i], object);
            json_decref(object);
        }
}

static void tell_all(remote *self, json_t *object)
{
    for (int i = 0; i < CLIENTS; ++i)
        if (self->client[i].fd >= 0 && self->client[i].is_socket)
            send_json(&self->client[i], object);
    json_decref(object);
}

/* What else happens on the stage, to every WebSocket. */
static void tell_news(remote *self)
{
    const news_list *news = app_news(self->of);
    const bool is_recording = app_status(self->of)->is_recording;
    for (uint32_t i = news_list_first_after(news, self->news_told); i < news_list_count(news); ++i)
        if (news_list_at(news, i)->level >= MRT_LOG_INFO)
            tell_all(self, json_pack("{so}", "news", json_text(news_list_at(news, i)->text)));
    self->news_told = news_list_total(news);
    if (is_recording != self->was_recording)
        tell_all(self, json_pack("{sb}", "recording", (int)is_recording));
    self->was_recording = is_recording;
}

/* ---- OSC ---- */

static void take_message(void *context, const osc_message *message)
{
    remote *self = context;
    remote_command command;
    char why[REMOTE_WHY] = "";
    if (self->from_stranger ||
        self->answer_count >= OSC_ANSWERS) /* nonsense can be shorter than a command */
        return;
    /* Not answered: its sender may be forged. One guess a datagram. */
    if (!remote_osc_has_code(message->address, self->code)) {
        self->from_stranger = true;
        complain(self, "a datagram without the pairing code was ignored: its address begins "
                       "with " REMOTE_OSC_PREFIX "CODE/");
        return;
    }
    const bool is_good = remote_command_of_osc(&command, message, self->code, why);
    take_command(self, &self->from, &command, is_good ? NULL : why);
}

static void receive_datagrams(remote *self)
{
    unsigned char bytes[DATAGRAM_MAX]; /* a longer datagram is cut, and then is not OSC */
    for (int i = 0; i < REMOTE_DATAGRAMS_A_LOOK && self->answer_count < REMOTE_DATAGRAMS_A_LOOK;
         ++i) {
        self->from = (asker){.client = 0};
        self->from_stranger = false;
        const int64_t size =
            udp_receive(self->udp, bytes, sizeof bytes, &self->from.peer, INT64_MIN / 2);
        if (size <= 0)
            return;
        if (osc_wire_read(bytes, (size_t)size, take_message, self) != OSC_FAULT_NONE)
            complain(self, "a datagram that is not OSC was ignored");
    }
}

/* ---- WebSocket ---- */

static void answer_request(remote *self, client *c, const web_request *request)
{
    const int status = remote_request_judge(request, self->port, self->code);
    char accept[WEB_ACCEPT];
    c->out_sent = 0;
    if (status == 101) {
        web_accept_key(request->key, accept);
        c->is_socket = true;
        c->out_size = (size_t)snprintf((char *)c->out, sizeof c->out,
                                       "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                                       "Connection: Upgrade\r\nSec-WebSocket-Accept: %s\r\n\r\n",
                                       accept);
        return;
    }
    static const char page[] =
        "marotte: this is the port of a WebSocket; ws://.../ takes JSON, the "
        "same port by UDP takes OSC.\n";
    const bool is_page = status == 200;
    c->is_ending = true;
    c->out_size = (size_t)snprintf((char *)c->out, sizeof c->out,
                                   "HTTP/1.1 %s\r\nContent-Type: text/plain\r\nContent-Length: "
                                   "%zu\r\nConnection: close\r\n\r\n%s",
                                   is_page         ? "200 OK"
                                   : status == 403 ? "403 Forbidden"
                                   : status == 404 ? "404 Not Found"
                                                   : "400 Bad Request",
                                   is_page ? sizeof page - 1 : (size_t)0, is_page ? page : "");
    if (!is_page)
        complain(self, self->code[0]
                           ? "a connection was refused: its address is ws://HOST:PORT/CODE/, "
                             "with this computer's address in numbers"
                           : "a connection was refused: only pages and programs of this "
                             "computer may connect");
}

static bool take_head(remote *self, client *c)
{
    web_request request = {.has_host = false};
    const int size = web_request_parse(&request, c->in, c->in_size, NULL);
    if (size == 0)
        return false;
    if (size < 0) {
        request = (web_request){.has_host = false};
        c->in_size = 0;
        answer_request(self, c, &request);
        return false;
    }
    c->in_size -= (size_t)size;
    memmove(c->in, c->in + size, c->in_size);
    answer_request(self, c, &request);
    return c->is_socket;
}

static void take_frame(remote *self, client *c, const web_frame *frame)
{
    remote_command command;
    char why[REMOTE_WHY] = "";
    if (frame->opcode == WEB_PING) {
        send_frame(c, WEB_PONG, frame->payload, frame->size);
    } else if (frame->opcode == WEB_CLOSE) {
        close_client(c, 1000);
    } else if (frame->opcode == WEB_BINARY) {
        close_client(c, 1003);
    } else if (frame->opcode == WEB_TEXT) {
        const asker from = {.client = c->number};
        const bool is_good =
            remote_command_of_json(&command, (const char *)frame->payload, frame->size, why);
        take_command(self, &from, &command, is_good ? NULL : why);
    }
}

/* At most *left messages; more of them wait in the buffer. */
static void take_frames(remote *self, client *c, uint32_t *left)
{
    size_t used = 0;
    for (; c->fd >= 0 && !c->is_ending && *left > 0; --*left) {
        web_frame frame;
        const int size = web_frame_parse(&frame, c->in + used, c->in_size - used);
        if (size == 0)
            break;
        if (size < 0) {
            complain(self, size == -1009 ? "a message that is too long: 1 024 bytes at most"
                                         : "a WebSocket with invalid data was closed");
            close_client(c, -size);
            return;
        }
        used += (size_t)size;
        take_frame(self, c, &frame);
    }
    c->in_size -= used;
    memmove(c->in, c->in + used, c->in_size);
}

/* Reads from a client in this frame: a limited number of messages, and one buffer of bytes. The
 * rest waits in the socket. A client that does not read its answers is not read either. */
static void receive_from(remote *self, client *c, double dt_s)
{
    uint32_t left = REMOTE_MESSAGES_A_LOOK;
    c->age_s += dt_s;
    if ((!c->is_socket || c->is_ending) && c->age_s > handshake_s) {
        drop(c);
        return;
    }
    if (c->is_ending || c->out_size - c->out_sent > OUT_MAX / 2)
        return;
    if (c->is_socket)
        take_frames(self, c, &left);
    if (c->fd < 0 || c->is_ending || left == 0 || c->in_size == sizeof c->in)
        return;
    const ssize_t size = recv(c->fd, c->in + c->in_size, sizeof c->in - c->in_size, 0);
    if (size < 0 && (errno == EAGAIN || errno == EINTR))
        return;
    if (size <= 0) {
        drop(c);
        return;
    }
    c->in_size += (size_t)size;
    if (c->is_socket || take_head(self, c))
        take_frames(self, c, &left);
}

static void welcome(remote *self)
{
    const int on = 1;
    for (int i = 0; i < CLIENTS; ++i) {
        const int fd = accept(self->tcp, NULL, NULL);
        if (fd < 0)
            return;
        client *to = NULL;
        for (int k = 0; k < CLIENTS && !to; ++k)
            if (self->client[k].fd < 0)
                to = &self->client[k];
        if (!to || fcntl(fd, F_SETFD, FD_CLOEXEC) != 0 || fcntl(fd, F_SETFL, O_NONBLOCK) != 0) {
            close(fd);
            complain(self, "eight clients are connected: another one was refused");
            continue;
        }
        (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        to->fd = fd;
        to->number = ++self->client_count;
        to->is_socket = to->is_ending = false;
        to->in_size = to->out_size = to->out_sent = 0;
        to->age_s = 0.0;
    }
}

/* ---- opening ---- */

static int listen_at(const char *host, uint16_t port)
{
    char number[8];
    const int on = 1;
    struct addrinfo *at = NULL, hints = {.ai_family = AF_UNSPEC,
                                         .ai_socktype = SOCK_STREAM,
                                         .ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV};
    (void)snprintf(number, sizeof number, "%u", (unsigned)port);
    if (getaddrinfo(host, number, &hints, &at) != 0)
        return -1;
    const int fd = socket(at->ai_family, SOCK_STREAM, 0);
    const bool is_open = fd >= 0 && fcntl(fd, F_SETFD, FD_CLOEXEC) == 0 &&
                         fcntl(fd, F_SETFL, O_NONBLOCK) == 0 &&
                         setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
                         bind(fd, at->ai_addr, at->ai_addrlen) == 0 && listen(fd, CLIENTS) == 0;
    freeaddrinfo(at);
    if (is_open)
        return fd;
    if (fd >= 0)
        close(fd);
    return -1;
}

static void close_sockets(remote *self)
{
    for (int i = 0; i < CLIENTS; ++i)
        drop(&self->client[i]);
    udp_close(self->udp);
    if (self->tcp >= 0)
        close(self->tcp);
    self->udp = self->tcp = -1;
    self->answer_count = 0;
}

static void open_sockets(remote *self)
{
    char why[UDP_REASON] = "";
    self->udp = udp_bind(self->host, self->port, why);
    self->tcp = self->udp >= 0 ? listen_at(self->host, self->port) : -1;
    if (self->udp >= 0 && self->tcp < 0)
        (void)snprintf(
            why, sizeof why,
            "TCP port %u is in use by another program: choose another one, as in --remote %u",
            (unsigned)self->port, self->port < 65535 ? self->port + 1u : 9000u);
    const bool was_told = self->trouble[0] != '\0';
    if (self->tcp < 0) {
        close_sockets(self);
        self->wait_s = retry_s;
        if (!was_told) {
            complain(self, why);
            self->quiet_s = 0.0;
        }
        (void)snprintf(self->trouble, sizeof self->trouble, "%s", why);
        return;
    }
    self->trouble[0] = '\0';
    self->news_told = news_list_total(app_news(self->of));
    self->was_recording = app_status(self->of)->is_recording;
    char words[APP_REMOTE_ADDRESS + 96];
    (void)snprintf(words, sizeof words, "remote control at %s port %u: OSC and WebSocket%s%s",
                   self->host, (unsigned)self->port, self->code[0] ? ", pairing code " : "",
                   self->code);
    news_list_add(app_news(self->of), MRT_LOG_INFO, "remote", words);
}

/* ---- the code ---- */

static const char code_key[] = "remote.code";

static bool draw_code(char out[REMOTE_CODE + 1])
{
    unsigned char bytes[REMOTE_CODE];
    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
        return false;
    for (int i = 0; i < REMOTE_CODE; ++i)
        out[i] = REMOTE_CODE_LETTERS[bytes[i] % 32];
    out[REMOTE_CODE] = '\0';
    return true;
}

/* Reads the pairing code from the settings, or makes one. It is kept, because buttons of a Stream
 * Deck contain it. */
static bool find_code(remote *self, char out[REMOTE_CODE + 1])
{
    const char *kept = settings_text(app_settings(self->of), code_key, "");
    if (remote_is_code(kept)) {
        (void)snprintf(out, REMOTE_CODE + 1, "%s", kept);
        return true;
    }
    if (!draw_code(out))
        return false;
    settings_set_text(app_settings(self->of), code_key, out);
    return true;
}

void remote_renew_code(remote *self)
{
    char address[APP_REMOTE_ADDRESS];
    error ignored;
    (void)snprintf(address, sizeof address, "%s", self->address);
    settings_set_text(app_settings(self->of), code_key, NULL);
    const mrt_result result =
        remote_listen(self, address, &ignored); /* has listened there before */
    (void)result;
}

/* ---- where ---- */

/* Without an address the usual one. */
static bool parse_address(const char *address, char host[UDP_HOST], uint16_t *port)
{
    (void)snprintf(host, UDP_HOST, "127.0.0.1");
    *port = REMOTE_PORT;
    return !address[0] || (strlen(address) < APP_REMOTE_ADDRESS &&
                           udp_address_parse(host, port, address, strlen(address)));
}

static bool is_own(const char *host)
{
    return strcmp(host, "127.0.0.1") == 0 || strcmp(host, "::1") == 0;
}

bool remote_is_local(const char *address)
{
    char host[UDP_HOST];
    uint16_t port;
    return parse_address(address, host, &port) && is_own(host);
}

mrt_result remote_listen(remote *self, const char *address, error *err)
{
    char host[UDP_HOST], code[REMOTE_CODE + 1] = "";
    uint16_t port;
    if (!parse_address(address, host, &port))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "remote control at \"%.60s\": expected a port, as in 9110, or "
                         "0.0.0.0:9110 for the whole network",
                         address);
    if (!is_own(host) && !find_code(self, code))
        return error_set(err, MRT_ERR_IO,
                         "remote control at %.60s: the system has no random numbers for its "
                         "pairing code",
                         address);
    close_sockets(self);
    (void)snprintf(self->code, sizeof self->code, "%s", code);
    (void)snprintf(self->address, sizeof self->address, "%s", address);
    (void)snprintf(self->host, sizeof self->host, "%s", host);
    self->port = port;
    self->trouble[0] = self->last[0] = '\0';
    self->wait_s = self->quiet_s = 0.0;
    if (address[0])
        pose_palette_want(app_poses(self->of));
    return MRT_OK;
}

remote *remote_create(app *of)
{
    remote *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of = of;
    self->udp = self->tcp = -1;
    for (int i = 0; i < CLIENTS; ++i)
        self->client[i].fd = -1;
    return self;
}

void remote_destroy(remote *self)
{
    if (!self)
        return;
    close_sockets(self);
    free(self);
}

/* ---- each frame ---- */

void remote_update(remote *self, double dt_s)
{
    if (!self->address[0])
        return;
    self->quiet_s -= dt_s;
    self->wait_s -= dt_s;
    if (self->tcp < 0 && self->wait_s <= 0.0)
        open_sockets(self);
    if (self->tcp < 0)
        return;
    for (uint32_t i = 0; i < self->answer_count; ++i)
        tell_answer(self, &self->answer[i]);
    self->answer_count = 0;
    tell_news(self);
    receive_datagrams(self);
    welcome(self);
    for (int i = 0; i < CLIENTS; ++i)
        if (self->client[i].fd >= 0)
            receive_from(self, &self->client[i], dt_s);
    for (int i = 0; i < CLIENTS; ++i)
        if (self->client[i].fd >= 0)
            flush(&self->client[i]);
}

app_remote_status remote_status_of(const remote *self)
{
    app_remote_status out = {.address = self->address,
                             .is_listening = self->tcp >= 0,
                             .code = self->code,
                             .trouble = self->trouble,
                             .last = self->last};
    for (int i = 0; i < CLIENTS; ++i)
        out.clients += self->client[i].fd >= 0 && self->client[i].is_socket;
    return out;
}
