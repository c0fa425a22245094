#include "felt.h"
#include "form.h"
#include "plan.h"

#include <math.h>

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

void felt_build_brow(sheet *s)
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

void felt_build_ear(sheet *s)
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

void felt_build_hair(sheet *s)
{
    int32_t first = s->point_count;
    add_lock(s, &MIDDLE_LOCK, HALF_POINTS, 1);
    for (size_t i = 0; i < sizeof SIDE_LOCKS / sizeof *SIDE_LOCKS; ++i)
        add_lock(s, &SIDE_LOCKS[i], LOCK_POINTS, 0);
    sheet_mark(s, first, SHEET_SKULL);
}
