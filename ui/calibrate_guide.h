/* calibrate_guide.h - the guided part of `marotte calibrate`: a glove, the guide (hand/guide.h),
 * and a person at a terminal or a script. [main] */
#ifndef MAROTTE_UI_CALIBRATE_GUIDE_H
#define MAROTTE_UI_CALIBRATE_GUIDE_H
#include "hand/guide_judge.h"
#include "stage/spec.h"

#include <stdio.h>

typedef struct calibrate_guide_options {
    const plugin_spec *input;
    uint32_t side;    /* MRT_NO_HAND: whichever the glove is */
    double timeout_s; /* for each pose, and without any sample; 0: none */
    FILE *screen;     /* where the guidance goes; a terminal gets live bars */
} calibrate_guide_options;

/* Guides through every pose. `out` lacks name, date and hand length. */
CHECKED mrt_result calibrate_guide_run(calibration_file *out, guide_judgement *out_judgement,
                                       const calibrate_guide_options *options, error *err);

#endif
