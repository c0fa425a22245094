/* hand/still.h - whether a hand holds still: the last moments of its values, and their standard
 * deviation. Any unit: counts for the guide, rad for a re-zero. A function of the samples alone;
 * no allocation. [frame] */
#ifndef MAROTTE_HAND_STILL_H
#define MAROTTE_HAND_STILL_H
#include <marotte/plugin.h>

enum { STILL_SAMPLES = 128 };

typedef struct still_window {
    int64_t span_ns;
    uint32_t channels;     /* bit i: channel i counts */
    uint32_t first, count; /* of the ring below */
    int64_t time_ns[STILL_SAMPLES];
    float value[STILL_SAMPLES][MRT_ANGLES];
} still_window;

void still_init(still_window *window, int64_t span_ns, uint32_t channels);
/* Time must go on: a sample that is not later than the last is ignored, and a step backwards or a
 * gap of more than 0.25 s starts anew. When samples come faster than the ring holds, some are left
 * out, evenly. */
void still_add(still_window *window, const float *value, int64_t time_ns);

typedef struct still_state {
    bool is_full;      /* the samples reach over the span */
    double worst;      /* greatest standard deviation of a channel */
    int worst_channel; /* -1: none counts */
} still_state;
still_state still_measure(const still_window *window);

/* MRT_ANGLES values each; 0 for channels that do not count, and when there is no sample. */
void still_mean(const still_window *window, float *out);
void still_median(const still_window *window, float *out);

#endif
