/* hand/guide.h - the guided calibration of one glove or bare hand. It is a state machine that
 * receives raw samples with their times. It leads through ten poses of a glove, or three of a hand
 * that a camera or a headset reads as angles. A pose is taken when the hand has moved into it and
 * holds still, or on the user's request. Impossible poses are refused with a reason. Leaves out the
 * device, the clock and the screen. A function of its samples and calls alone. [main] */
#ifndef MAROTTE_HAND_GUIDE_H
#define MAROTTE_HAND_GUIDE_H
#include "hand/calibration_file.h"

typedef enum guide_step {
    GUIDE_RELAXED = 0, /* relaxed, ready to talk: the neutral pose */
    GUIDE_FLAT,        /* every angle is 0 */
    GUIDE_FIST,
    GUIDE_THUMB_ACROSS,
    GUIDE_SPREAD,
    GUIDE_THUMB_ALONE, /* one finger bent, the others straight: for cross-talk */
    GUIDE_INDEX_ALONE,
    GUIDE_MIDDLE_ALONE,
    GUIDE_RING_ALONE,
    GUIDE_LITTLE_ALONE,
    GUIDE_STEPS /* the end: all steps are done */
} guide_step;
extern const char *const guide_step_name[GUIDE_STEPS]; /* "flat hand" */

typedef struct guide_settings {
    uint32_t side;
    uint32_t sensors;       /* bit i: sensor i exists and is calibrated */
    uint32_t steps;         /* bit i: guide_step i is requested; GUIDE_FLAT always is */
    char input[HAND_INPUT]; /* input of a bare hand, as in hand_calibration: raw is rad; "": a glove
                             */
    double still_s;         /* time for which a pose must be held still */
    double lead_s;          /* minimum time from the beginning of a step to its pose */
    double timeout_s;       /* time in a step until GUIDE_TIMED_OUT; 0: never */
    double still_raw;       /* greatest standard deviation of a sensor at rest */
    double moved_raw;       /* distance from the last pose above which a sensor has left it */
} guide_settings;
/* Default settings for 8-bit counts: 0.7 s still within 1.5 counts, 1 s lead, no timeout, 10
 * counts. */
guide_settings guide_settings_default(uint32_t side, uint32_t sensors);
/* Settings for flat, fist and spread in ten seconds: 1 s still within 4.6 degrees, because
 * landmarks jitter, 0.6 s lead, no timeout, 20 degrees. The roll of the thumb is not calibrated:
 * the fist does not show it, and beside the index finger it cannot be seen. */
guide_settings guide_settings_bare(uint32_t side, uint32_t sensors, const char *input);

typedef enum guide_news {
    GUIDE_NOTHING = 0,
    GUIDE_TAKEN,     /* the pose was taken; guide_reason: a warning, or "" */
    GUIDE_REFUSED,   /* guide_reason has the reason; the step continues after the hand has moved */
    GUIDE_TIMED_OUT, /* guide_reason names what was missing; the step continues */
    GUIDE_SKIPPED
} guide_news;

/* The condition that the guide waits for. */
typedef enum guide_wait {
    GUIDE_WAITS_FOR_SAMPLES = 0,
    GUIDE_WAITS_FOR_MOVEMENT, /* the hand is still in the last pose, or in a refused one */
    GUIDE_WAITS_FOR_STILLNESS,
    GUIDE_WAITS_FOR_NOTHING
} guide_wait;
extern const char *const guide_wait_text[GUIDE_WAITS_FOR_NOTHING + 1]; /* "hold still" */

typedef struct guide guide;
guide *guide_create(const guide_settings *settings); /* NULL: no memory */
void guide_destroy(guide *self);                     /* accepts NULL */

/* raw: MRT_ANGLES; values of missing sensors are ignored. */
guide_news guide_sample(guide *self, const float *raw, int64_t time_ns);
/* Takes the current pose, still or not. */
guide_news guide_next(guide *self);
/* Skips the pose. Returns GUIDE_REFUSED for the flat hand, which all measurements need. */
guide_news guide_skip(guide *self);
/* Returns to the previous step and discards its pose. In the first step, restarts that step. */
void guide_repeat(guide *self);
/* Repeats a taken pose, then returns to the current step. The old pose counts until the new one is
 * taken, and after guide_skip. step: below GUIDE_STEPS. */
void guide_again(guide *self, guide_step step);

/* Returns the intended pose, for pictures of it. out_rad: MRT_ANGLES. Pure. */
void guide_pose(guide_step step, float *out_rad);

guide_step guide_current(const guide *self);
bool guide_is_requested(const guide *self, guide_step step);
/* Returns the instruction for the user: a sentence; "" when all steps are done. */
const char *guide_instruction(const guide *self);
/* Returns the number of the pose, as in "pose 2 of 3"; out_of: number of requested poses. At the
 * end the last one. */
int guide_number(const guide *self, int *out_of);
guide_wait guide_waiting(const guide *self);
/* Returns how much of the time is over for which the pose must be held still, 0..1. 0 while the
 * hand is still in the last pose. */
double guide_held(const guide *self);
const char *guide_reason(const guide *self);        /* valid until the next call */
bool guide_has(const guide *self, guide_step step); /* whether the pose of the step was taken */
/* MRT_ANGLES minimum and maximum raw values; 0, 0 before any sample. */
void guide_range(const guide *self, float *out_low, float *out_high);

/* Returns the calibration, without name and date. Possible in every step after the flat hand.
 * Values that were not measured are the shipped ones. */
CHECKED mrt_result guide_result(const guide *self, calibration_file *out, error *err);

/* ---- quality of a calibration: a flaw for each bad sensor, and the pose to repeat ---- */

/* Used by the window and by `marotte calibrate`. Pure. [main] */
typedef enum guide_flaw_kind {
    GUIDE_FLAW_NONE = 0,
    GUIDE_FLAW_LOOSE, /* reads 3 to 10 degrees where it should read 0, because the cloth slips; for
                         a bare hand 8 to 20 */
    GUIDE_FLAW_DEAD,  /* did not change in the pose at the end of its range; the gain is the shipped
                         one */
    GUIDE_FLAW_BEYOND, /* 15 degrees further in a later pose than at the end of its range */
    GUIDE_FLAW_OFF /* over 10 (20) degrees where it should read 0: the hand was in another pose */
} guide_flaw_kind;

typedef struct guide_flaw {
    guide_flaw_kind kind;
    int sensor;
    guide_step step; /* pose to repeat; GUIDE_STEPS: unknown, calibrate again */
    bool is_bare;
    float off_rad; /* LOOSE: RMS; OFF: worst reading */
} guide_flaw;

typedef struct guide_judgement {
    guide_flaw flaw[MRT_ANGLES]; /* at most one per sensor; flat hand first, then by kind */
    uint32_t flaw_count;
    uint32_t left_out, asked; /* number of skipped poses; number of requested ones */
} guide_judgement;

/* self: the guide that made `made`; NULL: only the file is known, and thus only its residuals. */
void guide_judge(guide_judgement *out, const guide *self, const calibration_file *made);
/* Returns whether the flaw is more than loose. */
bool guide_flaw_is_wrong(const guide_flaw *flaw);
/* Writes "middle finger, middle joint: reads 98 degrees ... Repeat: index alone." */
void guide_flaw_text(const guide_flaw *flaw, char *out, size_t capacity);
/* Writes the summary: "All poses are done, but 2 sensors are not right." */
void guide_judgement_text(const guide_judgement *judgement, char *out, size_t capacity);

#endif
