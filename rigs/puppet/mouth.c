#include "mouth.h"
#include "form.h"

#include <math.h>
#include <string.h>

enum { LAST = MOUTH_POINTS - 1, BAG_STEPS = 2 };

/* A column goes from the face over the lip and along the bag to its back. */
typedef struct column {
    vec3 slit;          /* on the middle of the slit, below the face */
    vec3 outward, away; /* unit: out of the face, and from the slit into the lip */
    double radius_mm;   /* of the lip's cord */
    double corner;      /* 0: the lip is round as its cord; 1: it runs out into the corner */
    double bend;       /* 1/mm: how the face rises from the slit, over the square of the way away */
    double across, up; /* on the bag's section: -1..1 of its half width and height */
} column;

static const double GAP_MM = 0.05; /* from the middle of the slit to either lip: they just part */
static const double UPPER_RADIUS_MM = 6.55, LOWER_RADIUS_MM = 7.95, CORNER_RADIUS_MM = 3.6;
static const double SUNK_MM = 2.0, CORNER_SUNK_MM = 1.2; /* of the slit below the face */
static const double LEDGE_MM = 0.25; /* the lower lip's behind the rims: no light comes through */
static const double CORNER_TILT_DEG = 50.0;
static const double CORNER_FROM = 0.55;  /* of the way to the corner */
static const double OUTLINE_RADII = 2.6; /* from the slit to where the lip leaves the face */

/* A section from where the lip leaves the face over its front to the rim, where the lips meet, and
 * on to the back. */
typedef struct lip_ring {
    double cord_deg;                   /* around the cord; -90 is nearest to the slit */
    double corner_away, corner_out_mm; /* at the corner: of the way to the outline; off the slit */
} lip_ring;

static const lip_ring LIP[] = {
    {64, 0.86, 1.5},  {38, 0.66, 1.9}, {12, 0.45, 1.9},    {-14, 0.24, 1.4},   {-40, 0.155, 0.95},
    {-65, 0.08, 0.5}, {-90, 0.0, 0.0}, {-113, 0.15, -1.2}, {-138, 0.26, -3.4},
};
enum { LIP_RINGS = sizeof LIP / sizeof *LIP, COLOURED_FROM = 3, RIM = 6 };

/* The bag's sections from the lips to the back. */
typedef struct station {
    double depth; /* 0 at the lips, 1 at the back */
    double half_width_mm, above_mm, below_mm;
} station;

static const station STATION[] = {
    {0.00, 58.5, 9, 10}, {0.03, 61, 18, 20}, {0.12, 65, 24, 25}, {0.30, 67, 26, 27},
    {0.52, 65, 26, 27},  {0.75, 59, 24, 25}, {0.92, 49, 18, 19}, {1.00, 38, 10, 11},
};
enum { STATIONS = sizeof STATION / sizeof *STATION };
static const double BACK_Z = 14.0;

static double line_y(double x)
{
    double s = x / PLAN_MOUTH_REACH;
    return PLAN_MOUTH_Y + PLAN_CORNER_RISE * s * s;
}

static double mixed(double a, double b, double t)
{
    return a + (b - a) * t;
}

static double fourth_root(double a)
{
    return sqrt(sqrt(fmax(a, 0.0)));
}

static double smooth_step(double from, double to, double at)
{
    double t = fmax(0.0, fmin(1.0, (at - from) / (to - from)));
    return t * t * (3.0 - 2.0 * t);
}

/* Along the lips: s from 0 at the middle to 1 at the corner. */
static column straight_column(double s, double sign, double *out_tilt_deg)
{
    double radius = sign > 0.0 ? UPPER_RADIUS_MM : LOWER_RADIUS_MM;
    column c = {.radius_mm = mixed(radius, CORNER_RADIUS_MM, s * s),
                .corner = smooth_step(CORNER_FROM, 1.0, s),
                .across = 0.93 * s * (1.1 - 0.1 * s)};
    double a2 = c.across * c.across;
    c.up = sign * fourth_root(1.0 - a2 * a2);
    *out_tilt_deg = sign * mixed(90.0, CORNER_TILT_DEG, s * s * s * s);
    return c;
}

/* Around the corner: t from 0 at its lower to 1 at its upper end. */
static column corner_column(double t, double *out_tilt_deg)
{
    const double end = fourth_root(1.0 - 0.93 * 0.93 * 0.93 * 0.93);
    column c = {.radius_mm = CORNER_RADIUS_MM, .corner = 1.0, .up = end * (2.0 * t - 1.0)};
    double u2 = c.up * c.up;
    c.across = fourth_root(1.0 - u2 * u2);
    *out_tilt_deg = CORNER_TILT_DEG * (2.0 * t - 1.0);
    return c;
}

static vec3 beside(const column *c, double away_mm, double out_mm)
{
    double rise_mm = c->bend * away_mm * away_mm;
    vec3 shift = vec3_add(vec3_scale(c->away, away_mm), vec3_scale(c->outward, out_mm + rise_mm));
    return vec3_add(c->slit, shift);
}

static double outline_mm(const column *c)
{
    return OUTLINE_RADII * c->radius_mm;
}

static column column_at(int32_t i)
{
    const int32_t columns = PLAN_MOUTH_COLUMNS, rows = PLAN_MOUTH_ROWS;
    double tilt_deg, s = 1.0;
    column c;
    if (i <= columns)
        c = straight_column(s = (double)i / columns, -1.0, &tilt_deg);
    else if (i < columns + rows)
        c = corner_column((double)(i - columns) / rows, &tilt_deg);
    else
        c = straight_column(s = (double)(LAST - i) / columns, 1.0, &tilt_deg);
    double x = PLAN_MOUTH_REACH * (s + 0.12 * s * (1.0 - s));
    vec3 foot = form_along((vec3){x, line_y(x), 60.0}, (vec3){0, 0, 1});
    vec3 normal = form_normal(foot);
    normal.y = 0.0;
    c.outward = vec3_normalised(normal, (vec3){0, 0, 1});
    angle_sincos tilt = plan_degrees(tilt_deg);
    c.away = (vec3){c.outward.z * tilt.cos, tilt.sin, -c.outward.x * tilt.cos};
    c.slit = vec3_sub(foot, vec3_scale(c.outward, mixed(SUNK_MM, CORNER_SUNK_MM, s * s * s * s)));
    vec3 outline = form_projected(beside(&c, outline_mm(&c), 0.0));
    double rise_mm = vec3_dot(vec3_sub(outline, foot), c.outward);
    c.bend = rise_mm / (outline_mm(&c) * outline_mm(&c));
    return c;
}

static vec3 lip_point(const column *c, int32_t k)
{
    angle_sincos a = plan_degrees(LIP[k].cord_deg);
    double round_mm = GAP_MM + c->radius_mm * (1.0 + a.sin), out_mm = c->radius_mm * a.cos;
    double away_mm = mixed(round_mm, LIP[k].corner_away * outline_mm(c), c->corner);
    if (k == RIM + 1 && c->up < 0.0 && c->corner < 1.0)
        away_mm = -LEDGE_MM;
    return beside(c, away_mm, mixed(out_mm, LIP[k].corner_out_mm, c->corner));
}

void mouth_outline(vec3 out_point[MOUTH_POINTS], double away_mm)
{
    for (int32_t i = 0; i < MOUTH_POINTS; ++i) {
        column c = column_at(i);
        out_point[i] = form_projected(beside(&c, outline_mm(&c) + away_mm, 0.0));
    }
}

static vec3 station_point(const column *c, const station *at)
{
    double front = lip_point(c, LIP_RINGS - 1).z;
    double height = c->up > 0.0 ? at->above_mm : at->below_mm;
    double x = at->half_width_mm * c->across;
    double level = mixed(line_y(x), PLAN_MOUTH_Y, at->depth);
    return (vec3){x, level + height * c->up, mixed(front, BACK_Z, at->depth)};
}

/* Catmull and Rom's curve from b to c. */
static vec3 curve(vec3 a, vec3 b, vec3 c, vec3 d, double t)
{
    vec3 leave = vec3_scale(vec3_sub(c, a), 0.5), arrive = vec3_scale(vec3_sub(d, b), 0.5);
    double t2 = t * t, t3 = t2 * t;
    vec3 ends = vec3_add(vec3_scale(b, 2 * t3 - 3 * t2 + 1), vec3_scale(c, 3 * t2 - 2 * t3));
    vec3 slopes = vec3_add(vec3_scale(leave, t3 - 2 * t2 + t), vec3_scale(arrive, t3 - t2));
    return vec3_add(ends, slopes);
}

/* `step` counts rings behind the lips, from 1. */
static vec3 bag_point(const column *c, int32_t step)
{
    vec3 knot[STATIONS + 3];
    knot[0] = lip_point(c, LIP_RINGS - 2);
    knot[1] = lip_point(c, LIP_RINGS - 1);
    for (int32_t i = 0; i < STATIONS; ++i)
        knot[i + 2] = station_point(c, &STATION[i]);
    vec3 inwards = vec3_sub(knot[STATIONS + 1], knot[STATIONS]);
    knot[STATIONS + 2] = vec3_add(knot[STATIONS + 1], inwards);
    int32_t span = (step - 1) / BAG_STEPS;
    double t = (double)((step - 1) % BAG_STEPS + 1) / BAG_STEPS;
    return curve(knot[span], knot[span + 1], knot[span + 2], knot[span + 3], t);
}

/* The floor of the bag carries the lower gum, its roof the upper one. */
static void mark_bag(sheet *s, const ring *r, int32_t step)
{
    int32_t first = 3 * BAG_STEPS, last = 5 * BAG_STEPS;
    if (step < first || step > last)
        return;
    for (int32_t i = 0; 10 * i <= 8 * PLAN_MOUTH_COLUMNS; ++i) {
        s->bone[r->at[i]] = SHEET_JAW;
        s->bone[r->at[LAST - i]] = SHEET_SKULL;
    }
}

static ring add_ring(sheet *s, const vec3 *point, const ring *outer, int32_t part)
{
    ring r = sheet_ring(s, point, MOUTH_POINTS, 1, SHEET_FIXED);
    sheet_strip(s, outer, &r, part);
    return r;
}

/* Where the lips meet: all columns of the corner end in one point. */
static ring add_rim(sheet *s, const vec3 *point, const ring *outer)
{
    const int32_t columns = PLAN_MOUTH_COLUMNS, rows = PLAN_MOUTH_ROWS;
    ring r = {.count = MOUTH_POINTS, .is_half = 1};
    for (int32_t i = 0; i < MOUTH_POINTS; ++i) {
        int is_end = i == 0 || i == LAST, is_again = i > columns && i <= columns + rows;
        r.at[i] = is_again
                      ? r.at[columns]
                      : sheet_add_point(s, point[i], SHEET_FIXED | (is_end ? SHEET_MIDDLE : 0));
    }
    sheet_strip(s, outer, &r, PLAN_PART_LIPS);
    return r;
}

mrt_result mouth_build(sheet *s, const ring *outline, error *err)
{
    column c[MOUTH_POINTS];
    vec3 point[MOUTH_POINTS];
    ring last = *outline;
    for (int32_t i = 0; i < MOUTH_POINTS; ++i)
        c[i] = column_at(i);
    for (int32_t k = 0; k < LIP_RINGS; ++k) {
        for (int32_t i = 0; i < MOUTH_POINTS; ++i)
            point[i] = lip_point(&c[i], k);
        last = k == RIM
                   ? add_rim(s, point, &last)
                   : add_ring(s, point, &last, k > COLOURED_FROM ? PLAN_PART_LIPS : PLAN_PART_SKIN);
    }
    for (int32_t step = 1; step <= STATIONS * BAG_STEPS; ++step) {
        for (int32_t i = 0; i < MOUTH_POINTS; ++i)
            point[i] = bag_point(&c[i], step);
        last = add_ring(s, point, &last, PLAN_PART_MOUTH_BAG);
        mark_bag(s, &last, step);
    }
    int32_t first =
        sheet_close(s, &last, PLAN_MOUTH_COLUMNS, PLAN_MOUTH_ROWS, PLAN_PART_MOUTH_BAG, SHEET_FREE);
    return sheet_relax(s, first, 20, SHEET_AREA, NULL, err);
}
