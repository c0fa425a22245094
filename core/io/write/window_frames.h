/* io/window_frames.h - the frames of one window of time: the base they are seen from, which
 * vertices leave it, and where those are. Private to the search for components. One thread at a
 * time. */
#ifndef MAROTTE_IO_WINDOW_FRAMES_H
#define MAROTTE_IO_WINDOW_FRAMES_H
#include "io/write/component_frames.h"

#include <stdbool.h>

typedef enum window_base { WINDOW_BASE_NONE = 0, WINDOW_BASE_MEAN } window_base;

typedef struct window_frames {
    component_frames *frames;
    uint32_t first, count; /* of the free frames */
    float *base;           /* 3 per vertex: metres from the frames' base */
    bool has_base;         /* false: base is 0 */
    uint8_t *is_moved;     /* per vertex */
    uint32_t *moved;       /* moved_count: vertices, ascending */
    uint32_t moved_count;
    double *step_m;   /* count: how far the shape goes from the frame before */
    float *offset;    /* 3 per vertex: scratch */
    float still_peak; /* of what was read: greatest square of how far the others are off, m^2 */
} window_frames;

/* A base is the mean of the frames, but 0 for vertices that it moves less than
 * COMPONENT_STILL_SHARE. */
CHECKED mrt_result window_frames_init(window_frames *out, component_frames *frames, uint32_t first,
                                      uint32_t count, window_base base, double tolerance_m,
                                      error *err);
void window_frames_finish(window_frames *w);

/* out: 3 per moved vertex, metres from the base. */
CHECKED mrt_result window_frames_read(window_frames *w, uint32_t index, float *out, error *err);

#endif
