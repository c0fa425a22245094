/* phone.c - the plugin "org.marotte.phone": the face of a person in front of a phone or a webcam,
 * received from other programs over the network, as 61 named channels (phone_parse.h).
 * plugins/devices/README.md is the user's guide. */
#include "device_io.h"
#include "phone_parse.h"
#include "trace.h"
#include "udp.h"

#include <marotte/plugin.h>

#include <arpa/inet.h>
#include <errno.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum { PARAM_LATERALS, PARAM_COUNT };
typedef enum heard_from { HEARD_ANYBODY = 0, HEARD_PHONE_ALONE } heard_from;
enum { PORT_LIVE_LINK = 11111, PORT_IFACIALMOCAP = 49983 };

static const int64_t ns_per_s = 1000000000;
/* iFacialMocap sends after a request. It may start after marotte, and it may sleep, so the request
 * is repeated. */
static const int64_t ask_again_ns = 1000000000;
static const char greeting[] =
    "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719|sendDataVersion=v2";
/* A datagram with an earlier time than the previous one was overtaken on the way. If it is earlier
 * by more than this, it is of a new session. */
static const double overtaken_s = 1.0;

struct mrt_plugin {
    const mrt_host *host;
    int socket; /* -1: closed */
    uint16_t port;
    udp_peer phone; /* phone to send requests to; by default a broadcast */
    heard_from heard;
    bool is_asking;
    int64_t ask_ns;
    trace trace;
    udp_owner owner;
    clock_map clock;
    double time_s; /* of the last datagram with a time */
    int64_t host_offset_ns;
    int64_t last_ns; /* of the last sample returned */
    uint32_t sequence, faulty_count;
    bool has_time, has_given, has_told_other, has_told_fault, has_told_failure;
    float value[PHONE_VALUES];
    mrt_channel channel[PHONE_VALUES];
    unsigned char datagram[PHONE_DATAGRAM];
};

/* ---- opening ---- */

static void input_close(mrt_plugin *self)
{
    if (self->socket < 0)
        return;
    if (self->faulty_count > 0)
        device_log(self->host, MRT_LOG_INFO, "port %u: %u datagrams did not contain a face",
                   (unsigned)self->port, self->faulty_count);
    udp_close(self->socket);
    trace_close(&self->trace);
    self->socket = -1;
}

/* Chooses the address to listen on. A named address of this computer is used directly. Any other
 * named address is a phone: listens on all addresses, and accepts only that phone. */
static int listen_for(mrt_plugin *self, const char *named, char reason[UDP_REASON])
{
    bool is_named = named[0] && strcmp(named, "0.0.0.0") != 0;
    self->heard = HEARD_ANYBODY;
    self->is_asking = is_named || self->port == PORT_IFACIALMOCAP;
    if (!udp_peer_resolve(&self->phone, is_named ? named : "255.255.255.255", self->port, reason))
        return -1;
    if (is_named && udp_is_own(&self->phone))
        return udp_bind(named, self->port, reason);
    self->heard = is_named ? HEARD_PHONE_ALONE : HEARD_ANYBODY;
    return udp_bind(is_named && strchr(named, ':') ? "::" : "0.0.0.0", self->port, reason);
}

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    char reason[UDP_REASON] = "", named[UDP_HOST] = "";
    (void)params;
    input_close(self);
    self->port = PORT_LIVE_LINK;
    if (address[0] && !udp_address_parse(named, &self->port, address, strlen(address))) {
        device_log(self->host, MRT_LOG_ERROR,
                   "\"%.60s\" is not a port: write phone:11111 for Live Link Face, phone:49983 or "
                   "phone:192.168.1.30:49983 (the phone's address) for iFacialMocap, phone:11573 "
                   "for OpenSeeFace",
                   address);
        return MRT_ERR_ARGUMENT;
    }
    self->socket = listen_for(self, named, reason);
    if (self->socket < 0) {
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    const int on = 1;
    (void)setsockopt(self->socket, SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
    trace_open(&self->trace, self->host, "phone");
    self->ask_ns = 0;
    udp_owner_release(&self->owner);
    clock_map_reset(&self->clock);
    self->has_time = self->has_told_other = self->has_told_fault = self->has_told_failure = false;
    self->faulty_count = 0;
    self->host_offset_ns = device_clock_host_offset_ns(self->host);
    self->last_ns = self->host->now_ns(self->host);
    return MRT_OK;
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->socket >= 0 ? PHONE_VALUES : 0;
    return self->channel;
}

/* ---- asking ---- */

static void ask(mrt_plugin *self)
{
    char text[UDP_PEER_TEXT];
    int error = udp_send_to(self->socket, &self->phone, greeting, sizeof greeting - 1);
    trace_sent(&self->trace, self->host->now_ns(self->host), greeting, sizeof greeting - 1);
    if (error == 0 || self->has_told_failure)
        return;
    self->has_told_failure = true;
    udp_peer_text(&self->phone, text, sizeof text);
    device_log(self->host, MRT_LOG_WARNING,
               "port %u: cannot send the request to the phone at %s (%s): write its address, as in "
               "phone:192.168.1.30:%u. Still listening",
               (unsigned)self->port, text, strerror(error), (unsigned)self->port);
}

/* Sends a request until a face arrives, and again when it is silent. */
static void ask_if_due(mrt_plugin *self, int64_t now_ns)
{
    if (!self->is_asking || now_ns < self->ask_ns)
        return;
    self->ask_ns = now_ns + ask_again_ns;
    ask(self);
}

/* ---- reading ---- */

static void tell_other(mrt_plugin *self, const udp_peer *peer, const char *why)
{
    char text[UDP_PEER_TEXT];
    if (self->has_told_other)
        return;
    self->has_told_other = true;
    udp_peer_text(peer, text, sizeof text);
    device_log(self->host, MRT_LOG_WARNING, "port %u: ignored a second face from %s: %s",
               (unsigned)self->port, text, why);
}

static bool admit(mrt_plugin *self, const udp_peer *peer, int64_t now_ns)
{
    if (udp_owner_admits_single(&self->owner, peer, now_ns))
        return true;
    tell_other(self, peer, "open a second input on another port for it");
    return false;
}

static void refuse(mrt_plugin *self, size_t size)
{
    self->faulty_count += 1;
    if (self->has_told_fault)
        return;
    self->has_told_fault = true;
    device_log(self->host, MRT_LOG_WARNING,
               "port %u: ignored a datagram of %zu bytes: expected Live Link Face, iFacialMocap or "
               "OpenSeeFace",
               (unsigned)self->port, size);
}

static bool is_overtaken(mrt_plugin *self, const phone_frame *frame)
{
    if (!frame->has_time)
        return false;
    const bool is_old = self->has_time && frame->time_s < self->time_s &&
                        frame->time_s > self->time_s - overtaken_s;
    if (!is_old)
        self->time_s = frame->time_s;
    self->has_time = true;
    return is_old;
}

static int64_t time_of(mrt_plugin *self, const phone_frame *frame, int64_t now_ns)
{
    if (frame->has_time)
        now_ns =
            clock_map_to_host(&self->clock, (int64_t)(frame->time_s * (double)ns_per_s), now_ns);
    return device_sample_ns(self->host, now_ns + self->host_offset_ns, &self->last_ns);
}

/* Returns false if the datagram moves nothing. Then the face is held. */
static bool take(mrt_plugin *self, size_t size, const udp_peer *peer, const double *params,
                 int64_t now_ns, mrt_sample *out)
{
    phone_frame frame;
    const phone_laterals laterals =
        params[PARAM_LATERALS] < 0.5 ? PHONE_LEFT_FIRST : PHONE_RIGHT_FIRST;
    if (size == sizeof greeting - 1 && memcmp(self->datagram, greeting, size) == 0)
        return false; /* our own, broadcast */
    if (self->heard == HEARD_PHONE_ALONE &&
        memcmp(peer->ip, self->phone.ip, sizeof peer->ip) != 0) {
        tell_other(self, peer, "the input is set to the address of another phone");
        return false;
    }
    if (phone_parse(&frame, self->datagram, size, laterals) == PHONE_NONE) {
        refuse(self, size);
        return false;
    }
    if (!admit(self, peer, now_ns))
        return false;
    self->ask_ns = now_ns + ask_again_ns;
    if (is_overtaken(self, &frame) || !frame.has_face)
        return false;
    for (int i = 0; i < PHONE_VALUES; ++i)
        if (frame.is_told[i])
            self->value[i] = frame.value[i];
    memset(out, 0, sizeof *out);
    out->time_ns = time_of(self, &frame, now_ns);
    out->sequence = self->sequence++;
    out->count = PHONE_VALUES;
    memcpy(out->value, self->value, sizeof self->value);
    return true;
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    if (self->socket < 0)
        return MRT_ERR_IO;
    const int64_t until_ns = device_deadline_ns(self->host, deadline_ns);
    for (;;) {
        udp_peer peer;
        int64_t now_ns = device_clock_ns();
        ask_if_due(self, now_ns);
        int64_t wake_ns = self->is_asking && self->ask_ns < until_ns ? self->ask_ns : until_ns;
        int64_t size =
            udp_receive(self->socket, self->datagram, sizeof self->datagram, &peer, wake_ns);
        now_ns = device_clock_ns();
        if (size == UDP_FAILED) {
            device_log(self->host, MRT_LOG_ERROR, "port %u: the network failed (%s)",
                       (unsigned)self->port, strerror(errno));
            return MRT_ERR_IO;
        }
        if (size > 0) {
            trace_received(&self->trace, now_ns, self->datagram, (size_t)size);
            if (take(self, (size_t)size, &peer, params, now_ns, out_sample))
                return MRT_OK;
        }
        if (now_ns >= until_ns)
            return MRT_TIMEOUT;
    }
}

/* ---- devices ---- */

/* Finds the first address of this computer in a network; "": none. */
static void find_own_address(char *out, size_t capacity)
{
    struct ifaddrs *all = NULL;
    out[0] = '\0';
    if (getifaddrs(&all) != 0)
        return;
    for (const struct ifaddrs *one = all; one && !out[0]; one = one->ifa_next) {
        struct sockaddr_in at;
        if (!one->ifa_addr || one->ifa_addr->sa_family != AF_INET ||
            (one->ifa_flags & IFF_LOOPBACK) || !(one->ifa_flags & IFF_UP))
            continue;
        memcpy(&at, one->ifa_addr, sizeof at);
        (void)inet_ntop(AF_INET, &at.sin_addr, out, (socklen_t)capacity);
    }
    freeifaddrs(all);
}

static void fill_device(uint16_t port, mrt_device *out)
{
    char own[INET_ADDRSTRLEN];
    find_own_address(own, sizeof own);
    *out = (mrt_device){.state = MRT_DEVICE_UNSURE};
    (void)snprintf(out->address, sizeof out->address, "%u", (unsigned)port);
    (void)snprintf(out->name, sizeof out->name, "Face from a phone or a webcam program");
    (void)snprintf(out->advice, sizeof out->advice,
                   "Live Link Face: set the target to %s port 11111; iFacialMocap: open "
                   "phone:49983; OpenSeeFace: open phone:11573",
                   own[0] ? own : "(this computer has no network)");
}

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    if (capacity > 0)
        fill_device(self->socket >= 0 ? self->port : PORT_LIVE_LINK, out);
    return 1;
}

static bool current_device(mrt_plugin *self, mrt_device *out)
{
    if (self->socket >= 0)
        fill_device(self->port, out);
    return self->socket >= 0;
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->socket = -1;
    for (int i = 0; i < PHONE_VALUES; ++i)
        self->channel[i] = (mrt_channel){
            phone_name[i], i < PHONE_SHAPES ? "" : "rad",   MRT_CH_OTHER,
            MRT_NO_HAND,   i < PHONE_SHAPES ? 0.0f : -1.5f, i < PHONE_SHAPES ? 1.0f : 1.5f};
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    input_close(self);
    free(self);
}

static const char *const laterals_label[] = {"left first", "right first", NULL};
static const mrt_param params[PARAM_COUNT] = {
    [PARAM_LATERALS] = {1, MRT_PARAM_STEPPED, "laterals", "Phone", "",
                        "Order of left and right for jaw and mouth in Live Link: change it if the "
                        "mouth moves to the wrong side",
                        PHONE_LEFT_FIRST, PHONE_RIGHT_FIRST, PHONE_LEFT_FIRST, laterals_label},
};

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_devices devices = {list_devices, current_device};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.phone",
    "Phone",
    MAROTTE_VERSION,
    "A face from a phone or a webcam program: Live Link Face, iFacialMocap, OpenSeeFace",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
