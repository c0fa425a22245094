/* ifacialmocap.c - the plugin "org.marotte.ifacialmocap": the face in the format of the app
 * iFacialMocap. Listens like the phone. A program that sends the app's greeting gets text at 60 Hz,
 * in the requested version:
 * "mouthSmile_L-25|...|=head#pitch,yaw,roll,x,y,z|rightEye#...|leftEye#...|" in per cent and
 * degrees, with '&' for '-' in version 2. */
#include "device_io.h"
#include "receivers.h"
#include "trace.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PORT = 49983, CHANNELS = 61, SHAPES = 52, TEXT_BYTES = 4096 };
/* Limits per call: datagrams, and datagrams from unknown senders. */
enum { DATAGRAMS_A_LOOK = 32, STRANGERS_A_LOOK = 4 };
enum { HEAD = 52, LEFT_EYE = 55, RIGHT_EYE = 58 };
enum { RATE, VERSION, PARAM_COUNT };
static const char greeting[] = "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719";
static const char wants_version_2[] = "sendDataVersion=v2";
static const double degrees_a_rad = 57.29577951308232;

struct mrt_plugin {
    const mrt_host *host;
    int socket; /* -1: closed */
    trace trace;
    const mrt_face_names *names;
    char name[SHAPES][40]; /* "mouthSmile_L" */
    receivers to;
    bool has_told_far, has_told_full;
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->socket = -1;
    self->trace.file = -1;
    return self;
}

static void close(mrt_plugin *self)
{
    if (self->socket < 0)
        return;
    trace_close(&self->trace);
    udp_close(self->socket);
    self->socket = -1;
    self->to.count = 0;
}

static void destroy(mrt_plugin *self)
{
    if (self)
        close(self);
    free(self);
}

static const char *any_of(const udp_peer *to)
{
    char text[UDP_PEER_TEXT];
    udp_peer_text(to, text, sizeof text);
    return text[0] == '[' ? "::" : "0.0.0.0";
}

/* "to:HOST:PORT": send there without a greeting; else the address to listen on. */
static mrt_result open(mrt_plugin *self, const char *address, const double *params,
                       mrt_face_wants *wants)
{
    char reason[UDP_REASON], host[UDP_HOST] = "127.0.0.1";
    uint16_t port = PORT;
    bool is_told = strncmp(address, "to:", 3) == 0;
    const char *rest = is_told ? address + 3 : address;
    close(self);
    if (rest[0] && !udp_address_parse(host, &port, rest, strlen(rest))) {
        device_log(self->host, MRT_LOG_ERROR,
                   "\"%.100s\" is not an address: write an address to listen on, as in 0.0.0.0:%d, "
                   "or to:HOST:%d to send without a request",
                   address, PORT, PORT);
        return MRT_ERR_ARGUMENT;
    }
    udp_peer named;
    if (is_told && !udp_peer_resolve(&named, host, port, reason)) {
        device_log(self->host, MRT_LOG_ERROR, "%.200s: write an address, as in to:192.168.1.20:%d",
                   reason, PORT);
        return MRT_ERR_IO;
    }
    self->socket = is_told ? udp_bind(any_of(&named), 0, reason) : udp_bind(host, port, reason);
    if (self->socket < 0) {
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    trace_open(&self->trace, self->host, "ifacialmocap");
    udp_keep_failures(self->socket);
    self->has_told_far = self->has_told_full = false;
    self->to = (receivers){.count = is_told ? 1 : 0};
    if (is_told)
        self->to.of[0] =
            (receiver){.at = named, .has_version_2 = params[VERSION] > 0.5, .is_named = true};
    wants->rate_hz = params[RATE];
    wants->repeat_s = 0.1; /* greetings are also checked then */
    return MRT_OK;
}

/* "MouthSmileLeft" is "mouthSmile_L" in the app. */
static void name_of(char out[40], const char *name)
{
    size_t length = strlen(name);
    bool is_left = length > 4 && strcmp(name + length - 4, "Left") == 0;
    bool is_right = length > 5 && strcmp(name + length - 5, "Right") == 0;
    /* for jaw and mouth: a direction, not a side */
    bool is_way = strcmp(name, "JawLeft") == 0 || strcmp(name, "JawRight") == 0 ||
                  strcmp(name, "MouthLeft") == 0 || strcmp(name, "MouthRight") == 0;
    size_t cut = is_way ? 0 : is_left ? 4 : is_right ? 5 : 0;
    (void)snprintf(out, 40, "%.*s%s", (int)(length - cut), name,
                   cut == 0  ? ""
                   : is_left ? "_L"
                             : "_R");
    if (out[0] >= 'A' && out[0] <= 'Z')
        out[0] = (char)(out[0] - 'A' + 'a');
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names)
{
    self->names = names;
    for (uint32_t i = 0; i < SHAPES && i < names->weight_count; ++i)
        name_of(self->name[i], names->weights[i]);
    return MRT_OK;
}

/* ---- requests ---- */

/* A greeting, including its sender, may be forged. So only this computer and computers in its own
 * networks get a requested face. */
static void welcome(mrt_plugin *self, const udp_peer *at, bool has_version_2)
{
    char text[UDP_PEER_TEXT];
    udp_peer_text(at, text, sizeof text);
    if (!receivers_find(&self->to, at) && !udp_peer_is_near(at)) {
        if (!self->has_told_far)
            device_log(self->host, MRT_LOG_WARNING,
                       "ignored the request of %s: it is not in a network of this computer. To "
                       "send there, add the output ifacialmocap:to:%s",
                       text, text);
        self->has_told_far = true;
        return;
    }
    switch (receivers_greeted(&self->to, at, has_version_2, device_clock_ns())) {
    case RECEIVER_IS_NEW:
        device_log(self->host, MRT_LOG_INFO, "%s requested the face", text);
        break;
    case RECEIVER_HAS_NO_PLACE:
        if (!self->has_told_full)
            device_log(self->host, MRT_LOG_WARNING,
                       "ignored the request of %s: the limit of %d receivers is reached", text,
                       RECEIVERS_MAX);
        self->has_told_full = true;
        break;
    case RECEIVER_IS_KNOWN:
        break;
    }
}

static void hear(mrt_plugin *self)
{
    char text[512];
    udp_peer from;
    for (int i = 0, strangers = 0; i < DATAGRAMS_A_LOOK && strangers < STRANGERS_A_LOOK; ++i) {
        int64_t size = udp_receive(self->socket, text, sizeof text - 1, &from, 0);
        if (size == UDP_NOTHING)
            return;
        if (size < 0)
            continue; /* error report of a sent face: see forget */
        trace_received(&self->trace, device_clock_ns(), text, (size_t)size);
        text[size] = '\0';
        if (self->to.of[0].is_named || strncmp(text, greeting, sizeof greeting - 1) != 0)
            continue;
        from.port = PORT; /* where receivers listen, whatever port they send from */
        strangers += !receivers_find(&self->to, &from);
        welcome(self, &from, strstr(text, wants_version_2) != NULL);
    }
}

/* Processes the system's error reports about sent faces. */
static void forget(mrt_plugin *self)
{
    char text[UDP_PEER_TEXT];
    udp_peer at;
    int error;
    for (int i = 0; i < DATAGRAMS_A_LOOK && (error = udp_failure(self->socket, &at)) != 0; ++i)
        receivers_failed(&self->to, &at, error, device_clock_ns());
    for (receiver_end end;
         (end = receivers_forget_one(&self->to, device_clock_ns(), &at)) != RECEIVER_STAYS;) {
        udp_peer_text(&at, text, sizeof text);
        device_log(self->host, MRT_LOG_INFO,
                   end == RECEIVER_REFUSED
                       ? "%s stopped listening: sending stops until its next request"
                       : "%s sent no request for 12 hours: sending stops until its next request",
                   text);
    }
}

/* ---- the text ---- */

typedef struct line {
    char text[TEXT_BYTES];
    size_t size;
} line;

__attribute__((format(printf, 2, 3))) static void add(line *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int size = vsnprintf(out->text + out->size, sizeof out->text - out->size, format, arguments);
    va_end(arguments);
    if (size > 0 && (size_t)size < sizeof out->text - out->size)
        out->size += (size_t)size;
}

/* Writes a sample's yaw, pitch, roll as pitch, yaw, roll. */
static void add_rotation(line *out, const char *name, const float *turn, const char *behind)
{
    add(out, "%s#%.4f,%.4f,%.4f%s|", name, (double)turn[1] * degrees_a_rad,
        (double)turn[0] * degrees_a_rad, (double)turn[2] * degrees_a_rad, behind);
}

static void write_text(line *out, const mrt_plugin *self, const mrt_face_sample *sample,
                       bool has_version_2)
{
    char between = has_version_2 ? '&' : '-';
    bool has_face = self->names->weight_count >= CHANNELS;
    out->size = 0;
    add(out, "trackingStatus%c%d|", between, has_face);
    for (uint32_t i = 0; has_face && i < SHAPES; ++i)
        add(out, "%s%c%d|", self->name[i], between, (int)lrintf(100.0f * sample->weights[i]));
    if (!has_face)
        return;
    add(out, "=");
    add_rotation(out, "head", sample->weights + HEAD, ",0,0,0");
    add_rotation(out, "rightEye", sample->weights + RIGHT_EYE, "");
    add_rotation(out, "leftEye", sample->weights + LEFT_EYE, "");
}

static mrt_result send(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    line out;
    (void)params;
    forget(self);
    hear(self);
    for (uint32_t i = 0; i < self->to.count; ++i) {
        const receiver *to = &self->to.of[i];
        write_text(&out, self, sample, to->has_version_2);
        trace_sent(&self->trace, device_clock_ns(), out.text, out.size);
        (void)udp_send_to(self->socket, &to->at, out.text, out.size);
    }
    return self->to.count > 0 ? MRT_OK : MRT_TIMEOUT;
}

static const char *const versions[] = {"1", "2", NULL};
static const mrt_param params[PARAM_COUNT] = {
    [RATE] = {1, 0, "Rate", "Network", "Hz",
              "Largest number of faces per second. Used when the output is opened again", 1, 240,
              60, NULL},
    [VERSION] = {2, MRT_PARAM_STEPPED, "Version", "Network", "",
                 "Version of the text sent without a request (to:HOST:PORT)", 0, 1, 1, versions},
};
static const mrt_face_output output = {open, begin, send, close};
static const mrt_interface interfaces[] = {{MRT_FACE_OUTPUT, &output}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.ifacialmocap",
    "iFacialMocap",
    MAROTTE_VERSION,
    "The face in the format of the app iFacialMocap, sent to each program that requests it",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
