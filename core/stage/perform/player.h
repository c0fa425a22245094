/* stage/perform/player.h - the clock of a performance with inputs. Calls frame_step for each step
 * in time order (scheduler.h), and frame_draw at a fixed rate between them, in real time or as fast
 * as possible. Both ways perform the same samples; in real time a drawn frame shows the samples
 * that have arrived. [main], or the frame thread of a window. */
#ifndef MAROTTE_STAGE_PLAYER_H
#define MAROTTE_STAGE_PLAYER_H
#include "stage/input/input.h"
#include "stage/perform/frame.h"

typedef struct player_settings {
    double fps;     /* of drawn frames, > 0 */
    double seconds; /* length of the performance; 0: until all inputs end. A lost device does not
                       count as ended */
    instance_clock clock; /* of the inputs */
    _Atomic bool *stop;   /* any thread sets it to end the performance; may be NULL */
    const hand_calibration *calibration[2]; /* left, right, for gloves in counts; NULL: default */
} player_settings;

typedef struct player_events {
    /* Draws the face at time_ns. NULL: frame_draw is used. MRT_END: the performance is over.
     */
    CHECKED mrt_result (*draw)(void *data, int64_t time_ns, error *err);
    /* Called after drawn frame `index`, time_s after the start of the performance. work_ns: time
     * that all phases took since the last drawn frame. A result < 0 ends the performance with that
     * result. May be NULL. */
    mrt_result (*frame)(void *data, uint32_t index, double time_s, int64_t work_ns, error *err);
    /* Called when a device was lost or is back, time_s after the start of the performance. May be
     * NULL. */
    void (*incident)(void *data, const input *from, const input_incident *what, double time_s);
    /* [frame] player_run_live only: called between any two steps. player_add_input and
     * player_remove_input may be called here. Returns true to request a drawing as soon as no
     * sample waits. May be NULL. */
    bool (*between)(void *data);
    void *data;
} player_events;

typedef struct player_report {
    uint64_t sample_count, step_count;
    uint32_t frame_count;
    uint32_t dropped, refused;
    double duration_s; /* from the first to the last sample */
    bool input_failed;
    uint32_t went_count, returned_count; /* number of devices that were lost, and that came back */
    double away_s;                       /* total absence of the devices that came back */
} player_report;

enum { PLAYER_INPUTS_MAX = STEP_SAMPLES_MAX };

/* ---- real time, with or without inputs: draws immediately, skips late frames ----
 */

typedef struct player_loop player_loop;

/* frame_step performs each step with f, which must outlive the player; its sources become those of
 * the player. The settings and events are copied. [main] */
CHECKED mrt_result player_create(player_loop **out, stage_frame *f, const player_settings *settings,
                                 const player_events *events, error *err);
void player_destroy(player_loop *self); /* after its inputs are removed or stopped; accepts NULL */
/* Performs until *settings->stop is set. [frame] */
CHECKED mrt_result player_run_live(player_loop *self, error *err);
/* Returns the signal that wakes the player, for its inputs (input_set_wake) and for commands. */
wake *player_wake(player_loop *self);

/* Call from `between`. The input must use the wake of the player. The caller starts the input. */
void player_add_input(player_loop *self, input *in);
void player_remove_input(player_loop *self, uint32_t index); /* later ones move up */
input *player_input(player_loop *self, uint32_t index);
/* NULL: the default. The calibration must stay valid until the next call. */
void player_calibrate(player_loop *self, uint32_t side, const hand_calibration *calibration);
/* Performs a sample that the stage itself made, after all samples so far. */
CHECKED mrt_result player_perform_sample(player_loop *self, uint32_t index,
                                         const mrt_sample *sample, error *err);
/* Reports that the drawn face shows time_ns. Later samples get later times, even if they were
 * measured before. */
void player_show_until(player_loop *self, int64_t time_ns);

/* ---- until the inputs end ---- */

CHECKED mrt_result player_run_stage(stage_frame *f, input *const *inputs, uint32_t input_count,
                                    const player_settings *settings, const player_events *events,
                                    player_report *out_report, error *err);

#endif
