#include "eyes.h"
#include "plan.h"

enum { BALL_CELLS = 10, BALL_POINTS = 4 * BALL_CELLS, LID_COLUMNS = 20, LID_ROWS = 9 };

typedef struct zone { /* a ring of the ball, and what lies between the one before it and it */
    double from_front_deg;
    int part;
} zone;

static const zone ZONE[] = {
    {150, PLAN_PART_EYE}, {135, PLAN_PART_EYE},   {120, PLAN_PART_EYE}, {105, PLAN_PART_EYE},
    {90, PLAN_PART_EYE},  {77, PLAN_PART_EYE},    {65, PLAN_PART_EYE},  {54, PLAN_PART_EYE},
    {44, PLAN_PART_EYE},  {36, PLAN_PART_EYE},    {31, PLAN_PART_EYE},  {26, PLAN_PART_IRIS},
    {20, PLAN_PART_IRIS}, {14.5, PLAN_PART_IRIS}, {9, PLAN_PART_PUPIL},
};
enum { ZONES = sizeof ZONE / sizeof *ZONE };

/* The lids at rest: where their edges lie, above the middle of the ball; how far they go to the
 * sides; the rounding of their edges goes half as far as they are thick. */
static const double UPPER_EDGE_DEG = 39.0, LOWER_EDGE_DEG = -31.0, LID_BACK_DEG = 150.0;
static const double LID_SIDE_DEG = 82.0, LID_EDGE_DEG = 1.6;

static vec3 on_ball(vec3 direction, double radius_mm)
{
    return vec3_add(PLAN_EYE, vec3_scale(direction, radius_mm));
}

static void put_on_ball(sheet *s, int32_t first)
{
    for (int32_t i = first; i < s->point_count; ++i) {
        vec3 from = vec3_normalised(vec3_sub(s->point[i], PLAN_EYE), (vec3){0, 0, 1});
        s->point[i] = on_ball(from, PLAN_EYE_RADIUS);
    }
}

static ring ball_ring(sheet *s, double from_front_deg)
{
    vec3 point[BALL_POINTS];
    angle_sincos slope = plan_degrees(from_front_deg);
    for (int32_t i = 0; i < BALL_POINTS; ++i) {
        angle_sincos around = plan_degrees(-135.0 + 360.0 * i / BALL_POINTS);
        vec3 direction = {slope.sin * around.cos, slope.sin * around.sin, slope.cos};
        point[i] = on_ball(direction, PLAN_EYE_RADIUS);
    }
    return sheet_ring(s, point, BALL_POINTS, 0, SHEET_FIXED);
}

static void add_ball(sheet *s)
{
    ring last = ball_ring(s, ZONE[0].from_front_deg);
    int32_t back = sheet_close_back(s, &last, BALL_CELLS, BALL_CELLS, PLAN_PART_EYE, SHEET_FIXED);
    put_on_ball(s, back);
    for (int k = 1; k < ZONES; ++k) {
        ring next = ball_ring(s, ZONE[k].from_front_deg);
        sheet_strip(s, &last, &next, ZONE[k].part);
        last = next;
    }
    put_on_ball(s, sheet_close(s, &last, BALL_CELLS, BALL_CELLS, PLAN_PART_PUPIL, SHEET_FIXED));
}

typedef struct lid {
    double low_deg, high_deg; /* elevation over the front, about the axis along x */
    double grow_deg, radius_mm;
} lid;

static vec3 lid_point(const lid *l, double column, double row)
{
    double side_deg = LID_SIDE_DEG + l->grow_deg;
    double span_deg = l->high_deg - l->low_deg + 2.0 * l->grow_deg;
    angle_sincos side = plan_degrees(side_deg * (2.0 * column / LID_COLUMNS - 1.0));
    angle_sincos raised = plan_degrees(l->low_deg - l->grow_deg + span_deg * row / LID_ROWS);
    vec3 direction = {side.sin, side.cos * raised.sin, side.cos * raised.cos};
    return on_ball(direction, l->radius_mm);
}

static ring lid_ring(sheet *s, const lid *l)
{
    vec3 point[2 * (LID_COLUMNS + LID_ROWS)];
    int32_t count = 0;
    for (int32_t k = 0; k < LID_COLUMNS; ++k)
        point[count++] = lid_point(l, k, 0);
    for (int32_t k = 0; k < LID_ROWS; ++k)
        point[count++] = lid_point(l, LID_COLUMNS, k);
    for (int32_t k = LID_COLUMNS; k > 0; --k)
        point[count++] = lid_point(l, k, LID_ROWS);
    for (int32_t k = LID_ROWS; k > 0; --k)
        point[count++] = lid_point(l, 0, k);
    return sheet_ring(s, point, count, 0, SHEET_FIXED);
}

/* The inner grid has columns and rows exchanged: it is seen from the other side. */
static void place_inner(sheet *s, const lid *l, int32_t first)
{
    for (int32_t column = 1; column < LID_COLUMNS; ++column)
        for (int32_t row = 1; row < LID_ROWS; ++row)
            s->point[first++] = lid_point(l, column, row);
}

static void place_outer(sheet *s, const lid *l, int32_t first)
{
    for (int32_t row = 1; row < LID_ROWS; ++row)
        for (int32_t column = 1; column < LID_COLUMNS; ++column)
            s->point[first++] = lid_point(l, column, row);
}

static void add_lid(sheet *s, double low_deg, double high_deg, int part)
{
    const double middle_mm = 0.5 * (PLAN_LID_INNER + PLAN_LID_OUTER);
    const lid inner = {low_deg, high_deg, 0.0, PLAN_LID_INNER};
    const lid edge = {low_deg, high_deg, LID_EDGE_DEG, middle_mm};
    const lid outer = {low_deg, high_deg, 0.0, PLAN_LID_OUTER};
    ring inside = lid_ring(s, &inner), rim = lid_ring(s, &edge), outside = lid_ring(s, &outer);
    sheet_strip(s, &inside, &rim, part);
    sheet_strip(s, &rim, &outside, part);
    int32_t first = sheet_close_back(s, &inside, LID_COLUMNS, LID_ROWS, part, SHEET_FIXED);
    place_inner(s, &inner, first);
    first = sheet_close(s, &outside, LID_COLUMNS, LID_ROWS, part, SHEET_FIXED);
    place_outer(s, &outer, first);
}

void eyes_build(sheet *s)
{
    add_ball(s);
    add_lid(s, UPPER_EDGE_DEG, LID_BACK_DEG, PLAN_PART_LID_UPPER);
    add_lid(s, -LID_BACK_DEG, LOWER_EDGE_DEG, PLAN_PART_LID_LOWER);
}
