/* The plugin org.marotte.osc as a host loads it, on real sockets of this computer alone: a host
 * with a clock of its own epoch, inputs and outputs, a free port, and a socket that sends raw
 * bytes. */
#ifndef TESTS_DEVICE_OSC_NETWORK_H
#define TESTS_DEVICE_OSC_NETWORK_H
#include <marotte/plugin.h>

#include "osc_bytes.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

/* The host's clock is not the system's: whoever mixes them is years off. */
static const int64_t osc_network_epoch_ns = 500000000000000000;
enum { OSC_HAND, OSC_CONTENT, OSC_SILENCE, OSC_PARAMS };

typedef struct osc_node { /* one instance and its host */
    mrt_host host;
    pthread_mutex_t mutex;
    int said[4];
    char last_text[1024];
    bool is_stopping;
    const mrt_plugin_type *type;
    const mrt_input *input;
    const mrt_output *output;
    mrt_plugin *plugin;
    double params[OSC_PARAMS];
} osc_node;

static inline int64_t osc_network_now_ns(const mrt_host *host)
{
    (void)host;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return osc_network_epoch_ns + (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static inline int64_t osc_network_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    const osc_node *self = host->data;
    int64_t left_ns = time_ns - osc_network_now_ns(host);
    if (self->is_stopping)
        return time_ns - 1;
    struct timespec pause = {left_ns / 1000000000, (long)(left_ns % 1000000000)};
    if (left_ns > 0)
        nanosleep(&pause, NULL);
    return osc_network_now_ns(host);
}

static inline void osc_network_log(const mrt_host *host, int32_t level, const char *text)
{
    osc_node *self = host->data;
    pthread_mutex_lock(&self->mutex);
    self->said[level] += 1;
    snprintf(self->last_text, sizeof self->last_text, "%s", text);
    pthread_mutex_unlock(&self->mutex);
}

static inline void osc_network_restart(const mrt_host *host)
{
    (void)host;
}

static inline const void *osc_network_service(const mrt_host *host, const char *id)
{
    (void)host;
    (void)id;
    return NULL;
}

static inline osc_node *osc_node_create(void)
{
    osc_node *self = calloc(1, sizeof *self);
    void *library = dlopen(BUILD_DIR "/plugins/osc.so", RTLD_NOW | RTLD_LOCAL);
    assert(self && library);
    pthread_mutex_init(&self->mutex, NULL);
    self->host = (mrt_host){self,
                            osc_network_log,
                            osc_network_now_ns,
                            osc_network_wait_until_ns,
                            osc_network_restart,
                            osc_network_service};
    /* POSIX says that a symbol's address fits an object pointer. */
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    assert(types);
    self->type = types[0];
    for (const mrt_interface *i = self->type->interfaces; i->id; ++i) {
        if (strcmp(i->id, MRT_INPUT) == 0)
            self->input = i->functions;
        if (strcmp(i->id, MRT_OUTPUT) == 0)
            self->output = i->functions;
    }
    for (int i = 0; i < OSC_PARAMS; ++i)
        self->params[i] = self->type->params[i].initial;
    self->plugin = self->type->create(&self->host);
    assert(self->plugin && self->input && self->output);
    return self;
}

static inline void osc_node_destroy(osc_node *self)
{
    self->type->destroy(self->plugin);
    pthread_mutex_destroy(&self->mutex);
    free(self);
}

static inline mrt_result osc_node_open_input(osc_node *self, const char *address)
{
    return self->input->open(self->plugin, address, self->params);
}

static inline mrt_result osc_node_open_output(osc_node *self, const char *address)
{
    return self->output->open(self->plugin, address, self->params);
}

static inline mrt_result osc_node_read(osc_node *self, int64_t within_ns, mrt_sample *out)
{
    return self->input->read(self->plugin, self->params,
                             osc_network_now_ns(&self->host) + within_ns, out);
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
