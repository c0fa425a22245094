/* org.marotte.ltc: linear time code from a sound input, as a clock for takes. */
#include "listener.h"
#include "ltc_decode.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = MICROPHONE_RATE / 200 };

struct mrt_plugin {
    listener from; /* first: listener.h */
    ltc_decoder decoder;
    int16_t block[BLOCK];
    uint32_t block_size, block_at;
    uint32_t sequence;
};

/* ---- input ---- */

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    (void)params;
    ltc_decoder_init(&self->decoder, MICROPHONE_RATE);
    self->block_size = self->block_at = 0;
    return listener_open(&self->from, address, "Time code on");
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

/* Extrapolated to the end of the received sound; otherwise the slower of two inputs would be
 * late. */
static void give(mrt_plugin *self, const ltc_frame *frame, mrt_sample *out)
{
    const double heard = (double)(self->decoder.sample + self->block_size - self->block_at);
    memset(out, 0, sizeof *out);
    out->time_ns = self->from.time_ns;
    out->sequence = self->sequence++;
    out->count = 2;
    out->value[0] = (float)(frame->frame + (heard - frame->start_sample) / frame->length);
    out->value[1] = (float)(frame->is_drop ? -frame->rate : frame->rate);
}

/* Returns true if a frame of time code ended. */
static bool decode(mrt_plugin *self, mrt_sample *out)
{
    ltc_frame frame;
    while (self->block_at < self->block_size)
        if (ltc_decoder_add_sample(&self->decoder, self->block[self->block_at++] / 32768.0,
                                   &frame)) {
            give(self, &frame, out);
            return true;
        }
    return false;
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out)
{
    mrt_result result = MRT_OK;
    (void)params;
    while (result == MRT_OK && !decode(self, out)) {
        self->block_at = 0;
        result = listener_read(&self->from, deadline_ns, self->block, BLOCK, &self->block_size);
    }
    return result;
}

/* ---- devices ---- */

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    (void)self;
    return listener_list("Time code on ", out, capacity);
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->from.host = host;
    return self;
}

static const mrt_input input = {input_open, input_channels, input_read, listener_close, 0};
static const mrt_devices devices = {list_devices, listener_current};
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
    "Linear time code (LTC, SMPTE 12M) as the clock of takes, from a sound input (ltc, ltc:hw:1) "
    "or a pipe with sound (ltc:./pipe)",
    create,
    listener_destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
