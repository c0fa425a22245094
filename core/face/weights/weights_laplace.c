#include "face/weights/weights_laplace.h"

#include "base/rigid.h"
#include "mesh/position.h"

#include <cholmod.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bounds of cotangents and areas, so that slivers do not dominate the operator. Negative cotangents
 * are correct: without them the weights of a quad would depend on its diagonal. The two halves of a
 * face, if split alike instead of mirrored, would then differ by 0.08. The system is still positive
 * definite. */
#define COTANGENT_LEAST (-1.0)
#define COTANGENT_MOST  20.0
#define STIFFNESS_MOST  100.0
#define STRETCH_LEAST   1e-3
/* The tension dominates at distances of an eighth of the surface's width. */
#define TENSION_WIDTHS 8.0
/* Changes shrink to a sixth in each ring of edges. */
#define FADE 2.0

/* Returns the index of `to` in the row of `from`, or SIZE_MAX if they are not neighbours. */
static size_t edge_of(const topology *t, uint32_t from, uint32_t to)
{
    size_t low = t->neighbour_start[from], high = t->neighbour_start[from + 1];
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (t->neighbour[middle] < to)
            low = middle + 1;
        else
            high = middle;
    }
    return low < t->neighbour_start[from + 1] && t->neighbour[low] == to ? low : SIZE_MAX;
}

static void add_to_edge(laplace *l, uint32_t a, uint32_t b, double cotangent)
{
    size_t there = edge_of(l->topology, a, b), back = edge_of(l->topology, b, a);
    if (there == SIZE_MAX || back == SIZE_MAX)
        return;
    l->edge_weight[there] += cotangent;
    l->edge_weight[back] += cotangent;
}

/* Adds half the cotangents of its corners to the opposite edges, and a third of its area to its
 * corners. */
static void add_triangle(laplace *l, const mesh *m, const uint32_t corner[3])
{
    for (int i = 0; i < 3; i++) {
        uint32_t a = corner[i], b = corner[(i + 1) % 3], c = corner[(i + 2) % 3];
        vec3 to_b = vec3_sub(mesh_position(m, b), mesh_position(m, a));
        vec3 to_c = vec3_sub(mesh_position(m, c), mesh_position(m, a));
        double twice_area = vec3_length(vec3_cross(to_b, to_c));
        double cosine = vec3_dot(to_b, to_c);
        l->stiffness[a] += twice_area / 6;
        if (twice_area > 1e-12 * (vec3_dot(to_b, to_b) + vec3_dot(to_c, to_c)))
            add_to_edge(l, b, c, 0.5 * cosine / twice_area);
    }
}

static void add_triangles(laplace *l, const mesh *m)
{
    const topology *t = l->topology;
    uint32_t next_rejected = 0;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        if (next_rejected < t->rejected_count && t->rejected_triangle[next_rejected] == i) {
            next_rejected++;
            continue;
        }
        const uint32_t *corner = m->triangle + 3 * (size_t)i;
        add_triangle(l, m,
                     (uint32_t[3]){mesh_point(m, corner[0]), mesh_point(m, corner[1]),
                                   mesh_point(m, corner[2])});
    }
}

static void bound_operator(laplace *l)
{
    const topology *t = l->topology;
    double area = 0;
    for (uint32_t v = 0; v < t->vertex_count; v++)
        area += l->stiffness[v];
    uint32_t used = t->vertex_count - t->isolated_vertex_count;
    double mean = used > 0 ? area / used : 0;
    for (uint32_t v = 0; v < t->vertex_count; v++) {
        double least = mean / STIFFNESS_MOST;
        l->stiffness[v] = mean > 0 ? mean / fmax(l->stiffness[v], least) : 1;
    }
    for (size_t e = 0; e < t->neighbour_start[t->vertex_count]; e++)
        l->edge_weight[e] = fmin(fmax(l->edge_weight[e], COTANGENT_LEAST), COTANGENT_MOST);
    l->tension = area > 0 ? mean / area * (TENSION_WIDTHS * TENSION_WIDTHS) : 1;
}

mrt_result laplace_create(laplace *out, const mesh *m, const topology *t, error *err)
{
    size_t edge_count = t->neighbour_start[t->vertex_count];
    *out = (laplace){.topology = t,
                     .edge_weight = calloc(edge_count + 1, sizeof(double)),
                     .stiffness = calloc(t->vertex_count + (size_t)1, sizeof(double))};
    if (out->edge_weight == NULL || out->stiffness == NULL) {
        laplace_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the weights of %u vertices",
                         t->vertex_count);
    }
    add_triangles(out, m);
    bound_operator(out);
    return MRT_OK;
}

void laplace_destroy(laplace *l)
{
    free(l->edge_weight);
    free(l->stiffness);
    *l = (laplace){0};
}

/* ---- a single fill ---- */

typedef enum fill_kind { FILL_SMOOTH = 0, FILL_FADES } fill_kind;

typedef struct fill {
    const laplace *laplace;
    fill_kind kind;
    const uint8_t *is_free, *is_given;
    uint32_t *free_row; /* vertex_count: row of a free vertex */
    uint32_t free_count;
    cholmod_common common;
    cholmod_sparse *root; /* free_count by (vertices, then edges); the system is root root' */
    cholmod_factor *factor;
    cholmod_dense *right, *solution;
} fill;

static bool is_present(const fill *f, uint32_t v)
{
    return f->is_free[v] || f->is_given[v];
}

/* Returns the diagonal of row v of the Laplacian. Only edges between present vertices count. */
static double diagonal_of(const fill *f, uint32_t v)
{
    const topology *t = f->laplace->topology;
    double sum = 0;
    for (size_t e = t->neighbour_start[v]; e < t->neighbour_start[v + 1]; e++)
        if (is_present(f, t->neighbour[e]))
            sum += f->laplace->edge_weight[e];
    return sum;
}

static void append_entry(cholmod_sparse *s, int *at, uint32_t row, double value)
{
    ((int *)s->i)[*at] = (int)row;
    ((double *)s->x)[*at] = value;
    *at += 1;
}

/* Writes the column of vertex v: its row of the Laplacian, over the free vertices, in ascending
 * order. */
static void append_bend(const fill *f, int *at, uint32_t v)
{
    const topology *t = f->laplace->topology;
    double scale = sqrt(f->laplace->stiffness[v]);
    bool is_placed = !f->is_free[v];
    for (size_t e = t->neighbour_start[v]; e < t->neighbour_start[v + 1]; e++) {
        uint32_t other = t->neighbour[e];
        if (!is_placed && other > v) {
            append_entry(f->root, at, f->free_row[v], scale * diagonal_of(f, v));
            is_placed = true;
        }
        if (f->is_free[other])
            append_entry(f->root, at, f->free_row[other], -scale * f->laplace->edge_weight[e]);
    }
    if (!is_placed)
        append_entry(f->root, at, f->free_row[v], scale * diagonal_of(f, v));
}

/* Writes the column of vertex v: its own value. */
static void append_fade(const fill *f, int *at, uint32_t v)
{
    if (f->is_free[v])
        append_entry(f->root, at, f->free_row[v], FADE / sqrt(f->laplace->stiffness[v]));
}

static double stretch_of(const fill *f, double edge_weight)
{
    double tension = f->kind == FILL_FADES ? 1 : f->laplace->tension;
    return sqrt(tension * fmax(edge_weight, STRETCH_LEAST));
}

static void append_stretch(const fill *f, int *at, uint32_t v, uint32_t other, double edge_weight)
{
    double scale = stretch_of(f, edge_weight);
    if (f->is_free[v])
        append_entry(f->root, at, f->free_row[v], scale);
    if (f->is_free[other])
        append_entry(f->root, at, f->free_row[other], -scale);
}

static void fill_root(fill *f)
{
    const topology *t = f->laplace->topology;
    int at = 0, column = 0;
    int *start = f->root->p;
    for (uint32_t v = 0; v < t->vertex_count; v++) {
        start[column++] = at;
        if (is_present(f, v) && f->kind == FILL_FADES)
            append_fade(f, &at, v);
        else if (is_present(f, v))
            append_bend(f, &at, v);
    }
    for (uint32_t v = 0; v < t->vertex_count; v++)
        for (size_t e = t->neighbour_start[v]; e < t->neighbour_start[v + 1]; e++) {
            uint32_t other = t->neighbour[e];
            if (other <= v)
                continue;
            start[column++] = at;
            if (is_present(f, v) && is_present(f, other))
                append_stretch(f, &at, v, other, f->laplace->edge_weight[e]);
        }
    start[column] = at;
}

/* Subtracts root * (effect of the given values on the columns of root) from right, for one column
 * of values. */
static void add_given(const fill *f, double *right, const float *value)
{
    const topology *t = f->laplace->topology;
    const int *start = f->root->p, *row = f->root->i;
    const double *x = f->root->x;
    int column = 0;
    for (uint32_t v = 0; v < t->vertex_count; v++, column++) {
        if (start[column] == start[column + 1] || f->kind == FILL_FADES)
            continue; /* changes fade to 0 */
        double bend = f->is_given[v] ? diagonal_of(f, v) * (double)value[v] : 0;
        for (size_t e = t->neighbour_start[v]; e < t->neighbour_start[v + 1]; e++)
            if (f->is_given[t->neighbour[e]])
                bend -= f->laplace->edge_weight[e] * (double)value[t->neighbour[e]];
        bend *= sqrt(f->laplace->stiffness[v]);
        for (int i = start[column]; i < start[column + 1]; i++)
            right[row[i]] -= x[i] * bend;
    }
    for (uint32_t v = 0; v < t->vertex_count; v++)
        for (size_t e = t->neighbour_start[v]; e < t->neighbour_start[v + 1]; e++) {
            uint32_t other = t->neighbour[e];
            if (other <= v)
                continue;
            double stretch = (f->is_given[v] ? (double)value[v] : 0) -
                             (f->is_given[other] ? (double)value[other] : 0);
            stretch *= stretch_of(f, f->laplace->edge_weight[e]);
            for (int i = start[column]; i < start[column + 1]; i++)
                right[row[i]] -= x[i] * stretch;
            column++;
        }
}

static bool number_free(fill *f, uint32_t vertex_count)
{
    f->free_row = malloc((vertex_count + (size_t)1) * sizeof(uint32_t));
    if (f->free_row == NULL)
        return false;
    for (uint32_t v = 0; v < vertex_count; v++)
        if (f->is_free[v])
            f->free_row[v] = f->free_count++;
    return true;
}

/* Uses the simplicial method in AMD's order, without BLAS, whose sums differ between machines. */
static void start_cholmod(cholmod_common *common)
{
    cholmod_start(common);
    common->supernodal = CHOLMOD_SIMPLICIAL;
    common->nmethods = 1;
    common->method[0].ordering = CHOLMOD_AMD;
    common->postorder = 1;
    common->print = 0;
    common->error_handler = NULL;
    common->try_catch = 1;
}

static mrt_result failed(const fill *f, error *err)
{
    if (f->common.status == CHOLMOD_OUT_OF_MEMORY || f->common.status == CHOLMOD_TOO_LARGE)
        return error_set(err, MRT_ERR_MEMORY, "no memory to fill weights over %u vertices",
                         f->free_count);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "cannot fill the weights over the surface (%u free vertices); check for "
                     "degenerate triangles, or mark more vertices",
                     f->free_count);
}

static mrt_result factor_system(fill *f, error *err)
{
    const topology *t = f->laplace->topology;
    size_t edges = t->neighbour_start[t->vertex_count];
    size_t columns = t->vertex_count + edges / 2;
    size_t entries = t->vertex_count + edges + edges;
    f->root =
        cholmod_allocate_sparse(f->free_count, columns, entries, 1, 1, 0, CHOLMOD_REAL, &f->common);
    if (f->root == NULL)
        return failed(f, err);
    fill_root(f);
    cholmod_sparse *system = cholmod_aat(f->root, NULL, 0, 1, &f->common);
    if (system == NULL)
        return failed(f, err);
    system->stype = 1;
    f->factor = cholmod_analyze(system, &f->common);
    bool is_factored = f->factor != NULL && cholmod_factorize(system, f->factor, &f->common) &&
                       f->common.status == CHOLMOD_OK && f->factor->minor == f->factor->n;
    cholmod_free_sparse(&system, &f->common);
    return is_factored ? MRT_OK : failed(f, err);
}

static mrt_result solve_columns(fill *f, float *value, uint32_t column_count, error *err)
{
    uint32_t vertex_count = f->laplace->topology->vertex_count;
    f->right = cholmod_zeros(f->free_count, column_count, CHOLMOD_REAL, &f->common);
    if (f->right == NULL)
        return failed(f, err);
    for (uint32_t c = 0; c < column_count; c++)
        add_given(f, (double *)f->right->x + (size_t)c * f->free_count,
                  value + (size_t)c * vertex_count);
    f->solution = cholmod_solve(CHOLMOD_A, f->factor, f->right, &f->common);
    if (f->solution == NULL)
        return failed(f, err);
    for (uint32_t c = 0; c < column_count; c++)
        for (uint32_t v = 0; v < vertex_count; v++) {
            if (!f->is_free[v])
                continue;
            const double *solved = (const double *)f->solution->x + (size_t)c * f->free_count;
            if (!isfinite(solved[f->free_row[v]]))
                return failed(f, err);
            value[(size_t)c * vertex_count + v] = (float)solved[f->free_row[v]];
        }
    return MRT_OK;
}

static mrt_result solve(const laplace *l, fill_kind kind, float *value, uint32_t column_count,
                        const uint8_t *is_free, const uint8_t *is_given, error *err)
{
    fill f = {.laplace = l, .kind = kind, .is_free = is_free, .is_given = is_given};
    if (!number_free(&f, l->topology->vertex_count))
        return error_set(err, MRT_ERR_MEMORY, "no memory to fill weights");
    if (f.free_count == 0 || column_count == 0) {
        free(f.free_row);
        return MRT_OK;
    }
    mrt_result result = MRT_OK;
    start_cholmod(&f.common);
    if (f.free_count > LAPLACE_FREE_MOST)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "%u vertices have no mark, but weights can be filled over at most %u; "
                           "mark rigid parts, or use a coarser mesh",
                           f.free_count, LAPLACE_FREE_MOST);
    if (result == MRT_OK)
        result = factor_system(&f, err);
    if (result == MRT_OK)
        result = solve_columns(&f, value, column_count, err);
    cholmod_free_dense(&f.solution, &f.common);
    cholmod_free_dense(&f.right, &f.common);
    cholmod_free_factor(&f.factor, &f.common);
    cholmod_free_sparse(&f.root, &f.common);
    cholmod_finish(&f.common);
    free(f.free_row);
    return result;
}

mrt_result laplace_fill(const laplace *l, float *value, uint32_t column_count,
                        const uint8_t *is_free, const uint8_t *is_given, error *err)
{
    return solve(l, FILL_SMOOTH, value, column_count, is_free, is_given, err);
}

mrt_result laplace_fade(const laplace *l, float *change, uint32_t column_count,
                        const uint8_t *is_free, const uint8_t *is_given, error *err)
{
    return solve(l, FILL_FADES, change, column_count, is_free, is_given, err);
}
