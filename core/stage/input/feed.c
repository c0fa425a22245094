#include "stage/input/feed.h"
#include "base/clock.h"
#include "base/ring.h"
#include "stage/input/channel_table.h"
#include "stage/input/wake.h"
#include "stage/mapping/instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GIVEN_MAX = 256 };

/* maximum delay before a reader notices that the host is stopping */
static const int64_t look_span_ns = 20 * NS_PER_MS;

typedef struct given {
    int64_t time_ns;
    int32_t activity;
    float value[MRT_MAX_CHANNELS];
} given;

struct feed {
    mrt_plugin_type type;
    mrt_interface interfaces[2];
    channel_table table;
    int64_t period_ns;
    ring *values; /* elements of type given, from feed_push to the reader */
    wake signal;
};

struct mrt_plugin {
    feed *of;
    instance *host;
    bool has_begun; /* the first sample was read */
    given now;
    int64_t last_ns;
    uint32_t sequence;
};

/* ---- the plugin ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host->data;
    const char *type = (const char *)self->host->type;
    self->of = (feed *)(uintptr_t)(type - offsetof(feed, type));
    return self;
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result open_feed(mrt_plugin *self, const char *address, const double *params)
{
    (void)address, (void)params;
    self->has_begun = false;
    return MRT_OK;
}

static void close_feed(mrt_plugin *self)
{
    (void)self;
}

static const mrt_channel *channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->of->table.count;
    return self->of->table.channel;
}

/* Returns whether a sample is due: a new value, the first one, or a repeated one. */
static bool has_sample(mrt_plugin *self, int64_t now_ns)
{
    if (ring_pop(self->of->values, &self->now))
        return true;
    bool is_due = self->now.activity == FEED_MOVES && now_ns - self->last_ns >= self->of->period_ns;
    if (self->has_begun && !is_due)
        return false;
    self->now.time_ns = now_ns;
    return true;
}

static int64_t next_look_ns(const mrt_plugin *self, int64_t now_ns, int64_t deadline_ns)
{
    int64_t until_ns = now_ns + look_span_ns;
    int64_t due_ns = self->last_ns + self->of->period_ns;
    if (self->now.activity == FEED_MOVES && due_ns < until_ns)
        until_ns = due_ns;
    return until_ns < deadline_ns ? until_ns : deadline_ns;
}

static mrt_result read_feed(mrt_plugin *self, const double *params, int64_t deadline_ns,
                            mrt_sample *out)
{
    (void)params;
    for (;;) {
        uint32_t seen = wake_seen(&self->of->signal);
        int64_t now_ns = clock_now_ns();
        if (has_sample(self, now_ns))
            break;
        if (now_ns >= deadline_ns || instance_is_stopping(self->host))
            return MRT_TIMEOUT;
        wake_wait_until_ns(&self->of->signal, seen, next_look_ns(self, now_ns, deadline_ns));
    }
    self->has_begun = true;
    if (self->now.time_ns > self->last_ns)
        self->last_ns = self->now.time_ns;
    out->time_ns = self->last_ns;
    out->sequence = self->sequence++;
    out->count = self->of->table.count;
    memcpy(out->value, self->now.value, sizeof out->value);
    return MRT_OK;
}

static const mrt_input functions = {
    .open = open_feed, .channels = channels, .read = read_feed, .close = close_feed};

/* ---- create and destroy ---- */

mrt_result feed_create(feed **out, const feed_settings *settings, error *err)
{
    *out = NULL;
    feed *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %s", settings->id);
    mrt_result result = channel_table_init(&self->table, settings->channels,
                                           settings->channel_count, settings->id, err);
    self->values = ring_create(sizeof(given), GIVEN_MAX);
    if (result >= 0 && !self->values)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for %s", settings->id);
    if (result < 0) {
        feed_destroy(self);
        return result;
    }
    double rate_hz = settings->rate_hz > 0.0 ? settings->rate_hz : 125.0;
    self->period_ns = (int64_t)((double)NS_PER_S / rate_hz);
    self->interfaces[0] = (mrt_interface){MRT_INPUT, &functions};
    self->type = (mrt_plugin_type){.abi = MRT_ABI,
                                   .interfaces = self->interfaces,
                                   .id = settings->id,
                                   .name = settings->name,
                                   .version = "1.0",
                                   .about = "",
                                   .create = create,
                                   .destroy = destroy};
    wake_init(&self->signal);
    *out = self;
    return MRT_OK;
}

void feed_destroy(feed *self)
{
    if (!self)
        return;
    ring_destroy(self->values);
    free(self);
}

const mrt_plugin_type *feed_type(const feed *self)
{
    return &self->type;
}

void feed_push(feed *self, const float *value, feed_activity activity)
{
    given now = {.time_ns = clock_now_ns(), .activity = (int32_t)activity};
    for (uint32_t i = 0; i < self->table.count; ++i)
        now.value[i] = isfinite(value[i]) ? value[i] : 0.0f;
    (void)ring_push(self->values, &now); /* full only after the reader has stopped */
    wake_signal(&self->signal);
}
