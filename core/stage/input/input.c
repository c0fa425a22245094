#include "stage/input.h"
#include "base/clock.h"
#include "base/text.h"
#include "stage/input/input_inside.h"
#include "stage/mapping/plugins.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t patience_first_ns = 250 * NS_PER_MS, patience_later_ns = 500 * NS_PER_MS;

void input_name_of(char out[INPUT_NAME], const mrt_plugin_type *type, const char *address)
{
    const char *dot = strrchr(type->id, '.');
    const char *slash = strrchr(address, '/');
    snprintf(out, INPUT_NAME, "%.31s%s%.63s", dot ? dot + 1 : type->id, address[0] ? " " : "",
             slash ? slash + 1 : address);
    text_make_printable(out); /* addresses come from devices too */
}

/* "" found some device: the name says which. */
static void name_found(input *self)
{
    const mrt_devices *devices = plugin_interface(self->plugin.type, MRT_DEVICES);
    mrt_device found = {.address = ""};
    if (self->address[0] || !devices || !devices->current(self->plugin.self, &found))
        return;
    found.address[sizeof found.address - 1] = '\0';
    input_name_of(self->name, self->plugin.type, found.address);
}

static mrt_result allocate(input *self, error *err)
{
    self->samples = ring_create(sizeof(input_record), INPUT_RING);
    self->incidents = ring_create(sizeof(input_incident), INPUT_INCIDENTS);
    if (!self->samples || !self->incidents)
        return error_set(err, MRT_ERR_MEMORY, "no memory for input %s", self->name);
    return MRT_OK;
}

mrt_result input_create_stoppable(input **out, const mrt_plugin_type *type, const char *address,
                                  const char *params, instance_clock clock, log_queue *log,
                                  const _Atomic bool *stop, error *err)
{
    *out = NULL;
    input *self = calloc(1, sizeof *self);
    char *own_address = strdup(address);
    if (!self || !own_address) {
        free(self);
        free(own_address);
        return error_set(err, MRT_ERR_MEMORY, "no memory for input %s", type->id);
    }
    self->address = own_address;
    self->functions = plugin_interface(type, MRT_INPUT);
    self->patience_first_ns = patience_first_ns;
    self->patience_later_ns = patience_later_ns;
    health_board_init(&self->board);
    mrt_result result = instance_create(&self->plugin, type, clock, log, err);
    if (result < 0)
        goto fail;
    self->plugin.can_restart = true;
    input_name_of(self->name, type, address);
    result = instance_set_list(&self->plugin, params, err);
    if (result >= 0)
        result = allocate(self, err);
    self->plugin.stop = stop;
    if (result >= 0)
        result = input_run_open(self, err);
    self->plugin.stop = NULL;
    if (result < 0)
        goto fail;
    name_found(self);
    *out = self;
    return MRT_OK;
fail:
    input_destroy(self);
    return result;
}

mrt_result input_create(input **out, const mrt_plugin_type *type, const char *address,
                        const char *params, instance_clock clock, log_queue *log, error *err)
{
    return input_create_stoppable(out, type, address, params, clock, log, NULL, err);
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
    ring_destroy(self->incidents);
    free(self->address);
    free(self);
}

const char *input_name(const input *self)
{
    return self->name;
}

const mrt_channel *input_channels_of(const input *self, uint32_t version, uint32_t *out_count)
{
    const channel_table *table = &self->table[version % INPUT_VERSIONS];
    *out_count = table->count;
    return table->channel;
}

const mrt_plugin_type *input_plugin(const input *self)
{
    return self->plugin.type;
}

const mrt_channel *input_channels(const input *self, uint32_t *out_count)
{
    return input_channels_of(self, atomic_load(&self->version), out_count);
}

void input_set_wake(input *self, wake *signal)
{
    self->signal = signal;
}

void input_set_patience_ns(input *self, int64_t first_ns, int64_t later_ns)
{
    self->patience_first_ns = first_ns;
    self->patience_later_ns = later_ns;
}

mrt_result input_set(input *self, const char *key, const char *value, error *err)
{
    return instance_set_text(&self->plugin, key, value, err);
}

double input_value(const input *self, uint32_t index)
{
    return instance_value(&self->plugin, index);
}

mrt_result input_start(input *self, error *err)
{
    if (self->plugin.clock == CLOCK_VIRTUAL || self->has_thread)
        return MRT_OK;
    if (pthread_create(&self->thread, NULL, input_run, self) != 0)
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
    input_record record;
    if (self->plugin.clock == CLOCK_REAL) {
        if (!ring_peek(self->samples, &record))
            return false;
    } else {
        if (!self->has_pending)
            self->has_pending = input_run_virtual(self, &self->pending);
        if (!self->has_pending)
            return false;
        record = self->pending;
    }
    *out_sample = record.sample;
    self->peeked_version = record.version;
    return true;
}

void input_take(input *self)
{
    input_record dropped;
    if (self->plugin.clock == CLOCK_REAL)
        (void)ring_pop(self->samples, &dropped);
    self->has_pending = false;
}

uint32_t input_version(const input *self)
{
    return self->peeked_version;
}

/* The state is asked first: what came before the end is still in the ring. */
static mrt_result peek_source(void *self, mrt_sample *out, uint32_t *out_version, error *err)
{
    (void)err;
    input *in = self;
    input_state state = input_state_of(in);
    if (input_peek(in, out)) {
        *out_version = in->peeked_version;
        return MRT_OK;
    }
    if (in->plugin.clock == CLOCK_REAL && (state == INPUT_RUNNING || state == INPUT_LOST))
        return MRT_TIMEOUT;
    return MRT_END;
}

static void take_source(void *self)
{
    input_take(self);
}

static const mrt_channel *source_channels(void *self, uint32_t version, uint32_t *out_count)
{
    return input_channels_of(self, version, out_count);
}

sample_source input_source(input *self)
{
    return (sample_source){self, peek_source, take_source, source_channels};
}

bool input_take_incident(input *self, input_incident *out)
{
    return ring_pop(self->incidents, out);
}

input_state input_state_of(const input *self)
{
    return (input_state)atomic_load(&self->state);
}

uint32_t input_dropped(const input *self)
{
    return atomic_load(&self->dropped);
}

uint32_t input_refused(const input *self)
{
    return atomic_load(&self->refused);
}

void input_health(const input *self, health_report *out)
{
    if (self->plugin.clock == CLOCK_VIRTUAL) {
        *out = (health_report){.state = atomic_load(&self->state)};
        return;
    }
    health_look(&self->board, out);
    health_age(out, clock_now_ns());
}

const char *input_state_name(input_state state)
{
    switch (state) {
    case INPUT_RUNNING:
        return "running";
    case INPUT_ENDED:
        return "over";
    case INPUT_FAILED:
        return "failed";
    case INPUT_LOST:
        return "away";
    }
    return "unknown";
}
