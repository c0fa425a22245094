/* stage/perform/scheduler.h - asks all sources of samples (devices, recordings, the pointer, tracks
 * of a show) and chooses the next step: the samples that are performed together, and their voice.
 * Leaves out the clock (player.h) and the phases of a step (frame.h). One thread; no allocation.
 *
 * STEPS  (show/step_rule.h) All samples of a step have one time, and it is recorded so. Samples of
 * one recorded time are therefore always one step. While samples are measured, samples of different
 * hands become one step when they are at most half a period apart (three quarters once they were
 * together, so that noise does not separate them). Other samples measured in between join them.
 * Live, the scheduler waits for a late hand for at most one period, and only once: a hand that did
 * not come is expected again after its next sample. Each step is later than the one before, if only
 * by a nanosecond. */
#ifndef MAROTTE_STAGE_SCHEDULER_H
#define MAROTTE_STAGE_SCHEDULER_H
#include "stage/input/sample_source.h"
#include "stage/perform/hands.h"
#include "show/step_rule.h"

typedef enum scheduler_rule {
    SCHEDULE_RECORDED = 0, /* times are steps already */
    SCHEDULE_MEASURED,     /* what comes next is always known: recordings as inputs */
    SCHEDULE_LIVE          /* what comes next is waited for */
} scheduler_rule;

typedef struct scheduler_entry {
    sample_source source;
    const channel_route *route;
    uint32_t version;
    step_rhythm rhythm; /* of the samples that were taken */
    bool is_missed;     /* it was waited for, and did not come */
    /* as it was asked last */
    bool is_there, is_over, is_chosen;
    uint32_t next_version;
    int64_t due_ns;
    mrt_sample sample;
} scheduler_entry;

typedef struct scheduler {
    scheduler_rule rule;
    scheduler_entry *entry; /* the caller's, as are the routes */
    channel_route *route; /* of sources with channels, by their index; NULL: there are none such */
    uint32_t count, capacity;
    const hand_calibration *calibration[2];
    uint64_t step_count, sample_count;
    int64_t last_ns;  /* of the step taken last */
    int64_t shown_ns; /* the instant that the player has shown: later steps come behind it */
    /* the step that waits for a late hand */
    bool is_waiting;
    uint32_t waits_with, waits_sequence; /* index and sequence of its first sample */
    int64_t waits_until_ns;
} scheduler;

/* capacity: of entry, and of route unless that is NULL; both must outlive it. */
void scheduler_init(scheduler *out, scheduler_rule rule, scheduler_entry *entry,
                    channel_route *route, uint32_t capacity);
/* route: for a source without channels, and must outlive that; else NULL. At most `capacity`, and
 * STEP_SAMPLES_MAX of a voice: more are left out. */
void scheduler_add(scheduler *self, const sample_source *source, const channel_route *route);
void scheduler_remove(scheduler *self, uint32_t index); /* those behind it move up */
void scheduler_clear(scheduler *self);                  /* no sources */
/* left, right, for gloves in counts; NULL: shipped. It must live until the next call. */
void scheduler_calibrate(scheduler *self, uint32_t side, const hand_calibration *calibration);

/* The next step: what is due first, of several the first that was added; routes are valid until the
 * sources change. MRT_TIMEOUT: none now; look again when
 * one of the sources has something, at *out_until_ns at the latest. MRT_END: none any more.
 * now_ns: of the host's clock, SCHEDULE_LIVE only. */
CHECKED mrt_result scheduler_next(scheduler *self, int64_t now_ns, sample_step *out,
                                  int64_t *out_until_ns, error *err);
/* What scheduler_next gave is taken from its sources; all its samples get the time of the step. */
void scheduler_take(scheduler *self, sample_step *s);
/* The same for a step that no source gave. */
void scheduler_insert(scheduler *self, sample_step *s);

#endif
