/* What the tests of sound share: numbers from a seed, and a loudspeaker or microphone whose clock
 * is virtual, runs fast or slow, and tells the times of its blocks as wrongly as it is told to. */
#ifndef MAROTTE_TESTS_SOUND_HELP_H
#define MAROTTE_TESTS_SOUND_HELP_H
#include "stage/sound/sound_device.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline uint64_t fake_random(uint64_t n) /* SplitMix64 of a number */
{
    n += 0x9e3779b97f4a7c15u;
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
    return n ^ (n >> 31);
}

typedef struct fake_clock { /* frame n at start_ns + n / rate / (1 + ppm * 1e-6) */
    int64_t start_ns;
    double rate_hz, ppm;
    int64_t jitter_ns; /* blocks say times up to this much too early or too late */
} fake_clock;

static inline double fake_time_ns(const fake_clock *clock, int64_t frame)
{
    return (double)frame * 1e9 / (clock->rate_hz * (1.0 + clock->ppm * 1e-6));
}

/* What the device says of a block that begins with this frame. */
static inline int64_t fake_told_ns(const fake_clock *clock, int64_t frame)
{
    int64_t wrong = 0;
    if (clock->jitter_ns > 0)
        wrong = (int64_t)(fake_random((uint64_t)frame) % (uint64_t)(2 * clock->jitter_ns)) -
                clock->jitter_ns;
    return clock->start_ns + (int64_t)llround(fake_time_ns(clock, frame)) + wrong;
}

enum { FAKE_BLOCK = 512, FAKE_CHANNELS = 8, FAKE_RATE = 48000 /* its own */ };

/* A backend with at most one device in each direction. */
typedef struct fake_device {
    bool is_there;
    _Atomic bool is_dead; /* it was unplugged while it was open */
    const char *refusal;  /* it cannot be opened, and says why */
    uint32_t rate_hz, channel_count;
    fake_clock clock;
    _Atomic bool is_open, is_running; /* what was written before is seen by who finds it running */
    bool is_broken;                   /* with the next block */
    uint32_t open_count;
    sound_callback *callback;
    void *data;
    int64_t frame;
    float block[FAKE_BLOCK * FAKE_CHANNELS]; /* the last one */
} fake_device;
typedef struct fake_host {
    fake_device device[2]; /* by direction */
} fake_host;

static inline mrt_result fake_open(void *self, sound_direction direction,
                                   const sound_request *request, sound_callback *callback,
                                   void *data, sound_stream *out, error *err)
{
    fake_device *device = &((fake_host *)self)->device[direction];
    if (!device->is_there || device->refusal)
        return error_set(err, MRT_ERR_IO, "sound: %s",
                         device->refusal ? device->refusal : "nothing was found");
    device->is_open = true;
    device->is_dead = false;
    device->open_count += 1;
    device->callback = callback;
    device->data = data;
    *out = (sound_stream){.handle = device,
                          .rate_hz = device->rate_hz    ? device->rate_hz
                                     : request->rate_hz ? request->rate_hz
                                                        : FAKE_RATE,
                          .channel_count = request->channel_count < device->channel_count
                                               ? request->channel_count
                                               : device->channel_count,
                          .latency_ns = 20000000};
    if (device->clock.rate_hz != out->rate_hz) /* else whoever plays it may look at it already */
        device->clock.rate_hz = out->rate_hz;
    snprintf(out->name, sizeof out->name, "fake");
    return MRT_OK;
}

static inline mrt_result fake_start(void *self, void *handle, error *err)
{
    (void)self;
    (void)err;
    ((fake_device *)handle)->is_running = true;
    return MRT_OK;
}

static inline bool fake_is_alive(void *self, void *handle)
{
    (void)self;
    return !((fake_device *)handle)->is_dead;
}

static inline void fake_close(void *self, void *handle)
{
    (void)self;
    ((fake_device *)handle)->is_open = ((fake_device *)handle)->is_running = false;
}

static inline sound_backend fake_backend(fake_host *host)
{
    return (sound_backend){.self = host,
                           .open = fake_open,
                           .start = fake_start,
                           .is_alive = fake_is_alive,
                           .close = fake_close};
}

/* One block, if it runs; a microphone's is in device->block. */
static inline void fake_run(fake_device *device, sound_direction direction)
{
    sound_block block = {.frame_count = FAKE_BLOCK,
                         .time_ns = fake_told_ns(&device->clock, device->frame),
                         .is_broken = device->is_broken};
    if (direction == SOUND_OUT)
        block.out = device->block;
    else
        block.in = device->block;
    if (device->is_running && !device->is_dead) {
        device->callback(device->data, &block);
        device->is_broken = false;
    }
    device->frame += FAKE_BLOCK;
}

#endif
