#include "form.h"
#include "skin.h"

#include <math.h>

double form_wanted_mm(const form *shape, vec3 p)
{
    return shape->edge_scale * shape->edge_mm(p);
}

vec3 form_gradient(const form *shape, vec3 p)
{
    const double step = 0.02;
    vec3 plus[3] = {{p.x + step, p.y, p.z}, {p.x, p.y + step, p.z}, {p.x, p.y, p.z + step}};
    vec3 minus[3] = {{p.x - step, p.y, p.z}, {p.x, p.y - step, p.z}, {p.x, p.y, p.z - step}};
    double slope[3];
    for (int k = 0; k < 3; ++k)
        slope[k] = (shape->distance(plus[k]) - shape->distance(minus[k])) / (2.0 * step);
    return (vec3){slope[0], slope[1], slope[2]};
}

vec3 form_masked(vec3 move, int hold)
{
    if (hold & (SKIN_MIDDLE | SKIN_CORNER))
        move.x = 0.0;
    if (hold & (SKIN_LEVEL | SKIN_CORNER))
        move.y = 0.0;
    return move;
}

vec3 form_projected(const form *shape, vec3 p, int hold, double reach_mm)
{
    for (int turn = 0; turn < 3; ++turn) {
        vec3 slope = form_masked(form_gradient(shape, p), hold);
        double square = vec3_dot(slope, slope);
        if (square < 0.01)
            break;
        double step = shape->distance(p) / square;
        double length = fabs(step) * sqrt(square);
        if (length > reach_mm)
            step *= reach_mm / length;
        p = vec3_sub(p, vec3_scale(slope, step));
    }
    return p;
}
