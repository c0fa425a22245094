#include "face/rig/rig_teeth.h"

#include <math.h>

enum { TEETH_LEAST = 12 };
static const double reach_part = 0.8; /* of the depth of a row: lips reach no further back */
static const double flattest_mm = 0.5;

static double to_8(double x)
{
    double square = x * x, fourth = square * square;
    return fourth * fourth;
}

static double root_8(double x)
{
    return sqrt(sqrt(sqrt(x)));
}

typedef struct bounds {
    vec3 low, high;
} bounds;

static bounds bounds_of(const vec3 *p, uint32_t count)
{
    bounds b = {p[0], p[0]};
    for (uint32_t i = 1; i < count; ++i) {
        b.low = (vec3){fmin(b.low.x, p[i].x), fmin(b.low.y, p[i].y), fmin(b.low.z, p[i].z)};
        b.high = (vec3){fmax(b.high.x, p[i].x), fmax(b.high.y, p[i].y), fmax(b.high.z, p[i].z)};
    }
    return b;
}

static double flat_square(const rig_proxy *row, vec3 p)
{
    double x = (p.x - row->centre.x) / row->radii.x, z = (p.z - row->centre.z) / row->radii.z;
    return x * x + z * z;
}

/* Returns how far a point is beyond the core, as a share of the way from the core to the
 * surface. */
static double beyond(const rig_proxy *row, vec3 p)
{
    double core = rig_teeth_core(row), out = sqrt(flat_square(row, p));
    return out > core ? (out - core) / (1.0 - core) : 0.0;
}

static double size_in(const rig_proxy *row, vec3 p)
{
    return root_8(to_8(beyond(row, p)) + to_8((p.y - row->centre.y) / row->radii.y));
}

/* Sets the width that contains all teeth in front of the centre, for this depth. Returns false if
 * no width does. */
static bool widen(rig_proxy *row, const vec3 *tooth, uint32_t count)
{
    double widest = 0.0;
    for (uint32_t i = 0; i < count; ++i) {
        double z = (tooth[i].z - row->centre.z) / row->radii.z, x = tooth[i].x - row->centre.x;
        if (z < 0.0)
            continue;
        if (z > 1.0 - 1e-9 && fabs(x) > 1e-9)
            return false;
        widest = fmax(widest, fabs(x) / sqrt(fmax(1.0 - z * z, 1e-12)));
    }
    row->radii.x = widest;
    return widest > flattest_mm;
}

/* Sets the height that contains the teeth, for this width and depth. Iterates, since the core
 * depends on the height. */
static bool heighten(rig_proxy *row, const vec3 *tooth, uint32_t count, double least)
{
    row->radii.y = least;
    for (int i = 0; i < 3; ++i) {
        double highest = 0.0;
        for (uint32_t k = 0; k < count; ++k) {
            double left = 1.0 - to_8(beyond(row, tooth[k]));
            if (tooth[k].z < row->centre.z)
                continue;
            if (!(left > 1e-6))
                return false;
            highest = fmax(highest, fabs(tooth[k].y - row->centre.y) / root_8(left));
        }
        row->radii.y = highest;
    }
    return row->radii.y > flattest_mm;
}

/* Returns the mean distance of the teeth from the surface, mm along the ray from the centre. */
static double slack_of(const rig_proxy *row, const vec3 *tooth, uint32_t count, double from_z)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; ++i) {
        double size = tooth[i].z >= from_z ? size_in(row, tooth[i]) : 1.0;
        double mm = vec3_length(vec3_sub(tooth[i], row->centre));
        sum += size > 1e-6 ? (1.0 / size - 1.0) * mm : mm;
    }
    return sum / count;
}

static double up_to_tenth(double x)
{
    return ceil(10.0 * x - 1e-6) / 10.0;
}

bool rig_teeth_fit(rig_proxy *out, const vec3 *tooth, uint32_t tooth_count)
{
    double least = (double)INFINITY;
    if (tooth_count < TEETH_LEAST)
        return false;
    const bounds b = bounds_of(tooth, tooth_count);
    const double depth = b.high.z - b.low.z, front = b.high.z;
    for (int back = 8; back <= 16 && depth > flattest_mm; ++back)
        for (int bulge = 1; bulge <= 12; ++bulge)
            for (int scale = 0; scale <= 8; ++scale) {
                rig_proxy row = {.kind = PROXY_TEETH};
                row.centre = (vec3){0.5 * (b.low.x + b.high.x), 0.5 * (b.low.y + b.high.y),
                                    front - 0.1 * back * depth};
                row.radii.z = (front - row.centre.z) * (1.0 + 0.01 * bulge);
                if (!widen(&row, tooth, tooth_count))
                    continue;
                row.radii.x *= 1.0 + 0.005 * scale;
                row.radii.z *= 1.0 + 0.005 * scale;
                if (!heighten(&row, tooth, tooth_count, 0.5 * (b.high.y - b.low.y)))
                    continue;
                double slack = slack_of(&row, tooth, tooth_count, front - reach_part * depth);
                if (slack < least) {
                    least = slack;
                    *out = row;
                }
            }
    if (!isfinite(least))
        return false;
    out->centre = (vec3){round(10.0 * out->centre.x) / 10.0, round(10.0 * out->centre.y) / 10.0,
                         round(10.0 * out->centre.z) / 10.0};
    out->radii =
        (vec3){up_to_tenth(out->radii.x), up_to_tenth(out->radii.y), up_to_tenth(out->radii.z)};
    return true;
}
