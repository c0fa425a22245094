#include "mapping.h"

#include <stdlib.h>
#include <string.h>

void mapping_destroy(mrt_plugin *self)
{
    free(self);
}

void mapping_deactivate(mrt_plugin *self)
{
    (void)self;
}

void mapping_pull(mrt_pull *pull, const mrt_vector *vector, uint32_t count, float radius_mm)
{
    bool is_new = pull->mode != MRT_ANCHORED || pull->count != count;
    for (uint32_t i = 0; i < count; ++i) {
        const mrt_vector *before = &pull->vector[i];
        is_new = is_new || before->contact != vector[i].contact ||
                 memcmp(&before->start, &vector[i].start, sizeof before->start) != 0;
        pull->vector[i] = vector[i];
    }
    pull->mode = MRT_ANCHORED;
    pull->anchor += is_new;
    pull->count = count;
    pull->radius_mm = radius_mm;
    pull->gate = 0;
    pull->leak_per_s = 0.0f;
}
