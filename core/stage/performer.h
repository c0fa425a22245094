/* stage/performer.h - the frame: steps 3 to 7 of the design, for one face and one mapping. A sample
 * goes in; hands are calibrated, filtered and posed; the mapping pulls; the guard keeps nonsense
 * out; the shape moves. Steps 3 to 6 run once per sample, in time order; step 7 runs per sample
 * while unanchored and once per drawn frame while anchored: a performance is a function of its
 * samples alone. [frame] after create; no allocation then. */
#ifndef MAROTTE_STAGE_PERFORMER_H
#define MAROTTE_STAGE_PERFORMER_H
#include "csrbf/shape.h"
#include "hand/filter.h"
#include "hand/hand.h"
#include "mesh/mesh.h"
#include "stage/instance.h"

typedef struct performer performer;

typedef struct performer_settings {
    csrbf_settings solver; /* radius: used when a pull names none; 0: a quarter of the height */
    double hand_length_mm; /* 0: 190 */
} performer_settings;

/* [main] The mesh and the mapping must outlive it; the mapping is activated and reset. */
CHECKED mrt_result performer_create(performer **out, const mesh *face, instance *mapping,
                                    const performer_settings *settings, error *err);
void performer_destroy(performer *self); /* deactivates the mapping; NULL is fine */

/* Which channel feeds what. Made once per input; calibration: counts or rad, by the unit. */
typedef struct channel_route {
    uint32_t count;
    uint32_t semantic[MRT_MAX_CHANNELS], hand[MRT_MAX_CHANNELS];
    hand_calibration calibration[2]; /* left, right */
} channel_route;
void channel_route_init(channel_route *out, const mrt_channel *channel, uint32_t count);

/* Steps 3 to 6, and 7 while unanchored. A sample older than the last one counts as simultaneous. */
void performer_sample(performer *self, const channel_route *route, const mrt_sample *sample);
/* Step 7 for drawing: the shape shown and its normals. */
void performer_draw(performer *self);

/* The shape after performer_draw, in the engine's order; the order leads back to the file's. */
const shape *performer_shape(const performer *self);
const float *performer_normal(const performer *self, uint32_t axis); /* engine's order */
/* What the mapping pulls, after the guard, and the displacements of the anchored engagement
 * (control_count of the shape by 3). */
const mrt_pull *performer_pull(const performer *self);
const double *performer_displacement(const performer *self);
/* Grows by one at each engagement of anchored starts and at each commit: a new base. */
uint32_t performer_engagement(const performer *self);
bool performer_is_anchored(const performer *self);

typedef struct performer_counts {
    uint64_t samples;
    uint64_t bad_pulls;     /* the guard held the last good pull */
    uint64_t held_pulls;    /* the engine could not use a pull: the shape was held */
    uint64_t limited_steps; /* unanchored: the tips were faster than the substeps allow */
    uint64_t folded_steps;  /* unanchored: steps with a determinant <= 0 */
    uint64_t substeps;
    uint64_t engagements, commits;
    double min_determinant; /* unanchored: the smallest seen, 1 before any */
    error first_problem;    /* what the guard or the engine said first; "" none */
} performer_counts;
const performer_counts *performer_counted(const performer *self);

#endif
