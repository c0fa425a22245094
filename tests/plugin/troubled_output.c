/* A face output that goes wrong when it is told to: it sends "VERSION NUMBER" as text to a port of
 * this computer, and crashes, hangs or fails at each 20th face. */
#include <marotte/plugin.h>

#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#ifndef VERSION
#define VERSION 1
#endif
enum { TROUBLE, SLOW_MS, PARAM_COUNT };
enum { TROUBLE_NONE, TROUBLE_CRASH, TROUBLE_HANG, TROUBLE_FAIL, TROUBLE_OPEN };

struct mrt_plugin {
    const mrt_host *host;
    int fd;
    uint32_t sent;
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->fd = -1;
    return self;
}

static void close_it(mrt_plugin *self)
{
    if (self->fd >= 0)
        close(self->fd);
    self->fd = -1;
}

static void destroy(mrt_plugin *self)
{
    if (self)
        close_it(self);
    free(self);
}

static mrt_result open_it(mrt_plugin *self, const char *address, const double *params,
                          mrt_face_wants *wants)
{
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(address))};
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    wants->vertices = 1;
    wants->rate_hz = -1e300; /* nonsense, which the host does not take */
    self->sent = 0;
    if ((int)params[TROUBLE] == TROUBLE_OPEN) {
        self->host->log(self->host, MRT_LOG_ERROR, "the door is locked");
        return MRT_ERR_IO;
    }
    self->fd = socket(AF_INET, SOCK_DGRAM, 0);
    return self->fd >= 0 && connect(self->fd, (struct sockaddr *)&to, sizeof to) == 0 ? MRT_OK
                                                                                      : MRT_ERR_IO;
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names)
{
    (void)self;
    (void)names;
    return MRT_OK;
}

static mrt_result send_it(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    char text[64];
    self->sent += 1;
    int trouble = self->sent % 20 == 0 ? (int)params[TROUBLE] : TROUBLE_NONE;
    if (trouble == TROUBLE_CRASH)
        abort();
    for (; trouble == TROUBLE_HANG;)
        pause();
    if (trouble == TROUBLE_FAIL) {
        self->host->log(self->host, MRT_LOG_ERROR, "it is broken");
        return MRT_ERR_IO;
    }
    usleep((useconds_t)(params[SLOW_MS] * 1000.0));
    int length = snprintf(text, sizeof text, "%d %ju %d", VERSION, (uintmax_t)sample->number,
                          sample->vertices != NULL);
    (void)!send(self->fd, text, (size_t)length, 0);
    return MRT_OK;
}

static const mrt_param params[PARAM_COUNT] = {
    {1, MRT_PARAM_STEPPED, "Trouble", "Test", "", "What goes wrong.", 0, 4, 0, NULL},
    {2, 0, "Slow", "Test", "ms", "How long each takes.", 0, 100, 0, NULL},
};
static const mrt_face_output output = {open_it, begin, send_it, close_it};
static const mrt_interface interfaces[] = {{MRT_FACE_OUTPUT, &output}, {NULL, NULL}};
static const mrt_plugin_type type = {MRT_ABI,
                                     PARAM_COUNT,
                                     params,
                                     interfaces,
                                     "org.example.troubled_output",
                                     "Troubled output",
                                     "1",
                                     "Goes wrong when it is told to.",
                                     create,
                                     destroy};
const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
