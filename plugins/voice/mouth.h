/* voice/mouth.h - what the mouth of a speaker does, from the sound of the voice: how far it is
 * open, wide or round lips, closed lips, noise at the teeth. Causal: each sample depends only on
 * sound that has arrived. Leaves out devices, files and the level. Pure functions on one struct; no
 * allocation. */
#ifndef PLUGINS_VOICE_MOUTH_H
#define PLUGINS_VOICE_MOUTH_H
#include <stdbool.h>
#include <stdint.h>

enum {
    MOUTH_RATE = 16000,           /* Hz, at which the sound is analysed */
    MOUTH_HOP = MOUTH_RATE / 100, /* a sample each 10 ms */
    MOUTH_WINDOW = 400,           /* 25 ms */
    MOUTH_KERNEL = 512,           /* length of the resampling filter's table */
    MOUTH_TAPS = 160,             /* frames that the filter may need: enough up to 192 kHz */
    MOUTH_BANDS = 11,
    MOUTH_RECENT = 8, /* hops */
    MOUTH_FEATURES = MOUTH_BANDS + 4
};

typedef enum mouth_channel {                     /* each 0..1 */
                             MOUTH_OPENNESS = 0, /* 0: the jaw is up; 1: a wide "ah" */
                             MOUTH_WIDE,         /* lips drawn wide, as for "ee" */
                             MOUTH_ROUND,        /* lips rounded, as for "oo" */
                             MOUTH_CLOSURE,      /* lips closed, as for m, b, p */
                             MOUTH_HISS,         /* noise at the teeth, as for s, f, sh */
                             MOUTH_CHANNELS
} mouth_channel;

typedef struct mouth {
    double rate_hz; /* of the sound that arrives */
    float kernel[MOUTH_KERNEL + 2];
    float past[MOUTH_TAPS];   /* the newest frames, a ring */
    double reach;             /* half the length of the filter, in frames */
    int64_t frames, analysed; /* that arrived; samples at MOUTH_RATE since the beginning */
    float window[MOUTH_WINDOW], shape[MOUTH_WINDOW]; /* a ring of the newest samples; Hann */
    float cosine[257], sine[257];                    /* of 0..pi, for the transform */
    double floor_db, peak_db;                        /* noise and speech of the last seconds */
    double recent_db[MOUTH_RECENT];                  /* levels of the last hops */
    uint32_t hop;
    double quiet_s;                 /* since the last voiced sound */
    double feature[MOUTH_FEATURES]; /* of the newest hop, for fitting */
    double value[MOUTH_CHANNELS];
} mouth;

/* rate_hz: of the sound, 8 000 to 192 000. */
void mouth_init(mouth *self, double rate_hz);
/* Adds one frame of sound, full scale being 1. Returns true if value[] has changed. */
bool mouth_add(mouth *self, float frame);

#endif
