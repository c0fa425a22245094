/* stage/perform/hands.h - phase 3 of a frame: the channels of the inputs become two posed hands and
 * the pedals of a mrt_frame. Angles are calibrated, filtered, re-zeroed, eased after a gap and
 * after a jump of landmarks, and posed from the wrist outwards. A function of the samples (and of
 * re-zeros by the user) alone. Angles in MRT_UNIT_LANDMARKS go through the landmark_filter, all
 * others through the One-Euro filter. Tracks of versions without that unit are in "rad" and keep
 * their bits. [frame] after create; no allocation then. */
#ifndef MAROTTE_STAGE_HANDS_H
#define MAROTTE_STAGE_HANDS_H
#include "hand/filter.h"
#include "hand/hand.h"
#include "stage/input/channel_table.h"

typedef struct hands hands;

typedef struct hands_settings {
    double length_mm[2]; /* left, right; 0: HAND_LENGTH_MM */
    /* Settings of the One-Euro filter, which then filters landmarks too; 0 and false: the default
     * filters. */
    double min_cutoff_hz;
    bool has_beta;
    double beta;           /* Hz per deg/s */
    uint32_t rezero_pedal; /* 1..MRT_MAX_PEDALS: a press re-zeroes the hands that are present, and
                              mappings do not see this pedal; 0: none */
} hands_settings;

/* [main] */
CHECKED mrt_result hands_create(hands **out, const hands_settings *settings, error *err);
void hands_destroy(hands *self); /* accepts NULL */
void hands_reset(hands *self);   /* as after create */

/* Use of each channel of an input. Created once per input. */
enum { ROUTE_NAME = 96 };
typedef struct channel_route {
    char name[ROUTE_NAME]; /* name of the input; "": none */
    channel_table table;
    bool in_counts[2];               /* left, right: raw counts, which need a calibration */
    bool is_of_landmarks[2];         /* left, right: the landmark filter smooths the angles */
    bool has_distal[2][4];           /* of the fingers index .. little */
    hand_calibration calibration[2]; /* left, right */
} channel_route;
/* Selects the calibration by the unit of the channels: the shipped defaults for counts, the
 * identity for rad. The route must not move in memory. */
void channel_route_init(channel_route *out, const mrt_channel *channel, uint32_t count);
void channel_route_call(channel_route *route, const char *name);
/* Replaces the defaults with a calibration of the user, if it was made for this kind of input.
 * NULL: no change. Call after channel_route_call. */
void channel_route_calibrate(channel_route *route, uint32_t side,
                             const hand_calibration *calibration);

/* The samples that are performed together: at most one of each input, in the order of the inputs.
 * All have the time of the step and belong to one voice. */
enum { STEP_SAMPLES_MAX = 8 };
typedef struct step_sample {
    uint32_t input; /* index */
    const channel_route *route;
    mrt_sample sample;
} step_sample;
typedef struct sample_step {
    int64_t time_ns;
    uint32_t voice;
    int64_t due_ns; /* in the clock of the performer (sample_source) */
    uint32_t count;
    step_sample of[STEP_SAMPLES_MAX];
} sample_step;
/* Returns a step with one sample, of input 0. */
sample_step sample_step_of(const channel_route *route, const mrt_sample *sample);

/* Updates the hands and pedals in `frame` that the step has samples for. frame->time_ns must be the
 * time of the step. */
void hands_read(hands *self, const sample_step *s, mrt_frame *frame);

/* Makes the current pose of the hand its neutral pose, eased over 250 ms after the next sample. The
 * offset is always measured from the calibration tables, so a second re-zero replaces the first.
 * Returns MRT_HOLD with the reason in `why` while the hand moves: the standard deviation of a
 * channel over the last half second exceeds one degree. Returns it too if the samples do not reach
 * time_ns. */
CHECKED mrt_result hands_rezero(hands *self, uint32_t side, int64_t time_ns, error *why);

typedef struct rezero_counts {
    uint32_t done, refused; /* by pedal and by hands_rezero */
    error refusal;          /* reason of the last refusal; "": none */
} rezero_counts;
const rezero_counts *hands_rezeros(const hands *self);

/* Call between samples, when the next sample is measured in another way: the pose eases from its
 * last value. skeleton: a skeleton of another length, which the hand then owns; returns the old
 * one, which [main] must destroy. NULL: the skeleton is kept, and NULL is returned. */
hand_skeleton *hands_change(hands *self, uint32_t side, hand_skeleton *skeleton);
/* Call between samples; 0: none. */
void hands_set_rezero_pedal(hands *self, uint32_t pedal);

/* Serialises everything that later frames depend on. Writes at most `capacity` bytes; bytes NULL:
 * none. Returns the size of the state. */
size_t hands_save(const hands *self, void *bytes, size_t capacity);
/* Also reads states of earlier versions. Returns false if the bytes are invalid; the hands are then
 * reset. */
bool hands_load(hands *self, const void *bytes, size_t size);
/* Shifts the times of all past samples by by_ns. */
void hands_shift_time(hands *self, int64_t by_ns);

#endif
