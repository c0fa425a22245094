#include "osc_output.h"
#include "device_io.h"
#include "udp.h"
#include "osc_port.h"
#include "osc_table.h"
#include "trace.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SOURCES_MAX = 16, PACKET_BYTES = 8192 };
static const int64_t repeat_ns = 250000000, announce_ns = 500000000;

typedef struct forwarded {
    osc_table table; /* of what was written last; source "": unused */
    mrt_sample last;
    int64_t sent_ns, told_ns; /* when the last sample and the channels were sent, our clock */
} forwarded;

struct osc_output {
    const mrt_host *host;
    bool is_open;
    int socket;
    trace trace;
    osc_address address;
    int64_t host_offset_ns; /* host clock less ours */
    pthread_t thread;
    pthread_mutex_t mutex; /* guards what follows; held for a send at most, which never waits */
    pthread_cond_t wake;
    bool is_stopping;
    forwarded source[SOURCES_MAX];
    uint32_t failed_count;
    bool has_said_failure, has_said_source;
    unsigned char packet[PACKET_BYTES];
};

/* ---- sending, with the mutex held ---- */

static const char *advice_for_send(int error)
{
    if (error == ECONNREFUSED)
        return "nobody listens there yet: start marotte on that computer with "
               "--input osc:0.0.0.0:PORT/SOURCE";
    if (error == EACCES || error == EPERM)
        return "a firewall or this computer's settings forbid it";
    if (error == EAGAIN || error == ENOBUFS)
        return "the network is slower than the samples";
    return "is the network connected?";
}

static void send_packet(osc_output *self, size_t size)
{
    trace_sent(&self->trace, device_clock_ns(), self->packet, size);
    int error = size > 0 ? udp_send(self->socket, self->packet, size) : ENOMEM;
    if (error == 0)
        return;
    self->failed_count += 1;
    if (self->has_said_failure)
        return;
    self->has_said_failure = true;
    device_say(self->host, MRT_LOG_WARNING, "samples do not reach %s port %u (%s): %s; trying on",
               self->address.host, (unsigned)self->address.port, strerror(error),
               advice_for_send(error));
}

static void send_channels(osc_output *self, forwarded *from, int64_t now_ns)
{
    send_packet(self, osc_table_write(&from->table, self->packet, sizeof self->packet));
    from->told_ns = now_ns;
}

static void send_sample(osc_output *self, forwarded *from, int64_t now_ns)
{
    int64_t sent_ns = now_ns + self->host_offset_ns;
    if (sent_ns < from->last.time_ns)
        sent_ns = from->last.time_ns;
    send_packet(self, osc_table_write_sample(&from->table, &from->last, sent_ns, self->packet,
                                             sizeof self->packet));
    from->sent_ns = now_ns;
}

/* ---- the thread that repeats ---- */

static void repeat(osc_output *self, int64_t now_ns)
{
    for (int i = 0; i < SOURCES_MAX; ++i) {
        forwarded *from = &self->source[i];
        if (from->table.count == 0)
            continue;
        if (now_ns - from->told_ns >= announce_ns)
            send_channels(self, from, now_ns);
        if (now_ns - from->sent_ns >= repeat_ns)
            send_sample(self, from, now_ns);
    }
}

static void *repeat_thread(void *data)
{
    osc_output *self = data;
    pthread_mutex_lock(&self->mutex);
    while (!self->is_stopping) {
        int64_t next_ns = device_clock_ns() + repeat_ns / 2;
        struct timespec until = {.tv_sec = (time_t)(next_ns / 1000000000),
                                 .tv_nsec = (long)(next_ns % 1000000000)};
        (void)pthread_cond_timedwait(&self->wake, &self->mutex, &until);
        if (!self->is_stopping)
            repeat(self, device_clock_ns());
    }
    pthread_mutex_unlock(&self->mutex);
    return NULL;
}

/* ---- opening ---- */

static mrt_result start_thread(osc_output *self)
{
    pthread_condattr_t attributes;
    self->is_stopping = false;
    pthread_mutex_init(&self->mutex, NULL);
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&self->wake, &attributes);
    pthread_condattr_destroy(&attributes);
    if (pthread_create(&self->thread, NULL, repeat_thread, self) == 0)
        return MRT_OK;
    pthread_cond_destroy(&self->wake);
    pthread_mutex_destroy(&self->mutex);
    device_say(self->host, MRT_LOG_ERROR, "the thread that repeats could not be started");
    return MRT_ERR_MEMORY;
}

mrt_result osc_output_open(osc_output *self, const char *address)
{
    char reason[UDP_REASON];
    osc_output_close(self);
    if (!address || address[0] == '\0' || !osc_address_parse(&self->address, address) ||
        self->address.has_source) {
        device_say(self->host, MRT_LOG_ERROR,
                   "\"%.100s\" is no address to send to: expected HOST:PORT, as in 192.168.1.20:%d",
                   address ? address : "", OSC_PORT);
        return MRT_ERR_ARGUMENT;
    }
    self->socket = udp_connect(self->address.host, self->address.port, reason);
    if (self->socket < 0) {
        device_say(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    memset(self->source, 0, sizeof self->source);
    self->failed_count = 0;
    self->has_said_failure = self->has_said_source = false;
    self->host_offset_ns = device_clock_host_offset_ns(self->host);
    trace_open(&self->trace, self->host, "osc");
    mrt_result result = start_thread(self);
    if (result < 0) {
        trace_close(&self->trace);
        udp_close(self->socket);
        return result;
    }
    self->is_open = true;
    return MRT_OK;
}

static void say_end(osc_output *self)
{
    for (int i = 0; i < SOURCES_MAX; ++i)
        if (self->source[i].table.count > 0)
            send_packet(self, osc_table_write_end(&self->source[i].table, self->packet,
                                                  sizeof self->packet));
}

void osc_output_close(osc_output *self)
{
    if (!self->is_open)
        return;
    self->is_open = false;
    pthread_mutex_lock(&self->mutex);
    self->is_stopping = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->mutex);
    pthread_join(self->thread, NULL);
    say_end(self);
    if (self->failed_count > 0)
        device_say(self->host, MRT_LOG_INFO, "%u datagrams did not reach %s port %u",
                   self->failed_count, self->address.host, (unsigned)self->address.port);
    pthread_cond_destroy(&self->wake);
    pthread_mutex_destroy(&self->mutex);
    trace_close(&self->trace);
    udp_close(self->socket);
}

/* ---- writing ---- */

static bool is_sample(const mrt_sample *sample)
{
    if (sample->count == 0 || sample->count > MRT_MAX_CHANNELS)
        return false;
    for (uint32_t i = 0; i < sample->count; ++i)
        if (!isfinite(sample->value[i]))
            return false;
    return true;
}

/* The place of the source, or a free one; NULL: there is none. */
static forwarded *find(osc_output *self, const char *source)
{
    for (int i = 0; i < SOURCES_MAX; ++i)
        if (self->source[i].table.count > 0 && strcmp(self->source[i].table.source, source) == 0)
            return &self->source[i];
    for (int i = 0; i < SOURCES_MAX; ++i)
        if (self->source[i].table.count == 0)
            return &self->source[i];
    return NULL;
}

/* A new version for new channels, and for a source that counts its samples anew. */
static bool is_told(const forwarded *from, const mrt_channel *channels, const mrt_sample *sample)
{
    uint32_t ahead = sample->sequence - from->last.sequence;
    return from->table.count > 0 && osc_table_has(&from->table, channels, sample->count) &&
           ahead > 0 && ahead < UINT32_MAX / 2;
}

static mrt_result refuse(osc_output *self, mrt_result result, const char *source, const char *why)
{
    if (!self->has_said_source)
        device_say(self->host, MRT_LOG_ERROR, "%.95s cannot be forwarded: %s", source, why);
    self->has_said_source = true;
    return result;
}

static mrt_result forward(osc_output *self, const char *source, const mrt_channel *channels,
                          const mrt_sample *sample)
{
    forwarded *to = find(self, source);
    if (!to)
        return refuse(self, MRT_ERR_UNSUPPORTED, source,
                      "16 sources are forwarded already: open a second output");
    int64_t now_ns = device_clock_ns();
    bool was_told = is_told(to, channels, sample);
    if (!was_told &&
        !osc_table_set(&to->table, source, to->table.version + 1, channels, sample->count))
        return refuse(self, MRT_ERR_UNSUPPORTED, source,
                      "a name is longer than 95 (source), 63 (channel) or 15 (unit) letters, "
                      "or a channel is not described");
    if (!was_told)
        send_channels(self, to, now_ns);
    to->last = *sample;
    send_sample(self, to, now_ns);
    return MRT_OK;
}

mrt_result osc_output_write(osc_output *self, const char *source, const mrt_channel *channels,
                            const mrt_sample *sample)
{
    if (!self->is_open)
        return MRT_ERR_IO;
    if (!source || !channels || !is_sample(sample))
        return refuse(self, MRT_ERR_ARGUMENT, source ? source : "a source",
                      "expected a name, channels and finite values");
    pthread_mutex_lock(&self->mutex);
    mrt_result result = forward(self, source, channels, sample);
    pthread_mutex_unlock(&self->mutex);
    return result;
}

/* ---- the instance ---- */

osc_output *osc_output_create(const mrt_host *host)
{
    osc_output *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->socket = -1;
    return self;
}

void osc_output_destroy(osc_output *self)
{
    if (!self)
        return;
    osc_output_close(self);
    free(self);
}
