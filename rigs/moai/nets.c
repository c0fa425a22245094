#include "nets.h"

#include <stdlib.h>

enum { CELLS_CAP = 512 };

typedef struct grid {
    int32_t count[3]; /* corners along x, y, z; one more than cells */
    vec3 first;       /* the lowest corner; x is -cell/2, so that a layer of cells contains x = 0 */
    double cell_mm;
    float *value;    /* distance at the corners, x fastest */
    int32_t *vertex; /* of each cell (by its lowest corner); SKIN_NONE if not crossed */
} grid;

static size_t corner_index(const grid *g, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)g->count[1] + (size_t)y) * (size_t)g->count[0] + (size_t)x;
}

static vec3 corner_point(const grid *g, int32_t x, int32_t y, int32_t z)
{
    return vec3_add(g->first, vec3_scale((vec3){x, y, z}, g->cell_mm));
}

static void grid_finish(grid *g)
{
    free(g->value);
    free(g->vertex);
    *g = (grid){0};
}

static mrt_result grid_init(grid *out, vec3 low, vec3 high, double cell_mm, error *err)
{
    *out = (grid){.first = {-0.5 * cell_mm, low.y - cell_mm, low.z - cell_mm}, .cell_mm = cell_mm};
    const double span[3] = {high.x - out->first.x, high.y - out->first.y, high.z - out->first.z};
    size_t total = 1;
    for (int axis = 0; axis < 3; ++axis) {
        double cells = span[axis] / cell_mm + 2.0;
        if (!(cells > 2.0 && cells < CELLS_CAP))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "the grid has %g cells along axis %d: expected 3 to %d", cells, axis,
                             CELLS_CAP);
        out->count[axis] = (int32_t)cells + 1;
        total *= (size_t)out->count[axis];
    }
    out->value = malloc(total * sizeof *out->value);
    out->vertex = malloc(total * sizeof *out->vertex);
    if (out->value && out->vertex)
        return MRT_OK;
    grid_finish(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for a grid of %zu corners", total);
}

static void sample(grid *g, double (*distance)(vec3))
{
    for (int32_t z = 0; z < g->count[2]; ++z)
        for (int32_t y = 0; y < g->count[1]; ++y)
            for (int32_t x = 0; x < g->count[0]; ++x) {
                size_t i = corner_index(g, x, y, z);
                g->value[i] = (float)distance(corner_point(g, x, y, z));
                g->vertex[i] = SKIN_NONE;
            }
}

/* Computes the mean of the points where the surface crosses the cell's edges. Returns 0 if it does
 * not. */
static int cell_point(const grid *g, int32_t x, int32_t y, int32_t z, vec3 *out)
{
    float value[8];
    for (int32_t k = 0; k < 8; ++k)
        value[k] = g->value[corner_index(g, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))];
    vec3 sum = {0, 0, 0};
    int crossing_count = 0;
    for (int32_t k = 0; k < 8; ++k)
        for (int32_t bit = 1; bit < 8; bit *= 2) {
            int32_t other = k | bit;
            if (other == k || (value[k] < 0.0f) == (value[other] < 0.0f))
                continue;
            double at = (double)value[k] / ((double)value[k] - (double)value[other]);
            vec3 from = {k & 1, k >> 1 & 1, k >> 2};
            vec3 step = {bit & 1, bit >> 1 & 1, bit >> 2};
            sum = vec3_add(sum, vec3_add(from, vec3_scale(step, at)));
            ++crossing_count;
        }
    if (crossing_count == 0)
        return 0;
    vec3 offset = vec3_scale(sum, g->cell_mm / crossing_count);
    *out = vec3_add(corner_point(g, x, y, z), offset);
    return 1;
}

static mrt_result place_vertices(grid *g, skin *out, error *err)
{
    for (int32_t z = 0; z + 1 < g->count[2]; ++z)
        for (int32_t y = 0; y + 1 < g->count[1]; ++y)
            for (int32_t x = 0; x + 1 < g->count[0]; ++x) {
                vec3 point;
                if (!cell_point(g, x, y, z, &point))
                    continue;
                if (x == 0)
                    point.x = 0.0;
                g->vertex[corner_index(g, x, y, z)] = out->vertex_count;
                mrt_result result =
                    skin_add_point(out, point, x == 0 ? SKIN_MIDDLE : SKIN_FREE, err);
                if (result < 0)
                    return result;
            }
    return MRT_OK;
}

static int32_t crossed_cell_count(const grid *g)
{
    int32_t count = 0;
    vec3 point;
    for (int32_t z = 0; z + 1 < g->count[2]; ++z)
        for (int32_t y = 0; y + 1 < g->count[1]; ++y)
            for (int32_t x = 0; x + 1 < g->count[0]; ++x)
                count += cell_point(g, x, y, z, &point);
    return count;
}

static mrt_result add_quad(skin *out, const int32_t corner[4], error *err)
{
    for (int k = 0; k < 4; ++k)
        if (corner[k] == SKIN_NONE)
            return error_set(err, MRT_ERR_FORMAT, "the surface reaches the border of the grid");
    mrt_result result = skin_add_triangle(out, corner[0], corner[1], corner[2], err);
    return result < 0 ? result : skin_add_triangle(out, corner[0], corner[2], corner[3], err);
}

/* Adds the quad of the four cells around the grid edge that leaves corner x, y, z along `axis`. */
static mrt_result add_quad_at(const grid *g, skin *out, const int32_t at[3], int axis, error *err)
{
    int32_t next[3] = {at[0], at[1], at[2]};
    next[axis]++;
    int starts_inside = g->value[corner_index(g, at[0], at[1], at[2])] < 0.0f;
    int ends_inside = g->value[corner_index(g, next[0], next[1], next[2])] < 0.0f;
    if (starts_inside == ends_inside)
        return MRT_OK;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    static const int32_t AROUND[4][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
    int32_t corner[4];
    for (int k = 0; k < 4; ++k) {
        int32_t cell[3] = {at[0], at[1], at[2]};
        cell[u] += AROUND[k][0];
        cell[v] += AROUND[k][1];
        corner[starts_inside ? k : 3 - k] = g->vertex[corner_index(g, cell[0], cell[1], cell[2])];
    }
    return add_quad(out, corner, err);
}

/* Edges across x = 0 are never crossed. Edges at the lowest x belong to the other half. */
static mrt_result add_quads(const grid *g, skin *out, error *err)
{
    for (int32_t z = 1; z + 1 < g->count[2]; ++z)
        for (int32_t y = 1; y + 1 < g->count[1]; ++y)
            for (int32_t x = 1; x + 1 < g->count[0]; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    const int32_t at[3] = {x, y, z};
                    mrt_result result = add_quad_at(g, out, at, axis, err);
                    if (result < 0)
                        return result;
                }
    return MRT_OK;
}

mrt_result nets_half(skin *out, double (*distance)(vec3), vec3 low, vec3 high, double cell_mm,
                     error *err)
{
    grid g;
    *out = (skin){0};
    mrt_result result = grid_init(&g, low, high, cell_mm, err);
    if (result < 0)
        return result;
    sample(&g, distance);
    int32_t vertex_count = crossed_cell_count(&g);
    result = skin_create(out, 4 * vertex_count + 4, 8 * vertex_count + 8, err);
    if (result >= 0)
        result = place_vertices(&g, out, err);
    if (result >= 0)
        result = add_quads(&g, out, err);
    if (result >= 0)
        result = skin_join(out, err);
    grid_finish(&g);
    if (result < 0)
        skin_destroy(out);
    return result;
}
