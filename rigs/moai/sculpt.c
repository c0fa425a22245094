#include "sculpt.h"

#include <math.h>

const vec3 SCULPT_LOW = {-80.0, -150.0, -80.0}, SCULPT_HIGH = {80.0, 150.0, 90.0};
const vec3 SCULPT_LINE_END[SCULPT_LINES] = {
    {27.0, -54.0, 20.0},   /* between the lips */
    {26.0, -51.8, 20.0},   /* upper lip */
    {26.0, -56.2, 20.0},   /* lower lip */
    {51.0, 65.1, 34.0},    /* edge of the brow */
    {80.0, -149.7, -80.0}, /* rim of the base */
    {80.0, -145.5, -80.0}, /* a band above it, which keeps its shading narrow */
};

static const double LIP_LINE_Y = -54.0, BROW_Y = 64.0;

/* ---- tools ---- */

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

static double clamped(double value, double low, double high)
{
    return smaller(larger(value, low), high);
}

/* Returns the smaller value, rounded within `blend_mm` of the place where both are equal. */
static double joined(double a, double b, double blend_mm)
{
    double h = larger(blend_mm - fabs(a - b), 0.0) / blend_mm;
    return smaller(a, b) - h * h * blend_mm * 0.25;
}

static double common(double a, double b, double blend_mm)
{
    return -joined(-a, -b, blend_mm);
}

static double carved(double stone, double tool, double blend_mm)
{
    return common(stone, -tool, blend_mm);
}

/* Knots of a smooth curve in ascending y. It does not overshoot, and is constant beyond its
 * ends. */
typedef struct knot {
    double y, value;
} knot;

static double knot_slope(const knot *k, int count, int i)
{
    if (i == 0 || i == count - 1)
        return 0.0;
    double before = (k[i].value - k[i - 1].value) / (k[i].y - k[i - 1].y);
    double after = (k[i + 1].value - k[i].value) / (k[i + 1].y - k[i].y);
    return before * after <= 0.0 ? 0.0 : 2.0 * before * after / (before + after);
}

static double curve(const knot *k, int count, double y)
{
    if (y <= k[0].y)
        return k[0].value;
    if (y >= k[count - 1].y)
        return k[count - 1].value;
    int i = 0;
    while (y > k[i + 1].y)
        ++i;
    double width = k[i + 1].y - k[i].y, t = (y - k[i].y) / width;
    double a = width * knot_slope(k, count, i), b = width * knot_slope(k, count, i + 1);
    double rise = k[i + 1].value - k[i].value;
    return k[i].value + t * (a + t * (3.0 * rise - 2.0 * a - b + t * (a + b - 2.0 * rise)));
}

#define CURVE(knots, y) curve(knots, (int)(sizeof(knots) / sizeof(knots)[0]), y)

static double box2(double x, double y, double half_x, double half_y, double radius)
{
    double qx = fabs(x) - half_x + radius, qy = fabs(y) - half_y + radius;
    double ox = larger(qx, 0.0), oy = larger(qy, 0.0);
    return sqrt(ox * ox + oy * oy) + smaller(larger(qx, qy), 0.0) - radius;
}

static double box3(vec3 p, vec3 half, double radius)
{
    double qx = fabs(p.x) - half.x + radius, qy = fabs(p.y) - half.y + radius;
    double qz = fabs(p.z) - half.z + radius;
    vec3 out = {larger(qx, 0.0), larger(qy, 0.0), larger(qz, 0.0)};
    return vec3_length(out) + smaller(larger(qx, larger(qy, qz)), 0.0) - radius;
}

/* Returns the distance to the surface of an ellipsoid, accurate near it. */
static double ellipsoid(vec3 p, vec3 radii)
{
    vec3 k = {p.x / radii.x, p.y / radii.y, p.z / radii.z};
    vec3 g = {k.x / radii.x, k.y / radii.y, k.z / radii.z};
    double k0 = vec3_length(k), k1 = vec3_length(g);
    return k1 < 1e-9 ? -smaller(radii.x, smaller(radii.y, radii.z)) : k0 * (k0 - 1.0) / k1;
}

static double segment(vec3 p, vec3 a, vec3 b, double radius_a, double radius_b)
{
    vec3 ab = vec3_sub(b, a), ap = vec3_sub(p, a);
    double t = clamped(vec3_dot(ap, ab) / vec3_dot(ab, ab), 0.0, 1.0);
    return vec3_length(vec3_sub(ap, vec3_scale(ab, t))) - (radius_a + (radius_b - radius_a) * t);
}

static vec3 from(vec3 p, double x, double y, double z)
{
    return (vec3){p.x - x, p.y - y, p.z - z};
}

/* ---- the parts; they require p.x >= 0 ---- */

/* The block of the head: an outline lofted along y, with a nearly flat top and the jaw as a ledge
 * below. */
static double block(vec3 p)
{
    static const knot HALF_WIDTH[] = {{-112, 48}, {-90, 52}, {-60, 54}, {-10, 53},
                                      {40, 53},   {78, 54},  {110, 51}, {150, 43}};
    static const knot FRONT[] = {{-112, 42}, {-70, 41}, {-10, 37}, {30, 33}, {58, 34},
                                 {76, 43},   {95, 45},  {120, 41}, {150, 31}};
    static const knot BACK[] = {{-112, -46}, {-60, -54}, {0, -60},
                                {60, -62},   {110, -58}, {150, -48}};
    static const knot ROUND[] = {{-112, 20}, {-60, 26}, {0, 28}, {55, 28}, {80, 22}, {150, 20}};
    double front = CURVE(FRONT, p.y), back = CURVE(BACK, p.y);
    double side = box2(p.x, p.z - 0.5 * (front + back), CURVE(HALF_WIDTH, p.y),
                       0.5 * (front - back), CURVE(ROUND, p.y));
    double top = p.y - 150.0 + 0.0014 * (p.x * p.x + (p.z + 4.0) * (p.z + 4.0));
    double jaw = (-112.0 - p.y + 0.24 * (55.0 - p.z)) * 0.97;
    return common(common(side, top, 14.0), jaw, 7.0);
}

static double neck(vec3 p)
{
    static const knot HALF_WIDTH[] = {{-150, 51}, {-130, 46}, {-108, 43}, {-60, 44}};
    static const knot FRONT[] = {{-150, 26}, {-130, 19}, {-108, 14}, {-60, 15}};
    static const knot BACK[] = {{-150, -58}, {-110, -52}, {-60, -52}};
    double front = CURVE(FRONT, p.y), back = CURVE(BACK, p.y);
    double side =
        box2(p.x, p.z - 0.5 * (front + back), CURVE(HALF_WIDTH, p.y), 0.5 * (front - back), 26.0);
    return larger(side, p.y + 60.0);
}

/* A straight ledge that overhangs the eyes and rises into the forehead. */
static double brow(vec3 p)
{
    static const knot FACE[] = {{-6, 60}, {2, 61}, {12, 60}, {22, 55}, {44, 30}};
    double y = p.y - BROW_Y;
    double face = p.z - CURVE(FACE, y) + 0.0056 * p.x * p.x;
    double ledge = common(face * 0.9, -y, 4.0);
    return common(ledge, larger(larger(p.x - 54.0, -30.0 - p.z), y - 44.0), 5.0);
}

static double nose(vec3 p)
{
    static const knot RIDGE[] = {{-28, 70}, {-20, 77}, {-10, 76.5}, {12, 65},
                                 {38, 57},  {58, 56},  {72, 54}};
    static const knot HALF_WIDTH[] = {{-28, 19}, {-14, 18},  {10, 13.5},
                                      {38, 11},  {58, 12.5}, {72, 18}};
    double ridge = CURVE(RIDGE, p.y), half = CURVE(HALF_WIDTH, p.y);
    /* The sides slope outwards towards the cheek. */
    double slope = half + 0.18 * clamped(ridge - p.z, 0.0, 40.0);
    double side = box2(p.x, p.z - 0.5 * (ridge + 10.0), slope, 0.5 * (ridge - 10.0), 5.0) * 0.97;
    double under = (-27.0 - p.y - 0.10 * (p.z - 60.0)) * 0.99;
    return common(common(side, under, 5.0), p.y - 74.0, 4.0);
}

/* The wing as a roll that curls like a fish hook: from the tip back along the nostril, up the cheek
 * and forward again. */
static double nose_wing(vec3 p)
{
    static const vec3 PATH[] = {{15, -22, 67}, {22.5, -22.5, 57}, {27, -19, 47},
                                {28, -10, 44}, {24, -2.5, 49},    {18.5, -1.5, 59}};
    static const double RADIUS[] = {5.0, 5.7, 5.7, 5.2, 4.7, 3.2};
    double d =
        ellipsoid(from(p, 22.0, -12.0, 40.0), (vec3){8.0, 10.0, 9.0}); /* the base of the roll */
    for (int i = 0; i < 5; ++i)
        d = joined(d, segment(p, PATH[i], PATH[i + 1], RADIUS[i], RADIUS[i + 1]), 1.5);
    return d;
}

static double nostril(vec3 p)
{
    return ellipsoid(from(p, 12.0, -30.0, 59.0), (vec3){6.0, 7.0, 9.0});
}

/* The long socket under the brow. Its floor slopes out to the cheek. */
static double eye(vec3 p)
{
    double x = p.x - 29.0, y = p.y - 52.0;
    double floor = 14.0 - 0.10 * x - 0.80 * y;
    double hollow = box2(x, y, 18.5, 17.0, 11.0);
    return common(hollow, (floor - p.z) * 0.8, 5.0);
}

/* Two thin rolls that taper to the corners. The valley between them is level. */
static double lips(vec3 p)
{
    double bend = 0.011 * p.x * p.x, taper = larger(1.0 - 0.00045 * p.x * p.x, 0.2);
    double rise = p.y - LIP_LINE_Y;
    vec3 upper = {p.x, rise - 5.0 * taper, p.z + bend - 47.0};
    vec3 lower = {p.x, rise + 5.6 * taper, p.z + bend - 46.5};
    double a = box3(upper, (vec3){29.0, 5.0 * taper, 14.0}, 4.7 * taper);
    double b = box3(lower, (vec3){28.0, 5.6 * taper, 13.5}, 5.0 * taper);
    return joined(a, b, 1.2);
}

static double muzzle(vec3 p)
{
    return ellipsoid(from(p, 0.0, -54.0, 36.0), (vec3){44.0, 24.0, 15.0});
}

static double chin(vec3 p)
{
    double bend = 0.0065 * p.x * p.x;
    double y = p.y + 92.0;
    vec3 q = {p.x, y, p.z + bend - 40.0 + 0.16 * y};
    return box3(q, (vec3){42.0, 18.0, 22.0}, 6.0);
}

/* A long ear that leans back: a plate with a rim around it, the hollow of the ear above, and the
 * stretched lobe with its slot below. It stands out most at the top of the hollow and at the
 * lobe. */
static double ear(vec3 p)
{
    static const knot HALF_DEPTH[] = {{-86, 12.5}, {-62, 14.5}, {-24, 11}, {24, 14}, {62, 12.5}};
    static const knot REACH[] = {{-88, 57}, {-62, 62}, {-22, 58.5}, {14, 60}, {46, 63}, {66, 57.5}};
    double z = p.z + 14.0 + 0.06 * (p.y + 10.0), reach = CURVE(REACH, p.y);
    double outline = box2(z, p.y + 12.0, CURVE(HALF_DEPTH, p.y), 74.0, 11.0);
    double plate = common(outline, p.x - reach + 2.0, 7.0);
    double rim = common(fabs(outline + 4.2) - 4.2, p.x - reach - 2.5, 6.0);
    double hollow = ellipsoid((vec3){p.x - 61.5, p.y - 27.0, z - 0.5}, (vec3){8.0, 24.0, 7.5});
    double slot = ellipsoid((vec3){p.x - 61.0, p.y + 60.0, z}, (vec3){7.5, 14.0, 6.5});
    return carved(joined(plate, rim, 4.0), smaller(hollow, slot), 4.0);
}

double sculpt_rough_distance(vec3 p)
{
    p.x = fabs(p.x);
    double stone = block(p);
    stone = joined(stone, muzzle(p), 14.0);
    stone = joined(stone, chin(p), 14.0);
    stone = carved(stone, eye(p), 3.0);
    stone = joined(stone, brow(p), clamped(0.4 * (p.y - BROW_Y), 2.5, 10.0));
    stone = joined(stone, nose(p), 5.0);
    stone = joined(stone, nose_wing(p), 3.0);
    stone = joined(stone, lips(p), 4.0);
    stone = joined(stone, ear(p), 8.0);
    stone = joined(stone, neck(p), 6.0);
    return common(stone, -150.0 - p.y, 1.5);
}

double sculpt_distance(vec3 p)
{
    return carved(sculpt_rough_distance(p), nostril((vec3){fabs(p.x), p.y, p.z}), 2.5);
}

/* ---- wanted length of edges ---- */

typedef struct detail {
    vec3 centre, half; /* a box around x = +-centre.x */
    double edge_mm;
} detail;

double sculpt_edge_mm(vec3 p)
{
    static const detail DETAILS[] = {
        {{0, -54, 54}, {29, 3, 8}, 2.2},    /* between the lips */
        {{0, -54, 52}, {30, 9, 12}, 2.9},   /* lips */
        {{0, -18, 58}, {28, 14, 20}, 3.1},  /* tip and wings of the nose */
        {{0, 25, 50}, {18, 45, 16}, 4.2},   /* bridge of the nose */
        {{32, 52, 42}, {22, 16, 16}, 4.2},  /* eye */
        {{0, 70, 50}, {54, 8, 14}, 4.2},    /* brow */
        {{0, -94, 50}, {42, 18, 14}, 5.0},  /* chin */
        {{0, -10, 40}, {46, 95, 16}, 5.8},  /* cheeks, forehead */
        {{62, -12, -13}, {5, 76, 16}, 5.2}, /* ear */
        {{50, -98, 0}, {8, 8, 40}, 6.0},    /* jaw */
        {{0, 138, -6}, {40, 10, 40}, 8.5},  /* crown */
        {{50, -150, -16}, {4, 2, 34}, 7.0}, /* rim of the base: sides, front, back */
        {{0, -150, 24}, {46, 2, 4}, 7.0},   {{0, -150, -56}, {46, 2, 4}, 7.0},
    };
    const double growth = 0.21, coarsest_mm = 14.0;
    p.x = fabs(p.x);
    double edge = coarsest_mm;
    for (int i = 0; i < (int)(sizeof DETAILS / sizeof DETAILS[0]); ++i) {
        const detail *d = &DETAILS[i];
        vec3 out = {larger(fabs(p.x - d->centre.x) - d->half.x, 0.0),
                    larger(fabs(p.y - d->centre.y) - d->half.y, 0.0),
                    larger(fabs(p.z - d->centre.z) - d->half.z, 0.0)};
        edge = smaller(edge, d->edge_mm + growth * vec3_length(out));
    }
    return edge;
}
