/* stage/mapping/guard.h - phase 6 of a frame: checks whether a pull is valid. Pure. */
#ifndef MAROTTE_STAGE_GUARD_H
#define MAROTTE_STAGE_GUARD_H
#include "base/rigid.h"

#include <marotte/plugin.h>

typedef struct guard {
    uint32_t contact_count; /* of the face */
    vec3 centre;
    double reach_mm; /* maximum distance of a vector from `centre` */
} guard;

/* Describes the error of a pull. NULL: it is valid. */
const char *guard_fault(const guard *self, const mrt_pull *pull);
/* Returns a pull that moves nothing. */
mrt_pull guard_idle(void);

#endif
