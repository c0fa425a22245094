/* stage/input/sample_source.h - whoever gives samples in time order: a device, a recording, the
 * pointer, a track of a show. Asked by perform/scheduler.h, on its thread. */
#ifndef MAROTTE_STAGE_SAMPLE_SOURCE_H
#define MAROTTE_STAGE_SAMPLE_SOURCE_H
#include "base/error.h"

typedef struct sample_source {
    void *self;
    const char *name; /* of sources with channels: input_name; lives as long as it */
    /* The oldest that was not taken, and the version of its channels. MRT_TIMEOUT: none now;
     * MRT_END: none any more. */
    mrt_result (*peek)(void *self, mrt_sample *out, uint32_t *out_version, error *err);
    void (*take)(void *self); /* what was peeked last */
    /* Of a version; NULL: the route that was given holds for all of them. */
    const mrt_channel *(*channels)(void *self, uint32_t version, uint32_t *out_count);
    uint32_t voice; /* who performs them (perform/performer.h) */
    /* By the clock of who performs, when a sample of that time is due: a clip's, on the timeline.
     * INT64_MAX: never. NULL: at its own time. */
    int64_t (*due_ns)(void *clock, int64_t sample_ns);
    void *clock;
} sample_source;

#endif
