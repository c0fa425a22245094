#include "stage/input.h"
#include "base/clock.h"
#include "base/ring.h"
#include "stage/plugins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RING_SAMPLES = 1024, NAME_LENGTH = 96 };

/* How long a read may block before the thread looks whether it is to stop. */
static const int64_t read_span_ns = 100 * NS_PER_MS;

struct input {
    instance plugin;
    const mrt_input *functions;
    const mrt_channel *channels;
    uint32_t channel_count;
    char name[NAME_LENGTH];
    bool open, has_thread;
    pthread_t thread;
    ring *samples;
    bool has_pending; /* virtual clock: read ahead by one */
    mrt_sample pending;
    _Atomic int32_t state;
    _Atomic bool stopping;
    _Atomic uint32_t refused;
};

static void name_input(input *self, const char *address)
{
    const char *dot = strrchr(self->plugin.type->id, '.');
    const char *slash = strrchr(address, '/');
    snprintf(self->name, sizeof self->name, "%s%s%s", dot ? dot + 1 : self->plugin.type->id,
             address[0] ? " " : "", slash ? slash + 1 : address);
}

static mrt_result check_channels(const input *self, error *err)
{
    if (!self->channels || self->channel_count == 0 || self->channel_count > MRT_MAX_CHANNELS)
        return error_set(err, MRT_ERR_FORMAT, "%s: reports %u channels, 1 to %d are possible",
                         self->name, self->channel_count, MRT_MAX_CHANNELS);
    for (uint32_t i = 0; i < self->channel_count; ++i)
        if (!self->channels[i].name || !self->channels[i].unit ||
            self->channels[i].hand > MRT_NO_HAND)
            return error_set(err, MRT_ERR_FORMAT, "%s: channel %u is not described", self->name, i);
    return MRT_OK;
}

mrt_result input_create(input **out, const mrt_plugin_type *type, const char *address,
                        const char *params, instance_clock clock, log_queue *log, error *err)
{
    *out = NULL;
    input *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for input %s", type->id);
    self->functions = plugin_interface(type, MRT_INPUT);
    mrt_result result = instance_create(&self->plugin, type, clock, log, err);
    if (result < 0)
        goto fail;
    name_input(self, address);
    result = instance_set_list(&self->plugin, params, err);
    if (result < 0)
        goto fail;
    instance_latch(&self->plugin);
    error why = {""};
    self->plugin.failure = &why;
    result = self->functions->open(self->plugin.self, address, self->plugin.params);
    self->plugin.failure = NULL;
    if (result < 0) {
        error_set(err, result, "%s", why.text[0] ? why.text : "the input could not be opened");
        if (!why.text[0])
            error_prefix(err, self->name);
        goto fail;
    }
    self->open = true;
    self->channels = self->functions->channels(self->plugin.self, &self->channel_count);
    result = check_channels(self, err);
    if (result < 0)
        goto fail;
    self->samples = ring_create(sizeof(mrt_sample), RING_SAMPLES);
    if (!self->samples) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for input %s", self->name);
        goto fail;
    }
    *out = self;
    return MRT_OK;
fail:
    input_destroy(self);
    return result;
}

void input_destroy(input *self)
{
    if (!self)
        return;
    input_stop(self);
    if (self->open)
        self->functions->close(self->plugin.self);
    instance_destroy(&self->plugin);
    ring_destroy(self->samples);
    free(self);
}

const char *input_name(const input *self)
{
    return self->name;
}

const mrt_channel *input_channels(const input *self, uint32_t *out_count)
{
    *out_count = self->channel_count;
    return self->channels;
}

static bool is_good(const input *self, const mrt_sample *sample)
{
    if (sample->count != self->channel_count)
        return false;
    for (uint32_t i = 0; i < sample->count; ++i)
        if (!isfinite(sample->value[i]))
            return false;
    return true;
}

/* One read. True: a good sample. The state says why not. */
static bool read_sample(input *self, int64_t deadline_ns, mrt_sample *out)
{
    memset(out, 0, sizeof *out);
    instance_latch(&self->plugin);
    mrt_result result =
        self->functions->read(self->plugin.self, self->plugin.params, deadline_ns, out);
    if (result == MRT_OK) {
        if (is_good(self, out))
            return true;
        atomic_fetch_add(&self->refused, 1);
    } else if (result == MRT_END) {
        atomic_store(&self->state, INPUT_ENDED);
    } else if (result < 0) {
        atomic_store(&self->state, INPUT_FAILED);
    }
    return false;
}

static void *input_thread(void *data)
{
    input *self = data;
    mrt_sample sample;
    while (!atomic_load(&self->stopping) && atomic_load(&self->state) == INPUT_RUNNING)
        if (read_sample(self, clock_now_ns() + read_span_ns, &sample))
            (void)ring_push(self->samples, &sample); /* a full ring counts its drops */
    return NULL;
}

mrt_result input_start(input *self, error *err)
{
    if (self->plugin.clock == CLOCK_VIRTUAL || self->has_thread)
        return MRT_OK;
    if (pthread_create(&self->thread, NULL, input_thread, self) != 0)
        return error_set(err, MRT_ERR_MEMORY, "%s: its thread could not be started", self->name);
    self->has_thread = true;
    return MRT_OK;
}

void input_stop(input *self)
{
    if (!self->has_thread)
        return;
    atomic_store(&self->stopping, true);
    instance_stop_waiting(&self->plugin);
    pthread_join(self->thread, NULL);
    self->has_thread = false;
}

bool input_peek(input *self, mrt_sample *out_sample)
{
    if (self->plugin.clock == CLOCK_REAL)
        return ring_peek(self->samples, out_sample);
    while (!self->has_pending && atomic_load(&self->state) == INPUT_RUNNING)
        self->has_pending = read_sample(self, INT64_MAX, &self->pending);
    if (self->has_pending)
        *out_sample = self->pending;
    return self->has_pending;
}

void input_take(input *self)
{
    mrt_sample dropped;
    if (self->plugin.clock == CLOCK_REAL)
        (void)ring_pop(self->samples, &dropped);
    self->has_pending = false;
}

input_state input_state_of(const input *self)
{
    return (input_state)atomic_load(&self->state);
}

uint32_t input_dropped(const input *self)
{
    return ring_drop_count(self->samples);
}

uint32_t input_refused(const input *self)
{
    return atomic_load(&self->refused);
}
