/* hand/guide_judge.h - how good a calibration is, sensor by sensor, and which pose to repeat where
 * it is not: the one judgement of the window and of `marotte calibrate`. Pure. [main] */
#ifndef MAROTTE_HAND_GUIDE_JUDGE_H
#define MAROTTE_HAND_GUIDE_JUDGE_H
#include "hand/guide.h"

typedef enum guide_flaw_kind {
    GUIDE_FLAW_NONE = 0,
    GUIDE_FLAW_LOOSE,  /* reads 3 to 10 degrees where it should read 0: the cloth slips */
    GUIDE_FLAW_DEAD,   /* said nothing in the pose that ends its range; the gain is shipped */
    GUIDE_FLAW_BEYOND, /* 15 degrees further in a later pose than at the end of its range */
    GUIDE_FLAW_OFF     /* over 10 degrees where it should read 0: that was another pose */
} guide_flaw_kind;

typedef struct guide_flaw {
    guide_flaw_kind kind;
    int sensor;
    guide_step step; /* the pose to repeat; GUIDE_STEPS: not known, calibrate again */
    float off_rad;   /* LOOSE: RMS; OFF: where it is worst */
} guide_flaw;

typedef struct guide_judgement {
    guide_flaw flaw[MRT_ANGLES]; /* at most one a sensor; the flat hand first, then by kind */
    uint32_t flaw_count;
    uint32_t left_out; /* poses that were skipped */
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
