#include "osc_input.h"
#include "device_io.h"
#include "osc_port.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t ns_per_s = 1000000000;
/* How long open() waits for the channels of a forwarded source. */
static const int64_t open_wait_ns = 2000000000;
/* How long it waits for a sign of a sender that went away: the host tries again. */
static const int64_t return_wait_ns = 500000000;
/* open() looks this often whether the host is stopping; one read() waits no longer than a second.
 */
static const int64_t look_ns = 5000000, read_max_ns = 1000000000;
/* Silence after which an input is lost, in silences after which its pedals go up. */
enum { LOST_SILENCES = 3 };

struct osc_input {
    const mrt_host *host;
    osc_port *port; /* NULL: not listening */
    osc_address address;
    osc_listener listener; /* joined while port is there: under the port's lock */
    osc_table table;       /* what channels() gives while open */
    bool is_open;
    bool is_lost; /* the sender went away: the port stays open, so that nothing is missed when it
                     comes back */
    bool has_asked_to_restart;
    int64_t host_offset_ns; /* host clock less ours */
    int64_t opened_ns;      /* ours */
    int64_t last_time_ns;   /* of the sample given last, host clock */
    uint32_t sequence;      /* of the sample given last */
    float value[MRT_MAX_CHANNELS];
    bool has_given;
};

static void stop_listening(osc_input *self)
{
    if (!self->port)
        return;
    char summary[160];
    osc_port_summary(self->port, summary, sizeof summary);
    if (summary[0] != '\0')
        device_say(self->host, MRT_LOG_INFO, "%s", summary);
    osc_port_leave(self->port, &self->listener);
    osc_port_close(self->port);
    self->port = NULL;
}

/* ---- opening ---- */

static uint32_t side_of(const double *params)
{
    return (uint32_t)(params[OSC_PARAM_HAND] < 0.5 ? MRT_LEFT : MRT_RIGHT);
}

static osc_content content_of(const double *params)
{
    double content = params[OSC_PARAM_CONTENT];
    if (content < 0.5)
        return OSC_CONTENT_PEDALS;
    if (content < 1.5)
        return OSC_CONTENT_WRIST;
    return content < 2.5 ? OSC_CONTENT_PEDALS_ONLY : OSC_CONTENT_CONTROLS;
}

/* One that was lost listens on to what it had, if that is what is asked for. */
static bool goes_on(const osc_input *self, const osc_address *address, const double *params)
{
    if (!self->port || !self->is_lost || self->address.port != address->port ||
        strcmp(self->address.host, address->host) != 0 ||
        self->address.has_source != address->has_source ||
        strcmp(self->address.source, address->source) != 0)
        return false;
    return address->has_source ||
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
        device_say(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    if (address->has_source)
        osc_listener_start_forwarded(&self->listener, address->source);
    else
        osc_listener_start_simple(&self->listener, side_of(params), content_of(params));
    osc_port_join(self->port, &self->listener);
    return MRT_OK;
}

/* Whether there is what open() waits for: channels, and, of a sender that went away, a sign. */
static bool is_there(osc_input *self)
{
    osc_port_lock(self->port);
    const osc_listener *listener = &self->listener;
    bool found = listener->table.count > 0 && (!self->is_lost || listener->has_heard);
    osc_port_unlock(self->port);
    return found;
}

/* Receives until it is there. MRT_TIMEOUT: it was not in time, or the host is stopping. */
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

/* The socket is of no use any more: the next open() makes a new one. */
static mrt_result say_network_failed(osc_input *self)
{
    device_say(self->host, MRT_LOG_ERROR,
               "port %u: the network failed: is the connection still there?",
               (unsigned)self->address.port);
    self->is_lost = false;
    return MRT_ERR_IO;
}

static mrt_result say_nobody(osc_input *self)
{
    const osc_address *address = &self->address;
    if (self->is_lost) { /* said when it went */
        device_say(self->host, MRT_LOG_DEBUG, "port %u: nothing yet", (unsigned)address->port);
        return MRT_ERR_IO;
    }
    char there[256];
    osc_port_name_sources(self->port, there, sizeof there);
    if (there[0] != '\0')
        device_say(self->host, MRT_LOG_ERROR,
                   "port %u: \"%s\" is not forwarded to it, but %s: choose one of these",
                   (unsigned)address->port, address->source, there);
    else
        device_say(
            self->host, MRT_LOG_ERROR,
            "%s port %u: no marotte forwards \"%s\" to it: start `marotte devices --forward "
            "ADDRESS:%u` on the other computer, and let both firewalls pass UDP; to hear another "
            "computer write 0.0.0.0:%u/%s here",
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
        self->has_given = false; /* the sequence of one that was lost goes on */
    self->is_open = true;
    self->is_lost = false;
    self->has_asked_to_restart = false;
    self->host_offset_ns = device_clock_host_offset_ns(self->host);
    self->opened_ns = device_clock_ns();
    self->last_time_ns = INT64_MIN;
}

mrt_result osc_input_open(osc_input *self, const char *address, const double *params)
{
    osc_address parsed;
    osc_input_close(self);
    if (!osc_address_parse(&parsed, address)) {
        device_say(
            self->host, MRT_LOG_ERROR,
            "\"%.100s\" is no address: expected [HOST:]PORT, and /SOURCE for what another marotte "
            "forwards, as in 9105 or 0.0.0.0:9105/cyberglove",
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
    result = result < 0 ? say_network_failed(self) : say_nobody(self);
    if (!self->is_lost)
        stop_listening(self);
    return result;
}

const mrt_channel *osc_input_channels(osc_input *self, uint32_t *out_count)
{
    *out_count = self->is_open ? self->table.count : 0;
    return self->table.channel;
}

void osc_input_close(osc_input *self)
{
    self->is_open = false;
    if (!self->is_lost)
        stop_listening(self);
}

/* ---- reading ---- */

/* Channels are fixed while it is open, so another hand needs it opened again. */
static void follow_params(osc_input *self, const double *params)
{
    const osc_listener *listener = &self->listener;
    if (self->address.has_source || self->has_asked_to_restart ||
        (listener->side == side_of(params) && listener->content == content_of(params)))
        return;
    self->has_asked_to_restart = true;
    self->host->request_restart(self->host);
}

static void give(osc_input *self, int64_t time_ns, uint32_t step, mrt_sample *out)
{
    int64_t now_ns = self->host->now_ns(self->host);
    int64_t host_ns =
        (time_ns > self->opened_ns ? time_ns : self->opened_ns) + self->host_offset_ns;
    if (host_ns > now_ns)
        host_ns = now_ns;
    if (host_ns < self->last_time_ns)
        host_ns = self->last_time_ns;
    self->last_time_ns = host_ns;
    self->sequence = self->has_given ? self->sequence + step : 0;
    self->has_given = true;
    memset(out, 0, sizeof *out);
    out->time_ns = host_ns;
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

/* The next thing in the queue that is a sample. */
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

/* When the sender's silence will mean something, our clock; INT64_MAX: not as things are. */
typedef struct silence {
    const char *loss; /* why the sender counts as gone; NULL: it does not */
    int64_t release_ns, lost_ns;
    int64_t frame_ns; /* when the bones that have come are a frame */
} silence;

static const char *loss_of(const osc_listener *listener)
{
    if (listener->has_ended)
        return "its sender has stopped: waiting for it";
    if (listener->has_other_channels)
        return "its sender has other channels now: opening it again";
    return NULL;
}

static silence silence_of(osc_input *self, const double *params)
{
    silence out = {NULL, INT64_MAX, INT64_MAX, INT64_MAX};
    double silence_s = params[OSC_PARAM_SILENCE];
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
        out.loss = "silent: waiting for its sender";
    return out;
}

/* From now on the host closes and opens, and this listens for the sender's return. */
static mrt_result lose(osc_input *self, const char *why)
{
    char bound[OSC_SOURCE_LENGTH];
    osc_port_leave(self->port, &self->listener);
    snprintf(bound, sizeof bound, "%s", self->listener.bound);
    osc_listener_rearm(&self->listener);
    osc_port_join(self->port, &self->listener);
    device_say(self->host, MRT_LOG_ERROR, "port %u%s%s: %s", (unsigned)self->address.port,
               bound[0] ? ": " : "", bound, why);
    self->is_lost = true;
    return MRT_ERR_IO;
}

static void release_pedals(osc_input *self, mrt_sample *out)
{
    osc_port_lock(self->port);
    osc_listener_release_pedals(&self->listener);
    osc_port_unlock(self->port);
    device_say(
        self->host, MRT_LOG_WARNING,
        "port %u: nothing heard of the pedals: they count as up (silence=0 if their sender speaks "
        "only when one moves)",
        (unsigned)self->address.port);
    give_release(self, device_clock_ns(), out);
}

static int64_t sooner(int64_t a_ns, int64_t b_ns)
{
    return a_ns < b_ns ? a_ns : b_ns;
}

/* The deadline by our clock. The wait is bounded also for a host whose clock waits for this input.
 */
static int64_t own_deadline_ns(const osc_input *self, int64_t deadline_ns, int64_t own_now_ns)
{
    int64_t now_ns = self->host->now_ns(self->host);
    if (deadline_ns <= now_ns)
        return own_now_ns;
    return own_now_ns + sooner(deadline_ns - now_ns, read_max_ns);
}

mrt_result osc_input_read(osc_input *self, const double *params, int64_t deadline_ns,
                          mrt_sample *out_sample)
{
    if (!self->is_open || self->is_lost)
        return MRT_ERR_IO;
    follow_params(self, params);
    int64_t until_ns = own_deadline_ns(self, deadline_ns, device_clock_ns());
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
            return say_network_failed(self);
        if (quiet.loss)
            return lose(self, quiet.loss);
        if (has_waited && until_ns - now_ns < OSC_PORT_WAIT_LEAST_NS)
            return MRT_TIMEOUT;
        int64_t wake_ns =
            sooner(sooner(until_ns, quiet.frame_ns), sooner(quiet.release_ns, quiet.lost_ns));
        works = osc_port_wait(self->port, &self->listener, wake_ns, self->host);
        has_waited = true;
    }
}

/* ---- the instance ---- */

osc_input *osc_input_create(const mrt_host *host)
{
    osc_input *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

void osc_input_destroy(osc_input *self)
{
    if (!self)
        return;
    self->is_lost = false;
    osc_input_close(self);
    free(self);
}
