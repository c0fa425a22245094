/* stage/perform/player.h - plays inputs into a performer: steps in time order (scheduler.h), drawn
 * frames at a fixed rate between them, in real time or as fast as possible. The samples are
 * performed alike either way; in real time a frame shows those that have arrived by then. [main],
 * or the frame thread of a window. */
#ifndef MAROTTE_STAGE_PLAYER_H
#define MAROTTE_STAGE_PLAYER_H
#include "stage/input/input.h"
#include "stage/perform/frame.h"

typedef struct player_settings {
    double fps;           /* of drawn frames, > 0 */
    double seconds;       /* stop after so much of the performance; 0: when the inputs are over; a
                             device that is away is not over */
    instance_clock clock; /* the one that the inputs were created with */
    _Atomic bool *stop;   /* set by anybody to end the performance; may be NULL */
    const hand_calibration *calibration[2]; /* left, right, for gloves in counts; NULL: shipped */
} player_settings;

typedef struct player_events {
    /* Draws the face as it is at time_ns. NULL: frame_draw does. MRT_END: the performance is over.
     */
    CHECKED mrt_result (*draw)(void *data, int64_t time_ns, error *err);
    /* After drawn frame `index`, time_s from the start of the performance. work_ns: time that all
     * phases took since the last drawn frame. < 0 ends the performance with that result. May be
     * NULL. */
    mrt_result (*frame)(void *data, uint32_t index, double time_s, int64_t work_ns, error *err);
    /* A device went away or came back, time_s from the start of the performance. May be NULL. */
    void (*incident)(void *data, const input *from, const input_incident *what, double time_s);
    /* [frame] Of a stage that goes on: between any two steps; here player_add_input and
     * player_remove_input may be called. True: the stage is to be drawn as soon as no sample waits.
     * May be NULL. */
    bool (*between)(void *data);
    void *data;
} player_events;

typedef struct player_report {
    uint64_t sample_count, step_count;
    uint32_t frame_count;
    uint32_t dropped, refused;
    double duration_s; /* from the first to the last sample */
    bool input_failed;
    uint32_t went_count, came_count; /* of devices */
    double away_s;                   /* sum over those that came back */
} player_report;

enum { PLAYER_INPUTS_MAX = STEP_SAMPLES_MAX };

/* ---- a stage that goes on, whether there are inputs or not, in real time: it is drawn from its
 * beginning, and frames that are late are left out ---- */

typedef struct player_loop player_loop;

/* Each step is performed by frame_step of f, which must outlive the player; its sources become
 * those of the player. The settings and events are copied. [main] */
CHECKED mrt_result player_create(player_loop **out, stage_frame *f, const player_settings *settings,
                                 const player_events *events, error *err);
void player_destroy(player_loop *self); /* its inputs have been removed or stopped; NULL is fine */
/* Until *settings->stop. [frame] */
CHECKED mrt_result player_go_on(player_loop *self, error *err);
/* What wakes it: of inputs (input_set_wake), and of whoever has something for it. */
wake *player_wake(player_loop *self);

/* From `between`. The input's wake is the player's; it is started by whoever owns it. */
void player_add_input(player_loop *self, input *in);
void player_remove_input(player_loop *self, uint32_t index); /* those behind it move up */
input *player_input(player_loop *self, uint32_t index);
/* NULL: shipped; it must live until the next call. */
void player_calibrate(player_loop *self, uint32_t side, const hand_calibration *calibration);
/* A sample that the stage itself gives, in order behind all that were performed. */
CHECKED mrt_result player_give(player_loop *self, uint32_t index, const mrt_sample *sample,
                               error *err);
/* What was drawn shows this instant: samples that come now are performed behind it, whenever they
 * were measured, and are recorded so. */
void player_show_until(player_loop *self, int64_t time_ns);

/* ---- one that ends with its inputs ---- */

CHECKED mrt_result player_run_stage(stage_frame *f, input *const *inputs, uint32_t input_count,
                                    const player_settings *settings, const player_events *events,
                                    player_report *out_report, error *err);

#endif
