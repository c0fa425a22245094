#include "show/sound_pcm.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double s16_scale = 32768.0, s24_scale = 8388608.0;

static const struct {
    const char *name;
    uint32_t bytes;
} formats[] = {[SOUND_PCM_NONE] = {"", 0},
               [SOUND_PCM_S16] = {"s16", 2},
               [SOUND_PCM_S24] = {"s24", 3},
               [SOUND_PCM_F32] = {"f32", 4}};

sound_pcm sound_pcm_of(const char *name)
{
    for (int f = SOUND_PCM_S16; f <= SOUND_PCM_F32; ++f)
        if (strcmp(name, formats[f].name) == 0)
            return (sound_pcm)f;
    return SOUND_PCM_NONE;
}

const char *sound_pcm_name(sound_pcm format)
{
    return formats[format].name;
}

uint32_t sound_pcm_bytes(sound_pcm format)
{
    return formats[format].bytes;
}

static bool is_integer_of(double sample, double scale)
{
    double scaled = sample * scale;
    return scaled >= -scale && scaled <= scale - 1.0 && scaled == floor(scaled);
}

static bool is_float(double sample)
{
    return sample >= -(double)FLT_MAX && sample <= (double)FLT_MAX &&
           (double)(float)sample == sample;
}

static bool keeps(sound_pcm format, double sample)
{
    switch (format) {
    case SOUND_PCM_S16:
        return is_integer_of(sample, s16_scale);
    case SOUND_PCM_S24:
        return is_integer_of(sample, s24_scale);
    case SOUND_PCM_F32:
        return is_float(sample);
    case SOUND_PCM_NONE:
    default:
        return false;
    }
}

/* A wider format keeps all samples that a narrower one keeps, so one pass is enough. */
sound_pcm sound_pcm_narrowest(const double *samples, size_t count, sound_pcm at_least,
                              size_t *out_at)
{
    sound_pcm format = at_least == SOUND_PCM_NONE ? SOUND_PCM_S16 : at_least;
    for (size_t i = 0; i < count; ++i) {
        while (!keeps(format, samples[i])) {
            if (format == SOUND_PCM_F32) {
                *out_at = i;
                return SOUND_PCM_NONE;
            }
            format = (sound_pcm)(format + 1);
        }
    }
    return format;
}

static float float_of(const unsigned char *at)
{
    float value;
    memcpy(&value, at, sizeof value);
    return isfinite(value) ? value : 0.0f;
}

void sound_pcm_unpack(float *out, const void *bytes, size_t count, sound_pcm format)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < count && format == SOUND_PCM_S16; ++i, at += 2)
        out[i] = (float)(int16_t)(uint16_t)(at[0] | at[1] << 8) / 32768.0f;
    for (size_t i = 0; i < count && format == SOUND_PCM_S24; ++i, at += 3) {
        int32_t value = (int32_t)(at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16);
        out[i] = (float)(value - (value >= 0x800000 ? 0x1000000 : 0)) / 8388608.0f;
    }
    for (size_t i = 0; i < count && format == SOUND_PCM_F32; ++i, at += 4)
        out[i] = float_of(at);
}

static int32_t integer_of(float sample, double scale, size_t *cut_count)
{
    double scaled = floor((double)sample * scale + 0.5);
    if (!(scaled >= -scale)) {
        *cut_count += 1;
        scaled = -scale;
    } else if (scaled > scale - 1.0) {
        *cut_count += 1;
        scaled = scale - 1.0;
    }
    return (int32_t)scaled;
}

size_t sound_pcm_pack(void *out, const float *samples, size_t count, sound_pcm format)
{
    unsigned char *at = out;
    size_t cut_count = 0;
    if (format == SOUND_PCM_F32)
        memcpy(out, samples, count * sizeof *samples);
    if (format != SOUND_PCM_S16 && format != SOUND_PCM_S24)
        return 0;
    double scale = format == SOUND_PCM_S16 ? s16_scale : s24_scale;
    for (size_t i = 0; i < count; ++i) {
        uint32_t value = (uint32_t)integer_of(samples[i], scale, &cut_count);
        for (uint32_t byte = 0; byte < formats[format].bytes; ++byte)
            *at++ = (unsigned char)(value >> (8 * byte));
    }
    return cut_count;
}
