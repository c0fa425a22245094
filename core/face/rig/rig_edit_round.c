#include "face/rig/rig_edit_parts.h"

#include "base/angle.h"
#include "face/rig/rig_document.h"

#include <math.h>

static const double steps_per_mm = 100.0, steps_per_degree = 100.0, steps_per_share = 1000.0,
                    steps_per_unit = 1e6;
static const double degree = ANGLE_PI / 180.0;

const vec3 rig_edit_nowhere = {(double)NAN, (double)NAN, (double)NAN};

static bool is_same(double a, double b)
{
    return a >= b && a <= b;
}

static double round_to(double value, double steps, double before)
{
    return is_same(value, before) ? before : floor(value * steps + 0.5) / steps;
}

double rig_edit_round_mm(double mm, double before)
{
    return round_to(mm, steps_per_mm, before);
}

double rig_edit_round_rad(double rad, double before)
{
    return is_same(rad, before) ? before
                                : degree * round_to(rad / degree, steps_per_degree, (double)NAN);
}

double rig_edit_round_share(double share, double before)
{
    return isnan(share) ? share : round_to(share, steps_per_share, before);
}

vec3 rig_edit_round_place(vec3 mm, vec3 before)
{
    return (vec3){rig_edit_round_mm(mm.x, before.x), rig_edit_round_mm(mm.y, before.y),
                  rig_edit_round_mm(mm.z, before.z)};
}

vec3 rig_round_axis(vec3 axis)
{
    return (vec3){floor(axis.x * steps_per_unit + 0.5) / steps_per_unit,
                  floor(axis.y * steps_per_unit + 0.5) / steps_per_unit,
                  floor(axis.z * steps_per_unit + 0.5) / steps_per_unit};
}
