#include "form.h"
#include "plan.h"

#include <math.h>
#include <stddef.h>

typedef struct blob { /* an ellipsoid, melted into what came before it */
    vec3 centre, radius;
    double melt_mm;
} blob;

static const blob CRANIUM = {{0, 42, -12}, {92, 88, 88}, 0};

static const blob MIDDLE[] = {
    {{0, -36, 24}, {91, 54, 70}, 64}, /* the muzzle: wide, for the mouth */
    {{0, -66, 28}, {62, 30, 58}, 26}, /* the chin */
    {{0, 24, 80}, {21, 17.5, 23}, 7}, /* the nose */
};

static const blob PAIRS[] = {
    {{58, -8, 44}, {34, 30, 34}, 24},  /* cheeks */
    {{34, 104, 32}, {28, 11, 13}, 30}, /* the ridge that carries the brows */
};

static const double MOUND_RADIUS_MM = 35.0, MOUND_BEHIND_MM = 15.0, MOUND_MELT_MM = 18.0;

static double length_of(vec3 a)
{
    return sqrt(vec3_dot(a, a));
}

static double ellipsoid(vec3 p, const blob *b)
{
    vec3 q = vec3_sub(p, b->centre);
    vec3 once = {q.x / b->radius.x, q.y / b->radius.y, q.z / b->radius.z};
    vec3 twice = {once.x / b->radius.x, once.y / b->radius.y, once.z / b->radius.z};
    double k = length_of(once), slope = length_of(twice);
    return slope > 1e-9 ? k * (k - 1.0) / slope : -b->radius.y;
}

/* The smaller of two, rounded where they differ by less than melt_mm. */
static double melted(double a, double b, double melt_mm)
{
    double near = 1.0 - fabs(a - b) / melt_mm;
    double least = a < b ? a : b;
    return near > 0.0 ? least - near * near * near * melt_mm / 6.0 : least;
}

static vec3 mirrored(vec3 p)
{
    return (vec3){-p.x, p.y, p.z};
}

/* Both of a pair are melted together first: the order would show. */
static double pair(vec3 p, const blob *b)
{
    return melted(ellipsoid(p, b), ellipsoid(mirrored(p), b), b->melt_mm);
}

static double mound(vec3 p)
{
    vec3 centre = vec3_sub(PLAN_EYE, vec3_scale(plan_eye_axis(), MOUND_BEHIND_MM));
    return length_of(vec3_sub(p, centre)) - MOUND_RADIUS_MM;
}

static double neck(vec3 p)
{
    double below = (p.y - PLAN_NECK_Y) / 60.0;
    double radius = 40.0 + 6.0 / (1.0 + below * below * 6.0);
    double z = p.z - PLAN_NECK_Z;
    double side = sqrt(p.x * p.x + z * z) - radius;
    return fmax(side, p.y + 20.0); /* its upper end is deep in the head */
}

double form_distance(vec3 p)
{
    double d = ellipsoid(p, &CRANIUM);
    for (size_t i = 0; i < sizeof MIDDLE / sizeof *MIDDLE; ++i)
        d = melted(d, ellipsoid(p, &MIDDLE[i]), MIDDLE[i].melt_mm);
    for (size_t i = 0; i < sizeof PAIRS / sizeof *PAIRS; ++i)
        d = melted(d, pair(p, &PAIRS[i]), PAIRS[i].melt_mm);
    double mounds = melted(mound(p), mound(mirrored(p)), MOUND_MELT_MM);
    d = melted(d, mounds, MOUND_MELT_MM);
    return melted(d, neck(p), 30.0);
}

static vec3 gradient(vec3 p)
{
    const double step = 0.02;
    double x =
        form_distance((vec3){p.x + step, p.y, p.z}) - form_distance((vec3){p.x - step, p.y, p.z});
    double y =
        form_distance((vec3){p.x, p.y + step, p.z}) - form_distance((vec3){p.x, p.y - step, p.z});
    double z =
        form_distance((vec3){p.x, p.y, p.z + step}) - form_distance((vec3){p.x, p.y, p.z - step});
    return vec3_scale((vec3){x, y, z}, 1.0 / (2.0 * step));
}

vec3 form_normal(vec3 p)
{
    return vec3_normalised(gradient(p), (vec3){0, 0, 1});
}

vec3 form_projected(vec3 p)
{
    for (int turn = 0; turn < 6; ++turn) {
        double d = form_distance(p);
        if (fabs(d) < 1e-6)
            break;
        vec3 slope = gradient(p);
        double square = fmax(vec3_dot(slope, slope), 0.05);
        p = vec3_sub(p, vec3_scale(slope, d / square));
    }
    return p;
}

vec3 form_along(vec3 p, vec3 direction)
{
    for (int turn = 0; turn < 40; ++turn) {
        double d = form_distance(p);
        if (fabs(d) < 1e-6)
            break;
        double slope = fmax(vec3_dot(gradient(p), direction), 0.4);
        p = vec3_sub(p, vec3_scale(direction, d / slope));
    }
    return p;
}

vec3 form_lifted(vec3 p, double lift_mm)
{
    vec3 foot = form_projected(p);
    return vec3_add(foot, vec3_scale(form_normal(foot), lift_mm));
}
