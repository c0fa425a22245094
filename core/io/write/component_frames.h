/* io/write/component_frames.h - the free frames of a clip as offsets from one shape, in metres, and
 * the frames of one window of time: their base, the vertices that leave the base, and the offsets
 * of those vertices. Does not cover the components. Private to the search for components. One
 * thread at a time. */
#ifndef MAROTTE_IO_COMPONENT_FRAMES_H
#define MAROTTE_IO_COMPONENT_FRAMES_H
#include "io/clip.h"

#include <stdbool.h>

/* Vertices that move less than this share of the tolerance stay in place. */
#define COMPONENT_STILL_SHARE 0.1

typedef struct component_frames {
    const clip *clip;
    const float *base_m; /* vertex_count by 3 */
    uint32_t vertex_count, count;
    uint32_t *frame; /* count: frames of the clip, ascending */
    float *position; /* vertex_count by 3: scratch */
} component_frames;

CHECKED mrt_result component_frames_init(component_frames *out, const clip *c, const float *base_m,
                                         error *err);
void component_frames_finish(component_frames *f);

/* Reads a frame. out: vertex_count by 3. Refuses offsets whose squares are too large for float32;
 * the error names the frame. */
CHECKED mrt_result component_frames_read(component_frames *f, uint32_t index, float *out,
                                         error *err);

/* Returns the index of the i-th of `picked` frames, evenly spread from the first to the last of
 * `count`. */
uint32_t component_frames_spread(uint32_t i, uint32_t picked, uint32_t count);
/* Returns the greatest x^2 + y^2 + z^2. */
float component_frames_peak(const float *offset, size_t vertex_count);

/* ---- the frames of one window ---- */

typedef enum window_base { WINDOW_BASE_NONE = 0, WINDOW_BASE_MEAN } window_base;

typedef struct window_frames {
    component_frames *frames;
    uint32_t first, count; /* of the free frames */
    float *base;           /* 3 per vertex: metres from the frames' base */
    bool has_base;         /* false: base is 0 */
    uint8_t *is_moved;     /* per vertex */
    uint32_t *moved;       /* moved_count: vertices, ascending */
    uint32_t moved_count;
    double *step_m;   /* count: distance of each shape from the previous one */
    float *offset;    /* 3 per vertex: scratch */
    float still_peak; /* greatest squared error of the other vertices in the frames read so far, m^2
                       */
} window_frames;

/* Prepares a window. Its base is the mean of the frames, but 0 for vertices that it moves less than
 * COMPONENT_STILL_SHARE. */
CHECKED mrt_result window_frames_init(window_frames *out, component_frames *frames, uint32_t first,
                                      uint32_t count, window_base base, double tolerance_m,
                                      error *err);
void window_frames_finish(window_frames *w);

/* Reads a frame. out: 3 per moved vertex, metres from the base. */
CHECKED mrt_result window_frames_read(window_frames *w, uint32_t index, float *out, error *err);

#endif
