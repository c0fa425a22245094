/* window/panels/calibrate_guide.h - a calibration in progress, without a screen: the guide, what it
 * said last, its result and the saved file. For the dialog and the camera's card. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_CALIBRATE_GUIDE_H
#define MAROTTE_UI_WINDOW_PANELS_CALIBRATE_GUIDE_H
#include "hand/guide.h"
#include "stage/input/glove_channels.h"
#include "window/app/app.h"

typedef enum calibrate_tone {
    CALIBRATE_SAYS = 0,
    CALIBRATE_TOOK,
    CALIBRATE_REFUSED
} calibrate_tone;

typedef struct calibrate_guide {
    glove_channels glove;
    guide *guide;          /* NULL: no calibration in progress */
    float raw[MRT_ANGLES]; /* newest sample */
    bool has_sample;
    char news[600]; /* last message about a recorded or refused pose; may be "" */
    calibrate_tone tone;
    calibration_file *result;  /* NULL until all steps are done */
    guide_judgement judgement; /* of the result */
} calibrate_guide;

/* name: of the input. */
CHECKED mrt_result calibrate_guide_begin(calibrate_guide *out, const mrt_channel *channel,
                                         uint32_t count, uint32_t side, const char *name,
                                         error *err);
void calibrate_guide_end(calibrate_guide *self); /* accepts zeroed memory */
void calibrate_guide_sample(calibrate_guide *self, const mrt_sample *sample);
/* what: guide_next, which records the current pose, or guide_skip. */
void calibrate_guide_advance(calibrate_guide *self, guide_news (*what)(guide *));
void calibrate_guide_back(calibrate_guide *self);
/* Repeats one pose, then shows a new result. */
void calibrate_guide_again(calibrate_guide *self, guide_step step);
/* Saves the calibration in the user's folder. The caller frees *out_path. hand_length_mm 0:
 * unknown. */
CHECKED mrt_result calibrate_guide_keep(calibrate_guide *self, const char *name,
                                        double hand_length_mm, char **out_path, error *err);

/* Performs with the calibration of that path ("": default), also in the next run. */
CHECKED mrt_result calibrate_use(app *of, uint32_t side, const char *path, error *err);
/* Performs with the calibrations of the previous run. */
void calibrate_use_kept(app *of);

#endif
