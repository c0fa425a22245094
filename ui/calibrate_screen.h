/* calibrate_screen.h - what the person sees while a glove is calibrated: on a terminal a block that
 * is redrawn in place, with a bar per sensor; elsewhere one line per piece of news. [main] */
#ifndef MAROTTE_UI_CALIBRATE_SCREEN_H
#define MAROTTE_UI_CALIBRATE_SCREEN_H
#include "hand/guide.h"

#include <stdio.h>

typedef struct calibrate_screen {
    FILE *stream;
    bool is_terminal, has_keys;
    int line_count; /* of the block that stands on the terminal; 0: none */
    uint32_t sensors;
    float raw_min, raw_max; /* of the bars */
    char news[512];
    bool is_away;
} calibrate_screen;

void calibrate_screen_begin(calibrate_screen *self, FILE *stream, bool has_keys, uint32_t sensors);
/* The step that begins now. */
void calibrate_screen_step(calibrate_screen *self, const guide *of);
/* "taken: flat hand", "not taken: ..." */
__attribute__((format(printf, 2, 3))) void calibrate_screen_news(calibrate_screen *self,
                                                                 const char *format, ...);
/* Redraws the block; where there is none, nothing. */
void calibrate_screen_draw(calibrate_screen *self, const guide *of, const float *raw);
/* Leaves the block as it is, for what comes after it. */
void calibrate_screen_end(calibrate_screen *self);

#endif
