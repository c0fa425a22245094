/* template_name: the face as lines of text, one datagram per new face. A face output for marotte:
 * README.md explains how to build and try it, marotte/plugin.h is the whole contract. */
#include <marotte/plugin.h>

#include <arpa/inet.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { LEAST, PARAM_COUNT }; /* the order of the table of parameters below */
enum { PORT = 9200, DATAGRAM_BYTES = 1400 };

struct mrt_plugin { /* one instance: its whole state */
    const mrt_host *host;
    const mrt_face_names *names; /* of the current face; the host's until the next begin() */
    int socket;                  /* -1: closed */
};

static mrt_plugin *create(const mrt_host *host) /* [main] */
{
    mrt_plugin *self = (mrt_plugin *)calloc(1, sizeof(mrt_plugin));
    if (!self)
        return NULL;
    self->host = host;
    self->socket = -1;
    return self;
}

static void close_output(mrt_plugin *self) /* [output] also after an open() that failed */
{
    if (self->socket >= 0)
        (void)close(self->socket);
    self->socket = -1;
}

static void destroy(mrt_plugin *self) /* [main] */
{
    if (self)
        close_output(self);
    free(self);
}

/* [output] The address is the text after the colon. After an error the host opens again after a
 * second. */
static mrt_result open_output(mrt_plugin *self, const char *address, const double *params,
                              mrt_face_wants *wants)
{
    char host[64] = "127.0.0.1", text[160];
    unsigned port = PORT;
    struct sockaddr_in to;
    (void)params;
    memset(&to, 0, sizeof to);
    if ((address[0] && sscanf(address, "%63[0-9.]:%u", host, &port) != 2) || port > 65535 ||
        inet_pton(AF_INET, host, &to.sin_addr) != 1) {
        snprintf(text, sizeof text, "\"%.60s\" is not an address: write 127.0.0.1:%d", address,
                 PORT);
        self->host->log(self->host, MRT_LOG_ERROR, text);
        return MRT_ERR_ARGUMENT; /* open_output has logged the reason, as for every error */
    }
    to.sin_family = AF_INET;
    to.sin_port = htons((uint16_t)port);
    self->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (self->socket < 0 || connect(self->socket, (struct sockaddr *)&to, sizeof to) != 0) {
        snprintf(text, sizeof text, "%s:%u: %.80s", host, port, strerror(errno));
        self->host->log(self->host, MRT_LOG_ERROR, text);
        return MRT_ERR_IO;
    }
    wants->rate_hz = 60.0;  /* at most this many per second, the newest ones */
    wants->repeat_s = 0.25; /* repeats an unchanged face: shows that the sender is running */
    return MRT_OK;
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names) /* [output] another face */
{
    self->names = names;
    return MRT_OK;
}

/* [output] Sends "time 1.234", then a line "JawOpen 0.250" for each weight that is not nearly 0. */
static mrt_result send_face(mrt_plugin *self, const double *params, const mrt_face_sample *face)
{
    char text[DATAGRAM_BYTES];
    int64_t at_ns = face->take_ns >= 0 ? face->take_ns : face->time_ns;
    size_t used = (size_t)snprintf(text, sizeof text, "time %.3f\n", (double)at_ns * 1e-9);
    for (uint32_t i = 0; i < self->names->weight_count; ++i) {
        double weight = (double)face->weights[i];
        int length = 0;
        if (weight >= params[LEAST] || weight <= -params[LEAST])
            length = snprintf(text + used, sizeof text - used, "%s %.3f\n", self->names->weights[i],
                              weight);
        if (length < 0 || used + (size_t)length >= sizeof text)
            break; /* leave out what exceeds one datagram */
        used += (size_t)length;
    }
    if (send(self->socket, text, used, MSG_DONTWAIT) >= 0)
        return MRT_OK;
    return MRT_TIMEOUT; /* no receiver: not an error, it may start later */
}

/* ---- what the host reads ---- */

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    /* id (for ever), flags, name, group, unit, help, min, max, initial, labels */
    {1, 0, "Least", "Content", "", "Smallest weight that is sent.", 0, 1, 0.01, NULL},
};
static const mrt_face_output output = {open_output, begin, send_face, close_output};
static const mrt_interface interfaces[] = {{MRT_FACE_OUTPUT, &output}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI, PARAM_COUNT, params, interfaces,
    "org.example.template_name", "template_name", "1.0",
    "The face as lines of text over UDP.", create, destroy};
/* clang-format on */

const mrt_plugin_type *const marotte_plugins[] = {&type, NULL}; /* the only exported symbol */
