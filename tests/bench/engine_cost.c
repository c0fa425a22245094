/* engine_cost - what the engine's loops cost beside what the machine can do in the same run:
 * copying as many bytes, square roots, and the deformation as anybody would write it first. Each
 * time is the least of many rounds in which all take turns; what holds are the ratios. Not a test:
 * a clock decides nothing here. usage: engine_cost [ROUNDS] */
#include "base/clock.h"
#include "csrbf/columns_packed.h"
#include "csrbf/shape.h"
#include "csrbf/tangents.h"
#include "mesh/normals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CONTROLS = 10, ROOTS = 4096, WORKS_MAX = 24, FLUSH_FLOATS = 24 << 20 };

/* ---- the plane of the paper's table, with ten controls (research: performance.md A) ---- */

static const double layout[CONTROLS / 2][2] = {
    {3.01, 19.56}, {8.19, 9.01}, {26.86, 9.52}, {8.97, 0.71}, {26.94, 29.64}};

typedef struct scene {
    uint32_t count;
    float *xyz, *moved; /* rows, in the order of the file, for the naive deformation */
    float centre[3 * CONTROLS], alpha[3 * CONTROLS], radius;
    double start[3 * CONTROLS], pull[3 * CONTROLS];
    shape shape;
    columns_packed packed;
    tangents tangents;
    uint32_t *triangle, triangle_count; /* in the engine's order */
    float *normal[3];
    csrbf_solver *solver; /* of the same controls, solved: for direct evaluation */
    points out;
    float *from, *to; /* what is copied: as many bytes as a frame moves */
    size_t copied;
} scene;

static void must(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "engine_cost: %s\n", what);
    exit(1);
}

/* quads a side, each with a vertex in its middle */
static void make_plane(scene *s, uint32_t quads)
{
    uint32_t v = 0;
    double size = 66.12, step = size / quads;
    s->count = (quads + 1) * (quads + 1) + quads * quads;
    s->xyz = malloc((size_t)3 * s->count * sizeof *s->xyz);
    s->moved = malloc((size_t)3 * s->count * sizeof *s->moved);
    must(s->xyz && s->moved, "no memory for the plane");
    for (uint32_t pass = 0; pass < 2; ++pass)
        for (uint32_t row = 0; row < quads + 1 - pass; ++row)
            for (uint32_t column = 0; column < quads + 1 - pass; ++column, ++v) {
                s->xyz[3 * v] = (float)((column + 0.5 * pass) * step - 0.5 * size);
                s->xyz[3 * v + 1] = (float)((row + 0.5 * pass) * step - 0.5 * size);
                s->xyz[3 * v + 2] = 0.0f;
            }
}

/* Four triangles a quad, around the vertex in its middle. */
static void make_triangles(scene *s, uint32_t quads)
{
    static const uint32_t corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    const uint32_t *slot = s->shape.order.slot_of_file;
    s->triangle_count = 4 * quads * quads;
    s->triangle = malloc((size_t)3 * s->triangle_count * sizeof *s->triangle);
    must(s->triangle != NULL, "no memory for triangles");
    uint32_t *out = s->triangle;
    for (uint32_t row = 0; row < quads; ++row)
        for (uint32_t column = 0; column < quads; ++column)
            for (int side = 0; side < 4; ++side)
                for (int end = 0; end < 3; ++end) {
                    const uint32_t *at = corner[side + (end == 1)];
                    uint32_t vertex = (row + at[1]) * (quads + 1) + column + at[0];
                    if (end == 2)
                        vertex = (quads + 1) * (quads + 1) + row * quads + column;
                    *out++ = slot[vertex];
                }
}

static void make_normals(scene *s, uint32_t quads)
{
    const points *p = &s->shape.base;
    make_triangles(s, quads);
    for (int axis = 0; axis < 3; ++axis) {
        s->normal[axis] = calloc(p->padded_count, sizeof(float));
        must(s->normal[axis] != NULL, "no memory for normals");
    }
    for (uint32_t i = 0; i < p->padded_count; ++i)
        s->normal[2][i] = 1.0f;
    const float *const rest[3] = {s->normal[0], s->normal[1], s->normal[2]};
    must(tangents_create(&s->tangents, p, CONTROLS, NULL) >= 0, "no memory for tangents");
    must(tangents_engage(&s->tangents, s->solver, p, rest, CONTROLS), "tangents");
}

static void place_controls(scene *s)
{
    for (int i = 0; i < CONTROLS; ++i) {
        const double *at = layout[i / 2];
        s->start[3 * i] = i % 2 ? -at[0] : at[0];
        s->start[3 * i + 1] = at[1];
        s->pull[3 * i] = 0.3 * (i % 3) - 0.2;
        s->pull[3 * i + 1] = 0.2 * (i % 2) + 0.1;
        s->pull[3 * i + 2] = 1.0 + 0.1 * i;
    }
}

static void scene_create(scene *s, uint32_t quads, double radius)
{
    error err = {""};
    const csrbf_settings settings = {.radius = radius};
    *s = (scene){.radius = (float)radius};
    make_plane(s, quads);
    place_controls(s);
    s->solver = csrbf_solver_create(CONTROLS);
    must(s->solver != NULL, "no memory");
    mrt_result result = shape_create(&s->shape, s->xyz, s->count, CONTROLS, &err);
    if (result >= 0)
        result = points_create(&s->out, &s->shape.order, s->xyz, &err);
    if (result >= 0)
        result = shape_engage(&s->shape, &settings, s->start, CONTROLS, &err);
    if (result >= 0)
        result = csrbf_factor(s->solver, &settings, s->start, NULL, CONTROLS, &err);
    if (result >= 0)
        result = csrbf_solve(s->solver, s->pull, &err);
    if (result >= 0)
        result = columns_packed_create(&s->packed, &s->shape.response, &err);
    must(result >= 0, err.text);
    columns_packed_take(&s->packed, &s->shape.response);
    for (int i = 0; i < 3 * CONTROLS; ++i) {
        s->centre[i] = (float)s->start[i];
        s->alpha[i] = (float)s->pull[i]; /* of the size that counts: the cost is the same */
    }
    make_normals(s, quads);
    s->copied = (size_t)s->count * 4 * (CONTROLS + 3 + 3) / 2;
    s->from = aligned_alloc(64, s->copied / 64 * 64 + 64);
    s->to = aligned_alloc(64, s->copied / 64 * 64 + 64);
    must(s->from && s->to, "no memory to copy");
    memset(s->from, 1, s->copied);
    memset(s->to, 1, s->copied);
}

static void scene_destroy(scene *s)
{
    columns_packed_destroy(&s->packed);
    tangents_destroy(&s->tangents);
    free(s->triangle);
    for (int axis = 0; axis < 3; ++axis)
        free(s->normal[axis]);
    shape_destroy(&s->shape);
    csrbf_solver_destroy(s->solver);
    points_destroy(&s->out);
    free(s->xyz);
    free(s->moved);
    free(s->from);
    free(s->to);
}

/* ---- what is timed ---- */

static void run_copy(void *data)
{
    const scene *s = data;
    memcpy(s->to, s->from, s->copied);
}

static void run_naive(void *data)
{
    const scene *s = data;
    for (size_t v = 0; v < s->count; ++v) {
        const float *x = s->xyz + 3 * v;
        float sum[3] = {0.0f, 0.0f, 0.0f};
        for (int k = 0; k < CONTROLS; ++k) {
            float dx = x[0] - s->centre[3 * k], dy = x[1] - s->centre[3 * k + 1];
            float dz = x[2] - s->centre[3 * k + 2];
            float r = sqrtf(dx * dx + dy * dy + dz * dz) / s->radius;
            if (r >= 1.0f)
                continue;
            float t = 1.0f - r, phi = t * t * t * t * (4.0f * r + 1.0f);
            for (int axis = 0; axis < 3; ++axis)
                sum[axis] += phi * s->alpha[3 * k + axis];
        }
        for (size_t axis = 0; axis < 3; ++axis)
            s->moved[3 * v + axis] = x[axis] + sum[axis];
    }
}

static void run_columns(void *data)
{
    scene *s = data;
    columns_move(&s->shape.response, &s->shape.shown, &s->shape.base, s->pull);
}

static void run_packed(void *data)
{
    scene *s = data;
    columns_packed_move(&s->packed, &s->shape.response, &s->shape.shown, &s->shape.base, s->pull);
}

static void run_tangents(void *data)
{
    scene *s = data;
    tangents_normals(&s->tangents, s->normal, s->pull);
}

static void run_triangles(void *data)
{
    const scene *s = data;
    const points *p = &s->shape.shown;
    normals_smooth(s->normal[0], s->normal[1], s->normal[2], p->x, p->y, p->z, p->count,
                   s->triangle, s->triangle_count);
}

static void run_direct(void *data)
{
    scene *s = data;
    (void)csrbf_move(s->solver, &s->out, &s->shape.rest);
}

static void run_engage(void *data)
{
    scene *s = data;
    const csrbf_settings settings = s->shape.settings;
    must(shape_engage(&s->shape, &settings, s->start, CONTROLS, NULL) >= 0, "engage");
}

static void run_roots(void *data)
{
    float *row = data;
    for (int i = 0; i < ROOTS; ++i)
        row[ROOTS + i] = sqrtf(row[i]);
}

typedef struct work {
    const char *name;
    void (*run)(void *);
    void *data;
    double least_ns;
} work;

static float *flush;

/* Reads more than the caches of one core hold; nothing is left to be written back. */
static void flush_caches(void)
{
    static volatile float sink;
    float sum = 0.0f;
    for (size_t i = 0; i < FLUSH_FLOATS; i += 16)
        sum += flush[i];
    sink = sum;
    (void)sink;
}

static void measure(work *all, int count, int rounds, bool cold)
{
    for (int round = -1; round < rounds; ++round)
        for (int i = 0; i < count; ++i) {
            if (cold)
                flush_caches();
            else
                all[i].run(all[i].data);
            int64_t start_ns = clock_now_ns();
            all[i].run(all[i].data);
            double took = (double)(clock_now_ns() - start_ns);
            if (round <= 0 || took < all[i].least_ns)
                all[i].least_ns = took;
        }
}

static void print_row(const char *name, double ns, uint32_t vertices, double bytes)
{
    printf("  %-34s %9.1f us  %6.3f ns/vertex", name, ns * 1e-3, ns / vertices);
    if (bytes > 0)
        printf("  %6.1f GB/s", bytes / ns);
    putchar('\n');
}

static void compare_plane(uint32_t quads, int rounds, bool cold, float *roots)
{
    scene r80, r10;
    scene_create(&r80, quads, 80.0);
    scene_create(&r10, quads, 10.0);
    work all[] = {{"copy of as many bytes", run_copy, &r80, 0},
                  {"columns R 80", run_columns, &r80, 0},
                  {"columns R 10", run_columns, &r10, 0},
                  {"packed R 80", run_packed, &r80, 0},
                  {"direct R 80", run_direct, &r80, 0},
                  {"direct R 10", run_direct, &r10, 0},
                  {"naive R 80", run_naive, &r80, 0},
                  {"naive R 10", run_naive, &r10, 0},
                  {"engage R 80", run_engage, &r80, 0},
                  {"normals of triangles", run_triangles, &r80, 0},
                  {"normals by tangents", run_tangents, &r80, 0},
                  {"4096 square roots", run_roots, roots, 0}};
    enum {
        COPY,
        COLUMNS80,
        COLUMNS10,
        PACKED80,
        DIRECT80,
        DIRECT10,
        NAIVE80,
        NAIVE10,
        ENGAGE,
        TRIANGLES,
        TANGENTS,
        ROOT,
        COUNT
    };
    measure(all, COUNT, rounds, cold);
    double bytes = 2.0 * (double)r80.copied;
    printf("%u vertices, ten controls, %s\n", r80.count, cold ? "cold" : "hot");
    for (int i = 0; i < COUNT; ++i)
        print_row(all[i].name, all[i].least_ns, r80.count, i == COPY || i == COLUMNS80 ? bytes : 0);
    double root = all[ROOT].least_ns / ROOTS * CONTROLS * r80.count;
    printf(
        "  columns: %.2f x copy, %.1f x naive R 80; direct: %.2f x roots, %.1f x naive R 80, "
        "%.1f x naive at R 10; R 10 %.1f x faster than R 80; columns %.2f x direct, packed %.2f x "
        "direct; tangents %.2f x triangles\n",
        all[COPY].least_ns / all[COLUMNS80].least_ns,
        all[NAIVE80].least_ns / all[COLUMNS80].least_ns, root / all[DIRECT80].least_ns,
        all[NAIVE80].least_ns / all[DIRECT80].least_ns,
        all[NAIVE10].least_ns / all[DIRECT10].least_ns,
        all[DIRECT80].least_ns / all[DIRECT10].least_ns,
        all[DIRECT80].least_ns / all[COLUMNS80].least_ns,
        all[DIRECT80].least_ns / all[PACKED80].least_ns,
        all[TRIANGLES].least_ns / all[TANGENTS].least_ns);
    scene_destroy(&r80);
    scene_destroy(&r10);
}

/* ---- many centres ---- */

/* Even points on an ellipsoid of 62, 85 and 78 mm: a skull. */
static void place_skull(double *centre, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        double h = 1.0 - (2.0 * i + 1.0) / count, across = sqrt(1.0 - h * h), turn = 2.399963 * i;
        centre[3 * i] = 62.0 * across * cos(turn);
        centre[3 * i + 1] = 85.0 * h;
        centre[3 * i + 2] = 78.0 * across * sin(turn);
    }
}

typedef struct skull {
    csrbf_solver *solver;
    csrbf_settings settings;
    double *centre;
    uint32_t count;
} skull;

static void run_factor(void *data)
{
    const skull *s = data;
    must(csrbf_factor(s->solver, &s->settings, s->centre, NULL, s->count, NULL) >= 0, "factor");
}

static void run_solve(void *data)
{
    const skull *s = data;
    must(csrbf_solve(s->solver, s->centre, NULL) >= 0, "solve");
}

static void factor_many(uint32_t count, double radius, int rounds)
{
    skull s = {.solver = csrbf_solver_create(count), .count = count};
    s.settings.radius = radius;
    s.centre = malloc((size_t)3 * count * sizeof *s.centre);
    must(s.solver && s.centre, "no memory");
    place_skull(s.centre, count);
    work all[] = {{"factor", run_factor, &s, 0}, {"solve", run_solve, &s, 0}};
    measure(all, 2, rounds, false);
    double entries = (double)csrbf_diagnose(s.solver).envelope_count;
    printf("%u centres, R %.0f: factor %.2f ms, solve %.2f ms, %.0f %% of the entries kept\n",
           count, radius, all[0].least_ns * 1e-6, all[1].least_ns * 1e-6,
           100.0 * entries / (0.5 * count * (count + 1.0)));
    csrbf_solver_destroy(s.solver);
    free(s.centre);
}

int main(int argc, char **argv)
{
    int rounds = argc > 1 ? atoi(argv[1]) : 40;
    float *roots = malloc(2 * ROOTS * sizeof *roots);
    flush = calloc(FLUSH_FLOATS, sizeof *flush);
    must(roots && flush && rounds > 0, "usage: engine_cost [ROUNDS]");
    for (int i = 0; i < ROOTS; ++i)
        roots[i] = 1.0f + (float)i;
    compare_plane(128, rounds, false, roots);
    compare_plane(128, rounds / 2 + 1, true, roots);
    compare_plane(724, rounds / 4 + 1, false, roots);
    factor_many(1000, 40.0, rounds / 8 + 1);
    factor_many(3000, 30.0, rounds / 8 + 1);
    factor_many(3000, 40.0, rounds / 8 + 1);
    free(roots);
    free(flush);
    return 0;
}
