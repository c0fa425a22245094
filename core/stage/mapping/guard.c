#include "stage/mapping/guard.h"

#include <math.h>
#include <stddef.h>

static bool is_within_reach(const guard *self, mrt_vec3 p)
{
    vec3 from_centre = vec3_sub((vec3){(double)p.x, (double)p.y, (double)p.z}, self->centre);
    return vec3_length(from_centre) <= self->reach_mm; /* false if not finite */
}

const char *guard_fault(const guard *self, const mrt_pull *pull)
{
    if (pull->mode > MRT_UNANCHORED)
        return "an unknown mode";
    if (pull->count > MRT_MAX_VECTORS)
        return "more vectors than are allowed";
    if (!isfinite(pull->radius_mm) || pull->radius_mm < 0.0f)
        return "a radius that is not a length";
    if (!isfinite(pull->leak_per_s) || pull->leak_per_s < 0.0f)
        return "a leak that is not a rate";
    if (!isfinite(pull->stretch_most))
        return "a stretch that is not a number";
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        if (!is_within_reach(self, v->start) || !is_within_reach(self, v->end))
            return "a control vector that is not finite or leads out of reach";
        if (v->contact > self->contact_count)
            return "a contact that the face does not have";
    }
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        if (isinf(pull->dof[i]))
            return "an infinite degree of freedom";
    return NULL;
}

mrt_pull guard_idle(void)
{
    mrt_pull out = {.mode = MRT_IDLE};
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        out.dof[i] = NAN;
    return out;
}
