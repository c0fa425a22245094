#include "constraint_cost.h"
#include "base/clock.h"

#include <math.h>
#include <stdlib.h>

enum { FRAMES = 201 };

typedef struct example { /* the last pull, as a face wants it */
    face_control control[MRT_MAX_VECTORS];
    double end[MRT_MAX_VECTORS * 3];
    csrbf_settings settings;
    uint32_t count;
} example;

static example example_of(performer *p)
{
    const mrt_pull *pull = performer_pull(p);
    example out = {.settings = performer_solver(p), .count = pull->count};
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        out.control[i].start = (vec3){(double)v->start.x, (double)v->start.y, (double)v->start.z};
        out.control[i].contact = v->contact;
        out.end[3 * i] = (double)v->end.x;
        out.end[3 * i + 1] = (double)v->end.y;
        out.end[3 * i + 2] = (double)v->end.z;
    }
    return out;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* One frame a time of each face, in turn, so that both see the same machine. */
static mrt_result time_frames(constraint_cost *out, face *const faces[2], const example *e,
                              const float *dof, error *err)
{
    double took_ms[2][FRAMES];
    for (uint32_t i = 0; i < FRAMES; ++i)
        for (int which = 0; which < 2; ++which) {
            int64_t before = clock_now_ns();
            mrt_result result = face_pull(faces[which], e->end, which == 0 ? dof : NULL, err);
            took_ms[which][i] = (double)(clock_now_ns() - before) * 1e-6;
            if (result < 0)
                return result;
        }
    for (int which = 0; which < 2; ++which)
        qsort(took_ms[which], FRAMES, sizeof took_ms[which][0], by_size);
    out->constrained_ms = took_ms[0][FRAMES / 2];
    out->unconstrained_ms = took_ms[1][FRAMES / 2];
    return MRT_OK;
}

mrt_result constraint_cost_measure(constraint_cost *out, const face_file *file, performer *p,
                                   error *err)
{
    *out = (constraint_cost){0};
    face *faces[2] = {NULL, NULL};
    const float *dof = performer_pull(p)->dof;
    example e = example_of(p);
    if (!performer_is_anchored(p) || e.count == 0)
        return MRT_OK;
    mrt_result result =
        face_create(&faces[0], file->rig, &file->mesh, &file->topology, MRT_MAX_VECTORS, err);
    if (result >= 0)
        result = face_create(&faces[1], NULL, &file->mesh, &file->topology, MRT_MAX_VECTORS, err);
    if (result >= 0)
        result = face_engage(faces[0], &e.settings, e.control, e.count, err);
    for (uint32_t i = 0; i < e.count; ++i)
        e.control[i].contact = 0;
    if (result >= 0)
        result = face_engage(faces[1], &e.settings, e.control, e.count, err);
    if (result >= 0)
        result = time_frames(out, faces, &e, dof, err);
    face_destroy(faces[0]);
    face_destroy(faces[1]);
    return result;
}
