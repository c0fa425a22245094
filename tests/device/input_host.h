/* One plugin of inputs, perhaps of outputs, as a host loads it: a clock of its own epoch, what was
 * said (by any thread), restarts that were asked for, a folder for settings. */
#ifndef TESTS_DEVICE_INPUT_HOST_H
#define TESTS_DEVICE_INPUT_HOST_H
#include <marotte/plugin.h>

#include <assert.h>
#include <dlfcn.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The host's clock is not the system's: whoever mixes them is years off. */
static const int64_t input_host_epoch_ns = 500000000000000000;
enum { INPUT_HOST_PARAMS = 16 };

typedef struct input_host {
    mrt_host host;
    mrt_folders folders;
    char settings[512];    /* "": this host has no folders */
    pthread_mutex_t mutex; /* guards what was said */
    int said[4], restart_count;
    char last_text[1024];
    bool is_stopping; /* waits end before their time */
    int wait_count;
    const mrt_plugin_type *type;
    const mrt_input *input;
    const mrt_devices *devices;
    const mrt_output *output;
    mrt_plugin *plugin;
    double params[INPUT_HOST_PARAMS];
} input_host;

static inline int64_t input_host_now_ns(const mrt_host *host)
{
    (void)host;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return input_host_epoch_ns + (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static inline int64_t input_host_wait(const mrt_host *host, int64_t time_ns)
{
    input_host *self = host->data;
    int64_t left_ns = time_ns - input_host_now_ns(host);
    self->wait_count += 1;
    if (self->is_stopping)
        return time_ns - 1;
    struct timespec pause = {left_ns / 1000000000, (long)(left_ns % 1000000000)};
    if (left_ns > 0)
        nanosleep(&pause, NULL);
    return input_host_now_ns(host);
}

static inline void input_host_log(const mrt_host *host, int32_t level, const char *text)
{
    input_host *self = host->data;
    pthread_mutex_lock(&self->mutex);
    self->said[level] += 1;
    snprintf(self->last_text, sizeof self->last_text, "%s", text);
    pthread_mutex_unlock(&self->mutex);
}

static inline void input_host_restart(const mrt_host *host)
{
    ((input_host *)host->data)->restart_count += 1;
}

static inline mrt_result input_host_settings(const mrt_host *host, char *out, size_t capacity)
{
    snprintf(out, capacity, "%s", ((input_host *)host->data)->settings);
    return MRT_OK;
}

/* Of MRT_LANDMARKS, which is asked for while an instance is made; NULL: these hosts have none. */
static const mrt_landmark_reader *input_host_landmarks;

static inline const void *input_host_service(const mrt_host *host, const char *id)
{
    input_host *self = host->data;
    if (strcmp(id, MRT_LANDMARKS) == 0)
        return input_host_landmarks;
    return strcmp(id, MRT_FOLDERS) == 0 && self->settings[0] ? &self->folders : NULL;
}

static inline input_host *input_host_create(const char *library_path)
{
    input_host *self = calloc(1, sizeof *self);
    void *library = dlopen(library_path, RTLD_NOW | RTLD_LOCAL);
    if (!self || !library) {
        fprintf(stderr, "%s\n", dlerror());
        abort();
    }
    pthread_mutex_init(&self->mutex, NULL);
    self->host = (mrt_host){self,
                            input_host_log,
                            input_host_now_ns,
                            input_host_wait,
                            input_host_restart,
                            input_host_service};
    self->folders = (mrt_folders){input_host_settings, input_host_settings};
    /* POSIX says that a symbol's address fits an object pointer. */
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    self->type = types[0];
    for (const mrt_interface *i = self->type->interfaces; i->id; ++i) {
        if (strcmp(i->id, MRT_INPUT) == 0)
            self->input = i->functions;
        if (strcmp(i->id, MRT_DEVICES) == 0)
            self->devices = i->functions;
        if (strcmp(i->id, MRT_OUTPUT) == 0)
            self->output = i->functions;
    }
    for (uint32_t i = 0; i < self->type->param_count; ++i)
        self->params[i] = self->type->params[i].initial;
    self->plugin = self->type->create(&self->host);
    assert(self->plugin && self->input);
    return self;
}

static inline void input_host_destroy(input_host *self)
{
    self->type->destroy(self->plugin);
    pthread_mutex_destroy(&self->mutex);
    free(self);
}

static inline void input_host_set(input_host *self, const char *name, double value)
{
    for (uint32_t i = 0; i < self->type->param_count; ++i)
        if (strcmp(self->type->params[i].name, name) == 0)
            self->params[i] = value;
}

static inline mrt_result input_host_open(input_host *self, const char *address)
{
    return self->input->open(self->plugin, address, self->params);
}

static inline mrt_result input_host_read(input_host *self, int64_t within_ns, mrt_sample *out)
{
    int64_t deadline_ns = input_host_now_ns(&self->host) + within_ns;
    return self->input->read(self->plugin, self->params, deadline_ns, out);
}

/* Of the channel of this name; -1: there is none. */
static inline int input_host_channel(input_host *self, const char *name)
{
    uint32_t count;
    const mrt_channel *channel = self->input->channels(self->plugin, &count);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(channel[i].name, name) == 0)
            return (int)i;
    return -1;
}

#endif
