/* stage/playback/diff.h - how far apart two motions of one mesh are, in mm: by the regions of the face,
 * frame by frame. Leaves out where the frames come from (sequencer.h). Pure but for create; any
 * thread. */
#ifndef MAROTTE_STAGE_DIFF_H
#define MAROTTE_STAGE_DIFF_H
#include "show/own.h"

enum { DIFF_ELSEWHERE = OWN_REGION_COUNT, DIFF_FACE, DIFF_PART_COUNT };

typedef struct diff diff;

/* Vertices belong to the region of the nearest contact within radius_mm at rest; the others, and
 * those whose contact no region owns, are elsewhere; all are of the face.
 * rest: vertex_count by 3, mm. */
CHECKED mrt_result diff_create(diff **out, const float *rest, uint32_t vertex_count,
                               const mrt_face *about, double radius_mm, error *err);
void diff_destroy(diff *self); /* NULL is fine */

const char *diff_part_name(uint32_t part); /* "mouth", "elsewhere", "face" */
uint32_t diff_vertex_count(const diff *self, uint32_t part);

typedef struct diff_frame {
    double max_mm[DIFF_PART_COUNT], rms_mm[DIFF_PART_COUNT];
} diff_frame;
/* a, b: vertex_count by 3, mm. */
void diff_measure(const diff *self, const float *a, const float *b, diff_frame *out);

typedef struct diff_total {
    double max_mm, rms_mm; /* over all vertices and frames */
    uint32_t worst;        /* frame of the maximum */
} diff_total;
void diff_sum(uint32_t part, const diff_frame *frames, uint32_t count, diff_total *out);

/* The frames at which the face is furthest apart, the worst first, at least `apart` frames from
 * each other, none without a difference. out: capacity. Returns how many. */
uint32_t diff_worst(const diff_frame *frames, uint32_t count, uint32_t apart, uint32_t *out,
                    uint32_t capacity);

#endif
