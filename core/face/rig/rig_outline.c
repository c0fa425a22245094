#include "face/rig/rig_outline.h"

#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>

enum { CELLS = 96, MARGIN = 1, SIDE = CELLS + 2 * MARGIN, COUNT = SIDE * SIDE };

typedef struct outline { /* seen along x: columns from the back to the front, rows upwards */
    double cell_mm;
    double inside[COUNT]; /* distance to the border in cells; 0 outside */
    int part[COUNT];      /* 0: outside of all parts */
    int stack[COUNT];
} outline;

typedef struct part { /* cells that are further inside than a limit, and joined */
    double radius;    /* of the largest disc around one of its cells, in cells */
    double row, column;
} part;

static const double least_radius = 0.3; /* of a head, as a share of the largest disc */

static double corner_row(const outline *o, vec3 p, vec3 low)
{
    return (p.y - low.y) / o->cell_mm + MARGIN;
}

static double corner_column(const outline *o, vec3 p, vec3 low)
{
    return (p.z - low.z) / o->cell_mm + MARGIN;
}

/* Marks the cells whose centre the triangle covers, and those of its corners. */
static void draw(outline *o, const vec3 corner[3], vec3 low)
{
    double row[3], column[3];
    for (int i = 0; i < 3; ++i) {
        row[i] = corner_row(o, corner[i], low);
        column[i] = corner_column(o, corner[i], low);
        o->inside[(int)row[i] * SIDE + (int)column[i]] = INFINITY;
    }
    const double area =
        (row[1] - row[0]) * (column[2] - column[0]) - (row[2] - row[0]) * (column[1] - column[0]);
    const int first = (int)fmin(row[0], fmin(row[1], row[2])),
              last = (int)fmax(row[0], fmax(row[1], row[2])),
              left = (int)fmin(column[0], fmin(column[1], column[2])),
              right = (int)fmax(column[0], fmax(column[1], column[2]));
    for (int y = first; area != 0.0 && y <= last; ++y)
        for (int x = left; x <= right; ++x) {
            const double dy = y + 0.5 - row[0], dx = x + 0.5 - column[0];
            const double u = (dy * (column[2] - column[0]) - (row[2] - row[0]) * dx) / area;
            const double v = ((row[1] - row[0]) * dx - dy * (column[1] - column[0])) / area;
            if (u >= 0.0 && v >= 0.0 && u + v <= 1.0)
                o->inside[y * SIDE + x] = INFINITY;
        }
}

static void come_nearer(outline *o, int cell, int other, double step)
{
    o->inside[cell] = fmin(o->inside[cell], o->inside[other] + step);
}

/* Replaces marks by distances to the border, in two passes over the cells. */
static void measure_inside(outline *o)
{
    const double across = sqrt(2.0);
    for (int y = 1; y < SIDE - 1; ++y)
        for (int x = 1; x < SIDE - 1; ++x) {
            const int cell = y * SIDE + x;
            come_nearer(o, cell, cell - 1, 1.0);
            come_nearer(o, cell, cell - SIDE, 1.0);
            come_nearer(o, cell, cell - SIDE - 1, across);
            come_nearer(o, cell, cell - SIDE + 1, across);
        }
    for (int y = SIDE - 2; y > 0; --y)
        for (int x = SIDE - 2; x > 0; --x) {
            const int cell = y * SIDE + x;
            come_nearer(o, cell, cell + 1, 1.0);
            come_nearer(o, cell, cell + SIDE, 1.0);
            come_nearer(o, cell, cell + SIDE + 1, across);
            come_nearer(o, cell, cell + SIDE - 1, across);
        }
}

/* Collects the cells that are joined to `from` and further inside than the limit. */
static part fill_part(outline *o, int from, int number, double limit)
{
    static const int step[4] = {1, -1, SIDE, -SIDE};
    part out = {0};
    int used = 0;
    o->part[from] = number;
    o->stack[used++] = from;
    while (used > 0) {
        const int cell = o->stack[--used];
        if (o->inside[cell] > out.radius)
            out = (part){o->inside[cell], cell / SIDE, cell % SIDE};
        for (int i = 0; i < 4; ++i) {
            const int next = cell + step[i];
            if (o->part[next] != 0 || !(o->inside[next] > limit))
                continue;
            o->part[next] = number;
            o->stack[used++] = next;
        }
    }
    return out;
}

/* Finds the foremost large part if another one lies behind it, and the one that lies furthest
 * behind. */
static bool find_front_part(part *out, part *out_rear, outline *o, double limit, double least,
                            double least_row)
{
    part rear = {.column = (double)INFINITY};
    bool found = false;
    int count = 0;
    for (int i = 0; i < COUNT; ++i)
        o->part[i] = 0;
    for (int i = 0; i < COUNT; ++i) {
        if (o->part[i] != 0 || !(o->inside[i] > limit))
            continue;
        const part p = fill_part(o, i, ++count, limit);
        if (p.radius < least || p.radius < 1.02 * limit)
            continue;
        if (p.column < rear.column)
            rear = p;
        if (p.row >= least_row && (!found || p.column > out->column))
            *out = p;
        found = found || p.row >= least_row;
    }
    *out_rear = rear;
    return found && out->column - rear.column > out->radius + rear.radius;
}

bool rig_outline_find_head(outline_head *out, const mesh *m, const uint8_t *is_head, vec3 low,
                           vec3 high)
{
    const vec3 size = vec3_sub(high, low);
    if (!(size.z > 1.5 * size.x) ||
        !(size.y > 0.4 * size.z)) /* too wide or too flat for an animal */
        return false;
    outline *o = calloc(1, sizeof *o);
    if (!o)
        return false;
    o->cell_mm = fmax(size.y, size.z) / (CELLS - 1e-6);
    for (uint32_t i = 0; i < m->triangle_count; ++i) {
        const uint32_t *index = m->triangle + (size_t)i * 3;
        const vec3 corner[3] = {mesh_position(m, index[0]), mesh_position(m, index[1]),
                                mesh_position(m, index[2])};
        if (is_head[index[0]] && is_head[index[1]] && is_head[index[2]])
            draw(o, corner, low);
    }
    measure_inside(o);
    double largest = 0.0;
    for (int i = 0; i < COUNT; ++i)
        largest = fmax(largest, o->inside[i]);
    const double least_row = 0.18 * size.y / o->cell_mm + MARGIN; /* legs are below */
    part head = {0}, rear = {0};
    bool found = false;
    for (double share = least_radius; !found && share < 1.0; share += 0.01)
        found =
            find_front_part(&head, &rear, o, share * largest, least_radius * largest, least_row);
    if (found) {
        const double rows = head.row - rear.row, columns = head.column - rear.column;
        *out = (outline_head){.y = low.y + (head.row + 0.5 - MARGIN) * o->cell_mm,
                              .z = low.z + (head.column + 0.5 - MARGIN) * o->cell_mm,
                              .radius_mm = head.radius * o->cell_mm,
                              .up_y = rows / hypot(rows, columns),
                              .up_z = columns / hypot(rows, columns)};
    }
    free(o);
    return found;
}
