/* stage/playback/diff.h - distance between two motions of one mesh, in mm, by region of the face
 * and by frame. Leaves out the source of the frames (sequencer.h). All functions except diff_create
 * and diff_destroy are pure. Any thread. */
#ifndef MAROTTE_STAGE_DIFF_H
#define MAROTTE_STAGE_DIFF_H
#include "show/own.h"

enum { DIFF_ELSEWHERE = OWN_REGION_COUNT, DIFF_FACE, DIFF_PART_COUNT };

typedef struct diff diff;

/* Assigns each vertex to the region of its nearest contact within radius_mm in the neutral face.
 * Vertices without such a contact, or whose contact belongs to no region, are DIFF_ELSEWHERE.
 * DIFF_FACE covers all vertices. rest: vertex_count by 3, mm. */
CHECKED mrt_result diff_create(diff **out, const float *rest, uint32_t vertex_count,
                               const mrt_face *about, double radius_mm, error *err);
void diff_destroy(diff *self); /* accepts NULL */

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

/* Lists the frames with the largest distance, largest first, at least `apart` frames from each
 * other. Frames without a difference are left out. out: `capacity` elements. Returns the count. */
uint32_t diff_worst(const diff_frame *frames, uint32_t count, uint32_t apart, uint32_t *out,
                    uint32_t capacity);

#endif
