/* stage/mapping/guard.h - phase 6 of a frame: checks the pull of a mapping. Pure. */
#ifndef MAROTTE_STAGE_GUARD_H
#define MAROTTE_STAGE_GUARD_H
#include "base/rigid.h"

#include <marotte/plugin.h>

typedef struct guard {
    uint32_t contact_count; /* of the face */
    vec3 centre;
    double reach_mm; /* no vector leads further from `centre` */
} guard;

/* Says what is wrong with a pull; NULL: nothing. */
const char *guard_fault(const guard *self, const mrt_pull *pull);

#endif
