/* hand/guide.h - the guided calibration of one glove or bare hand: a state machine fed with raw
 * samples and their time, step by step through ten poses of a glove, three of a hand that a camera
 * or a headset reads as angles. Each is taken when the hand has moved into it and holds still, or
 * when the person says so; what cannot be that pose is refused with a reason.
 * Leaves out the device, the clock and the screen. A function of its samples and calls alone.
 * [main] */
#ifndef MAROTTE_HAND_GUIDE_H
#define MAROTTE_HAND_GUIDE_H
#include "hand/calibration_file.h"

typedef enum guide_step {
    GUIDE_RELAXED = 0, /* ready to talk: the neutral pose */
    GUIDE_FLAT,        /* every angle is 0 */
    GUIDE_FIST,
    GUIDE_THUMB_ACROSS,
    GUIDE_SPREAD,
    GUIDE_THUMB_ALONE, /* bent alone, the others straight: cross-talk */
    GUIDE_INDEX_ALONE,
    GUIDE_MIDDLE_ALONE,
    GUIDE_RING_ALONE,
    GUIDE_LITTLE_ALONE,
    GUIDE_STEPS /* all are done */
} guide_step;
extern const char *const guide_step_name[GUIDE_STEPS]; /* "flat hand" */

typedef struct guide_settings {
    uint32_t side;
    uint32_t sensors;       /* bit i: sensor i is there and calibrated */
    uint32_t steps;         /* bit i: guide_step i is asked for; GUIDE_FLAT always is */
    char input[HAND_INPUT]; /* of a bare hand, as in hand_calibration: raw is rad; "": a glove */
    double still_s;         /* hold still for so long */
    double lead_s;          /* no pose is taken sooner after its step began */
    double timeout_s;       /* GUIDE_TIMED_OUT after so long in a step; 0: never */
    double still_raw;       /* greatest standard deviation of a sensor that is still */
    double moved_raw;       /* a sensor that is so far from the last pose has left it */
} guide_settings;
/* 0.7 s still within 1.5 counts, 1 s lead, no time-out, 10 counts; 8-bit counts. */
guide_settings guide_settings_usual(uint32_t side, uint32_t sensors);
/* Flat, fist and spread in ten seconds: 0.5 s still within 4.6 degrees, as landmarks jitter, 0.6 s
 * lead, no time-out, 20 degrees. Of the thumb the fist tells nothing, and its roll lies where it
 * cannot be seen while it is at the index finger: that is left as it is. */
guide_settings guide_settings_bare(uint32_t side, uint32_t sensors, const char *input);

typedef enum guide_news {
    GUIDE_NOTHING = 0,
    GUIDE_TAKEN,     /* the pose is taken; guide_reason: what is odd about it, or "" */
    GUIDE_REFUSED,   /* guide_reason says why; the step goes on once the hand has moved */
    GUIDE_TIMED_OUT, /* guide_reason says what was missing; the step goes on */
    GUIDE_SKIPPED
} guide_news;

/* What the guide waits for. */
typedef enum guide_wait {
    GUIDE_WAITS_FOR_SAMPLES = 0,
    GUIDE_WAITS_FOR_MOVEMENT, /* the hand is still in the last pose, or in the one refused */
    GUIDE_WAITS_FOR_STILLNESS,
    GUIDE_WAITS_FOR_NOTHING
} guide_wait;
extern const char *const guide_wait_words[GUIDE_WAITS_FOR_NOTHING + 1]; /* "hold still" */

typedef struct guide guide;
guide *guide_create(const guide_settings *settings); /* NULL: no memory */
void guide_destroy(guide *self);                     /* NULL is fine */

/* raw: MRT_ANGLES; those that the glove lacks do not matter. */
guide_news guide_sample(guide *self, const float *raw, int64_t time_ns);
/* Takes the pose as it is now, still or not. */
guide_news guide_next(guide *self);
/* Goes on without the pose: GUIDE_REFUSED for the flat hand, without which nothing can be said. */
guide_news guide_skip(guide *self);
/* Back to the step before, whose pose is forgotten; in the first one, it begins again. */
void guide_repeat(guide *self);
/* A pose that is taken, once more, and then on from where the guide stood. The old one counts until
 * the new one is taken, and after guide_skip. step: below GUIDE_STEPS. */
void guide_again(guide *self, guide_step step);

/* The pose as it is meant, for pictures of it: out_rad MRT_ANGLES. Pure. */
void guide_pose(guide_step step, float *out_rad);

guide_step guide_current(const guide *self);
bool guide_asks(const guide *self, guide_step step);
/* What the person is to do now: a sentence; "" when all are done. */
const char *guide_words(const guide *self);
/* "pose 2 of 3": of what is asked for; out_of: how many these are. At the end the last one. */
int guide_number(const guide *self, int *out_of);
guide_wait guide_waiting(const guide *self);
const char *guide_reason(const guide *self);        /* until the next call */
bool guide_has(const guide *self, guide_step step); /* its pose is taken */
/* MRT_ANGLES: least and greatest raw value seen; 0, 0 before any sample. */
void guide_range(const guide *self, float *out_low, float *out_high);

/* The calibration, without name and date. Possible in every step once the flat hand is taken: what
 * has not been measured is shipped. */
CHECKED mrt_result guide_result(const guide *self, calibration_file *out, error *err);

/* ---- how good a calibration is, sensor by sensor, and which pose to repeat ---- */

/* The one judgement of the window and of `marotte calibrate`. Pure. [main] */
typedef enum guide_flaw_kind {
    GUIDE_FLAW_NONE = 0,
    GUIDE_FLAW_LOOSE,  /* reads 3 to 10 degrees where it should read 0: the cloth slips; of a bare
                          hand 8 to 20 */
    GUIDE_FLAW_DEAD,   /* said nothing in the pose that ends its range; the gain is shipped */
    GUIDE_FLAW_BEYOND, /* 15 degrees further in a later pose than at the end of its range */
    GUIDE_FLAW_OFF     /* over 10 (20) degrees where it should read 0: that was another pose */
} guide_flaw_kind;

typedef struct guide_flaw {
    guide_flaw_kind kind;
    int sensor;
    guide_step step; /* the pose to repeat; GUIDE_STEPS: not known, calibrate again */
    bool is_bare;
    float off_rad; /* LOOSE: RMS; OFF: where it is worst */
} guide_flaw;

typedef struct guide_judgement {
    guide_flaw flaw[MRT_ANGLES]; /* at most one a sensor; the flat hand first, then by kind */
    uint32_t flaw_count;
    uint32_t left_out, asked; /* poses that were skipped, of those */
} guide_judgement;

/* self: what `made` was made by; NULL: only the file is known, and so the residuals alone. */
void guide_judge(guide_judgement *out, const guide *self, const calibration_file *made);
/* Not merely loose. */
bool guide_flaw_is_wrong(const guide_flaw *flaw);
/* "middle finger, middle joint: reads 98 degrees ... Repeat: index alone." */
void guide_flaw_text(const guide_flaw *flaw, char *out, size_t capacity);
/* Over all of it: "All poses are done, but 2 sensors are not right." */
void guide_judgement_text(const guide_judgement *judgement, char *out, size_t capacity);

#endif
