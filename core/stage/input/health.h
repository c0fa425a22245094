/* stage/input/health.h - measures the quality of an input: rate, jitter, lateness, losses,
 * saturated channels, silence, clock drift. The thread that reads the input feeds a meter with each
 * sample and its arrival time. It posts the reports on a board that any thread may read. Pure
 * except for the board; no allocation, no clock. All times: the host's monotonic clock. */
#ifndef MAROTTE_STAGE_HEALTH_H
#define MAROTTE_STAGE_HEALTH_H
#include <marotte/plugin.h>

#include <stdatomic.h>

enum { HEALTH_SLICES = 8, HEALTH_WINDOWS = 16, HEALTH_WORDS_LENGTH = 168 };

typedef struct health_report {
    int32_t state; /* the caller's value: an input_state */
    int64_t state_since_ns;
    double state_s;                  /* duration of the state */
    char words[HEALTH_WORDS_LENGTH]; /* explanation of the state; "": none */
    uint32_t loss_count;             /* number of times the device was lost */
    uint64_t sample_count;           /* since the start, like all counts here */
    uint64_t gap_count;              /* samples missing in the sequence */
    uint64_t refused_count;          /* invalid samples */
    uint64_t dropped_count;          /* lost because the reader was too slow */
    int64_t last_arrival_ns;         /* 0: none yet */
    double silence_s;                /* time since the last arrival, or since the start */
    /* Measured over the last 2 s: */
    double rate_hz;           /* from the time stamps of the samples */
    double jitter_ms;         /* standard deviation of the interval between samples in sequence */
    double lateness_ms;       /* mean of arrival - sample time */
    double lateness_worst_ms; /* maximum of arrival - sample time */
    uint32_t channel_count;
    float saturated[MRT_MAX_CHANNELS]; /* share of samples at an end of the channel's range, 0..1;
                                          0 for pedals and channels without a range */
    /* Measured over the last 32 s: how much faster the clock of the time stamps runs than the
     * host's clock. It is the negative slope of the minimum lateness. Drift that the plugin
     * corrects is not visible. */
    double drift_ppm;
    bool has_drift; /* false: not known yet (needs 10 s) */
} health_report;

/* Statistics of a quarter of a second. */
typedef struct health_slice {
    int64_t index; /* arrival time in slices */
    uint32_t sample_count, interval_count, steady_count;
    double interval_ms;                 /* sum over all intervals */
    double steady_ms, steady_square_ms; /* over intervals without a gap in the sequence */
    double lateness_ms, lateness_worst_ms;
    uint32_t saturated[MRT_MAX_CHANNELS];
} health_slice;

typedef struct health_meter {
    health_report counted; /* values that do not depend on the last seconds */
    int64_t start_ns;
    health_slice slice[HEALTH_SLICES];
    bool has_last;
    uint32_t last_sequence;
    int64_t last_time_ns;
    bool is_ranged[MRT_MAX_CHANNELS];
    float low[MRT_MAX_CHANNELS], high[MRT_MAX_CHANNELS];
    /* Lower envelope of lateness: the minimum in each of the last windows of 2 s. */
    int64_t window_index;
    uint32_t window_count; /* finished windows, oldest first */
    double window_s[HEALTH_WINDOWS], window_least_ms[HEALTH_WINDOWS];
    double open_s, open_least_ms; /* current window */
    bool has_open;
} health_meter;

void health_init(health_meter *out, const mrt_channel *channels, uint32_t count, int64_t now_ns);
/* Call after the device was opened again, maybe with other channels. Intervals and drift are
 * measured from the beginning again. */
void health_reopened(health_meter *self, const mrt_channel *channels, uint32_t count);
void health_sample(health_meter *self, const mrt_sample *sample, int64_t arrival_ns);
void health_refused(health_meter *self);
void health_dropped(health_meter *self);
/* words: shortened to fit. If the state is unchanged, only the words are replaced. */
void health_state(health_meter *self, int32_t state, const char *words, int64_t now_ns);
void health_lost(health_meter *self); /* counts one more loss */
void health_measure(const health_meter *self, int64_t now_ns, health_report *out);
/* Updates silence_s and state_s to the current time. */
void health_age(health_report *self, int64_t now_ns);

/* The newest report, from one writer to any number of readers. */
enum { HEALTH_BOARD_WORDS = (sizeof(health_report) + 7) / 8 };
typedef struct health_board {
    _Atomic uint32_t sequence; /* odd during a write */
    _Atomic uint64_t word[HEALTH_BOARD_WORDS];
} health_board;
void health_board_init(health_board *out);
void health_post(health_board *board, const health_report *report); /* [writer] never waits */
/* [any but frame] Waits while a report is being written. */
void health_read(const health_board *board, health_report *out);

#endif
