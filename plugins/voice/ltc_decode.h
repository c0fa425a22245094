/* voice/ltc_decode.h - linear time code (SMPTE 12M-1): sound of 80 bits a frame, biphase mark, into
 * the frames that it counts, at whatever level, polarity, offset and speed from half to double.
 * Played backwards it is silent. Pure functions on one struct; no allocation. */
#ifndef PLUGINS_VOICE_LTC_DECODE_H
#define PLUGINS_VOICE_LTC_DECODE_H
#include <stdbool.h>
#include <stdint.h>

typedef struct ltc_frame {
    int32_t frame; /* since 00:00:00:00; labels that drop-frame leaves out are not counted */
    double rate;   /* frames a second, as one of the trade: 24000/1001, 24, 25 .. 30 */
    bool is_drop;
    double start_sample; /* at which it began; may lie between two samples */
    double length;       /* mean samples of a frame */
} ltc_frame;

typedef struct ltc_decoder {
    double sample_rate_hz;
    int64_t sample;   /* so many were taken */
    double high, low; /* envelope of the sound */
    double last;      /* the sample before */
    bool is_high;
    double crossing;  /* the last one, in samples */
    double cell;      /* samples of a bit; 0: not known */
    bool has_half;    /* half a one was seen */
    uint8_t bits[10]; /* the last 80: bit 0 is the oldest */
    uint32_t count;   /* of them, since the sound began; at most 80 */
    double frame_end; /* where the frame before ended; < 0: there is none */
    int32_t label;    /* of it */
    double length;    /* mean samples of a frame, of so many in a row */
    uint32_t length_count;
} ltc_decoder;

void ltc_decoder_init(ltc_decoder *self, double sample_rate_hz);
/* True: with this sample a frame has ended, and how fast they come is known. */
bool ltc_take(ltc_decoder *self, double sample, ltc_frame *out);

#endif
