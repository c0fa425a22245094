#include "face/fit.h"

#include "face/fit/fit_side.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Ridges that are tried in turn until the fit does not fold. The first one only guards against
 * singular systems. */
static const double ridges[] = {1e-5, 1e-3, 1e-2, 0.1, 1};
enum { RIDGE_COUNT = sizeof ridges / sizeof ridges[0] };

typedef struct fitting {
    const rig *rig;
    const mesh *mesh, *targets;
    const fit_options *options;
    uint32_t *vertex;  /* contact_count: vertices of the contacts */
    uint8_t *is_skin;  /* vertex_count */
    uint8_t *is_still; /* vertex_count: rigid on a bone that never moves */
    float *shown;      /* vertex_count by 3 */
    fit_side rigged, paper;
} fitting;

static mrt_result check(const rig *r, const mesh *m, const mesh *targets,
                        const fit_options *options, error *err)
{
    if (targets->vertex_count != m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the targets have %u vertices, but the rig's mesh has %u; export both "
                         "from the same mesh, in the same vertex order",
                         targets->vertex_count, m->vertex_count);
    if (targets->target_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "the file of targets has no morph targets");
    for (uint32_t k = 0; k < options->contact_count; k++) {
        uint32_t contact = options->contact[k];
        if (contact >= r->contact_count || r->contact[contact].vertex >= m->vertex_count)
            return error_set(
                err, MRT_ERR_ARGUMENT,
                "contact %u is not one of the rig's %u contacts, or is not on its mesh", contact,
                r->contact_count);
        for (uint32_t other = 0; other < k; other++)
            if (options->contact[other] == contact)
                return error_set(err, MRT_ERR_ARGUMENT, "contact \"%s\" is named twice",
                                 r->contact[contact].name);
    }
    return MRT_OK;
}

/* Marks the skin: vertices that are not rigid and can be pulled. */
static mrt_result find_skin(fitting *f, const binding *b, const topology *t, error *err)
{
    bind_marks marks = {0};
    mrt_result result = bind_marks_create(&marks, f->rig, f->mesh, t, err);
    for (uint32_t v = 0; result == MRT_OK && v < f->mesh->vertex_count; v++) {
        uint32_t bone = marks.rigid_bone[v];
        f->is_still[v] = bone < f->rig->bone_count && f->rig->bone[bone].kind == BONE_FIXED;
        f->is_skin[v] = bone == RIG_NONE && b->mobility[v] > 0;
    }
    bind_marks_destroy(&marks);
    return result;
}

static mrt_result create_sides(fitting *f, binding *b, error *err)
{
    const fit_options *o = f->options;
    csrbf_settings settings = fit_side_settings(f->rig, &o->settings);
    mrt_result result =
        fit_side_create(&f->rigged, f->rig, f->mesh, b, o->contact, f->vertex, o->contact_count,
                        &settings, f->is_skin, f->targets, ridges[0], err);
    binding everything_free = {0};
    if (result == MRT_OK)
        result = binding_create(&everything_free, NULL, f->mesh, NULL, err);
    if (result == MRT_OK)
        result =
            fit_side_create(&f->paper, NULL, f->mesh, &everything_free, o->contact, f->vertex,
                            o->contact_count, &settings, f->is_skin, f->targets, ridges[0], err);
    return result;
}

static mrt_result prepare(fitting *f, const topology *t, error *err)
{
    size_t vertices = f->mesh->vertex_count + (size_t)1;
    f->vertex = malloc((f->options->contact_count + (size_t)1) * sizeof *f->vertex);
    f->is_skin = calloc(vertices, 1);
    f->is_still = calloc(vertices, 1);
    f->shown = malloc(3 * vertices * sizeof *f->shown);
    if (f->vertex == NULL || f->is_skin == NULL || f->is_still == NULL || f->shown == NULL)
        return error_set(err, MRT_ERR_MEMORY, "no memory to fit %u vertices",
                         f->mesh->vertex_count);
    for (uint32_t k = 0; k < f->options->contact_count; k++)
        f->vertex[k] = f->rig->contact[f->options->contact[k]].vertex;
    binding b = {0};
    mrt_result result = binding_create(&b, f->rig, f->mesh, t, err);
    if (result == MRT_OK)
        result = find_skin(f, &b, t, err);
    if (result == MRT_OK)
        return create_sides(f, &b, err);
    binding_destroy(&b);
    return result;
}

static void finish(fitting *f)
{
    fit_side_destroy(&f->rigged);
    fit_side_destroy(&f->paper);
    free(f->vertex);
    free(f->is_skin);
    free(f->is_still);
    free(f->shown);
}

/* ---- results ---- */

typedef struct distance {
    double relative, worst_mm, still_mm;
} distance;

static double length_of(const float *a, const float *b, const float *offset)
{
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = (double)a[axis] - (double)b[axis] - (offset != NULL ? (double)offset[axis] : 0);
        sum += d * d;
    }
    return sqrt(sum);
}

/* Measures the distance of the shape in f->shown from the target. A target that moves no skin has
 * relative error 0 if nothing moved, else infinity. */
static distance measure(const fitting *f, const mesh_target *target)
{
    distance out = {0, 0, 0};
    double missed = 0, wanted = 0;
    for (size_t v = 0; v < f->mesh->vertex_count; v++) {
        const float *shown = f->shown + 3 * v, *rest = f->mesh->position + 3 * v;
        const float *offset = target->offset + 3 * v;
        if (f->is_still[v])
            out.still_mm = fmax(out.still_mm, length_of(shown, rest, NULL));
        if (!f->is_skin[v])
            continue;
        double miss = length_of(shown, rest, offset);
        double want = length_of(offset, (const float[3]){0, 0, 0}, NULL);
        out.worst_mm = fmax(out.worst_mm, miss);
        missed += miss * miss;
        wanted += want * want;
    }
    if (wanted > 0)
        out.relative = sqrt(missed / wanted);
    else if (missed > 0)
        out.relative = HUGE_VAL;
    return out;
}

static mrt_result solve(fitting *f, fit_side *side, float *dof, uint32_t target, double ridge,
                        error *err)
{
    side->solver.ridge = ridge;
    mrt_result result = fit_side_solve(side, dof, target, err);
    if (result == MRT_OK)
        points_to_rows(f->shown, face_shown(side->face), face_order(side->face));
    return result;
}

static mrt_result fit_paper(fitting *f, fit_result *out, uint32_t target, error *err)
{
    float dof[MRT_MAX_DOFS] = {0};
    mrt_result result = solve(f, &f->paper, dof, target, ridges[0], err);
    if (result != MRT_OK)
        return result;
    distance d = measure(f, &f->targets->target[target]);
    out->paper_residual = d.relative;
    out->paper_rigid_motion_mm = d.still_mm;
    return MRT_OK;
}

/* Fits with the rig. A fit that folds is not a face, so the ridge grows until it does not fold. */
static mrt_result fit_rigged(fitting *f, fit_result *out, uint32_t target, error *err)
{
    for (int attempt = 0; attempt < RIDGE_COUNT; attempt++) {
        mrt_result result = solve(f, &f->rigged, out->dof, target, ridges[attempt], err);
        if (result != MRT_OK)
            return result;
        out->min_determinant = face_min_determinant(f->rigged.face);
        if (out->min_determinant > 0)
            break;
    }
    distance d = measure(f, &f->targets->target[target]);
    out->relative_residual = d.relative;
    out->worst_mm = d.worst_mm;
    out->rigid_motion_mm = d.still_mm;
    out->penetration_mm = face_penetration_mm(f->rigged.face);
    face_unride(f->rigged.face, f->rigged.end, out->dof);
    for (uint32_t k = 0; k < f->options->contact_count; k++) {
        const double *pull = f->rigged.end + 3 * (size_t)k;
        out->pull[k] = (vec3){pull[0], pull[1], pull[2]};
    }
    memcpy(out->position, f->shown, 3 * (size_t)f->mesh->vertex_count * sizeof(float));
    return MRT_OK;
}

static mrt_result fit_one(fitting *f, fit_result *out, uint32_t target, error *err)
{
    out->name = f->targets->target[target].name;
    out->pull = calloc(f->options->contact_count + (size_t)1, sizeof *out->pull);
    out->position = malloc((3 * (size_t)f->mesh->vertex_count + 1) * sizeof *out->position);
    if (out->pull == NULL || out->position == NULL)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the fitted shape of \"%s\"",
                         out->name);
    mrt_result result = fit_paper(f, out, target, err);
    return result == MRT_OK ? fit_rigged(f, out, target, err) : result;
}

mrt_result fit_targets(fit_result *out, const rig *r, const mesh *m, const topology *t,
                       const mesh *targets, const fit_options *options, error *err)
{
    memset(out, 0, targets->target_count * sizeof *out);
    mrt_result result = check(r, m, targets, options, err);
    if (result != MRT_OK)
        return result;
    fitting f = {.rig = r, .mesh = m, .targets = targets, .options = options};
    result = prepare(&f, t, err);
    for (uint32_t i = 0; result == MRT_OK && i < targets->target_count; i++)
        result = fit_one(&f, &out[i], i, err);
    finish(&f);
    if (result != MRT_OK)
        fit_results_destroy(out, targets->target_count);
    return result;
}

void fit_results_destroy(fit_result *results, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        free(results[i].pull);
        free(results[i].position);
        results[i] = (fit_result){0};
    }
}
