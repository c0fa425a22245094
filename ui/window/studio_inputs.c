#include "window/studio_inputs.h"

#include "base/ring.h"
#include "stage/device_list.h"
#include "stage/spec.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct studio_inputs {
    plugin_list *plugins;
    log_queue *log;
    char text[STUDIO_INPUTS_MAX][STUDIO_INPUT_TEXT];
    uint32_t count;
    bool looks_further;
    device_list found;
    ring *opened; /* studio_input_opened, to [main] */
    _Atomic bool stop, is_done;
    pthread_t thread;
    bool has_thread;
};

static bool open_one(studio_inputs *self, const char *text)
{
    studio_input_opened one = {.input = NULL};
    plugin_spec of;
    const mrt_plugin_type *type;
    (void)snprintf(one.text, sizeof one.text, "%s", text);
    mrt_result result = MRT_OK;
    if (!spec_read(&of, text))
        result = error_set(&one.err, MRT_ERR_ARGUMENT,
                           "\"%.200s\" is not PLUGIN[:ADDRESS][,key=value]", text);
    if (result >= 0)
        result = plugin_list_find(self->plugins, of.plugin, MRT_INPUT, &type, &one.err);
    if (result >= 0)
        result = input_create_stoppable(&one.input, type, of.address, of.params, CLOCK_REAL,
                                        self->log, &self->stop, &one.err);
    spec_finish(&of);
    if (result < 0)
        one.input = NULL;
    if (!ring_push(self->opened, &one))
        input_destroy(one.input);
    return result >= 0;
}

/* The plugin's first device is opened by its plugin's name alone when it is the only one. */
static void open_what_is_ready(studio_inputs *self)
{
    error err = {0};
    uint32_t opened = 0;
    if (device_list_look(&self->found, self->plugins, self->log, NULL, &err) < 0) {
        log_push(self->log, MRT_LOG_WARNING, "devices", err.text);
        return;
    }
    for (uint32_t i = 0; i < self->found.count && opened < STUDIO_INPUTS_MAX && !self->stop; ++i) {
        const device_found *one = &self->found.one[i];
        char text[STUDIO_INPUT_TEXT];
        if (one->device.state != MRT_DEVICE_READY)
            continue;
        (void)snprintf(text, sizeof text, "%.48s:%s", device_list_plugin_name(one->type),
                       one->device.address);
        opened += open_one(self, text);
    }
}

static void *run(void *data)
{
    studio_inputs *self = data;
    uint32_t opened = 0;
    for (uint32_t i = 0; i < self->count && !self->stop; ++i)
        opened += open_one(self, self->text[i]);
    if (opened == 0 && self->looks_further && !self->stop)
        open_what_is_ready(self);
    self->is_done = true;
    return NULL;
}

studio_inputs *studio_inputs_start(plugin_list *plugins, log_queue *log, const char *const *texts,
                                   uint32_t count, bool looks_further)
{
    studio_inputs *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->plugins = plugins;
    self->log = log;
    self->count = count < STUDIO_INPUTS_MAX ? count : STUDIO_INPUTS_MAX;
    for (uint32_t i = 0; i < self->count; ++i)
        (void)snprintf(self->text[i], sizeof self->text[i], "%s", texts[i]);
    self->looks_further = looks_further;
    self->opened = ring_create(sizeof(studio_input_opened), 2 * STUDIO_INPUTS_MAX);
    self->has_thread = self->opened && pthread_create(&self->thread, NULL, run, self) == 0;
    if (self->has_thread)
        return self;
    studio_inputs_destroy(self);
    return NULL;
}

void studio_inputs_destroy(studio_inputs *self)
{
    studio_input_opened left;
    if (!self)
        return;
    self->stop = true;
    if (self->has_thread)
        (void)pthread_join(self->thread, NULL);
    while (self->opened && ring_pop(self->opened, &left))
        input_destroy(left.input);
    ring_destroy(self->opened);
    free(self);
}

bool studio_inputs_take(studio_inputs *self, studio_input_opened *out)
{
    return ring_pop(self->opened, out);
}

bool studio_inputs_are_done(studio_inputs *self)
{
    studio_input_opened next;
    const bool is_done = self->is_done;
    return is_done && !ring_peek(self->opened, &next);
}
