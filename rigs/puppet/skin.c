#include "skin.h"
#include "form.h"
#include "mouth.h"
#include "plan.h"

#include <math.h>

enum {
    MOUTH_COLLAR = 4,
    NOSE_COLLAR = 2,
    NOSE_DOME = 3,
    EYE_POINTS = 4 * PLAN_EYE_CELLS,
    NOSE_POINTS = 2 * PLAN_NOSE_COLUMNS + PLAN_NOSE_ROWS + 1,
    NO_POINT = -1,
    EVEN_ROUNDS = 200,
    AREA_ROUNDS = 150
};

/* Fixed lines around lips and sockets: relaxed ones would fold over such sharp bends. From where
 * lips and rims begin. */
static const double LIP_LINES_MM[] = {4.0, 0.0};
static const double RIM_LINES_MM[] = {4.9, 2.6};

/* The points of the box that the net is folded from. */
typedef struct box {
    int32_t wall[PLAN_UP + 1][PLAN_AROUND + 1];
    int32_t roof[PLAN_SIDE + 1][PLAN_FRONT + 1]; /* from the front to the back; by x */
} box;

/* Cells of the wall that are left out, for rings to be laid in. */
typedef struct window {
    int32_t column, row, column_count, row_count; /* column 0: half of it, on the middle */
} window;

static const window MOUTH = {0, PLAN_MOUTH_ROW, PLAN_MOUTH_COLUMNS, PLAN_MOUTH_ROWS};
static const window NOSE = {0, PLAN_NOSE_ROW, PLAN_NOSE_COLUMNS, PLAN_NOSE_ROWS};
static const window EYE = {PLAN_EYE_COLUMN, PLAN_EYE_ROW, PLAN_EYE_CELLS, PLAN_EYE_CELLS};

static int is_inside(const window *w, int32_t column, int32_t row)
{
    int is_right_of = w->column == 0 || column > w->column;
    return is_right_of && column < w->column + w->column_count && row > w->row &&
           row < w->row + w->row_count;
}

static int has_cell(const window *w, int32_t column, int32_t row)
{
    return column >= w->column && column < w->column + w->column_count && row >= w->row &&
           row < w->row + w->row_count;
}

static vec3 wall_point(int32_t column, int32_t row)
{
    angle_sincos around = angle_sincos_of(ANGLE_PI * column / PLAN_AROUND);
    double radius = row == 0 ? 46.0 : 60.0;
    double y = PLAN_NECK_Y + 240.0 * row / PLAN_UP;
    return form_projected((vec3){radius * around.sin, y, PLAN_NECK_Z + radius * around.cos});
}

static vec3 roof_point(int32_t across, int32_t back)
{
    double x = 55.0 * across / PLAN_FRONT, z = 50.0 - 120.0 * back / PLAN_SIDE;
    return form_projected((vec3){x, 100.0, z});
}

static void add_wall_points(sheet *s, box *b)
{
    for (int32_t row = 0; row <= PLAN_UP; ++row)
        for (int32_t column = 0; column <= PLAN_AROUND; ++column) {
            int is_open = is_inside(&MOUTH, column, row) || is_inside(&NOSE, column, row) ||
                          is_inside(&EYE, column, row);
            int hold = column == 0 || column == PLAN_AROUND ? SHEET_MIDDLE : SHEET_FREE;
            hold |= row == 0 ? SHEET_FIXED : SHEET_FREE;
            vec3 p = wall_point(column, row);
            if (row == 0)
                p.y = PLAN_NECK_Y;
            b->wall[row][column] = is_open ? NO_POINT : sheet_add_point(s, p, hold);
        }
}

/* Its front, side and back edges are the wall's upper one. */
static void add_roof_points(sheet *s, box *b)
{
    for (int32_t back = 0; back <= PLAN_SIDE; ++back)
        for (int32_t across = 0; across <= PLAN_FRONT; ++across) {
            int32_t *at = &b->roof[back][across];
            if (back == 0)
                *at = b->wall[PLAN_UP][across];
            else if (across == PLAN_FRONT)
                *at = b->wall[PLAN_UP][PLAN_FRONT + back];
            else if (back == PLAN_SIDE)
                *at = b->wall[PLAN_UP][PLAN_AROUND - across];
            else
                *at = sheet_add_point(s, roof_point(across, back),
                                      across == 0 ? SHEET_MIDDLE : SHEET_FREE);
        }
}

static void add_box_quads(sheet *s, const box *b)
{
    for (int32_t v = 0; v < PLAN_UP; ++v)
        for (int32_t u = 0; u < PLAN_AROUND; ++u)
            if (!has_cell(&MOUTH, u, v) && !has_cell(&NOSE, u, v) && !has_cell(&EYE, u, v))
                sheet_add_quad(s, b->wall[v][u], b->wall[v][u + 1], b->wall[v + 1][u + 1],
                               b->wall[v + 1][u], PLAN_PART_SKIN);
    for (int32_t v = 0; v < PLAN_SIDE; ++v)
        for (int32_t u = 0; u < PLAN_FRONT; ++u)
            sheet_add_quad(s, b->roof[v][u], b->roof[v][u + 1], b->roof[v + 1][u + 1],
                           b->roof[v + 1][u], PLAN_PART_SKIN);
}

static ring frame_of(const box *b, const window *w)
{
    ring r = {.is_half = w->column == 0};
    int32_t right = w->column + w->column_count, top = w->row + w->row_count;
    for (int32_t u = w->column; u < right; ++u)
        r.at[r.count++] = b->wall[w->row][u];
    for (int32_t v = w->row; v < top; ++v)
        r.at[r.count++] = b->wall[v][right];
    for (int32_t u = right; u > w->column; --u)
        r.at[r.count++] = b->wall[top][u];
    if (r.is_half)
        r.at[r.count++] = b->wall[top][0];
    for (int32_t v = top; !r.is_half && v > w->row; --v)
        r.at[r.count++] = b->wall[v][w->column];
    return r;
}

/* Free rings from the frame of a window to a fixed line further in; returns the fixed one. */
static ring add_collar(sheet *s, const ring *frame, const vec3 *line, int32_t ring_count)
{
    ring last = *frame;
    for (int32_t k = 1; k <= ring_count; ++k) {
        vec3 point[SHEET_RING_CAP];
        double t = (double)k / ring_count;
        for (int32_t i = 0; i < frame->count; ++i)
            point[i] = form_mixed(s->point[frame->at[i]], line[i], t);
        ring next = sheet_ring(s, point, frame->count, frame->is_half,
                               k == ring_count ? SHEET_FIXED : SHEET_FREE);
        sheet_strip(s, &last, &next, PLAN_PART_SKIN);
        last = next;
    }
    return last;
}

static void eye_line(vec3 out_point[EYE_POINTS], double radius_mm)
{
    vec3 axis = plan_eye_axis();
    vec3 right = vec3_normalised(vec3_cross((vec3){0, 1, 0}, axis), (vec3){1, 0, 0});
    vec3 up = vec3_cross(axis, right);
    for (int32_t i = 0; i < EYE_POINTS; ++i) {
        angle_sincos a = plan_degrees(-135.0 + 360.0 * i / EYE_POINTS);
        vec3 side = vec3_add(vec3_scale(right, a.cos), vec3_scale(up, a.sin));
        out_point[i] = form_along(vec3_add(PLAN_EYE, vec3_scale(side, radius_mm)), axis);
    }
}

static vec3 on_bowl(vec3 p)
{
    vec3 from = vec3_normalised(vec3_sub(p, PLAN_EYE), (vec3){0, 0, -1});
    return vec3_add(PLAN_EYE, vec3_scale(from, PLAN_SOCKET_RADIUS));
}

/* From the rim over its rounded edge down to a bowl around the ball. */
static mrt_result add_socket(sheet *s, const ring *rim, error *err)
{
    static const double EDGE[][2] = {/* of the way from the rim's to the bowl's radius; sunk, mm */
                                     {0.45, 0.1},
                                     {0.8, 0.9},
                                     {1.0, 2.6}};
    static const double BOWL_DEG[] = {12, 28, 44, 60}; /* behind the middle of the ball */
    vec3 axis = plan_eye_axis();
    vec3 foot[EYE_POINTS], side[EYE_POINTS], point[EYE_POINTS];
    double height[EYE_POINTS], radius = 0.0;
    for (int32_t i = 0; i < EYE_POINTS; ++i) {
        vec3 from = vec3_sub(s->point[rim->at[i]], PLAN_EYE);
        height[i] = vec3_dot(from, axis);
        foot[i] = vec3_sub(from, vec3_scale(axis, height[i]));
        radius = vec3_length(foot[i]);
        side[i] = vec3_scale(foot[i], 1.0 / radius);
    }
    ring last = *rim;
    for (size_t k = 0; k < sizeof EDGE / sizeof *EDGE; ++k) {
        double away = radius + (PLAN_SOCKET_RADIUS - radius) * EDGE[k][0];
        for (int32_t i = 0; i < EYE_POINTS; ++i)
            point[i] = vec3_add(PLAN_EYE, vec3_add(vec3_scale(side[i], away),
                                                   vec3_scale(axis, height[i] - EDGE[k][1])));
        ring next = sheet_ring(s, point, EYE_POINTS, 0, SHEET_FIXED);
        sheet_strip(s, &last, &next, PLAN_PART_SKIN);
        last = next;
    }
    int32_t first = s->point_count;
    for (size_t k = 0; k < sizeof BOWL_DEG / sizeof *BOWL_DEG; ++k) {
        angle_sincos a = plan_degrees(BOWL_DEG[k]);
        for (int32_t i = 0; i < EYE_POINTS; ++i)
            point[i] = vec3_add(PLAN_EYE, vec3_add(vec3_scale(side[i], PLAN_SOCKET_RADIUS * a.cos),
                                                   vec3_scale(axis, -PLAN_SOCKET_RADIUS * a.sin)));
        ring next = sheet_ring(s, point, EYE_POINTS, 0, SHEET_FIXED);
        sheet_strip(s, &last, &next, PLAN_PART_SKIN);
        last = next;
    }
    int32_t cap = sheet_close(s, &last, PLAN_EYE_CELLS, PLAN_EYE_CELLS, PLAN_PART_SKIN, SHEET_FREE);
    sheet_mark(s, first, SHEET_SKULL);
    return sheet_relax(s, cap, 40, SHEET_AREA, on_bowl, err);
}

static void nose_line(vec3 out_point[NOSE_POINTS])
{
    for (int32_t i = 0; i < NOSE_POINTS; ++i) {
        angle_sincos a = plan_degrees(-90.0 + 180.0 * i / (NOSE_POINTS - 1));
        out_point[i] = form_projected((vec3){22.0 * a.cos, 24.0 + 18.6 * a.sin, 79.0});
    }
}

static void add_nose(sheet *s, const ring *base)
{
    ring last = *base;
    for (int32_t k = 1; k <= NOSE_DOME; ++k) {
        vec3 point[NOSE_POINTS];
        for (int32_t i = 0; i < NOSE_POINTS; ++i)
            point[i] =
                form_projected(form_mixed(s->point[base->at[i]], (vec3){0, 24, 112}, 0.16 * k));
        ring next = sheet_ring(s, point, NOSE_POINTS, 1, SHEET_FREE);
        sheet_strip(s, &last, &next, PLAN_PART_NOSE);
        last = next;
    }
    (void)sheet_close(s, &last, PLAN_NOSE_COLUMNS, PLAN_NOSE_ROWS, PLAN_PART_NOSE, SHEET_FREE);
}

/* An ellipse, seen from the front. */
static int is_in_chin(vec3 p)
{
    double x = p.x / 44.0, y = (p.y + 74.0) / 22.0;
    return p.z > 40.0 && x * x + y * y < 1.0;
}

/* Cranium, nape and the lower end of the neck never move; the chin goes with the jaw. The lower lip
 * is left to the fill between chin, floor of the bag and corners: so it opens in a smooth curve. */
static void mark_bones(sheet *s)
{
    for (int32_t i = 0; i < s->point_count; ++i) {
        vec3 p = s->point[i];
        int is_cranium = p.y > 106.0 || (p.z < -8.0 && p.y > -70.0) || p.z < -30.0;
        int is_neck = p.y < -132.0;
        int is_chin = is_in_chin(p);
        if (s->bone[i] == SHEET_UNSURE && (is_cranium || is_neck))
            s->bone[i] = SHEET_SKULL;
        if (s->bone[i] == SHEET_UNSURE && is_chin)
            s->bone[i] = SHEET_JAW;
    }
}

mrt_result skin_build(sheet *s, error *err)
{
    box b;
    vec3 line[SHEET_RING_CAP];
    add_wall_points(s, &b);
    add_roof_points(s, &b);
    add_box_quads(s, &b);
    ring mouth = frame_of(&b, &MOUTH), eye = frame_of(&b, &EYE), nose = frame_of(&b, &NOSE);
    for (size_t k = 0; k < sizeof LIP_LINES_MM / sizeof *LIP_LINES_MM; ++k) {
        mouth_outline(line, LIP_LINES_MM[k]);
        mouth = add_collar(s, &mouth, line, k == 0 ? MOUTH_COLLAR : 1);
    }
    for (size_t k = 0; k < sizeof RIM_LINES_MM / sizeof *RIM_LINES_MM; ++k) {
        eye_line(line, PLAN_SOCKET_RADIUS + RIM_LINES_MM[k]);
        eye = add_collar(s, &eye, line, 1);
    }
    nose_line(line);
    nose = add_collar(s, &nose, line, NOSE_COLLAR);
    add_nose(s, &nose);
    mrt_result result = sheet_relax(s, 0, EVEN_ROUNDS, SHEET_EVEN, form_projected, err);
    if (result >= 0)
        result = sheet_relax(s, 0, AREA_ROUNDS, SHEET_AREA, form_projected, err);
    if (result >= 0)
        result = add_socket(s, &eye, err);
    if (result >= 0)
        result = mouth_build(s, &mouth, err);
    mark_bones(s);
    return result;
}
