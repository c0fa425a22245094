/* osc.c - the plugin "org.marotte.osc": receives hands and pedals from the network (input), and
 * sends the samples of inputs to another marotte (output). README.md documents every message. */
#include "device_io.h"
#include "osc_port.h"
#include "trace.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARAM_HAND, PARAM_CONTENT, PARAM_SILENCE, PARAM_COUNT };

static const int64_t ns_per_s = 1000000000;
/* Time for which open() waits for the channels of a forwarded source. */
static const int64_t open_wait_ns = 2000000000;
/* Time for which it waits for a message of a lost sender; the host tries again. */
static const int64_t return_wait_ns = 500000000;
/* Interval at which open() checks whether the host is stopping. */
static const int64_t look_ns = 5000000;
/* An input is lost after this many times the silence that releases its pedals. */
enum { LOST_SILENCES = 3 };

/* MRT_INPUT: receives hands, pedals and forwarded sources. Returns them as samples, detects a
 * silent sender, and releases its pedals. */
typedef struct osc_input {
    const mrt_host *host;
    osc_port *port; /* NULL: not listening */
    osc_address address;
    osc_listener listener; /* joined while port is open: guarded by the port's lock */
    osc_table table;       /* result of channels() while open */
    bool is_open;
    bool is_lost; /* the sender was lost: the port stays open, so that no message is missed when the
                     sender returns */
    bool has_asked_to_restart;
    int64_t host_offset_ns; /* host clock minus ours */
    int64_t opened_ns;      /* ours */
    int64_t last_time_ns;   /* of the last sample returned, host clock */
    uint32_t sequence;      /* of the last sample returned */
    float value[MRT_MAX_CHANNELS];
    bool has_given;
} osc_input;

enum { SOURCES_MAX = 16, PACKET_BYTES = 8192 };
static const int64_t repeat_ns = 250000000, announce_ns = 500000000;

typedef struct forwarded {
    osc_table table; /* last content sent; source "": unused */
    mrt_sample last;
    int64_t sent_ns,
        told_ns; /* times at which the last sample and the channels were sent, our clock */
} forwarded;

/* MRT_OUTPUT: forwards samples of inputs to another marotte, bit for bit. A separate thread sends
 * the channels every 500 ms, and repeats the last sample after 250 ms without a newer one. So a
 * receiver can start late, knows that the sender is running, and gets the release of a pedal even
 * if its datagram was lost. */
typedef struct osc_output {
    const mrt_host *host;
    bool is_open;
    int socket;
    trace trace;
    osc_address address;
    int64_t host_offset_ns; /* host clock minus ours */
    pthread_t thread;
    pthread_mutex_t mutex; /* guards the fields below; held for at most one send, without waiting */
    pthread_cond_t wake;
    bool is_stopping;
    forwarded source[SOURCES_MAX];
    uint32_t failed_count;
    bool has_logged_failure, has_logged_source;
    unsigned char packet[PACKET_BYTES];
} osc_output;

struct mrt_plugin {
    osc_input input;
    osc_output output;
};

/* ---- the input: listening ---- */

static void stop_listening(osc_input *self)
{
    if (!self->port)
        return;
    char summary[160];
    osc_port_summary(self->port, summary, sizeof summary);
    if (summary[0] != '\0')
        device_log(self->host, MRT_LOG_INFO, "%s", summary);
    osc_port_leave(self->port, &self->listener);
    osc_port_close(self->port);
    self->port = NULL;
}

/* ---- the input: opening ---- */

static uint32_t side_of(const double *params)
{
    return (uint32_t)(params[PARAM_HAND] < 0.5 ? MRT_LEFT : MRT_RIGHT);
}

static osc_content content_of(const double *params)
{
    double content = params[PARAM_CONTENT];
    if (content < 0.5)
        return OSC_CONTENT_PEDALS;
    if (content < 1.5)
        return OSC_CONTENT_WRIST;
    return content < 2.5 ? OSC_CONTENT_PEDALS_ONLY : OSC_CONTENT_CONTROLS;
}

/* Returns true if a lost input can keep its listener, because it has the same settings. */
static bool goes_on(const osc_input *self, const osc_address *address, const double *params)
{
    if (!self->port || !self->is_lost || self->address.port != address->port ||
        strcmp(self->address.host, address->host) != 0 ||
        self->address.has_source != address->has_source ||
        strcmp(self->address.source, address->source) != 0)
        return false;
    return address->has_source || self->listener.is_adopted ||
           (self->listener.side == side_of(params) && self->listener.content == content_of(params));
}

static mrt_result start_listening(osc_input *self, const osc_address *address, const double *params)
{
    char reason[UDP_REASON];
    stop_listening(self);
    self->is_lost = false;
    self->address = *address;
    self->port = osc_port_open(address, self->host, reason);
    if (!self->port) {
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    if (address->has_source)
        osc_listener_start_forwarded(&self->listener, address->source);
    else
        osc_listener_start_simple(&self->listener, side_of(params), content_of(params));
    osc_port_join(self->port, &self->listener);
    return MRT_OK;
}

/* Returns true if open() is complete: the channels are known and, for a lost sender, a message has
 * arrived. */
static bool is_there(osc_input *self)
{
    osc_port_lock(self->port);
    const osc_listener *listener = &self->listener;
    bool found = listener->table.count > 0 && (!self->is_lost || listener->has_heard);
    osc_port_unlock(self->port);
    return found;
}

/* Receives until that. Returns MRT_TIMEOUT if it took too long, or if the host is stopping. */
static mrt_result wait_until_there(osc_input *self, int64_t wait_ns)
{
    int64_t until_ns = device_clock_ns() + wait_ns;
    while (!is_there(self)) {
        if (device_clock_ns() >= until_ns)
            return MRT_TIMEOUT;
        if (!osc_port_wait(self->port, &self->listener, device_clock_ns() + look_ns, self->host))
            return MRT_ERR_IO;
        int64_t look_again_ns = self->host->now_ns(self->host) + look_ns;
        if (!is_there(self) && self->host->wait_until_ns(self->host, look_again_ns) < look_again_ns)
            return MRT_TIMEOUT;
    }
    return MRT_OK;
}

/* The socket failed: the next open() creates a new one. */
static mrt_result report_network_failure(osc_input *self)
{
    device_log(self->host, MRT_LOG_ERROR,
               "port %u: the network failed: is the connection still there?",
               (unsigned)self->address.port);
    self->is_lost = false;
    return MRT_ERR_IO;
}

static mrt_result report_no_sender(osc_input *self)
{
    const osc_address *address = &self->address;
    if (self->is_lost) { /* reported when it was lost */
        device_log(self->host, MRT_LOG_DEBUG, "port %u: nothing yet", (unsigned)address->port);
        return MRT_ERR_IO;
    }
    char there[256];
    osc_port_name_sources(self->port, there, sizeof there);
    if (there[0] != '\0')
        device_log(self->host, MRT_LOG_ERROR,
                   "port %u: \"%s\" is not forwarded to it; available: %s", (unsigned)address->port,
                   address->source, there);
    else
        device_log(self->host, MRT_LOG_ERROR,
                   "%s port %u: no marotte forwards \"%s\" to it: start `marotte devices --forward "
                   "ADDRESS:%u` on the other computer, and let both firewalls pass UDP; to receive "
                   "from another computer, write 0.0.0.0:%u/%s here",
                   address->host, (unsigned)address->port, address->source, (unsigned)address->port,
                   (unsigned)address->port, address->source);
    return MRT_ERR_IO;
}

static void begin(osc_input *self)
{
    osc_port_lock(self->port);
    osc_table_copy(&self->table, &self->listener.table);
    osc_port_unlock(self->port);
    if (!self->is_lost)
        self->has_given = false; /* keeps the sequence of a lost input */
    self->is_open = true;
    self->is_lost = false;
    self->has_asked_to_restart = false;
    self->host_offset_ns = device_clock_host_offset_ns(self->host);
    self->opened_ns = device_clock_ns();
    self->last_time_ns = INT64_MIN;
}

static void input_close(mrt_plugin *plugin)
{
    osc_input *self = &plugin->input;
    self->is_open = false;
    if (!self->is_lost)
        stop_listening(self);
}

static mrt_result input_open(mrt_plugin *plugin, const char *address, const double *params)
{
    osc_input *self = &plugin->input;
    osc_address parsed;
    input_close(plugin);
    if (!osc_address_parse(&parsed, address)) {
        device_log(self->host, MRT_LOG_ERROR,
                   "\"%.100s\" is not an address: expected [HOST:]PORT, with /SOURCE for an input "
                   "that another marotte forwards, as in 9105 or 0.0.0.0:9105/cyberglove",
                   address);
        return MRT_ERR_ARGUMENT;
    }
    if (!goes_on(self, &parsed, params)) {
        mrt_result result = start_listening(self, &parsed, params);
        if (result < 0)
            return result;
    }
    mrt_result result = wait_until_there(self, self->is_lost ? return_wait_ns : open_wait_ns);
    if (result == MRT_OK) {
        begin(self);
        return MRT_OK;
    }
    result = result < 0 ? report_network_failure(self) : report_no_sender(self);
    if (!self->is_lost)
        stop_listening(self);
    return result;
}

static const mrt_channel *input_channels(mrt_plugin *plugin, uint32_t *out_count)
{
    const osc_input *self = &plugin->input;
    *out_count = self->is_open ? self->table.count : 0;
    return self->table.channel;
}

/* ---- the input: reading ---- */

/* Channels are fixed while the input is open, so a change of the hand requests a restart. */
static void follow_params(osc_input *self, const double *params)
{
    const osc_listener *listener = &self->listener;
    if (self->address.has_source || listener->is_adopted || self->has_asked_to_restart ||
        (listener->side == side_of(params) && listener->content == content_of(params)))
        return;
    self->has_asked_to_restart = true;
    self->host->request_restart(self->host);
}

static void give(osc_input *self, int64_t time_ns, uint32_t step, mrt_sample *out)
{
    int64_t measured_ns = time_ns > self->opened_ns ? time_ns : self->opened_ns;
    self->sequence = self->has_given ? self->sequence + step : 0;
    self->has_given = true;
    memset(out, 0, sizeof *out);
    out->time_ns =
        device_sample_ns(self->host, measured_ns + self->host_offset_ns, &self->last_time_ns);
    out->sequence = self->sequence;
    out->count = self->table.count;
    memcpy(out->value, self->value, out->count * sizeof *out->value);
}

static bool is_pedal(const mrt_channel *channel)
{
    return channel->semantic >= MRT_CH_PEDAL && channel->semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS;
}

static bool has_pedal_down(const osc_input *self)
{
    for (uint32_t i = 0; self->has_given && i < self->table.count; ++i)
        if (is_pedal(&self->table.channel[i]) && self->value[i] > 0)
            return true;
    return false;
}

static void give_release(osc_input *self, int64_t time_ns, mrt_sample *out)
{
    for (uint32_t i = 0; i < self->table.count; ++i)
        if (is_pedal(&self->table.channel[i]))
            self->value[i] = 0;
    give(self, time_ns, 1, out);
}

/* Returns the next sample in the queue. */
static bool give_heard(osc_input *self, mrt_sample *out)
{
    osc_item item;
    for (;;) {
        osc_port_lock(self->port);
        osc_listener_close_frame_if_due(&self->listener, device_clock_ns());
        bool found = osc_listener_pop(&self->listener, &item);
        osc_port_unlock(self->port);
        if (!found)
            return false;
        if (item.step == 0 && !has_pedal_down(self))
            continue;
        if (item.step == 0) {
            give_release(self, item.time_ns, out);
            return true;
        }
        memcpy(self->value, item.value, sizeof self->value);
        give(self, item.time_ns, item.step, out);
        return true;
    }
}

/* Times at which the sender's silence has an effect, our clock; INT64_MAX: never. */
typedef struct silence {
    const char *loss; /* reason why the sender counts as lost; NULL: it does not */
    int64_t release_ns, lost_ns;
    int64_t frame_ns; /* when the received bones become a frame */
} silence;

static const char *loss_of(const osc_listener *listener)
{
    if (listener->has_ended)
        return "the sender stopped: waiting for it";
    if (listener->has_other_channels && listener->is_adopted && !listener->has_heard)
        return "another marotte forwards a device: its channels are used";
    if (listener->has_other_channels)
        return "the sender's channels changed: opening the input again";
    return NULL;
}

static silence silence_of(osc_input *self, const double *params)
{
    silence out = {NULL, INT64_MAX, INT64_MAX, INT64_MAX};
    double silence_s = params[PARAM_SILENCE];
    bool matters = silence_s > 0 && silence_s <= 1e6;
    int64_t silence_ns = matters ? (int64_t)(silence_s * (double)ns_per_s) : 0;
    osc_port_lock(self->port);
    const osc_listener *listener = &self->listener;
    out.loss = loss_of(listener);
    out.frame_ns = osc_listener_frame_due_ns(listener);
    if (matters && has_pedal_down(self))
        out.release_ns = listener->pedal_heard_ns + silence_ns;
    if (matters && listener->has_heard)
        out.lost_ns = listener->heard_ns + LOST_SILENCES * silence_ns;
    osc_port_unlock(self->port);
    if (!out.loss && out.lost_ns <= device_clock_ns())
        out.loss = "no messages: waiting for the sender";
    return out;
}

/* Marks the input as lost. The host closes and opens it, and this listener waits for the sender's
 * return. */
static mrt_result lose(osc_input *self, const char *why)
{
    char bound[OSC_SOURCE_LENGTH];
    osc_port_leave(self->port, &self->listener);
    snprintf(bound, sizeof bound, "%s", self->listener.bound);
    osc_listener_reset(&self->listener);
    osc_port_join(self->port, &self->listener);
    device_log(self->host, MRT_LOG_ERROR, "port %u%s%s: %s", (unsigned)self->address.port,
               bound[0] ? ": " : "", bound, why);
    self->is_lost = true;
    return MRT_ERR_IO;
}

static void release_pedals(osc_input *self, mrt_sample *out)
{
    osc_port_lock(self->port);
    osc_listener_release_pedals(&self->listener);
    osc_port_unlock(self->port);
    device_log(self->host, MRT_LOG_WARNING,
               "port %u: no pedal messages: pedals released. If the sender only sends changes, set "
               "silence=0",
               (unsigned)self->address.port);
    give_release(self, device_clock_ns(), out);
}

static mrt_result input_read(mrt_plugin *plugin, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    osc_input *self = &plugin->input;
    if (!self->is_open || self->is_lost)
        return MRT_ERR_IO;
    follow_params(self, params);
    int64_t until_ns = device_deadline_ns(self->host, deadline_ns);
    bool has_waited = false, works = true;
    for (;;) {
        if (give_heard(self, out_sample))
            return MRT_OK;
        silence quiet = silence_of(self, params);
        int64_t now_ns = device_clock_ns();
        if (has_pedal_down(self) && (quiet.loss || !works || quiet.release_ns <= now_ns)) {
            release_pedals(self, out_sample);
            return MRT_OK;
        }
        if (!works)
            return report_network_failure(self);
        if (quiet.loss)
            return lose(self, quiet.loss);
        if (has_waited && until_ns - now_ns < OSC_PORT_WAIT_LEAST_NS)
            return MRT_TIMEOUT;
        int64_t wake_ns = device_earlier_ns(device_earlier_ns(until_ns, quiet.frame_ns),
                                            device_earlier_ns(quiet.release_ns, quiet.lost_ns));
        works = osc_port_wait(self->port, &self->listener, wake_ns, self->host);
        has_waited = true;
    }
}

/* ---- the output: sending, with the mutex held ---- */

static const char *advice_for_send(int error)
{
    if (error == ECONNREFUSED)
        return "no program listens there: start marotte on that computer with --input "
               "osc:0.0.0.0:PORT/SOURCE";
    if (error == EACCES || error == EPERM)
        return "a firewall or this computer's settings block it";
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
    if (self->has_logged_failure)
        return;
    self->has_logged_failure = true;
    device_log(self->host, MRT_LOG_WARNING,
               "cannot send samples to %s port %u (%s): %s. Still trying", self->address.host,
               (unsigned)self->address.port, strerror(error), advice_for_send(error));
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

/* ---- the output: the repeating thread ---- */

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
        (void)device_condition_wait(&self->wake, &self->mutex, device_clock_ns() + repeat_ns / 2);
        if (!self->is_stopping)
            repeat(self, device_clock_ns());
    }
    pthread_mutex_unlock(&self->mutex);
    return NULL;
}

/* ---- the output: opening and closing ---- */

static mrt_result start_thread(osc_output *self)
{
    self->is_stopping = false;
    pthread_mutex_init(&self->mutex, NULL);
    device_condition_init(&self->wake);
    if (pthread_create(&self->thread, NULL, repeat_thread, self) == 0)
        return MRT_OK;
    pthread_cond_destroy(&self->wake);
    pthread_mutex_destroy(&self->mutex);
    device_log(self->host, MRT_LOG_ERROR, "cannot start the thread that repeats messages");
    return MRT_ERR_MEMORY;
}

static void send_end(osc_output *self)
{
    for (int i = 0; i < SOURCES_MAX; ++i)
        if (self->source[i].table.count > 0)
            send_packet(self, osc_table_write_end(&self->source[i].table, self->packet,
                                                  sizeof self->packet));
}

static void output_close(mrt_plugin *plugin)
{
    osc_output *self = &plugin->output;
    if (!self->is_open)
        return;
    self->is_open = false;
    pthread_mutex_lock(&self->mutex);
    self->is_stopping = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->mutex);
    pthread_join(self->thread, NULL);
    send_end(self);
    if (self->failed_count > 0)
        device_log(self->host, MRT_LOG_INFO, "%u datagrams could not be sent to %s port %u",
                   self->failed_count, self->address.host, (unsigned)self->address.port);
    pthread_cond_destroy(&self->wake);
    pthread_mutex_destroy(&self->mutex);
    trace_close(&self->trace);
    udp_close(self->socket);
}

static mrt_result output_open(mrt_plugin *plugin, const char *address, const double *params)
{
    osc_output *self = &plugin->output;
    char reason[UDP_REASON];
    (void)params;
    output_close(plugin);
    if (!address || address[0] == '\0' || !osc_address_parse(&self->address, address) ||
        self->address.has_source) {
        device_log(
            self->host, MRT_LOG_ERROR,
            "\"%.100s\" is not an address to send to: expected HOST:PORT, as in 192.168.1.20:%d",
            address ? address : "", OSC_PORT);
        return MRT_ERR_ARGUMENT;
    }
    self->socket = udp_connect(self->address.host, self->address.port, reason);
    if (self->socket < 0) {
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    memset(self->source, 0, sizeof self->source);
    self->failed_count = 0;
    self->has_logged_failure = self->has_logged_source = false;
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

/* ---- the output: writing ---- */

static bool is_sample(const mrt_sample *sample)
{
    if (sample->count == 0 || sample->count > MRT_MAX_CHANNELS)
        return false;
    for (uint32_t i = 0; i < sample->count; ++i)
        if (!isfinite(sample->value[i]))
            return false;
    return true;
}

/* Returns the slot of the source, or a free one; NULL: none. */
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

/* Returns false if a new version is needed: for new channels, or if the sequence restarts. */
static bool is_told(const forwarded *from, const mrt_channel *channels, const mrt_sample *sample)
{
    uint32_t ahead = sample->sequence - from->last.sequence;
    return from->table.count > 0 && osc_table_has(&from->table, channels, sample->count) &&
           ahead > 0 && ahead < UINT32_MAX / 2;
}

static mrt_result refuse(osc_output *self, mrt_result result, const char *source, const char *why)
{
    if (!self->has_logged_source)
        device_log(self->host, MRT_LOG_ERROR, "cannot forward %.95s: %s", source, why);
    self->has_logged_source = true;
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
                      "a name is longer than 95 (source), 63 (channel) or 15 (unit) letters, or a "
                      "channel has no description");
    if (!was_told)
        send_channels(self, to, now_ns);
    to->last = *sample;
    send_sample(self, to, now_ns);
    return MRT_OK;
}

/* A temporary failure of the network is logged once and is not an error: the next sample may
 * arrive. */
static mrt_result output_write(mrt_plugin *plugin, const char *source, const mrt_channel *channels,
                               const mrt_sample *sample)
{
    osc_output *self = &plugin->output;
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

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->input.host = self->output.host = host;
    self->output.socket = -1;
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    self->input.is_lost = false;
    input_close(self);
    output_close(self);
    free(self);
}

static const char *const hand_label[] = {"left", "right", NULL};
static const char *const content_label[] = {"hand and pedals", "hand and wrist", "pedals",
                                            "controls", NULL};

static const mrt_param params[PARAM_COUNT] = {
    [PARAM_HAND] = {1, MRT_PARAM_STEPPED, "hand", "Network", "",
                    "Hand for the messages of other software", MRT_LEFT, MRT_RIGHT, MRT_RIGHT,
                    hand_label},
    [PARAM_CONTENT] = {2, MRT_PARAM_STEPPED, "content", "Network", "",
                       "Channels made from the messages of other software", 0, 3, 0, content_label},
    [PARAM_SILENCE] = {3, 0, "silence", "Network", "s",
                       "Time without messages after which pedals are released; after three times "
                       "this the sender is lost. 0: the sender only sends changes",
                       0, 60, 1, NULL},
};

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_output output = {output_open, output_write, output_close};

static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_OUTPUT, &output}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.osc",
    "Network",
    MAROTTE_VERSION,
    "Hands and pedals over the network: from OSC or VMC trackers, and from another marotte",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
