#include "sheet.h"

#include <assert.h>
#include <stdlib.h>

mrt_result sheet_create(sheet *out, int32_t capacity, error *err)
{
    size_t count = (size_t)capacity;
    *out = (sheet){.capacity = capacity};
    out->point = calloc(count, sizeof *out->point);
    out->hold = calloc(count, sizeof *out->hold);
    out->bone = calloc(count, sizeof *out->bone);
    out->quad = calloc(count, sizeof *out->quad);
    if (out->point && out->hold && out->bone && out->quad)
        return MRT_OK;
    sheet_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for a sheet of %d points", capacity);
}

void sheet_destroy(sheet *s)
{
    if (!s)
        return;
    free(s->point);
    free(s->hold);
    free(s->bone);
    free(s->quad);
    *s = (sheet){0};
}

int32_t sheet_add_point(sheet *s, vec3 point, int hold)
{
    if (s->point_count == s->capacity) {
        s->is_full = 1;
        return 0;
    }
    if (hold & SHEET_MIDDLE)
        point.x = 0.0;
    s->point[s->point_count] = point;
    s->hold[s->point_count] = (uint8_t)hold;
    return s->point_count++;
}

void sheet_add_quad(sheet *s, int32_t a, int32_t b, int32_t c, int32_t d, int32_t part)
{
    if (s->quad_count == s->capacity) {
        s->is_full = 1;
        return;
    }
    s->quad[s->quad_count++] = (sheet_quad){{a, b, c, d}, part};
}

ring sheet_ring(sheet *s, const vec3 *point, int32_t count, int is_half, int hold)
{
    assert(count <= SHEET_RING_CAP);
    ring out = {.count = count, .is_half = is_half};
    for (int32_t i = 0; i < count; ++i) {
        int is_end = is_half && (i == 0 || i == count - 1);
        out.at[i] = sheet_add_point(s, point[i], hold | (is_end ? SHEET_MIDDLE : 0));
    }
    return out;
}

void sheet_strip(sheet *s, const ring *outer, const ring *inner, int32_t part)
{
    assert(outer->count == inner->count);
    int32_t edge_count = outer->is_half ? outer->count - 1 : outer->count;
    for (int32_t i = 0; i < edge_count; ++i) {
        int32_t next = (i + 1) % outer->count;
        int32_t a = outer->at[i], b = outer->at[next], c = inner->at[next], d = inner->at[i];
        if (a == b)
            sheet_add_quad(s, c, d, a, a, part);
        else
            sheet_add_quad(s, a, b, c, d, part);
    }
}

typedef struct cap {
    const ring *outer;
    int32_t column_count, row_count;
    int32_t first; /* new point */
} cap;

static int32_t first_column(const cap *c)
{
    return c->outer->is_half ? 0 : 1;
}

static int32_t cap_vertex(const cap *c, int32_t column, int32_t row)
{
    const int32_t columns = c->column_count, rows = c->row_count;
    if (row == 0)
        return c->outer->at[column];
    if (column == columns)
        return c->outer->at[columns + row];
    if (row == rows)
        return c->outer->at[columns + rows + columns - column];
    if (column == 0 && !c->outer->is_half)
        return c->outer->at[2 * columns + rows + rows - row];
    return c->first + (row - 1) * (columns - first_column(c)) + column - first_column(c);
}

static vec3 mixed(vec3 a, vec3 b, double t)
{
    return vec3_add(vec3_scale(a, 1.0 - t), vec3_scale(b, t));
}

/* The patch of Coons between the four sides; a half ring's left side is the straight line. */
static vec3 cap_point(const sheet *s, const cap *c, int32_t column, int32_t row)
{
    double u = (double)column / c->column_count, v = (double)row / c->row_count;
    const vec3 *at = s->point;
    vec3 low = at[cap_vertex(c, column, 0)], high = at[cap_vertex(c, column, c->row_count)];
    vec3 left_low = at[cap_vertex(c, 0, 0)], left_high = at[cap_vertex(c, 0, c->row_count)];
    vec3 left = c->outer->is_half ? mixed(left_low, left_high, v) : at[cap_vertex(c, 0, row)];
    vec3 right = at[cap_vertex(c, c->column_count, row)];
    vec3 right_low = at[cap_vertex(c, c->column_count, 0)];
    vec3 right_high = at[cap_vertex(c, c->column_count, c->row_count)];
    vec3 corners = mixed(mixed(left_low, right_low, u), mixed(left_high, right_high, u), v);
    vec3 sides = vec3_add(mixed(low, high, v), mixed(left, right, u));
    return vec3_sub(sides, corners);
}

int32_t sheet_close(sheet *s, const ring *outer, int32_t column_count, int32_t row_count,
                    int32_t part, int hold)
{
    assert(outer->is_half ? outer->count == 2 * column_count + row_count + 1
                          : outer->count == 2 * (column_count + row_count));
    const cap c = {outer, column_count, row_count, s->point_count};
    for (int32_t row = 1; row < row_count; ++row)
        for (int32_t column = first_column(&c); column < column_count; ++column)
            (void)sheet_add_point(s, cap_point(s, &c, column, row),
                                  hold | (column == 0 ? SHEET_MIDDLE : 0));
    for (int32_t row = 0; row < row_count; ++row)
        for (int32_t column = 0; column < column_count; ++column)
            sheet_add_quad(s, cap_vertex(&c, column, row), cap_vertex(&c, column + 1, row),
                           cap_vertex(&c, column + 1, row + 1), cap_vertex(&c, column, row + 1),
                           part);
    return c.first;
}

int32_t sheet_close_back(sheet *s, const ring *first, int32_t column_count, int32_t row_count,
                         int32_t part, int hold)
{
    ring turned = {.count = first->count, .is_half = first->is_half};
    int32_t last = first->is_half ? first->count - 1 : first->count;
    for (int32_t i = 0; i < first->count; ++i)
        turned.at[i] = first->at[(last - i) % first->count];
    if (first->is_half)
        return sheet_close(s, &turned, column_count, row_count, part, hold);
    return sheet_close(s, &turned, row_count, column_count, part, hold);
}

void sheet_mark(sheet *s, int32_t first_point, sheet_bone bone)
{
    for (int32_t i = first_point; i < s->point_count; ++i)
        s->bone[i] = (uint8_t)bone;
}

/* ---- relaxing ---- */

/* Of the way to the mean. EVEN's goes beyond it: that settles sooner. */
static const double EVEN_STEP = 1.9, AREA_STEP = 1.0;

typedef struct fans { /* the quads around each point, one row each */
    int32_t *start;   /* point_count + 1 */
    int32_t *quad;
} fans;

static void fans_finish(fans *f)
{
    free(f->start);
    free(f->quad);
    *f = (fans){0};
}

static mrt_result fans_init(fans *out, const sheet *s, error *err)
{
    size_t points = (size_t)s->point_count, quads = (size_t)s->quad_count;
    *out = (fans){.start = calloc(points + 2, sizeof(int32_t)),
                  .quad = calloc(4 * quads + 1, sizeof(int32_t))};
    if (!out->start || !out->quad) {
        fans_finish(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the fans of %d points",
                         s->point_count);
    }
    /* Filled one row late: when all are placed, each start has moved to where it belongs. */
    int32_t *end = out->start + 1;
    for (int32_t q = 0; q < s->quad_count; ++q)
        for (int k = 0; k < 4; ++k)
            end[s->quad[q].corner[k] + 1]++;
    for (int32_t v = 0; v < s->point_count; ++v)
        end[v + 1] += end[v];
    for (int32_t q = 0; q < s->quad_count; ++q)
        for (int k = 0; k < 4; ++k)
            out->quad[end[s->quad[q].corner[k]]++] = q;
    return MRT_OK;
}

static double area_mm2(const sheet *s, const sheet_quad *q)
{
    vec3 across = vec3_sub(s->point[q->corner[2]], s->point[q->corner[0]]);
    vec3 other = vec3_sub(s->point[q->corner[3]], s->point[q->corner[1]]);
    return 0.5 * vec3_length(vec3_cross(across, other));
}

static vec3 centre_of(const sheet *s, const sheet_quad *q)
{
    vec3 sum = {0, 0, 0};
    for (int k = 0; k < 4; ++k)
        sum = vec3_add(sum, s->point[q->corner[k]]);
    return vec3_scale(sum, 0.25);
}

/* A point on the middle has the mirrored quads too: they take its x back to 0. */
static vec3 wanted_point(const sheet *s, const fans *f, int32_t v, sheet_pull pull)
{
    vec3 sum = {0, 0, 0};
    double weight = 0.0;
    for (int32_t i = f->start[v]; i < f->start[v + 1]; ++i) {
        const sheet_quad *q = &s->quad[f->quad[i]];
        double share = pull == SHEET_AREA ? area_mm2(s, q) + 1e-6 : 1.0;
        sum = vec3_add(sum, vec3_scale(centre_of(s, q), share));
        weight += share;
    }
    return vec3_scale(sum, 1.0 / weight);
}

static void relax_point(sheet *s, int32_t v, vec3 wanted, double step, sheet_projection project)
{
    vec3 old = s->point[v];
    if (s->hold[v] & SHEET_MIDDLE)
        wanted.x = 0.0;
    vec3 moved = vec3_add(old, vec3_scale(vec3_sub(wanted, old), step));
    if (project)
        moved = project(moved);
    if (s->hold[v] & SHEET_MIDDLE)
        moved.x = 0.0;
    s->point[v] = moved;
}

mrt_result sheet_relax(sheet *s, int32_t first_point, int32_t round_count, sheet_pull pull,
                       sheet_projection project, error *err)
{
    fans f;
    mrt_result result = fans_init(&f, s, err);
    if (result < 0)
        return result;
    double step = pull == SHEET_AREA ? AREA_STEP : EVEN_STEP;
    for (int32_t round = 0; round < round_count; ++round)
        for (int32_t v = first_point; v < s->point_count; ++v) {
            if (s->hold[v] & SHEET_FIXED || f.start[v] == f.start[v + 1])
                continue;
            relax_point(s, v, wanted_point(s, &f, v, pull), step, project);
        }
    fans_finish(&f);
    return MRT_OK;
}
