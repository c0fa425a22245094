#include "pieces.h"
#include "form.h"
#include "plan.h"

#include <math.h>

/* ---- teeth ---- */

/* The section of a row: from the tips of the teeth outwards, over the gum and back inside. */
typedef struct section_point {
    double out, up; /* 0..1 of the thickness, from the middle line of the arch; of the height */
    int is_tooth;   /* the strip from here to the next */
} section_point;

static const section_point SECTION[] = {
    {-0.62, 0.05, 1}, {-0.25, 0.00, 1}, {0.25, 0.00, 1},  {0.62, 0.05, 1},  {0.86, 0.17, 1},
    {0.94, 0.38, 1},  {0.80, 0.58, 0},  {1.02, 0.62, 0},  {1.10, 0.76, 0},  {1.00, 0.92, 0},
    {0.50, 1.00, 0},  {-0.50, 1.00, 0}, {-1.00, 0.92, 0}, {-1.10, 0.76, 0}, {-1.02, 0.62, 0},
    {-0.80, 0.58, 1}, {-0.94, 0.38, 1}, {-0.86, 0.17, 1},
};
enum { SECTION_POINTS = sizeof SECTION / sizeof *SECTION, CAP_COLUMNS = 3, CAP_ROWS = 6 };

enum { TEETH = 5, TOOTH_CELLS = 6, ARCH_CELLS = TEETH * TOOTH_CELLS };

typedef struct arch {
    double front_z;           /* of the middle line */
    double reach_x, reach_z;  /* of its end: half width, and how far it goes back */
    double edge_y, height_mm; /* height: to the top of the gum, below 0 downwards */
    double thickness_mm;      /* half */
    double end_sinks;         /* into the gum, of the height: the far end of the lower row does not
                                 stand out of an open mouth */
    int tooth, gum;
} arch;

static const arch UPPER = {
    80.0, 47.0, 42.0, -43.5, 25.0, 3.7, 0.0, PLAN_PART_TEETH_UPPER, PLAN_PART_GUM_UPPER};
static const arch LOWER = {
    76.0, 38.0, 24.0, -46.5, -14.0, 3.7, 0.5, PLAN_PART_TEETH_LOWER, PLAN_PART_GUM_LOWER};

/* From the middle (s = 0) to the end (1): an arch that is flat in front. */
static vec3 arch_point(const arch *a, double s)
{
    angle_sincos t = plan_degrees(78.0 * s);
    double z = (1.0 - t.cos) / (1.0 - plan_degrees(78.0).cos);
    return (vec3){a->reach_x * t.sin / plan_degrees(78.0).sin, a->edge_y,
                  a->front_z - a->reach_z * z};
}

static vec3 arch_outward(const arch *a, double s)
{
    vec3 along = vec3_sub(arch_point(a, s + 0.01), arch_point(a, s - 0.01));
    return vec3_normalised((vec3){-along.z, 0.0, along.x}, (vec3){0, 0, 1});
}

/* 1 in the middle of a tooth, less beside it. */
static double tooth_bulge(double s)
{
    double within = s * TEETH - floor(fmin(s * TEETH, TEETH - 0.5));
    double q = 2.0 * within - 1.0;
    return 1.0 - q * q * q * q * q * q;
}

/* The upper row hangs upside down: its ring runs the other way, from the other end of the first
 * side. */
static int section_index(const arch *a, int i)
{
    return a->height_mm < 0.0 ? i : (SECTION_POINTS + CAP_COLUMNS - i) % SECTION_POINTS;
}

static ring arch_ring(sheet *s, const arch *a, int32_t cell)
{
    vec3 point[SECTION_POINTS];
    double along = (double)cell / ARCH_CELLS;
    double bulge = tooth_bulge(along), shrink = 1.0 - 0.4 * along * along;
    vec3 base = arch_point(a, along), outward = arch_outward(a, along);
    for (int i = 0; i < SECTION_POINTS; ++i) {
        int k = section_index(a, i);
        const section_point *at = &SECTION[k];
        int is_tooth_point = at->up < 0.5;
        double narrow = is_tooth_point ? 0.72 + 0.28 * bulge : 1.0;
        double up = is_tooth_point ? at->up * shrink + 0.09 * (1.0 - bulge) * (at->up < 0.3)
                                   : at->up - (1.0 - shrink) * 0.3;
        vec3 shift = vec3_scale(outward, at->out * a->thickness_mm * narrow);
        up += a->end_sinks * along * along * (1.0 - up);
        shift.y = up * a->height_mm;
        point[i] = vec3_add(base, shift);
    }
    return sheet_ring(s, point, SECTION_POINTS, 0, SHEET_FIXED | (cell == 0 ? SHEET_MIDDLE : 0));
}

static void add_arch_strip(sheet *s, const arch *a, const ring *from, const ring *to)
{
    for (int i = 0; i < SECTION_POINTS; ++i) {
        int next = (i + 1) % SECTION_POINTS;
        int k = a->height_mm < 0.0 ? i : section_index(a, next);
        sheet_add_quad(s, from->at[i], from->at[next], to->at[next], to->at[i],
                       SECTION[k].is_tooth ? a->tooth : a->gum);
    }
}

static void add_arch(sheet *s, const arch *a)
{
    ring last = arch_ring(s, a, 0);
    for (int32_t cell = 1; cell <= ARCH_CELLS; ++cell) {
        ring next = arch_ring(s, a, cell);
        add_arch_strip(s, a, &last, &next);
        last = next;
    }
    (void)sheet_close(s, &last, CAP_COLUMNS, CAP_ROWS, a->gum, SHEET_FIXED);
}

static void add_teeth(sheet *s)
{
    int32_t first = s->point_count;
    add_arch(s, &UPPER);
    sheet_mark(s, first, SHEET_SKULL);
    first = s->point_count;
    add_arch(s, &LOWER);
    sheet_mark(s, first, SHEET_JAW);
}

/* ---- tongue ---- */

enum { TONGUE_COLUMNS = 6, TONGUE_ROWS = 2, TONGUE_POINTS = 2 * TONGUE_COLUMNS + TONGUE_ROWS + 1 };

typedef struct tongue_station {
    double z, y, half_width_mm, half_height_mm;
} tongue_station;

static const tongue_station TONGUE[] = {
    {28.0, -54.2, 14.5, 3.6}, {30.0, -53.4, 18.5, 5.2}, {34.0, -52.6, 22.0, 6.4},
    {38.5, -52.0, 24.0, 7.0}, {43.0, -51.6, 25.0, 7.2}, {48.0, -51.2, 24.8, 7.1},
    {53.0, -51.0, 23.5, 6.7}, {58.0, -51.0, 21.0, 6.0}, {62.0, -51.0, 17.5, 5.0},
    {64.8, -51.0, 13.0, 4.0}, {66.4, -51.0, 8.5, 2.8},
};

/* From below, by the left side, to the top: an oval, with a groove along the top. */
static ring tongue_ring(sheet *s, const tongue_station *at)
{
    vec3 point[TONGUE_POINTS];
    for (int32_t i = 0; i < TONGUE_POINTS; ++i) {
        angle_sincos a = plan_degrees(-90.0 + 180.0 * i / (TONGUE_POINTS - 1));
        double flat =
            1.0 / sqrt(sqrt(a.cos * a.cos * a.cos * a.cos + a.sin * a.sin * a.sin * a.sin));
        double x = a.cos * flat;
        double groove = a.sin > 0.0 ? fmax(1.0 - 3.0 * fabs(x), 0.0) * 0.28 : 0.0;
        point[i] = (vec3){at->half_width_mm * x,
                          at->y + at->half_height_mm * (a.sin * flat - groove), at->z};
    }
    return sheet_ring(s, point, TONGUE_POINTS, 1, SHEET_FIXED);
}

static void add_tongue(sheet *s)
{
    int32_t first = s->point_count;
    ring last = tongue_ring(s, &TONGUE[0]);
    (void)sheet_close_back(s, &last, TONGUE_COLUMNS, TONGUE_ROWS, PLAN_PART_TONGUE, SHEET_FIXED);
    for (size_t k = 1; k < sizeof TONGUE / sizeof *TONGUE; ++k) {
        ring next = tongue_ring(s, &TONGUE[k]);
        sheet_strip(s, &last, &next, PLAN_PART_TONGUE);
        last = next;
    }
    (void)sheet_close(s, &last, TONGUE_COLUMNS, TONGUE_ROWS, PLAN_PART_TONGUE, SHEET_FIXED);
    sheet_mark(s, first, SHEET_JAW);
}

/* ---- eyes ---- */

enum { BALL_CELLS = 10, BALL_POINTS = 4 * BALL_CELLS };
enum { LID_COLUMNS = 20, LID_ROWS = 9, LASH_ROWS_MAX = 2 };

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

/* How far the lids go to the sides and the back; the rounding of their edges goes half as far as
 * they are thick. */
static const double LID_SIDE_DEG = 82.0, LID_BACK_DEG = 150.0, LID_EDGE_DEG = 1.6;

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

/* A lid has the lash on its edge: rows of its own there, raised, of another part. */
typedef struct lid {
    double sign;       /* 1: the upper lid; -1: the lower one, the same upside down */
    double edge_deg;   /* at rest, from the middle of the ball */
    int32_t lash_rows; /* behind the edge */
    double lash_mm[2]; /* its width: in the middle of the lid, at its sides */
    double raised_mm[LASH_ROWS_MAX + 1]; /* in the middle: the edge, and the rows behind it */
    int part, lash_part;
} lid;

static const lid UPPER_LID = {
    1.0, 39.0, 2, {2.8, 2.0}, {0.7, 1.2, 0.0}, PLAN_PART_LID_UPPER, PLAN_PART_LASH_UPPER};
static const lid LOWER_LID = {
    -1.0, 31.0, 1, {1.5, 1.3}, {0.5, 0.0, 0.0}, PLAN_PART_LID_LOWER, PLAN_PART_LASH_LOWER};

typedef struct lid_layer {
    double grow_deg, radius_mm;
    int is_raised;
} lid_layer;

static int32_t lid_rows(const lid *l)
{
    return LID_ROWS + l->lash_rows;
}

/* Of the rows in the grid, which begins below: counted from the edge. */
static int32_t from_edge(const lid *l, int32_t row)
{
    return l->sign > 0.0 ? row : lid_rows(l) - row;
}

static vec3 lid_point(const lid *l, const lid_layer *layer, int32_t column, int32_t grid_row)
{
    const double span_deg = LID_BACK_DEG - l->edge_deg;
    int32_t row = from_edge(l, grid_row);
    double t = 2.0 * column / LID_COLUMNS - 1.0;
    double aside = t * (1.15 - 0.15 * t * t), q = aside * aside; /* closer columns at the sides */
    angle_sincos rest_side = plan_degrees(LID_SIDE_DEG * aside);
    double lash_mm = l->lash_mm[0] + (l->lash_mm[1] - l->lash_mm[0]) * q;
    double lash_deg = lash_mm / (PLAN_LID_OUTER * rest_side.cos) * (180.0 / ANGLE_PI);
    double behind_deg = row <= l->lash_rows
                            ? lash_deg * row / l->lash_rows
                            : lash_deg + (span_deg - lash_deg) * (row - l->lash_rows) / LID_ROWS;
    double grown = 1.0 + 2.0 * layer->grow_deg / span_deg;
    double raised_deg = l->sign * (l->edge_deg - layer->grow_deg + behind_deg * grown);
    double radius_mm = layer->radius_mm;
    if (layer->is_raised && row <= l->lash_rows)
        radius_mm += l->raised_mm[row] * (1.0 - q * q);
    angle_sincos side = plan_degrees((LID_SIDE_DEG + layer->grow_deg) * aside);
    angle_sincos raised = plan_degrees(raised_deg);
    vec3 direction = {side.sin, side.cos * raised.sin, side.cos * raised.cos};
    return on_ball(direction, radius_mm);
}

static ring lid_ring(sheet *s, const lid *l, const lid_layer *layer)
{
    vec3 point[2 * (LID_COLUMNS + LID_ROWS + LASH_ROWS_MAX)];
    const int32_t rows = lid_rows(l);
    int32_t count = 0;
    for (int32_t k = 0; k < LID_COLUMNS; ++k)
        point[count++] = lid_point(l, layer, k, 0);
    for (int32_t k = 0; k < rows; ++k)
        point[count++] = lid_point(l, layer, LID_COLUMNS, k);
    for (int32_t k = LID_COLUMNS; k > 0; --k)
        point[count++] = lid_point(l, layer, k, rows);
    for (int32_t k = rows; k > 0; --k)
        point[count++] = lid_point(l, layer, 0, k);
    return sheet_ring(s, point, count, 0, SHEET_FIXED);
}

/* The inner grid has columns and rows exchanged: it is seen from the other side. */
static void place_inner(sheet *s, const lid *l, const lid_layer *layer, int32_t first)
{
    for (int32_t column = 1; column < LID_COLUMNS; ++column)
        for (int32_t row = 1; row < lid_rows(l); ++row)
            s->point[first++] = lid_point(l, layer, column, row);
}

static void place_outer(sheet *s, const lid *l, const lid_layer *layer, int32_t first)
{
    for (int32_t row = 1; row < lid_rows(l); ++row)
        for (int32_t column = 1; column < LID_COLUMNS; ++column)
            s->point[first++] = lid_point(l, layer, column, row);
}

/* A strip around the lid, whose cells along its edge are lash. */
static void add_lid_strip(sheet *s, const lid *l, const ring *outer, const ring *inner)
{
    int32_t edge = s->quad_count + (l->sign > 0.0 ? 0 : LID_COLUMNS + lid_rows(l));
    sheet_strip(s, outer, inner, l->part);
    for (int32_t q = edge; q < edge + LID_COLUMNS && !s->is_full; ++q)
        s->quad[q].part = l->lash_part;
}

static void add_lid(sheet *s, const lid *l)
{
    const lid_layer inner = {0.0, PLAN_LID_INNER, 0};
    const lid_layer edge = {LID_EDGE_DEG, 0.5 * (PLAN_LID_INNER + PLAN_LID_OUTER), 0};
    const lid_layer outer = {0.0, PLAN_LID_OUTER, 1};
    const int32_t rows = lid_rows(l);
    ring inside = lid_ring(s, l, &inner), rim = lid_ring(s, l, &edge);
    ring outside = lid_ring(s, l, &outer);
    add_lid_strip(s, l, &inside, &rim);
    add_lid_strip(s, l, &rim, &outside);
    int32_t first = sheet_close_back(s, &inside, LID_COLUMNS, rows, l->part, SHEET_FIXED);
    place_inner(s, l, &inner, first);
    int32_t first_quad = s->quad_count;
    first = sheet_close(s, &outside, LID_COLUMNS, rows, l->part, SHEET_FIXED);
    place_outer(s, l, &outer, first);
    for (int32_t q = first_quad; q < s->quad_count; ++q) {
        int32_t row = (q - first_quad) / LID_COLUMNS;
        if ((l->sign > 0.0 ? row : rows - 1 - row) < l->lash_rows)
            s->quad[q].part = l->lash_part;
    }
}

static void add_eye(sheet *s)
{
    add_ball(s);
    add_lid(s, &UPPER_LID);
    add_lid(s, &LOWER_LID);
}

/* ---- felt ---- */

static const double SEAM_MM = 0.7; /* between felt and skin */

/* Sewn pieces lean: what would dip into the skin is kept least_mm above it. */
static vec3 kept_above(vec3 p, double least_mm)
{
    return form_distance(p) < least_mm ? form_lifted(p, least_mm) : p;
}

/* ---- brow ---- */

enum {
    BROW_COLUMNS = 6, /* across; BROW_ROWS through its thickness */
    BROW_ROWS = 2,
    BROW_POINTS = 2 * (BROW_COLUMNS + BROW_ROWS),
    BROW_CELLS = 24
};

static const double BROW_THICK_MM = 5.5;

/* From its inner (t = 0) to its outer end. */
static vec3 brow_middle(double t)
{
    double x = 12.5 + 50.0 * t;
    double y = 106.0 + 21.0 * t * (1.0 - t) - 7.0 * t * t;
    return form_along((vec3){x, y, 40.0}, (vec3){0, 0, 1});
}

static double brow_half_width_mm(double t)
{
    double q = 2.0 * t - 0.85; /* widest a little inside the middle */
    double r = fmin(q * q, 1.3225) / 1.3225;
    return 3.6 + 4.8 * sqrt(1.0 - r * r);
}

/* Around the section, in cells: the bottom, and back over the top. */
static void brow_section(int32_t i, double *out_across, double *out_lift)
{
    const int32_t columns = BROW_COLUMNS, rows = BROW_ROWS;
    if (i < columns) {
        *out_across = 1.0 - 2.0 * i / columns;
        *out_lift = 0.0;
    } else if (i < columns + rows) {
        *out_across = -1.0 - 0.06 * (i > columns);
        *out_lift = 0.45 * (i - columns) / rows;
    } else if (i < 2 * columns + rows) {
        double c = -1.0 + 2.0 * (i - columns - rows) / columns;
        *out_across = c;
        *out_lift = 0.45 + 0.55 * sqrt(1.0 - c * c * c * c);
    } else {
        int32_t k = i - 2 * columns - rows;
        *out_across = 1.0 + 0.06 * (k > 0);
        *out_lift = 0.45 * (rows - k) / rows;
    }
}

static ring brow_ring(sheet *s, double t)
{
    vec3 point[BROW_POINTS];
    vec3 middle = brow_middle(t);
    vec3 along = vec3_sub(brow_middle(t + 0.01), brow_middle(t - 0.01));
    vec3 across = vec3_normalised(vec3_cross(along, form_normal(middle)), (vec3){0, 1, 0});
    double thick = BROW_THICK_MM * (0.35 + 0.65 * fmin(1.0, brow_half_width_mm(t) / 6.5));
    for (int32_t i = 0; i < BROW_POINTS; ++i) {
        double aside, lift;
        brow_section(i, &aside, &lift);
        vec3 foot = vec3_add(middle, vec3_scale(across, aside * brow_half_width_mm(t)));
        point[i] = form_lifted(foot, SEAM_MM + lift * thick);
    }
    return sheet_ring(s, point, BROW_POINTS, 0, SHEET_FIXED);
}

static void add_brow(sheet *s)
{
    ring last = brow_ring(s, 0.0);
    (void)sheet_close_back(s, &last, BROW_COLUMNS, BROW_ROWS, PLAN_PART_BROW, SHEET_FIXED);
    for (int32_t k = 1; k <= BROW_CELLS; ++k) {
        ring next = brow_ring(s, (double)k / BROW_CELLS);
        sheet_strip(s, &last, &next, PLAN_PART_BROW);
        last = next;
    }
    (void)sheet_close(s, &last, BROW_COLUMNS, BROW_ROWS, PLAN_PART_BROW, SHEET_FIXED);
}

/* ---- ear ---- */

enum { EAR_COLUMNS = 3, EAR_ROWS = 9, EAR_POINTS = 2 * (EAR_COLUMNS + EAR_ROWS) };

typedef struct ear_station {
    double out_mm, half_height_mm, half_thick_mm, dish_mm;
} ear_station;

static const ear_station EAR[] = {
    {5.5, 15.2, 5.0, 0.8},  {8.2, 16.9, 5.2, 2.4},  {11.2, 18.9, 5.6, 4.8},
    {15.5, 21.0, 5.8, 7.0}, {20.5, 22.0, 5.9, 8.0}, {25.5, 21.4, 5.7, 7.2},
    {30.0, 19.0, 5.2, 5.0}, {33.5, 15.0, 4.4, 2.4}, {35.3, 10.5, 3.0, 0.4},
};

typedef struct ear_frame {
    vec3 root, out, up, front;
} ear_frame;

static ear_frame ear_frame_of(void)
{
    ear_frame f;
    f.root = form_along((vec3){70.0, 14.0, -14.0}, (vec3){1, 0, 0});
    f.out = vec3_normalised((vec3){0.88, 0.12, -0.34}, (vec3){1, 0, 0});
    f.front = vec3_normalised(vec3_cross(f.out, (vec3){0.0, 1.0, -0.15}), (vec3){0, 0, 1});
    f.up = vec3_cross(f.front, f.out);
    return f;
}

static vec3 ear_point(const ear_frame *f, const ear_station *at, int32_t i)
{
    angle_sincos a = plan_degrees(-112.0 + 360.0 * i / EAR_POINTS);
    double front = -a.cos * at->half_thick_mm, up = a.sin;
    if (front > 0.0)
        front -= at->dish_mm * (1.0 - up * up) * (1.0 - up * up);
    vec3 p = vec3_add(f->root, vec3_scale(f->out, at->out_mm));
    p = vec3_add(p, vec3_scale(f->front, front - 0.012 * at->out_mm * at->out_mm * 0.3));
    return vec3_add(p, vec3_scale(f->up, up * at->half_height_mm + 0.12 * at->out_mm));
}

static void add_ear(sheet *s)
{
    const ear_frame f = ear_frame_of();
    vec3 point[EAR_POINTS];
    for (int32_t i = 0; i < EAR_POINTS; ++i)
        point[i] = form_lifted(ear_point(&f, &EAR[0], i), SEAM_MM);
    ring last = sheet_ring(s, point, EAR_POINTS, 0, SHEET_FIXED);
    for (size_t k = 0; k < sizeof EAR / sizeof *EAR; ++k) {
        for (int32_t i = 0; i < EAR_POINTS; ++i)
            point[i] = kept_above(ear_point(&f, &EAR[k], i), SEAM_MM + 1.5 * (double)(k + 1));
        ring next = sheet_ring(s, point, EAR_POINTS, 0, SHEET_FIXED);
        sheet_strip(s, &last, &next, PLAN_PART_EAR);
        last = next;
    }
    (void)sheet_close(s, &last, EAR_COLUMNS, EAR_ROWS, PLAN_PART_EAR, SHEET_FIXED);
}

/* ---- hair ---- */

enum { LOCK_CELLS = 3, LOCK_POINTS = 4 * LOCK_CELLS, LOCK_RINGS = 14 };
enum { HALF_COLUMNS = 2, HALF_ROWS = 2, HALF_POINTS = 2 * HALF_COLUMNS + HALF_ROWS + 1 };

typedef struct lock { /* of hair: an arc from its root over a knee to its tip */
    vec3 root, knee, tip;
    double radius_mm;
} lock;

static const lock MIDDLE_LOCK = {{0, 128, -4}, {0, 158, -8}, {0, 160, 24}, 8.5};
static const lock SIDE_LOCKS[] = {
    {{13, 127, -12}, {24, 152, -16}, {36, 152, 4}, 7.5},
    {{8, 127, -26}, {20, 154, -42}, {36, 146, -46}, 7.0},
};

static vec3 lock_middle(const lock *l, double t)
{
    return form_mixed(form_mixed(l->root, l->knee, t), form_mixed(l->knee, l->tip, t), t);
}

static double lock_radius_mm(const lock *l, double t)
{
    return l->radius_mm * (0.75 + 1.1 * t * (1.0 - t)) * sqrt(1.0 - 0.93 * t * t * t);
}

/* Around the lock at t against the clock seen from its tip, from angle_deg on. */
static vec3 lock_point(const lock *l, double t, double angle_deg)
{
    vec3 middle = lock_middle(l, t);
    vec3 along = vec3_sub(lock_middle(l, t + 0.01), lock_middle(l, t - 0.01));
    vec3 axis = vec3_normalised(along, (vec3){0, 1, 0});
    vec3 up = vec3_normalised(vec3_cross(axis, (vec3){1, 0, 0}), (vec3){0, 0, 1});
    vec3 right = vec3_cross(up, axis);
    angle_sincos a = plan_degrees(angle_deg);
    vec3 side = vec3_add(vec3_scale(right, a.cos), vec3_scale(up, a.sin));
    return vec3_add(middle, vec3_scale(side, lock_radius_mm(l, t)));
}

static ring lock_ring(sheet *s, const lock *l, int32_t k, int32_t count, int is_half)
{
    vec3 point[LOCK_POINTS];
    double t = (double)k / LOCK_RINGS;
    for (int32_t i = 0; i < count; ++i) {
        double angle_deg = is_half ? -90.0 + 180.0 * i / (count - 1) : -135.0 + 360.0 * i / count;
        point[i] = lock_point(l, t, angle_deg);
        point[i] =
            k == 0 ? form_lifted(point[i], SEAM_MM) : kept_above(point[i], SEAM_MM + 0.8 * k);
    }
    return sheet_ring(s, point, count, is_half, SHEET_FIXED);
}

static void add_lock(sheet *s, const lock *l, int32_t count, int is_half)
{
    ring last = lock_ring(s, l, 0, count, is_half);
    for (int32_t k = 1; k <= LOCK_RINGS; ++k) {
        ring next = lock_ring(s, l, k, count, is_half);
        sheet_strip(s, &last, &next, PLAN_PART_HAIR);
        last = next;
    }
    int32_t columns = is_half ? HALF_COLUMNS : LOCK_CELLS;
    int32_t rows = is_half ? HALF_ROWS : LOCK_CELLS;
    (void)sheet_close(s, &last, columns, rows, PLAN_PART_HAIR, SHEET_FIXED);
}

static void add_hair(sheet *s)
{
    int32_t first = s->point_count;
    add_lock(s, &MIDDLE_LOCK, HALF_POINTS, 1);
    for (size_t i = 0; i < sizeof SIDE_LOCKS / sizeof *SIDE_LOCKS; ++i)
        add_lock(s, &SIDE_LOCKS[i], LOCK_POINTS, 0);
    sheet_mark(s, first, SHEET_SKULL);
}

/* ---- collar ---- */

enum { COLLAR_COLUMNS = 32 };

/* A section of the collar: from below the neck's end up along the skin, over the roll and down. */
typedef struct collar_point {
    double y, off_mm; /* outside of the neck */
} collar_point;

static const collar_point COLLAR[] = {
    {-152.0, -2.0}, {-150.9, 0.7},  {-144.0, 0.7},  {-137.0, 0.7}, {-131.0, 0.9},
    {-128.0, 3.0},  {-127.4, 5.5},  {-129.0, 8.2},  {-133.5, 9.6}, {-139.0, 10.0},
    {-145.0, 10.6}, {-150.5, 11.2}, {-154.6, 10.0}, {-156.0, 6.0}, {-155.2, 1.5},
};
enum { COLLAR_POINTS = sizeof COLLAR / sizeof *COLLAR };

static ring collar_ring(sheet *s, int32_t column)
{
    vec3 point[COLLAR_POINTS];
    angle_sincos around = plan_degrees(180.0 * column / COLLAR_COLUMNS);
    const vec3 outward = {around.sin, 0.0, around.cos};
    int is_end = column == 0 || column == COLLAR_COLUMNS;
    for (int32_t i = 0; i < COLLAR_POINTS; ++i) {
        const collar_point *at = &COLLAR[i];
        vec3 axis = {0.0, at->y, PLAN_NECK_Z};
        vec3 foot = form_along(vec3_add(axis, vec3_scale(outward, 46.0)), outward);
        point[i] = vec3_add(foot, vec3_scale(outward, at->off_mm));
    }
    return sheet_ring(s, point, COLLAR_POINTS, 0, SHEET_FIXED | (is_end ? SHEET_MIDDLE : 0));
}

static void add_collar(sheet *s)
{
    int32_t first = s->point_count;
    ring last = collar_ring(s, 0);
    for (int32_t column = 1; column <= COLLAR_COLUMNS; ++column) {
        ring next = collar_ring(s, column);
        sheet_strip(s, &last, &next, PLAN_PART_COLLAR);
        last = next;
    }
    sheet_mark(s, first, SHEET_SKULL);
}

void pieces_build(sheet *s)
{
    add_teeth(s);
    add_tongue(s);
    add_eye(s);
    add_brow(s);
    add_ear(s);
    add_hair(s);
    add_collar(s);
}
