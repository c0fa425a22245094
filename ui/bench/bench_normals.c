/* Smooth normals of a deformed plane: the engine's two ways, and the scatter that is written first.
 */
#include "bench/bench.h"
#include "bench/bench_plane.h"
#include "csrbf/shape.h"
#include "csrbf/tangents.h"
#include "mesh/normals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double radius_mm = 40.0;

typedef struct scene {
    bench_plane plane;
    shape shape;
    tangents tangents;
    float *row;       /* naive: vertex_count by 3 */
    float *stream[6]; /* x y z, nx ny nz, in the order of the file */
    float *smooth[3]; /* by tangents, in the engine's order, padded */
} scene;

static void run_naive(void *data)
{
    scene *self = data;
    const float *at = self->plane.moved;
    float *out = self->row;
    for (size_t i = 0; i < (size_t)3 * self->plane.vertex_count; ++i)
        out[i] = 0.0f;
    for (size_t i = 0; i < self->plane.triangle_count; ++i) {
        const uint32_t *t = self->plane.triangle + 3 * i;
        const float *a = at + (size_t)3 * t[0], *b = at + (size_t)3 * t[1],
                    *c = at + (size_t)3 * t[2];
        float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        float v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                      u[0] * v[1] - u[1] * v[0]};
        for (int k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis)
                out[(size_t)3 * t[k] + (size_t)axis] += n[axis];
    }
    for (size_t i = 0; i < self->plane.vertex_count; ++i) {
        float *n = out + 3 * i;
        float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int axis = 0; axis < 3; ++axis)
            n[axis] /= size;
    }
}

static void run_engine(void *data)
{
    scene *self = data;
    normals_smooth(self->stream[3], self->stream[4], self->stream[5], self->stream[0],
                   self->stream[1], self->stream[2], self->plane.vertex_count, self->plane.triangle,
                   self->plane.triangle_count);
}

static void run_tangents(void *data)
{
    scene *self = data;
    tangents_normals(&self->tangents, self->smooth, bench_pull);
}

/* Of the streams, whose rows are at row_of (NULL: in their order). */
static double worst_degrees(const scene *self, float *const stream[3], const uint32_t *row_of)
{
    double worst = 0.0;
    for (size_t i = 0; i < self->plane.vertex_count; ++i) {
        const float *row = self->row + 3 * (row_of ? (size_t)row_of[i] : i);
        double dot = 0.0;
        for (size_t axis = 0; axis < 3; ++axis)
            dot += (double)row[axis] * (double)stream[axis][i];
        double apart = acos(dot < 1.0 ? dot : 1.0) * 57.29577951308232;
        worst = apart > worst ? apart : worst;
    }
    return worst;
}

static void tell(bench *self, const scene *s, const char *what, double took_ns, double naive_ns,
                 double off_deg)
{
    char label[32], line[128];
    snprintf(label, sizeof label, "%u", s->plane.vertex_count);
    snprintf(line, sizeof line, "%-24s %8.3f ms %6.1f x naive scatter   off %.4f degrees", what,
             took_ns * 1e-6, naive_ns / took_ns, off_deg);
    const facts_cell cells[] = {
        {"vertices", NULL, s->plane.vertex_count, 0},
        {"how", what, 0.0, 0},
        {"took_ns", NULL, took_ns, 1},
        {"over_naive", NULL, naive_ns / took_ns, 4},
        {"off_deg", NULL, off_deg, 6},
    };
    facts_row(self->told, "normals", label, line, cells, sizeof cells / sizeof cells[0]);
}

static mrt_result make_scene(scene *s, uint32_t quads, bool has_centres, error *err)
{
    const csrbf_settings settings = {.radius = radius_mm};
    mrt_result result = bench_plane_create(&s->plane, quads, has_centres, err);
    if (result >= 0)
        result = shape_create(&s->shape, s->plane.xyz, s->plane.vertex_count, BENCH_CONTROLS, err);
    if (result >= 0)
        result = shape_engage(&s->shape, &settings, bench_control, BENCH_CONTROLS, err);
    if (result >= 0)
        result = tangents_create(&s->tangents, &s->shape.base, BENCH_CONTROLS, err);
    if (result < 0)
        return result;
    bool is_there = (s->row = calloc((size_t)s->plane.vertex_count * 3, sizeof *s->row)) != NULL;
    for (int i = 0; i < 6; ++i)
        if (!(s->stream[i] = calloc(s->plane.vertex_count, sizeof(float))))
            is_there = false;
    for (int i = 0; i < 3; ++i)
        if (!(s->smooth[i] = calloc(s->shape.base.padded_count, sizeof(float))))
            is_there = false;
    return is_there ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to measure normals");
}

static void drop_scene(scene *s)
{
    for (int i = 0; i < 6; ++i)
        free(s->stream[i]);
    for (int i = 0; i < 3; ++i)
        free(s->smooth[i]);
    free(s->row);
    tangents_destroy(&s->tangents);
    shape_destroy(&s->shape);
    bench_plane_destroy(&s->plane);
}

/* Moved as the naive deformation moves it; at rest every normal is +z. */
static mrt_result pose_scene(scene *s, error *err)
{
    bench_naive naive;
    bench_naive_init(&naive, &s->plane, radius_mm);
    bench_naive_run(&naive);
    for (size_t i = 0; i < s->plane.vertex_count; ++i)
        for (size_t axis = 0; axis < 3; ++axis)
            s->stream[axis][i] = s->plane.moved[3 * i + axis];
    for (size_t i = 0; i < s->shape.base.padded_count; ++i)
        s->smooth[2][i] = 1.0f;
    const float *const rest[3] = {s->smooth[0], s->smooth[1], s->smooth[2]};
    if (tangents_engage(&s->tangents, s->shape.solver, &s->shape.base, rest, BENCH_CONTROLS))
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED, "the engine has no tangents for the bench");
}

static mrt_result measure(bench *self, uint32_t quads, bool has_centres, error *err)
{
    scene s = {.row = NULL};
    mrt_result result = make_scene(&s, quads, has_centres, err);
    if (result >= 0)
        result = pose_scene(&s, err);
    if (result >= 0) {
        bench_work work[] = {{.name = "naive", .run = run_naive, .data = &s},
                             {.name = "faces", .run = run_engine, .data = &s},
                             {.name = "tangents", .run = run_tangents, .data = &s}};
        bench_measure(work, 3, self->rounds, self->seconds);
        double naive_ns = work[0].least_ns;
        tell(self, &s, "faces", work[1].least_ns, naive_ns, worst_degrees(&s, s.stream + 3, NULL));
        tell(self, &s, "tangents", work[2].least_ns, naive_ns,
             worst_degrees(&s, s.smooth, s.shape.order.file_of_slot));
        if (has_centres)
            bench_at_least(self, "normals by tangents: over naive", naive_ns / work[2].least_ns,
                           3.0);
    }
    drop_scene(&s);
    return result;
}

mrt_result bench_normals(bench *self, error *err)
{
    bench_title(self, "Normals of the deformed plane");
    mrt_result result = measure(self, 128, true, err);
    return result >= 0 && !self->is_quick ? measure(self, 512, false, err) : result;
}
