/* Linear time code as sound, written from the definition: 80 bits a frame, each a span between two
 * crossings, a one with another in its midst. */
#ifndef TESTS_DEVICE_LTC_SOUND_H
#define TESTS_DEVICE_LTC_SOUND_H
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef struct ltc_sound {
    double rate_hz, fps, speed; /* speed 1: as it is */
    uint32_t nominal;           /* frames in a second of the labels */
    bool is_drop;
    uint32_t hour, minute, second, frame;
    double into;   /* of the frame, 0..1 */
    double level;  /* as it stands, -1 or 1; slews as sound does */
    double sample; /* the last one given, before gain and offset */
    bool bit[80];
    int half; /* half cells of the frame that have begun */
} ltc_sound;

static inline void ltc_sound_put(bool bit[80], uint32_t first, uint32_t count, uint32_t value)
{
    for (uint32_t i = 0; i < count; ++i)
        bit[first + i] = value >> i & 1;
}

static inline void ltc_sound_fill(ltc_sound *self)
{
    memset(self->bit, 0, sizeof self->bit);
    ltc_sound_put(self->bit, 0, 4, self->frame % 10);
    ltc_sound_put(self->bit, 8, 2, self->frame / 10);
    self->bit[10] = self->is_drop;
    ltc_sound_put(self->bit, 16, 4, self->second % 10);
    ltc_sound_put(self->bit, 24, 3, self->second / 10);
    ltc_sound_put(self->bit, 32, 4, self->minute % 10);
    ltc_sound_put(self->bit, 40, 3, self->minute / 10);
    ltc_sound_put(self->bit, 48, 4, self->hour % 10);
    ltc_sound_put(self->bit, 56, 2, self->hour / 10);
    ltc_sound_put(self->bit, 4, 4, 0xa); /* user bits are anybody's */
    static const bool sync[16] = {0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1};
    memcpy(self->bit + 64, sync, sizeof sync);
}

static inline void ltc_sound_count(ltc_sound *self)
{
    self->frame += 1;
    if (self->frame == self->nominal) {
        self->frame = 0;
        self->second += 1;
    }
    if (self->second == 60) {
        self->second = 0;
        self->minute += 1;
        if (self->is_drop && self->minute % 10 != 0)
            self->frame = 2;
    }
    if (self->minute == 60) {
        self->minute = 0;
        self->hour = (self->hour + 1) % 24;
    }
}

static inline ltc_sound ltc_sound_make(double rate_hz, double fps, bool is_drop, uint32_t hour,
                                       uint32_t minute, uint32_t second, uint32_t frame)
{
    ltc_sound out = {.rate_hz = rate_hz,
                     .fps = fps,
                     .speed = 1.0,
                     .nominal = (uint32_t)ceil(fps),
                     .is_drop = is_drop,
                     .hour = hour,
                     .minute = minute,
                     .second = second,
                     .frame = frame,
                     .level = 1.0,
                     .half = -1};
    ltc_sound_fill(&out);
    return out;
}

/* -1..1, as it rises and falls within some 40 us. */
static inline double ltc_sound_next(ltc_sound *self)
{
    const int half = (int)(self->into * 160.0);
    if (half != self->half) {
        self->half = half;
        if (half % 2 == 0 || self->bit[half / 2])
            self->level = -self->level;
    }
    self->into += self->speed * self->fps / self->rate_hz;
    if (self->into >= 1.0) {
        self->into -= 1.0;
        self->half = -1;
        ltc_sound_count(self);
        ltc_sound_fill(self);
    }
    self->sample += (self->level - self->sample) * fmin(1.0, 25000.0 / self->rate_hz);
    return self->sample;
}

#endif
