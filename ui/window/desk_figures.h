/* window/desk_figures.h - how long things took lately, and how long most of them take. Pure. */
#ifndef MAROTTE_UI_WINDOW_DESK_FIGURES_H
#define MAROTTE_UI_WINDOW_DESK_FIGURES_H
#include <stdint.h>

enum { FIGURES_KEPT = 240 };

typedef struct figures {
    double value[FIGURES_KEPT]; /* a ring */
    uint32_t count;             /* of all that were added */
} figures;

void figures_add(figures *self, double value);
/* Of the last FIGURES_KEPT; 0 when there are none. */
void figures_look(const figures *self, double *out_p50, double *out_p99);

#endif
