/* stage/input/sample_source.h - interface of a source of samples in time order: a device, a
 * recording, the pointer, a track of a show. Called by perform/scheduler.h on its thread. */
#ifndef MAROTTE_STAGE_SAMPLE_SOURCE_H
#define MAROTTE_STAGE_SAMPLE_SOURCE_H
#include "base/error.h"

typedef struct sample_source {
    void *self;
    const char *name; /* input_name, for sources with channels; must outlive the source */
    /* Copies the oldest unread sample and the version of its channels. MRT_TIMEOUT: none now;
     * MRT_END: the source has ended. */
    mrt_result (*peek)(void *self, mrt_sample *out, uint32_t *out_version, error *err);
    void (*take)(void *self); /* removes the sample of the last peek */
    /* Returns the channels of a version. NULL: one route is valid for all samples. */
    const mrt_channel *(*channels)(void *self, uint32_t version, uint32_t *out_count);
    uint32_t voice; /* performer voice of the samples (perform/performer.h) */
    /* Returns when a sample is due in the clock of the performer, such as the timeline of a clip.
     * INT64_MAX: never. NULL: at the time of the sample. */
    int64_t (*due_ns)(void *clock, int64_t sample_ns);
    void *clock;
} sample_source;

#endif
