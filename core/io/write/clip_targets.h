/* io/write/clip_targets.h - a clip as morph targets and their weights, like those of gltf_write,
 * for writers of other formats. Anchored frames have exact targets, all others have components.
 * Each target lists the vertices that it moves. Does not cover the file formats. [main] or a
 * worker. */
#ifndef MAROTTE_IO_CLIP_TARGETS_H
#define MAROTTE_IO_CLIP_TARGETS_H
#include "io/export.h"

typedef struct clip_target {
    char *name;
    uint32_t count;
    uint32_t *vertex;       /* count, ascending */
    float *offset, *normal; /* count by 3: metres, and change of the normal, for a weight of 1 */
} clip_target;

typedef struct clip_targets {
    clip_target *target;
    uint32_t count;
    float *weight; /* frames of the clip by count, 0..1: frame i shows the mesh and the sum of its
                      targets; NULL without targets or frames */
} clip_targets;

/* Finds the targets of a clip. options: NULL: defaults. out_report: everything except byte_count.
 * */
CHECKED mrt_result clip_targets_find(clip_targets *out, const clip *c, const gltf_options *options,
                                     const export_progress *progress, gltf_report *out_report,
                                     error *err);
void clip_targets_finish(clip_targets *targets); /* accepts zeroed */

#endif
