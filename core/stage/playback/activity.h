/* stage/playback/activity.h - how much a recorded performance moves the face, over its time: for the
 * lanes of a timeline. Computed in pieces beside other work, from the samples; goes on when the
 * recording does. One thread at a time, any that may read the show. */
#ifndef MAROTTE_STAGE_ACTIVITY_H
#define MAROTTE_STAGE_ACTIVITY_H
#include "stage/playback/replay.h"
#include "show/own.h"

typedef struct activity activity;

/* Of the performance's control vectors and degrees of freedom, by the parts of the face that people
 * speak of, and of all of it. world: as for replay_open; outlives it. */
CHECKED mrt_result activity_create(activity **out, const replay_world *world, int64_t performance,
                                   error *err);
void activity_destroy(activity *self); /* NULL is fine */
/* Performs up to so many further samples. MRT_OK: there are more; MRT_END: all that is recorded by
 * now was performed. */
CHECKED mrt_result activity_step(activity *self, uint32_t samples_max, error *err);

enum { ACTIVITY_LANES = OWN_REGION_COUNT + 1 }; /* the last: everything */
typedef struct activity_bin {
    float least, greatest; /* of the lane's offset from rest: root mean square over its controls,
                              1 = a tenth of the face's height, or the end of a degree of freedom */
} activity_bin;
/* Source time from..to (0: the performance's start) in `count` equal bins; bins that are not known
 * yet have least > greatest. */
void activity_read(const activity *self, uint32_t lane, int64_t from_ns, int64_t to_ns,
                   uint32_t count, activity_bin *out);
int64_t activity_known_ns(const activity *self); /* source time up to which it is known */

#endif
