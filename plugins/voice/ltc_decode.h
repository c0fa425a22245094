/* voice/ltc_decode.h - decoder of linear time code (SMPTE 12M-1): converts sound with 80 bits per
 * frame, biphase mark, to frame numbers, at any level, polarity and offset, and from half to double
 * speed. A signal played backwards gives nothing. Pure functions on one struct; no allocation. */
#ifndef PLUGINS_VOICE_LTC_DECODE_H
#define PLUGINS_VOICE_LTC_DECODE_H
#include <stdbool.h>
#include <stdint.h>

typedef struct ltc_frame {
    int32_t frame; /* since 00:00:00:00, without the labels that drop-frame skips */
    double rate;   /* frames per second, rounded to a standard rate: 24000/1001, 24, 25 .. 30 */
    bool is_drop;
    double start_sample; /* start of the frame; may be between two samples */
    double length;       /* mean length of a frame, in samples */
} ltc_frame;

typedef struct ltc_decoder {
    double sample_rate_hz;
    int64_t sample;   /* number of samples processed */
    double high, low; /* envelope of the sound */
    double last;      /* the previous sample */
    bool is_high;
    double crossing;  /* the last one, in samples */
    double cell;      /* samples per bit; 0: unknown */
    bool has_half;    /* the first half of a 1 bit was received */
    uint8_t bits[10]; /* the last 80: bit 0 is the oldest */
    uint32_t count;   /* number of valid bits since the sound began, at most 80 */
    double frame_end; /* end of the previous frame; < 0: none */
    int32_t label;    /* of it */
    double length;    /* mean length of the last length_count frames, in samples */
    uint32_t length_count;
} ltc_decoder;

void ltc_decoder_init(ltc_decoder *self, double sample_rate_hz);
/* Processes a sample. Returns true if a frame ended and the frame rate is known. */
bool ltc_decoder_add_sample(ltc_decoder *self, double sample, ltc_frame *out);

#endif
