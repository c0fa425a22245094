/* The paper's claims about its solver: the effect of sorting on the matrix, and the engine beside a
 * plain reference solve. */
#include "paper/paper.h"

#include "base/clock.h"
#include "bench/bench.h"
#include "csrbf/kernel.h"
#include "csrbf/saddle.h"
#include "csrbf/shape.h"
#include "io/mesh_file.h"
#include "base/installed.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the fill of the matrix ---- */

enum { FEW = BENCH_CONTROLS, MANY = 3000, MANY_QUICK = 600, RASTER = 150, ORDERS = 3 };
static const double few_radius_mm = 20.0, many_radius_mm = 40.0;
static const char *const order_name[ORDERS] = {"unsorted", "along a Morton curve",
                                               "along the longest axis"};

typedef struct centres {
    uint32_t count;
    double radius_mm;
    order_item *item, *scratch; /* scratch: count elements */
} centres;

typedef struct fill {
    uint32_t nonzero, profile, half_band; /* of the lower triangle, diagonal included */
    double factor_ms, operations;         /* of the factorisation within its envelope */
    uint8_t cell[RASTER][RASTER]; /* 0: zero; 1: within the envelope; 2: has a nonzero entry */
    uint32_t raster;              /* cells on each side */
} fill;

static mrt_result create_centres(centres *out, uint32_t count, double radius_mm, error *err)
{
    *out = (centres){.count = count, .radius_mm = radius_mm};
    out->item = calloc((size_t)2 * count, sizeof *out->item);
    out->scratch = out->item ? out->item + count : NULL;
    return out->item ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for %u centres", count);
}

static void place_few(centres *out)
{
    for (uint32_t i = 0; i < FEW; ++i) {
        memcpy(out->item[i].at, bench_control + (size_t)3 * i, sizeof out->item[i].at);
        out->item[i].row = i;
    }
}

/* Spreads centres evenly over an ellipsoid of the size of a skull, and shuffles them in a fixed
 * way. */
static void place_many(centres *out)
{
    uint64_t state = 2005;
    for (uint32_t i = 0; i < out->count; ++i)
        bench_skull_centre(out->item[i].at, i, out->count, 1.0);
    for (uint32_t i = out->count; i-- > 1;) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        uint32_t other = (uint32_t)((state >> 33) % (i + 1));
        order_item kept = out->item[i];
        out->item[i] = out->item[other];
        out->item[other] = kept;
    }
    for (uint32_t i = 0; i < out->count; ++i)
        out->item[i].row = i;
}

static void sort_centres(centres *c, int order)
{
    if (order == 1)
        order_sort(c->item, c->scratch, c->count);
    else if (order == 2)
        (void)order_sort_along(c->item, c->scratch, c->count);
}

static double entry_of(const centres *c, uint32_t i, uint32_t j)
{
    const double *a = c->item[i].at, *b = c->item[j].at;
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return kernel_value(CSRBF_WENDLAND_C2, sqrt(x * x + y * y + z * z) / c->radius_mm);
}

static void note_cells(fill *out, uint32_t count, uint32_t i, uint32_t from, uint32_t to,
                       uint8_t what)
{
    uint64_t side = out->raster;
    for (uint64_t column = from * side / count; column <= to * side / count; ++column) {
        uint8_t *cell = &out->cell[i * side / count][column];
        *cell = *cell > what ? *cell : what;
    }
}

/* Fills the matrix into `matrix`; rows begin together, as the factorisation needs it. */
static void fill_matrix(fill *out, envelope *matrix, const centres *c)
{
    uint32_t first = 0;
    *out = (fill){.raster = c->count < RASTER ? c->count : RASTER};
    envelope_keep(matrix, 0);
    for (uint32_t i = 0; i < c->count; ++i) {
        uint32_t own = 0;
        while (entry_of(c, i, own) <= 0.0)
            ++own;
        if (i % ENVELOPE_ALIKE == 0) {
            first = own;
            for (uint32_t row = i + 1; row < i + ENVELOPE_ALIKE && row < c->count; ++row)
                for (uint32_t j = 0; j < first; ++j)
                    if (entry_of(c, row, j) > 0.0)
                        first = j;
        }
        double *row = envelope_add_row(matrix, first);
        for (uint32_t j = first; j <= i; ++j) {
            row[j - first] = entry_of(c, i, j);
            if (row[j - first] > 0.0) {
                ++out->nonzero;
                note_cells(out, c->count, i, j, j, 2);
            }
        }
        note_cells(out, c->count, i, own, i, 1);
        out->profile += i - own + 1;
        out->half_band = i - own > out->half_band ? i - own : out->half_band;
        out->operations += 0.5 * (double)(i - own) * (double)(i - own);
    }
}

static mrt_result measure_fill(fill *out, const centres *c, error *err)
{
    envelope matrix;
    uint32_t row = 0;
    mrt_result result = MRT_OK;
    if (!envelope_create(&matrix, c->count))
        return error_set(err, MRT_ERR_MEMORY, "no memory for a matrix of %u rows", c->count);
    double least_ms = INFINITY;
    for (int round = 0; round < 2 && result >= 0; ++round) {
        fill_matrix(out, &matrix, c);
        int64_t start_ns = clock_now_ns();
        if (!envelope_factor(&matrix, 1e-12, &row))
            result =
                error_set(err, MRT_ERR_UNSUPPORTED, "centre %u makes the matrix singular", row);
        least_ms = fmin(least_ms, (double)(clock_now_ns() - start_ns) * 1e-6);
    }
    out->factor_ms = least_ms;
    envelope_destroy(&matrix);
    return result;
}

enum { PANEL = 270, PANEL_GAP = 24, FILL_WIDTH = 24 + 3 * (270 + 24), FILL_TOP = 44 };

static void draw_cells(svg *s, const fill *f, double x, double y, uint8_t what, svg_ink ink)
{
    double side = (double)PANEL / f->raster;
    svg_cells_begin(s, ink);
    for (uint32_t row = 0; row < f->raster; ++row)
        for (uint32_t from = 0; from < f->raster;) {
            uint32_t to = from;
            while (to < f->raster && f->cell[row][to] == what)
                ++to;
            if (to > from)
                svg_cells(s, x, y, side, row, from, to - from);
            from = to > from ? to : from + 1;
        }
    svg_cells_end(s);
}

static void draw_fills(svg *s, const fill f[ORDERS], uint32_t count, double top)
{
    char words[96];
    for (int order = 0; order < ORDERS; ++order) {
        double x = PANEL_GAP + order * (PANEL + PANEL_GAP), all = 0.5 * count * (count + 1.0);
        (void)snprintf(words, sizeof words, "%u, %s", count, order_name[order]);
        svg_strong_words(s, SVG_INK, 14.5, SVG_START, x, top + 18, words);
        (void)snprintf(words, sizeof words, "envelope %.0f %% of the triangle",
                       100.0 * f[order].profile / all);
        svg_words(s, SVG_CALM, 13, SVG_START, x, top + 37, words);
        svg_box(s, SVG_WASH, SVG_LINE, x, top + FILL_TOP, PANEL, PANEL);
        draw_cells(s, &f[order], x, top + FILL_TOP, 1, SVG_SECOND);
        draw_cells(s, &f[order], x, top + FILL_TOP, 2, SVG_FIRST);
    }
}

static mrt_result draw_all_fills(paper *of, const fill few[ORDERS], const fill many[ORDERS],
                                 uint32_t many_count, error *err)
{
    static const char name[] = "solver_fill.svg",
                      what[] = "The lower triangle of the matrix for ten and for many centres: "
                               "unsorted, along a Morton curve, along the longest axis";
    const double pitch = FILL_TOP + PANEL + PANEL_GAP;
    char path[PATH_MAX];
    svg s;
    mrt_result result = paper_add_file(of, path, name, err);
    if (result >= 0)
        result = svg_open(&s, path, FILL_WIDTH, (uint32_t)(2 * pitch) + 52, what, err);
    if (result < 0)
        return result;
    draw_fills(&s, few, FEW, 8);
    draw_fills(&s, many, many_count, 8 + pitch);
    double y = 8 + 2 * pitch + 20;
    svg_point(&s, SVG_FIRST, SVG_SQUARE, PANEL_GAP + 8, y - 5, 6);
    svg_words(&s, SVG_INK, 13.5, SVG_START, PANEL_GAP + 24, y, "entries that are not zero");
    svg_point(&s, SVG_SECOND, SVG_SQUARE, PANEL_GAP + 238, y - 5, 6);
    svg_words(&s, SVG_INK, 13.5, SVG_START, PANEL_GAP + 254, y,
              "zeros within the envelope: the factor fills them");
    result = svg_finish(&s, err);
    if (result >= 0)
        page_picture(of->page, name, what, 640, 0);
    return result;
}

static void add_fill_rows(paper *of, const centres *c, const fill f[ORDERS])
{
    double all = 0.5 * c->count * (c->count + 1.0);
    for (int order = 0; order < ORDERS; ++order) {
        char text[6][32];
        (void)snprintf(text[0], 32, "%u", c->count);
        (void)snprintf(text[1], 32, "%.1f %%", 100.0 * f[order].nonzero / all);
        (void)snprintf(text[2], 32, "%u", f[order].half_band);
        (void)snprintf(text[3], 32, "%.1f %%", 100.0 * f[order].profile / all);
        paper_count(text[4], f[order].operations);
        if (f[order].factor_ms < 0.1)
            (void)snprintf(text[5], 32, "%.2f µs", 1e3 * f[order].factor_ms);
        else
            (void)snprintf(text[5], 32, "%.1f ms", f[order].factor_ms);
        const char *const cell[] = {text[0], order_name[order], text[1], text[2],
                                    text[3], text[4],           text[5]};
        page_row(of->page, cell);
        const facts_cell cells[] = {
            {"centres", NULL, c->count, 0},
            {"radius_mm", NULL, c->radius_mm, 1},
            {"order", order_name[order], 0.0, 0},
            {"nonzero", NULL, f[order].nonzero, 0},
            {"half_band", NULL, f[order].half_band, 0},
            {"envelope", NULL, f[order].profile, 0},
            {"factor_ms", NULL, f[order].factor_ms, 4},
        };
        facts_row(of->told, "fill", "", "", cells, sizeof cells / sizeof cells[0]);
    }
}

static mrt_result fill_in_all_orders(fill out[ORDERS], centres *c, error *err)
{
    mrt_result result = MRT_OK;
    for (int order = 0; order < ORDERS && result >= 0; ++order) {
        sort_centres(c, order);
        result = measure_fill(&out[order], c, err);
        if (result >= 0)
            result = paper_check_stop(err);
    }
    return result;
}

static void add_fill_table(paper *of, const centres *few, const centres *many, const fill f[])
{
    static const char *const head[] = {">centres",   "order",     ">not zero",
                                       ">half band", ">envelope", ">multiplications of the factor",
                                       ">factor"};
    page_table(of->page, head, 7);
    add_fill_rows(of, few, f);
    add_fill_rows(of, many, f + ORDERS);
    page_table_end(of->page);
    page_caption(
        of->page,
        "Shares of the lower triangle. The ten are those of Table 1 at R = %g mm. The many are "
        "spread over a head of the size of a skull, R = %g mm, and shuffled; a cell of their "
        "drawing represents many entries. With only ten centres, sorting saves no measurable "
        "time. It is kept, because sorted centres give the same bits for any numbering. With "
        "thousands the claim is right for the envelope, but not for a band: along the Morton "
        "curve of an octree, single rows reach far back, so that the half band stays wide. The "
        "engine sorts up to 64 centres along the curve, and more along the longest axis, and "
        "stores each row from its first entry on (`core/csrbf/saddle.h`).",
        few->radius_mm, many->radius_mm);
}

static mrt_result add_fill(paper *of, error *err)
{
    centres few = {0}, many = {0};
    fill *f = calloc((size_t)2 * ORDERS, sizeof *f);
    mrt_result result = f ? create_centres(&few, FEW, few_radius_mm, err)
                          : error_set(err, MRT_ERR_MEMORY, "no memory for the solver's claims");
    if (result >= 0)
        result = create_centres(&many, of->is_quick ? MANY_QUICK : MANY, many_radius_mm, err);
    if (result >= 0) {
        place_few(&few);
        place_many(&many);
        page_heading(of->page, "The solver: what sorting does");
        page_text(of->page, "The paper sorts its centres by an octree, so that the matrix becomes "
                            "a band and solving stays cheap. The lower triangle of the matrix, in "
                            "three orders:");
        result = fill_in_all_orders(f, &few, err);
    }
    if (result >= 0)
        result = fill_in_all_orders(f + ORDERS, &many, err);
    if (result >= 0)
        result = draw_all_fills(of, f, f + ORDERS, many.count, err);
    if (result >= 0)
        add_fill_table(of, &few, &many, f);
    free(few.item);
    free(many.item);
    free(f);
    return result;
}

/* ---- a plain reference ---- */

/* The formulas of the paper in long double: the whole saddle matrix at once, Gauss elimination with
 * pivots. It uses nothing of the engine. */
typedef struct reference {
    uint32_t count, terms, size; /* size = count + terms */
    csrbf_kernel kernel;
    double radius;
    const double *centre; /* count by 3 */
    long double *matrix;  /* size by size + 3: the right-hand sides are the last columns */
} reference;

static long double phi(csrbf_kernel kernel, long double r)
{
    if (r >= 1.0L)
        return 0.0L;
    long double t = 1.0L - r, t2 = t * t, t4 = t2 * t2;
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        return t2;
    case CSRBF_WENDLAND_C2:
        return t4 * (4.0L * r + 1.0L);
    case CSRBF_WENDLAND_C4:
        return t4 * t2 * (35.0L * r * r + 18.0L * r + 3.0L) / 3.0L;
    case CSRBF_WENDLAND_C6:
        break;
    }
    return t4 * t4 * (32.0L * r * r * r + 25.0L * r * r + 8.0L * r + 1.0L);
}

static long double apart(const double *a, const double *b)
{
    long double x = (long double)a[0] - (long double)b[0],
                y = (long double)a[1] - (long double)b[1],
                z = (long double)a[2] - (long double)b[2];
    return sqrtl(x * x + y * y + z * z);
}

static long double term_of(uint32_t term, const double *at)
{
    return term == 0 ? 1.0L : (long double)at[term - 1];
}

static void assemble(reference *self, const double *pull)
{
    const size_t stride = (size_t)self->size + 3;
    memset(self->matrix, 0, self->size * stride * sizeof *self->matrix);
    for (size_t i = 0; i < self->count; ++i) {
        long double *row = self->matrix + i * stride;
        for (size_t j = 0; j < self->count; ++j)
            row[j] = phi(self->kernel, apart(self->centre + 3 * i, self->centre + 3 * j) /
                                           (long double)self->radius);
        for (uint32_t term = 0; term < self->terms; ++term) {
            row[self->count + term] = term_of(term, self->centre + 3 * i);
            self->matrix[(self->count + term) * stride + i] = row[self->count + term];
        }
        for (size_t axis = 0; axis < 3; ++axis)
            row[self->size + axis] = (long double)pull[3 * i + axis];
    }
}

static bool eliminate(reference *self)
{
    const size_t stride = (size_t)self->size + 3;
    for (size_t at = 0; at < self->size; ++at) {
        size_t pivot = at;
        for (size_t row = at + 1; row < self->size; ++row)
            if (fabsl(self->matrix[row * stride + at]) > fabsl(self->matrix[pivot * stride + at]))
                pivot = row;
        if (!(fabsl(self->matrix[pivot * stride + at]) > 0.0L))
            return false;
        for (size_t i = 0; i < stride && pivot != at; ++i) {
            long double kept = self->matrix[at * stride + i];
            self->matrix[at * stride + i] = self->matrix[pivot * stride + i];
            self->matrix[pivot * stride + i] = kept;
        }
        for (size_t row = 0; row < self->size; ++row) {
            long double factor = self->matrix[row * stride + at] / self->matrix[at * stride + at];
            for (size_t i = at; i < stride && row != at; ++i)
                self->matrix[row * stride + i] -= factor * self->matrix[at * stride + i];
        }
    }
    return true;
}

static void displace(const reference *self, const double *at, long double out[3])
{
    const size_t stride = (size_t)self->size + 3;
    memset(out, 0, 3 * sizeof *out);
    for (size_t i = 0; i < self->size; ++i) {
        const long double *row = self->matrix + i * stride;
        long double share =
            i < self->count
                ? phi(self->kernel, apart(at, self->centre + 3 * i) / (long double)self->radius)
                : term_of((uint32_t)(i - self->count), at);
        for (int axis = 0; axis < 3; ++axis)
            out[axis] += share * row[self->size + (size_t)axis] / row[i];
    }
}

/* ---- compared with the engine ---- */

enum { TIPS = 10, PINS = 300 };

typedef struct comparison { /* on the Moai */
    const mesh *mesh;
    points_order order;
    points rest, moved;
    double centre[PINS * 3], pull[PINS * 3];
} comparison;

typedef struct deviation { /* greatest, mm */
    double f64_mm, f32_mm, at_controls_mm;
} deviation;

/* Chooses vertices, each the furthest from those before it, with pulls of at most 10 mm. */
static mrt_result choose_centres(comparison *self, error *err)
{
    const mesh *m = self->mesh;
    double *nearest = malloc((size_t)m->vertex_count * sizeof *nearest);
    if (!nearest)
        return error_set(err, MRT_ERR_MEMORY, "no memory for centres");
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        nearest[v] = INFINITY;
    uint32_t chosen = 0;
    for (uint32_t i = 0; i < PINS; ++i) {
        for (uint32_t axis = 0; axis < 3; ++axis) {
            self->centre[3 * i + axis] = (double)m->position[(size_t)3 * chosen + axis];
            self->pull[3 * i + axis] = 5.0 * sin(1.0 + 2.3 * i + 1.7 * axis);
        }
        uint32_t furthest = 0;
        for (uint32_t v = 0; v < m->vertex_count; ++v) {
            double at[3];
            for (uint32_t axis = 0; axis < 3; ++axis)
                at[axis] = (double)m->position[(size_t)3 * v + axis];
            nearest[v] = fmin(nearest[v], (double)apart(at, self->centre + (size_t)3 * i));
            furthest = nearest[v] > nearest[furthest] ? v : furthest;
        }
        chosen = furthest;
    }
    free(nearest);
    return MRT_OK;
}

static double off_by(const double *at, const double *rest, const long double way[3])
{
    long double sum = 0.0L;
    for (int axis = 0; axis < 3; ++axis) {
        long double d = (long double)at[axis] - (long double)rest[axis] - way[axis];
        sum += d * d;
    }
    return (double)sqrtl(sum);
}

static void compare(deviation *out, comparison *self, const csrbf_solver *solver,
                    const reference *plain)
{
    *out = (deviation){0};
    (void)csrbf_move(solver, &self->moved, &self->rest);
    for (size_t slot = 0; slot < self->rest.count; ++slot) {
        double rest[3], f32[3], f64[3];
        long double way[3];
        points_at(rest, &self->rest, slot);
        points_at(f32, &self->moved, slot);
        memcpy(f64, rest, sizeof f64);
        csrbf_move_f64(solver, f64, 1);
        displace(plain, rest, way);
        out->f64_mm = fmax(out->f64_mm, off_by(f64, rest, way));
        out->f32_mm = fmax(out->f32_mm, off_by(f32, rest, way));
    }
    for (size_t i = 0; i < plain->count; ++i) {
        double at[3];
        long double way[3];
        memcpy(at, plain->centre + 3 * i, sizeof at);
        csrbf_move_f64(solver, at, 1);
        for (int axis = 0; axis < 3; ++axis)
            way[axis] = (long double)self->pull[3 * i + (size_t)axis];
        out->at_controls_mm = fmax(out->at_controls_mm, off_by(at, plain->centre + 3 * i, way));
    }
}

static mrt_result solve_both(comparison *self, const csrbf_settings *settings, uint32_t count,
                             deviation *out, error *err)
{
    reference plain = {.count = count,
                       .terms = settings->polynomial == CSRBF_LINEAR ? 4 : 0,
                       .kernel = settings->kernel,
                       .radius = settings->radius,
                       .centre = self->centre};
    plain.size = plain.count + plain.terms;
    plain.matrix = calloc((size_t)plain.size * (plain.size + 3), sizeof *plain.matrix);
    csrbf_solver *solver = csrbf_solver_create(count);
    mrt_result result =
        plain.matrix && solver ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to solve");
    if (result >= 0)
        result = csrbf_factor(solver, settings, self->centre, NULL, count, err);
    if (result >= 0)
        result = csrbf_solve(solver, self->pull, err);
    if (result >= 0) {
        assemble(&plain, self->pull);
        if (eliminate(&plain))
            compare(out, self, solver, &plain);
        else
            result = error_set(err, MRT_ERR_UNSUPPORTED, "the reference finds no solution");
    }
    csrbf_solver_destroy(solver);
    free(plain.matrix);
    return result;
}

static const struct {
    csrbf_kernel kernel;
    csrbf_polynomial polynomial;
    uint32_t count;
    double radius_mm;
} cases[] = {
    {CSRBF_WENDLAND_C0, CSRBF_NONE, TIPS, 200.0},   {CSRBF_WENDLAND_C2, CSRBF_NONE, TIPS, 200.0},
    {CSRBF_WENDLAND_C4, CSRBF_NONE, TIPS, 200.0},   {CSRBF_WENDLAND_C6, CSRBF_NONE, TIPS, 200.0},
    {CSRBF_WENDLAND_C2, CSRBF_LINEAR, TIPS, 200.0}, {CSRBF_WENDLAND_C2, CSRBF_NONE, PINS, 60.0},
    {CSRBF_WENDLAND_C2, CSRBF_LINEAR, PINS, 60.0},
};

static mrt_result compare_cases(paper *of, comparison *self, error *err)
{
    static const char *const head[] = {"kernel",
                                       "polynomial",
                                       ">centres",
                                       ">R, mm",
                                       ">float64, mm",
                                       ">as shown (float32), mm",
                                       ">at the controls, mm"};
    double worst_mm = 0.0;
    page_table(of->page, head, 7);
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0] && result >= 0; ++i) {
        if (of->is_quick && cases[i].count > TIPS)
            continue;
        const csrbf_settings settings = {.kernel = cases[i].kernel,
                                         .polynomial = cases[i].polynomial,
                                         .radius = cases[i].radius_mm};
        const char *kernel = csrbf_kernel_name(cases[i].kernel),
                   *polynomial = csrbf_polynomial_name(cases[i].polynomial);
        deviation off = {0};
        char text[5][32];
        result = solve_both(self, &settings, cases[i].count, &off, err);
        if (result < 0)
            break;
        (void)snprintf(text[0], 32, "%u", cases[i].count);
        (void)snprintf(text[1], 32, "%g", cases[i].radius_mm);
        (void)snprintf(text[2], 32, "%.1e", off.f64_mm);
        (void)snprintf(text[3], 32, "%.1e", off.f32_mm);
        (void)snprintf(text[4], 32, "%.1e", off.at_controls_mm);
        const char *const cell[] = {kernel,  polynomial, text[0], text[1],
                                    text[2], text[3],    text[4]};
        page_row(of->page, cell);
        worst_mm = fmax(worst_mm, off.f64_mm);
        const facts_cell cells[] = {
            {"kernel", kernel, 0.0, 0},
            {"polynomial", polynomial, 0.0, 0},
            {"centres", NULL, cases[i].count, 0},
            {"radius_mm", NULL, cases[i].radius_mm, 1},
            {"f64_off_mm", NULL, off.f64_mm, 12},
            {"f32_off_mm", NULL, off.f32_mm, 12},
            {"control_off_mm", NULL, off.at_controls_mm, 12},
        };
        facts_row(of->told, "reference", "", "", cells, sizeof cells / sizeof cells[0]);
        result = paper_check_stop(err);
    }
    page_table_end(of->page);
    facts_number(of->told, "worst_reference_off_mm", "off the reference", worst_mm, 12, "mm");
    return result;
}

static mrt_result add_reference(paper *of, error *err)
{
    char *path = installed_path(INSTALLED_FACE, "moai");
    face_file moai = {0};
    comparison *self = calloc(1, sizeof *self);
    mrt_result result = path && self ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = face_file_read(&moai, path, NULL, FACE_FILE_USABLE, err);
    if (result >= 0) {
        self->mesh = &moai.mesh;
        result = points_order_create(&self->order, moai.mesh.position, moai.mesh.vertex_count, err);
    }
    if (result >= 0)
        result = points_create(&self->rest, &self->order, moai.mesh.position, err);
    if (result >= 0)
        result = points_create(&self->moved, &self->order, moai.mesh.position, err);
    if (result >= 0)
        result = choose_centres(self, err);
    if (result >= 0) {
        page_subheading(of->page, "Beside a plain reference");
        page_text(of->page,
                  "The same equations, solved again in the plainest way: the whole matrix, "
                  "Gauss elimination with pivots, 80-bit numbers, no sorting, and nothing of "
                  "the engine. The greatest difference between the two, over all %u vertices of "
                  "the Moai (300 mm high), for pulls of up to 8.7 mm; and the distance of the "
                  "controls from their targets:",
                  moai.mesh.vertex_count);
        result = compare_cases(of, self, err);
    }
    if (result >= 0)
        page_caption(of->page, "`marotte deform` passes fifteen further cases that were computed "
                               "with sixty digits (`tests/golden`).");
    if (self) {
        points_destroy(&self->moved);
        points_destroy(&self->rest);
        points_order_destroy(&self->order);
    }
    face_file_destroy(&moai);
    free(self);
    free(path);
    return result;
}

mrt_result paper_solver(paper *of, error *err)
{
    mrt_result result = add_fill(of, err);
    return result < 0 ? result : add_reference(of, err);
}
