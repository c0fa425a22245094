#include "io/read/mesh_shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points on the surface, a grid on each triangle, at most so many on an edge. */
enum { SAMPLES_MAX = 160 };

typedef struct sampling {
    float low[3];
    double cell; /* size of a cell, in units of the file */
} sampling;

/* Calls `found` with points of all triangles that are no further apart than half a cell. */
static void sample_surface(const mesh *m, const sampling *s,
                           void (*found)(void *self, const int cell[3], const double at[3]),
                           void *self)
{
    for (const uint32_t *t = m->triangle, *end = t + (size_t)m->triangle_count * 3; t < end;
         t += 3) {
        double corner[3][3], longest = 0.0;
        for (int i = 0; i < 3; ++i)
            for (int axis = 0; axis < 3; ++axis)
                corner[i][axis] =
                    ((double)m->position[(size_t)t[i] * 3 + (size_t)axis] - (double)s->low[axis]) /
                    s->cell;
        for (int i = 0; i < 3; ++i)
            for (int axis = 0; axis < 3; ++axis)
                longest = fmax(longest, fabs(corner[i][axis] - corner[(i + 1) % 3][axis]));
        const int steps = (int)fmin(ceil(2.0 * longest) + 1.0, (double)SAMPLES_MAX);
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j) {
                const double u = (double)i / steps, v = (double)j / steps;
                double at[3];
                int cell[3];
                for (int axis = 0; axis < 3; ++axis) {
                    at[axis] = corner[0][axis] + u * (corner[1][axis] - corner[0][axis]) +
                               v * (corner[2][axis] - corner[0][axis]);
                    cell[axis] = (int)at[axis];
                }
                found(self, cell, at);
            }
    }
}

static bool measure_cells(sampling *out, double size[3], const mesh *m, int cells)
{
    float high[3];
    mesh_bounds(m, out->low, high);
    double longest = 0.0;
    for (int i = 0; i < 3; ++i) {
        size[i] = (double)high[i] - (double)out->low[i];
        longest = fmax(longest, size[i]);
    }
    out->cell = longest / cells;
    return out->cell > 0.0 && isfinite(out->cell) && m->triangle_count > 0;
}

/* ---- symmetry ---- */

enum { GRID = 32, SIDE = GRID + 3 }; /* one empty cell around the others */

typedef struct grid {
    uint8_t is_full[SIDE][SIDE][SIDE];
} grid;

static void fill_cell(void *self, const int cell[3], const double at[3])
{
    (void)at;
    ((grid *)self)->is_full[cell[0] + 1][cell[1] + 1][cell[2] + 1] = 1;
}

static bool is_near(const grid *g, const int at[3])
{
    for (int axis = 0; axis < 3; ++axis)
        if (at[axis] < 1 || at[axis] >= SIDE - 1)
            return false;
    const int x = at[0], y = at[1], z = at[2];
    return g->is_full[x][y][z] || g->is_full[x - 1][y][z] || g->is_full[x + 1][y][z] ||
           g->is_full[x][y - 1][z] || g->is_full[x][y + 1][z] || g->is_full[x][y][z - 1] ||
           g->is_full[x][y][z + 1];
}

/* `sum`: of the numbers of two cells that are mirror images. */
static double share_mirrored(const grid *g, int axis, int sum)
{
    uint32_t full = 0, mirrored = 0;
    for (int x = 1; x < SIDE - 1; ++x)
        for (int y = 1; y < SIDE - 1; ++y)
            for (int z = 1; z < SIDE - 1; ++z) {
                int at[3] = {x, y, z};
                if (!g->is_full[x][y][z])
                    continue;
                full += 1;
                at[axis] = sum - at[axis];
                mirrored += is_near(g, at);
            }
    return full > 0 ? (double)mirrored / full : 0.0;
}

void mesh_symmetry(double out[3], const mesh *m)
{
    enum { ASIDE = 2 }; /* cells: planes beside the middle */
    sampling s;
    double size[3];
    grid *g = calloc(1, sizeof *g);
    out[0] = out[1] = out[2] = 0.0;
    if (g && measure_cells(&s, size, m, GRID)) {
        sample_surface(m, &s, fill_cell, g);
        for (int axis = 0; axis < 3; ++axis) {
            const int middle = (int)(size[axis] / s.cell) + 2;
            for (int sum = middle - ASIDE; sum <= middle + ASIDE; ++sum)
                out[axis] = fmax(out[axis], share_mirrored(g, axis, sum));
        }
    }
    free(g);
}

/* ---- relief ---- */

enum { VIEW = 64, FRAME = VIEW + 3 };

typedef struct view { /* seen along an axis, from one of its ends */
    int axis;
    double sign;
    double depth[FRAME][FRAME]; /* cells; -INFINITY: nothing is seen */
} view;

static void draw_point(void *self, const int cell[3], const double at[3])
{
    view *v = self;
    double *depth = &v->depth[cell[(v->axis + 1) % 3] + 1][cell[(v->axis + 2) % 3] + 1];
    *depth = fmax(*depth, v->sign * at[v->axis]);
}

/* Cells at the silhouette are left out. A step counts as 1.5 at most. */
static double relief_of(const view *v)
{
    enum { INSIDE = 2 };
    const double most = 1.5;
    double sum = 0.0;
    uint32_t count = 0;
    for (int i = INSIDE; i < FRAME - INSIDE; ++i)
        for (int j = INSIDE; j < FRAME - INSIDE; ++j) {
            bool is_inside = true;
            for (int k = -INSIDE; k <= INSIDE; ++k)
                is_inside =
                    is_inside && isfinite(v->depth[i + k][j]) && isfinite(v->depth[i][j + k]);
            if (!is_inside)
                continue;
            sum += fmin(fabs(4.0 * v->depth[i][j] - v->depth[i - 1][j] - v->depth[i + 1][j] -
                             v->depth[i][j - 1] - v->depth[i][j + 1]),
                        most);
            count += 1;
        }
    return count > 0 ? sum / count : 0.0;
}

bool mesh_relief(double out[3][2], const mesh *m)
{
    sampling s;
    double size[3];
    view *v = malloc(sizeof *v);
    memset(out, 0, 3 * sizeof *out);
    if (v && measure_cells(&s, size, m, VIEW))
        for (int side = 0; side < 6; ++side) {
            v->axis = side / 2;
            v->sign = side % 2 == 0 ? 1.0 : -1.0;
            for (int i = 0; i < FRAME * FRAME; ++i)
                v->depth[i / FRAME][i % FRAME] = -(double)INFINITY;
            sample_surface(m, &s, draw_point, v);
            out[side / 2][side % 2] = relief_of(v);
        }
    free(v);
    return v != NULL;
}
