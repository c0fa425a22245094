#include "mouth.h"
#include "form.h"

#include <math.h>
#include <string.h>

enum { LAST = MOUTH_POINTS - 1, BAG_STEPS = 2 };

/* A column goes from the face over the lip and along the bag to its back. */
typedef struct column {
    vec3 slit;          /* on the middle of the slit, at the depth of the lip's cord */
    vec3 outward, away; /* unit: out of the face, and from the slit into the lip */
    double radius_mm;   /* of the cord */
    double gap_mm;      /* from the middle of the slit to the lip */
    double bend;       /* 1/mm: how the face rises from the slit, over the square of the way away */
    double across, up; /* on the bag's section: -1..1 of its half width and height */
} column;

static const double GAP_MM = 1.5, CORNER_GAP_MM = 2.0;
static const double UPPER_RADIUS_MM = 6.0, LOWER_RADIUS_MM = 7.4, CORNER_RADIUS_MM = 3.6;
static const double CORNER_TILT_DEG = 50.0;
static const double OUTLINE_RADII = 2.6; /* from the slit's edge to where the lip leaves the face */
static const double SUNK = 0.3;          /* of its radius the cord lies below the face */

/* Angles around the cord, from where it leaves the face over its front and the slit to its back. */
static const double CORD_DEG[] = {64, 40, 16, -8, -32, -56, -80, -106, -136};
enum { CORD_RINGS = sizeof CORD_DEG / sizeof *CORD_DEG };

/* The bag's sections from the lips to the back. */
typedef struct station {
    double depth; /* 0 at the lips, 1 at the back */
    double half_width_mm, above_mm, below_mm;
} station;

static const station STATION[] = {
    {0.01, 58.5, 9, 10}, {0.04, 60, 18, 20}, {0.12, 61, 24, 25}, {0.30, 60, 26, 27},
    {0.52, 57, 26, 27},  {0.75, 52, 24, 25}, {0.92, 45, 18, 19}, {1.00, 36, 10, 11},
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

/* Along the lips: s from 0 at the middle to 1 beside the corner. */
static column straight_column(double s, double sign, vec3 *out_face, double *out_tilt_deg)
{
    const double corner_x = PLAN_MOUTH_REACH - CORNER_GAP_MM;
    double x = corner_x * (s + 0.12 * s * (1.0 - s));
    double radius = sign > 0.0 ? UPPER_RADIUS_MM : LOWER_RADIUS_MM;
    double s4 = s * s * s * s;
    column c = {.radius_mm = mixed(radius, CORNER_RADIUS_MM, s * s),
                .gap_mm = mixed(GAP_MM, CORNER_GAP_MM, s4),
                .across = 0.93 * s * (1.1 - 0.1 * s)};
    double a2 = c.across * c.across;
    c.up = sign * fourth_root(1.0 - a2 * a2);
    *out_face = (vec3){x, line_y(x), 60.0};
    *out_tilt_deg = sign * mixed(90.0, CORNER_TILT_DEG, s4);
    return c;
}

/* Around the corner: t from 0 at its lower to 1 at its upper end. */
static column corner_column(double t, vec3 *out_face, double *out_tilt_deg)
{
    const double x = PLAN_MOUTH_REACH - CORNER_GAP_MM;
    const double end = fourth_root(1.0 - 0.93 * 0.93 * 0.93 * 0.93);
    column c = {
        .radius_mm = CORNER_RADIUS_MM, .gap_mm = CORNER_GAP_MM, .up = end * (2.0 * t - 1.0)};
    double u2 = c.up * c.up;
    c.across = fourth_root(1.0 - u2 * u2);
    *out_face = (vec3){x, line_y(x), 60.0};
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
    return c->gap_mm + OUTLINE_RADII * c->radius_mm;
}

static column column_at(int32_t i)
{
    const int32_t columns = PLAN_MOUTH_COLUMNS, rows = PLAN_MOUTH_ROWS;
    vec3 face;
    double tilt_deg;
    column c;
    if (i <= columns)
        c = straight_column((double)i / columns, -1.0, &face, &tilt_deg);
    else if (i < columns + rows)
        c = corner_column((double)(i - columns) / rows, &face, &tilt_deg);
    else
        c = straight_column((double)(LAST - i) / columns, 1.0, &face, &tilt_deg);
    vec3 foot = form_along(face, (vec3){0, 0, 1});
    vec3 normal = form_normal(foot);
    normal.y = 0.0;
    c.outward = vec3_normalised(normal, (vec3){0, 0, 1});
    angle_sincos tilt = plan_degrees(tilt_deg);
    c.away = (vec3){c.outward.z * tilt.cos, tilt.sin, -c.outward.x * tilt.cos};
    c.slit = vec3_sub(foot, vec3_scale(c.outward, SUNK * c.radius_mm));
    vec3 outline = form_projected(beside(&c, outline_mm(&c), 0.0));
    double rise_mm = vec3_dot(vec3_sub(outline, foot), c.outward);
    c.bend = rise_mm / (outline_mm(&c) * outline_mm(&c));
    return c;
}

static vec3 cord_point(const column *c, double angle_deg)
{
    angle_sincos a = plan_degrees(angle_deg);
    return beside(c, c->gap_mm + c->radius_mm * (1.0 + a.sin), c->radius_mm * a.cos);
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
    double front = cord_point(c, CORD_DEG[CORD_RINGS - 1]).z;
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

/* `step` counts rings behind the cord, from 1. */
static vec3 bag_point(const column *c, int32_t step)
{
    vec3 knot[STATIONS + 3];
    knot[0] = cord_point(c, CORD_DEG[CORD_RINGS - 2]);
    knot[1] = cord_point(c, CORD_DEG[CORD_RINGS - 1]);
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

mrt_result mouth_build(sheet *s, const ring *outline, error *err)
{
    column c[MOUTH_POINTS];
    vec3 point[MOUTH_POINTS];
    ring last = *outline;
    for (int32_t i = 0; i < MOUTH_POINTS; ++i)
        c[i] = column_at(i);
    for (int32_t k = 0; k < CORD_RINGS; ++k) {
        for (int32_t i = 0; i < MOUTH_POINTS; ++i)
            point[i] = cord_point(&c[i], CORD_DEG[k]);
        last = add_ring(s, point, &last, PLAN_PART_SKIN);
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
