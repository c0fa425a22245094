/* window/calibrate_panel_guide.h - a calibration that is being made at the desk: the guide
 * (hand/guide.h) fed with every sample of one glove, what it said last, and keeping what comes out.
 * Leaves out what is drawn. [main] */
#ifndef MAROTTE_UI_WINDOW_CALIBRATE_PANEL_GUIDE_H
#define MAROTTE_UI_WINDOW_CALIBRATE_PANEL_GUIDE_H
#include "hand/guide_judge.h"
#include "stage/glove_channels.h"

typedef enum calibrate_tone {
    CALIBRATE_SAYS = 0,
    CALIBRATE_TOOK,
    CALIBRATE_REFUSED
} calibrate_tone;

typedef struct calibrate_guide {
    glove_channels glove;
    guide *guide;          /* NULL: none is made now */
    float raw[MRT_ANGLES]; /* newest */
    bool has_sample;
    char news[600]; /* what was taken or refused last; "" */
    calibrate_tone tone;
    calibration_file *result;  /* once all steps are done; NULL before */
    guide_judgement judgement; /* of the result */
} calibrate_guide;

CHECKED mrt_result calibrate_guide_begin(calibrate_guide *out, const mrt_channel *channel,
                                         uint32_t count, uint32_t side, const char *name,
                                         error *err);
void calibrate_guide_end(calibrate_guide *self); /* zeroed is fine */

void calibrate_guide_sample(calibrate_guide *self, const mrt_sample *sample);
void calibrate_guide_take(calibrate_guide *self);
void calibrate_guide_skip(calibrate_guide *self);
void calibrate_guide_back(calibrate_guide *self);
/* One pose once more, then back to the result. */
void calibrate_guide_again(calibrate_guide *self, guide_step step);

/* What is wrong, then what moves along: a line a sensor worth a word. Returns how many. */
typedef struct calibrate_finding {
    char text[200]; /* "ring knuckle moves along with the middle knuckle: 21 %" */
    bool is_warning;
} calibrate_finding;
uint32_t calibrate_guide_findings(const calibrate_guide *self, calibrate_finding *out,
                                  uint32_t capacity);

/* Into the user's folder; *out_path is to be freed. hand_length_mm 0: not said. */
CHECKED mrt_result calibrate_guide_keep(calibrate_guide *self, const char *name,
                                        double hand_length_mm, char **out_path, error *err);

#endif
