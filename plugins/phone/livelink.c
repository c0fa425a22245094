/* livelink.c - the plugin "org.marotte.livelink": the datagram of the app Live Link Face, for
 * Unreal's source "Apple ARKit" and other receivers. Big-endian: u8 6, id, subject (each: u32
 * length, text), u32 frame, f32 part of a frame, u32 rate, u32 per, u8 61, 61 floats: ARKit's 52,
 * then yaw, pitch and roll of head, left and right eye. */
#include "device_io.h"
#include "udp.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { PORT = 11111, CHANNELS = 61, ID_BYTES = 36, PACKET_BYTES = 512 };
enum { RATE, SWAP, SUBJECT, PARAM_COUNT, SUBJECTS = 16 };
enum { JAW_LEFT = 15, MOUTH_LEFT = 21 }; /* left shapes, each followed by its right one */
static const uint32_t frames_a_second = 60;
static const int64_t ns_per_s = 1000000000, day_s = 86400;

struct mrt_plugin {
    udp_sender to;
    const mrt_face_names *names;
    int claim;   /* a socket that only reserves its name; -1: none */
    int claimed; /* number of the subject; 0: none */
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    udp_sender_init(&self->to, host);
    self->claim = -1;
    return self;
}

static void give_back(mrt_plugin *self)
{
    if (self->claim >= 0)
        (void)close(self->claim);
    self->claim = -1;
    self->claimed = 0;
}

static void close_output(mrt_plugin *self)
{
    give_back(self);
    udp_sender_close(&self->to);
}

static void destroy(mrt_plugin *self)
{
    if (self)
        close_output(self);
    free(self);
}

static mrt_result open_output(mrt_plugin *self, const char *address, const double *params,
                              mrt_face_wants *wants)
{
    wants->rate_hz = params[RATE];
    wants->repeat_s = 0.1; /* the app never pauses: receivers treat silence as a loss */
    return udp_sender_open(&self->to, address, PORT, "livelink");
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names)
{
    self->names = names;
    return MRT_OK;
}

/* ---- one program per subject and receiver ---- */

/* Two senders with one device id look to a receiver like one face that jumps, and it cannot report
 * that. So each sender reserves a name: an abstract socket, which the system frees when the program
 * ends. */
static mrt_result claim(mrt_plugin *self, int number)
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    if (self->claimed == number)
        return MRT_OK;
    give_back(self);
    int length =
        snprintf(name.sun_path + 1, sizeof name.sun_path - 1, "marotte livelink %d %u %.64s",
                 number, (unsigned)self->to.port, self->to.host_name);
    socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length);
    self->claim = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (self->claim >= 0 && bind(self->claim, (struct sockaddr *)&name, size) != 0 &&
        errno == EADDRINUSE) {
        give_back(self);
        device_log(self->to.host, MRT_LOG_ERROR,
                   "another program sends there as the same device: close it, or set subject=%d",
                   number < SUBJECTS ? number + 1 : 1);
        return MRT_ERR_IO;
    }
    self->claimed = number;
    return MRT_OK;
}

/* ---- the datagram ---- */

typedef struct packet {
    unsigned char bytes[PACKET_BYTES];
    size_t size;
} packet;

static void put_u8(packet *out, uint32_t value)
{
    out->bytes[out->size++] = (unsigned char)value;
}

static void put_u32(packet *out, uint32_t value)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        put_u8(out, value >> shift & 0xffu);
}

static void put_f32(packet *out, float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    put_u32(out, word);
}

static void put_text(packet *out, const char *text)
{
    size_t length = strlen(text);
    put_u32(out, (uint32_t)length);
    memcpy(out->bytes + out->size, text, length);
    out->size += length;
}

/* Frames since midnight on the host's clock, or since the start of the take. */
static void put_time(packet *out, const mrt_face_sample *sample)
{
    int64_t at_ns = sample->take_ns >= 0 ? sample->take_ns : sample->time_ns;
    int64_t in_day_ns = at_ns % (day_s * ns_per_s);
    double frames = (double)in_day_ns * 1e-9 * frames_a_second;
    put_u32(out, (uint32_t)frames);
    put_f32(out, (float)(frames - floor(frames)));
    put_u32(out, frames_a_second);
    put_u32(out, 1);
}

static bool is_lateral(uint32_t i)
{
    return i == JAW_LEFT || i == JAW_LEFT + 1 || i == MOUTH_LEFT || i == MOUTH_LEFT + 1;
}

static mrt_result send_face(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    char id[ID_BYTES + 1], subject[32];
    packet out = {.size = 0};
    int number = (int)params[SUBJECT];
    bool has_face = self->names->weight_count >= CHANNELS;
    if (claim(self, number) < 0)
        return MRT_ERR_IO;
    (void)snprintf(id, sizeof id, "6D61726F-7474-4500-8000-%012X", (unsigned)number);
    (void)snprintf(subject, sizeof subject, number > 1 ? "marotte%d" : "marotte", number);
    put_u8(&out, 6);
    put_text(&out, id);
    put_text(&out, subject);
    put_time(&out, sample);
    if (has_face)
        put_u8(&out, CHANNELS);
    for (uint32_t i = 0; has_face && i < CHANNELS; ++i) {
        /* each pair begins at an odd index */
        uint32_t from = params[SWAP] > 0.5 && is_lateral(i) ? (i % 2 == 1 ? i + 1 : i - 1) : i;
        put_f32(&out, sample->weights[from]);
    }
    return udp_sender_send(&self->to, out.bytes, out.size);
}

static const char *const off_on[] = {"off", "on", NULL};
static const mrt_param params[PARAM_COUNT] = {
    [RATE] = {1, 0, "Rate", "Network", "Hz",
              "Largest number of faces per second. Used when the output is opened again", 1, 240,
              60, NULL},
    [SWAP] = {2, MRT_PARAM_STEPPED, "Swap laterals", "Network", "",
              "Send JawRight and MouthRight before the left ones, for receivers whose jaw and "
              "mouth move to the wrong side",
              0, 1, 0, off_on},
    [SUBJECT] = {3, MRT_PARAM_STEPPED, "Subject", "Network", "",
                 "Number of the subject, named marotte, marotte2 ...; each has its own device id",
                 1, SUBJECTS, 1, NULL},
};
static const mrt_face_output output = {open_output, begin, send_face, close_output};
static const mrt_interface interfaces[] = {{MRT_FACE_OUTPUT, &output}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.livelink",
    "Live Link Face",
    MAROTTE_VERSION,
    "The face in the format of the app Live Link Face, for Unreal's Apple ARKit source and others",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
