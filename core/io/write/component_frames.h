/* io/component_frames.h - the free frames of a clip as offsets from one shape, in metres. Private
 * to the search for components. One thread at a time. */
#ifndef MAROTTE_IO_COMPONENT_FRAMES_H
#define MAROTTE_IO_COMPONENT_FRAMES_H
#include "io/clip.h"

/* Vertices that move less than this share of the tolerance are left where they are. */
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

/* out: vertex_count by 3. Refuses what is too far for squares in float32, with the frame's name. */
CHECKED mrt_result component_frames_read(component_frames *f, uint32_t index, float *out,
                                         error *err);

/* Index of the i-th of `picked` frames, evenly spread from the first to the last of `count`. */
uint32_t component_frames_spread(uint32_t i, uint32_t picked, uint32_t count);
/* The greatest x^2 + y^2 + z^2. */
float component_frames_peak(const float *offset, size_t vertex_count);

#endif
