/* stage/playback/activity.h - how strongly a recorded performance moves the face over time, for the
 * lanes of a timeline. Computed from the samples in small parts, so that other work can run between
 * them. Continues while the performance is still being recorded. One thread at a time, any that may
 * read the show. */
#ifndef MAROTTE_STAGE_ACTIVITY_H
#define MAROTTE_STAGE_ACTIVITY_H
#include "stage/playback/replay.h"
#include "show/own.h"

typedef struct activity activity;

/* Measures the control vectors and degrees of freedom of a performance or a part of it, for each
 * region of the face (own.h) and for all of it. world: as for replay_open; must outlive the
 * activity. */
CHECKED mrt_result activity_create(activity **out, const replay_world *world, int64_t performance,
                                   take_part part, error *err);
void activity_destroy(activity *self); /* accepts NULL */
/* Performs up to samples_max further samples. MRT_OK: more samples are left. MRT_END: it has
 * processed every recorded sample. */
CHECKED mrt_result activity_step(activity *self, uint32_t samples_max, error *err);

enum { ACTIVITY_LANES = OWN_REGION_COUNT + 1 }; /* the last lane: the whole face */
typedef struct activity_bin {
    /* offset of the lane from neutral: root mean square over its controls; 1 is a tenth of the
     * height of the face, or the end of a degree of freedom */
    float least, greatest;
} activity_bin;
/* Reads the source time from_ns..to_ns (0: start of the performance) in `count` equal bins. A bin
 * that is not known yet has least > greatest. */
void activity_read(const activity *self, uint32_t lane, int64_t from_ns, int64_t to_ns,
                   uint32_t count, activity_bin *out);
int64_t activity_known_ns(const activity *self); /* source time up to which the activity is known */

#endif
