/* stage/input/health.h - how well an input is doing: rate, jitter, lateness, losses, saturated
 * channels, silence, drift. A meter is fed with every sample and the moment of its arrival by the
 * thread that reads the input; what it measures is posted on a board that any thread may look at.
 * Pure but for the board; no allocation, no clock. All times: the host's monotonic clock. */
#ifndef MAROTTE_STAGE_HEALTH_H
#define MAROTTE_STAGE_HEALTH_H
#include <marotte/plugin.h>

#include <stdatomic.h>

enum { HEALTH_SLICES = 8, HEALTH_WINDOWS = 16, HEALTH_WORDS_LENGTH = 168 };

typedef struct health_report {
    int32_t state; /* the caller's number: input_state */
    int64_t state_since_ns;
    double state_s;                  /* how long it has lasted */
    char words[HEALTH_WORDS_LENGTH]; /* what there is to say about the state; "" */
    uint32_t loss_count;             /* how often the device went away */
    uint64_t sample_count;           /* since the start, as all counts here */
    uint64_t gap_count;              /* samples that are missing in the sequence */
    uint64_t refused_count;          /* misshapen */
    uint64_t dropped_count;          /* the reader was not fast enough */
    int64_t last_arrival_ns;         /* 0: none yet */
    double silence_s;                /* since the last arrival, or since the start */
    /* Over the last 2 s: */
    double rate_hz;           /* by the samples' own times */
    double jitter_ms;         /* standard deviation of the interval between samples in sequence */
    double lateness_ms;       /* mean of arrival - sample time */
    double lateness_worst_ms; /* the greatest of them */
    uint32_t channel_count;
    float saturated[MRT_MAX_CHANNELS]; /* share of samples at an end of the channel's range, 0..1;
                                          0 for pedals and channels without a range */
    /* Over the last 32 s: how much faster the clock behind the samples' times runs than the host's:
     * minus the slope of the least lateness. What a plugin corrects does not show. */
    double drift_ppm;
    bool has_drift; /* false: not known yet (10 s are needed) */
} health_report;

/* A quarter of a second of samples. */
typedef struct health_slice {
    int64_t index; /* of arrival, in slices */
    uint32_t sample_count, interval_count, steady_count;
    double interval_ms;                 /* sum over all intervals */
    double steady_ms, steady_square_ms; /* over those without a gap in the sequence */
    double lateness_ms, lateness_worst_ms;
    uint32_t saturated[MRT_MAX_CHANNELS];
} health_slice;

typedef struct health_meter {
    health_report counted; /* what is not of the last seconds */
    int64_t start_ns;
    health_slice slice[HEALTH_SLICES];
    bool has_last;
    uint32_t last_sequence;
    int64_t last_time_ns;
    bool is_ranged[MRT_MAX_CHANNELS];
    float low[MRT_MAX_CHANNELS], high[MRT_MAX_CHANNELS];
    /* The lower envelope of lateness: its least value in each of the last windows of 2 s. */
    int64_t window_index;
    uint32_t window_count; /* closed, the oldest first */
    double window_s[HEALTH_WINDOWS], window_least_ms[HEALTH_WINDOWS];
    double open_s, open_least_ms; /* the one that is being filled */
    bool has_open;
} health_meter;

void health_init(health_meter *out, const mrt_channel *channels, uint32_t count, int64_t now_ns);
/* The device was opened again, maybe with other channels: intervals and drift begin anew. */
void health_reopened(health_meter *self, const mrt_channel *channels, uint32_t count);
void health_sample(health_meter *self, const mrt_sample *sample, int64_t arrival_ns);
void health_refused(health_meter *self);
void health_dropped(health_meter *self);
/* words: cut to fit. The same state again only changes the words. */
void health_state(health_meter *self, int32_t state, const char *words, int64_t now_ns);
void health_lost(health_meter *self); /* one more loss */
void health_measure(const health_meter *self, int64_t now_ns, health_report *out);
/* Brings what passes by itself (silence_s, state_s) up to now. */
void health_age(health_report *self, int64_t now_ns);

/* The newest report of one poster for any number of lookers. */
enum { HEALTH_BOARD_WORDS = (sizeof(health_report) + 7) / 8 };
typedef struct health_board {
    _Atomic uint32_t sequence; /* odd while posting */
    _Atomic uint64_t word[HEALTH_BOARD_WORDS];
} health_board;
void health_board_init(health_board *out);
void health_post(health_board *board, const health_report *report); /* [poster] never waits */
/* [any but frame] Waits while a report is being posted. */
void health_look(const health_board *board, health_report *out);

#endif
