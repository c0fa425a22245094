/* stage/perform/scheduler.h - reads all sources of samples (devices, recordings, the pointer,
 * tracks of a show) and chooses the next step: the samples that are performed together, and their
 * voice. Does not cover the clock (player.h) and the phases of a step (frame.h). Single-threaded;
 * no allocation.
 *
 * STEPS  (show/step_rule.h) All samples of a step get the same time, and it is recorded. Therefore
 * recorded samples of equal time always form one step. Measured samples of different hands form one
 * step if they are at most half a period apart. If they formed one step before, the limit is three
 * quarters, so that noise does not separate them. Other samples measured in between join them.
 * Live, the scheduler waits for a late hand for at most one period. If the hand does not arrive,
 * the scheduler does not wait for it again until its next sample. Each step is at least one
 * nanosecond later than the previous one. */
#ifndef MAROTTE_STAGE_SCHEDULER_H
#define MAROTTE_STAGE_SCHEDULER_H
#include "stage/input/sample_source.h"
#include "stage/perform/hands.h"
#include "show/step_rule.h"

typedef enum scheduler_rule {
    SCHEDULE_RECORDED = 0, /* times are already those of steps */
    SCHEDULE_MEASURED,     /* the next samples are always known: recordings as inputs */
    SCHEDULE_LIVE          /* the next samples must be waited for */
} scheduler_rule;

typedef struct scheduler_entry {
    sample_source source;
    const channel_route *route;
    uint32_t version;
    step_rhythm rhythm; /* of the samples that were consumed */
    bool is_missed;     /* the scheduler waited for it in vain */
    /* result of the last query of the source */
    bool is_there, is_over, is_chosen;
    uint32_t next_version;
    int64_t due_ns;
    mrt_sample sample;
} scheduler_entry;

typedef struct scheduler {
    scheduler_rule rule;
    scheduler_entry *entry; /* owned by the caller, as are the routes */
    channel_route *route;   /* for sources with channels, by their index; NULL: no such sources */
    uint32_t count, capacity;
    const hand_calibration *calibration[2];
    uint64_t step_count, sample_count;
    int64_t last_ns;  /* time of the last consumed step */
    int64_t shown_ns; /* latest time that the player has shown; later steps get later times */
    /* the step that waits for a late hand: */
    bool is_waiting;
    uint32_t waits_with, waits_sequence; /* index and sequence of its first sample */
    int64_t waits_until_ns;
} scheduler;

/* capacity: length of `entry`, and of `route` unless NULL. Both arrays must outlive the scheduler.
 */
void scheduler_init(scheduler *out, scheduler_rule rule, scheduler_entry *entry,
                    channel_route *route, uint32_t capacity);
/* Adds a source. route: for a source without channels, must outlive the source; otherwise NULL.
 * Ignores sources beyond `capacity`, or beyond STEP_SAMPLES_MAX of one voice. */
void scheduler_add(scheduler *self, const sample_source *source, const channel_route *route);
void scheduler_remove(scheduler *self, uint32_t index); /* later ones move up */
void scheduler_clear(scheduler *self);                  /* removes all sources */
/* Sets the calibration of one side, for gloves in counts; NULL: the shipped one. It must stay valid
 * until the next call. */
void scheduler_calibrate(scheduler *self, uint32_t side, const hand_calibration *calibration);

/* Finds the next step: the samples that are due first. If sources tie, the one that was added first
 * wins. Routes are valid until the sources change. MRT_TIMEOUT: no step now; call again when a
 * source has a sample, at *out_until_ns at the latest. MRT_END: all sources have ended. now_ns:
 * time of the host's clock, used by SCHEDULE_LIVE only. */
CHECKED mrt_result scheduler_next(scheduler *self, int64_t now_ns, sample_step *out,
                                  int64_t *out_until_ns, error *err);
/* Consumes the step of scheduler_next from its sources. All its samples get the time of the step.
 */
void scheduler_consume(scheduler *self, sample_step *s);
/* The same for a step that comes from no source. */
void scheduler_insert(scheduler *self, sample_step *s);

#endif
