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
    /* Of the One-Euro filter, which then filters landmarks too; 0 and false: the usual filters. */
    double min_cutoff_hz;
    bool has_beta;
    double beta;           /* Hz per deg/s */
    uint32_t rezero_pedal; /* 1..MRT_MAX_PEDALS: a press re-zeroes the hands that are there, and
                              mappings never see that pedal; 0: none */
} hands_settings;

/* [main] */
CHECKED mrt_result hands_create(hands **out, const hands_settings *settings, error *err);
void hands_destroy(hands *self); /* NULL is fine */
void hands_reset(hands *self);   /* as after create */

/* Which channel feeds what. Made once per input. */
enum { ROUTE_NAME = 96 };
typedef struct channel_route {
    char name[ROUTE_NAME]; /* of the input; "": none was given */
    channel_table table;
    bool in_counts[2];               /* left, right: these need a calibration */
    bool is_of_landmarks[2];         /* left, right: which filter smooths the angles */
    bool has_distal[2][4];           /* of the fingers index .. little */
    hand_calibration calibration[2]; /* left, right */
} channel_route;
/* For counts the shipped defaults, for rad as it is: by the unit. The route must not move. */
void channel_route_init(channel_route *out, const mrt_channel *channel, uint32_t count);
void channel_route_call(channel_route *route, const char *name);
/* Takes a user's calibration instead of the defaults, if it is made for such an input; NULL: leaves
 * it. After channel_route_call. */
void channel_route_calibrate(channel_route *route, uint32_t side,
                             const hand_calibration *calibration);

/* What is performed at once: samples of several inputs that belong to one instant, at most one of
 * each, in the order of the inputs. All have the step's time, and are one voice's. */
enum { STEP_SAMPLES_MAX = 8 };
typedef struct step_sample {
    uint32_t input; /* index */
    const channel_route *route;
    mrt_sample sample;
} step_sample;
typedef struct sample_step {
    int64_t time_ns;
    uint32_t voice;
    int64_t due_ns; /* by the clock of who performs (sample_source) */
    uint32_t count;
    step_sample of[STEP_SAMPLES_MAX];
} sample_step;
/* Of one sample, of input 0. */
sample_step sample_step_of(const channel_route *route, const mrt_sample *sample);

/* Changes what the step's samples speak of in `frame`: hands, pedals. frame->time_ns is the step's.
 */
void hands_read(hands *self, const sample_step *s, mrt_frame *frame);

/* From the next sample on, eased over 250 ms, the pose that the hand holds now is its neutral pose.
 * Always measured from the tables, so that a second one replaces the first. Refused, MRT_HOLD with
 * the reason in `why`, while the hand moves: when over the last half second some channel's standard
 * deviation is more than a degree, or when its samples do not reach up to time_ns. */
CHECKED mrt_result hands_rezero(hands *self, uint32_t side, int64_t time_ns, error *why);

typedef struct rezero_counts {
    uint32_t done, refused; /* by pedal and by hands_rezero */
    error refusal;          /* the last one's reason; "" none */
} rezero_counts;
const rezero_counts *hands_rezeros(const hands *self);

/* Between samples, on a hand that is measured otherwise from the next one on: its pose eases from
 * what it was. skeleton: of another length, taken over; the old one comes back, for [main] to
 * destroy. NULL: it stays, and NULL comes back. */
hand_skeleton *hands_change(hands *self, uint32_t side, hand_skeleton *skeleton);
/* Between samples; 0: none. */
void hands_set_rezero_pedal(hands *self, uint32_t pedal);

/* All that frames to come depend on, as bytes (at most `capacity` are written; NULL: none); returns
 * the size that it takes. */
size_t hands_save(const hands *self, void *bytes, size_t capacity);
/* Reads the bytes of earlier versions too. False: not such bytes; the hands are then reset. */
bool hands_load(hands *self, const void *bytes, size_t size);
/* As if all samples so far had been so much later. */
void hands_shift_time(hands *self, int64_t by_ns);

#endif
