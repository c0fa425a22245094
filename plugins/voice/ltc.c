/* org.marotte.ltc: linear time code from a sound input: a clock that takes are laid on. */
#include "clock_map.h"
#include "device_io.h"
#include "ltc_decode.h"
#include "microphone.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = MICROPHONE_RATE / 200 };

struct mrt_plugin {
    const mrt_host *host;
    microphone *from;
    mrt_device device; /* what was opened */
    ltc_decoder decoder;
    clock_map clock; /* from frames of sound to the host's clock */
    int16_t block[BLOCK];
    uint32_t block_size, block_at;
    int64_t block_ns; /* host clock: of the sound behind the block */
    uint32_t sequence;
    bool has_told_loss;
};

/* ---- input ---- */

static void input_close(mrt_plugin *self)
{
    microphone_close(self->from);
    self->from = NULL;
}

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    char reason[MICROPHONE_REASON];
    (void)params;
    input_close(self);
    self->from = microphone_open(address ? address : "", reason);
    if (!self->from) {
        if (!self->has_told_loss)
            device_say(self->host, MRT_LOG_ERROR, "%s", reason[0] ? reason : "no memory");
        return MRT_ERR_IO;
    }
    self->device = (mrt_device){.state = MRT_DEVICE_READY};
    (void)snprintf(self->device.address, sizeof self->device.address, "%s",
                   address && address[0] ? address : "default");
    (void)snprintf(self->device.name, sizeof self->device.name, "Time code on %.48s",
                   self->device.address);
    ltc_decoder_init(&self->decoder, MICROPHONE_RATE);
    clock_map_reset(&self->clock);
    self->block_size = self->block_at = 0;
    self->has_told_loss = false;
    return MRT_OK;
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    static const mrt_channel channels[] = {
        {"timecode", "frames", MRT_CH_TIMECODE, MRT_NO_HAND, 0.0f, 2592000.0f},
        {"timecode.rate", "1/s", MRT_CH_TIMECODE + 1, MRT_NO_HAND, -30.0f, 30.0f}};
    (void)self;
    *out_count = 2;
    return channels;
}

static mrt_result lose(mrt_plugin *self)
{
    device_say(self->host, MRT_LOG_ERROR, "%.100s went away: plug it in again", self->device.name);
    self->has_told_loss = true;
    input_close(self);
    return MRT_ERR_IO;
}

/* As of the end of what was heard: of two inputs the one that lies behind would be late. */
static void give(mrt_plugin *self, const ltc_frame *frame, mrt_sample *out)
{
    const double heard = (double)(self->decoder.sample + self->block_size - self->block_at);
    memset(out, 0, sizeof *out);
    out->time_ns = self->block_ns;
    out->sequence = self->sequence++;
    out->count = 2;
    out->value[0] = (float)(frame->frame + (heard - frame->start_sample) / frame->length);
    out->value[1] = (float)(frame->is_drop ? -frame->rate : frame->rate);
}

/* True: a frame of it has ended. */
static bool decode(mrt_plugin *self, mrt_sample *out)
{
    ltc_frame frame;
    while (self->block_at < self->block_size)
        if (ltc_take(&self->decoder, self->block[self->block_at++] / 32768.0, &frame)) {
            give(self, &frame, out);
            return true;
        }
    return false;
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out)
{
    (void)params;
    while (self->from) {
        if (decode(self, out))
            return MRT_OK;
        const int count = microphone_read(self->from, self->block, BLOCK);
        const int64_t now_ns = self->host->now_ns(self->host);
        if (count < 0)
            return lose(self);
        self->block_at = 0;
        self->block_size = (uint32_t)count;
        const int64_t heard = self->decoder.sample + count;
        if (count > 0)
            self->block_ns =
                clock_map_to_host(&self->clock, heard * 1000000000 / MICROPHONE_RATE, now_ns);
        if (count > 0)
            continue;
        if (now_ns >= deadline_ns)
            return MRT_TIMEOUT;
        if (!microphone_wait(self->from, deadline_ns - now_ns))
            return lose(self);
    }
    return MRT_ERR_IO;
}

/* ---- devices ---- */

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    (void)self;
    const uint32_t count = microphone_list(out, capacity);
    for (uint32_t i = 0; i < count && i < capacity; ++i) {
        char name[sizeof out[i].name];
        (void)snprintf(name, sizeof name, "%s", out[i].name);
        (void)snprintf(out[i].name, sizeof out[i].name, "Time code on %.48s", name);
    }
    return count;
}

static bool current_device(mrt_plugin *self, mrt_device *out)
{
    *out = self->device;
    return self->from != NULL;
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (self)
        input_close(self);
    free(self);
}

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_devices devices = {list_devices, current_device};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    0,
    NULL,
    interfaces,
    "org.marotte.ltc",
    "LTC",
    MAROTTE_VERSION,
    "Linear time code (LTC, SMPTE 12M) from a sound input: the clock of takes (ltc, ltc:hw:1), or "
    "from a pipe with sound in it (ltc:./pipe)",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
