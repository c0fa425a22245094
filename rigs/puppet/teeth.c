#include "teeth.h"
#include "plan.h"

#include <math.h>

/* The section of a row: from the tips of the teeth outwards, over the gum and back inside. */
typedef struct section_point {
    double out, up; /* 0..1 of the thickness, from the middle line of the arch; of the height */
    int is_tooth;   /* the strip from here to the next */
} section_point;

static const section_point SECTION[] = {
    {-0.62, 0.05, 1}, {-0.25, 0.00, 1}, {0.25, 0.00, 1},  {0.62, 0.05, 1},  {0.86, 0.17, 1},
    {0.94, 0.38, 1},  {0.80, 0.58, 0},  {1.12, 0.62, 0},  {1.22, 0.76, 0},  {1.00, 0.92, 0},
    {0.50, 1.00, 0},  {-0.50, 1.00, 0}, {-1.00, 0.92, 0}, {-1.22, 0.76, 0}, {-1.12, 0.62, 0},
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
    80.0, 42.0, 36.0, -43.5, 25.0, 3.9, 0.0, PLAN_PART_TEETH_UPPER, PLAN_PART_GUM_UPPER};
static const arch LOWER = {
    76.0, 35.0, 22.0, -46.5, -14.0, 3.7, 0.5, PLAN_PART_TEETH_LOWER, PLAN_PART_GUM_LOWER};

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
    double bulge = tooth_bulge(along), shrink = 1.0 - 0.25 * along * along;
    vec3 base = arch_point(a, along), outward = arch_outward(a, along);
    for (int i = 0; i < SECTION_POINTS; ++i) {
        int k = section_index(a, i);
        const section_point *at = &SECTION[k];
        int is_tooth_point = at->up < 0.5;
        double narrow = is_tooth_point ? 0.80 + 0.20 * bulge : 1.0;
        double up = is_tooth_point ? at->up * shrink + 0.05 * (1.0 - bulge) * (at->up < 0.3)
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

void teeth_build(sheet *s)
{
    int32_t first = s->point_count;
    add_arch(s, &UPPER);
    sheet_mark(s, first, SHEET_SKULL);
    first = s->point_count;
    add_arch(s, &LOWER);
    sheet_mark(s, first, SHEET_JAW);
}

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

void teeth_build_tongue(sheet *s)
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
