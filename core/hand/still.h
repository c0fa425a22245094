/* hand/still.h - detects whether a hand holds still, from the standard deviation of its last
 * values. Any unit: counts for the guide, rad for a re-zero. A function of the samples alone; no
 * allocation. [frame] */
#ifndef MAROTTE_HAND_STILL_H
#define MAROTTE_HAND_STILL_H
#include <marotte/plugin.h>

enum { STILL_SAMPLES = 128 };

typedef struct still_window {
    int64_t span_ns;
    uint32_t channels;     /* bit i: channel i counts */
    uint32_t first, count; /* of the ring */
    int64_t time_ns[STILL_SAMPLES];
    float value[STILL_SAMPLES][MRT_ANGLES];
} still_window;

void still_init(still_window *window, int64_t span_ns, uint32_t channels);
/* Adds a sample. Ignores a sample that is not later than the last. Restarts after a step backwards
 * or a gap of more than 0.25 s. If samples arrive faster than the ring can store, skips some of
 * them evenly. */
void still_add(still_window *window, const float *value, int64_t time_ns);

typedef struct still_state {
    bool is_full;      /* the samples cover the span */
    double worst;      /* greatest standard deviation of a channel */
    int worst_channel; /* -1: none */
} still_state;
still_state still_measure(const still_window *window);
/* Returns how long the hand has held still up to the newest sample, as a share 0..1 of the span: no
 * channel has a greater standard deviation than `most` since then. */
double still_share(const still_window *window, double most);

/* Compute MRT_ANGLES values each; 0 for channels that do not count, and if there are no samples. */
void still_mean(const still_window *window, float *out);
void still_median(const still_window *window, float *out);

#endif
