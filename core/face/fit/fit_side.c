#include "face/fit/fit_side.h"

#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* default radius: that of an adult's face */
#define RADIUS_MM 60.0

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to fit the targets");
}

static float share_of(const fit_side *s, uint32_t bone, uint32_t vertex)
{
    return s->binding->weight[(size_t)bone * s->binding->vertex_count + vertex];
}

static bool is_member(const fit_side *s, uint32_t bone, uint32_t contact)
{
    uint32_t vertex = s->vertex[contact];
    return share_of(s, bone, vertex) > FIT_SHARE_LEAST &&
           s->binding->mobility[vertex] >= FIT_MOBILITY_LEAST;
}

static mrt_result engage(fit_side *s, const uint32_t *contact, bool has_rig,
                         const csrbf_settings *settings, error *err)
{
    face_control *control = calloc(s->contact_count + (size_t)1, sizeof *control);
    if (control == NULL)
        return no_memory(err);
    for (uint32_t k = 0; k < s->contact_count; k++)
        control[k] = (face_control){s->start[k], has_rig ? contact[k] + 1 : 0};
    mrt_result result = face_engage(s->face, settings, control, s->contact_count, err);
    free(control);
    return result;
}

/* ---- the columns ---- */

typedef struct responses {
    float *row; /* column_count of the controls by padded_count */
    size_t stride;
    uint32_t first_column; /* index in the gram; columns before it belong to the bones */
} responses;

static mrt_result add_fields(fit_side *s, responses *out, const csrbf_settings *settings,
                             csrbf_solver *solver, double *centre, error *err)
{
    const points *rest = face_rest(s->face);
    uint32_t row = 0;
    for (uint32_t bone = 0; bone < s->binding->bone_count; bone++) {
        uint32_t members = 0;
        for (uint32_t k = 0; k < s->contact_count; k++) {
            if (!is_member(s, bone, k))
                continue;
            memcpy(centre + 3 * (size_t)members++, &s->start[k], 3 * sizeof *centre);
            fit_gram_add_column(&s->gram, bone, k);
        }
        if (members == 0)
            continue;
        mrt_result result = csrbf_factor(solver, settings, centre, NULL, members, err);
        if (result < 0)
            return result;
        csrbf_responses(solver, out->row + row * out->stride, out->stride, rest);
        row += members;
    }
    return MRT_OK;
}

static mrt_result create_responses(fit_side *s, responses *out, const csrbf_settings *settings,
                                   error *err)
{
    size_t most = (size_t)s->binding->bone_count * s->contact_count;
    uint32_t rows = 0;
    for (uint32_t bone = 0; bone < s->binding->bone_count; bone++)
        for (uint32_t k = 0; k < s->contact_count; k++)
            rows += is_member(s, bone, k);
    *out = (responses){.stride = face_rest(s->face)->padded_count,
                       .first_column = s->gram.column_count};
    out->row = malloc((rows * out->stride + 1) * sizeof *out->row);
    double *centre = malloc((3 * most + 1) * sizeof *centre);
    csrbf_solver *solver = csrbf_solver_create(s->contact_count + 1);
    mrt_result result = MRT_OK;
    if (out->row == NULL || centre == NULL || solver == NULL)
        result = no_memory(err);
    else
        result = add_fields(s, out, settings, solver, centre, err);
    csrbf_solver_destroy(solver);
    free(centre);
    return result;
}

static void value_at(const fit_side *s, const responses *r, double *out, uint32_t slot,
                     uint32_t vertex)
{
    double x[3];
    points_at(x, face_rest(s->face), slot);
    for (uint32_t j = 0; j < s->gram.column_count; j++) {
        const fit_column *c = &s->gram.column[j];
        double share = (double)share_of(s, c->bone, vertex);
        if (c->control != RIG_NONE)
            share *= (double)s->binding->mobility[vertex] *
                     (double)r->row[(j - r->first_column) * r->stride + slot];
        else if (c->axis < 3)
            share *= x[c->axis];
        out[j] = share;
    }
}

static mrt_result sum_up(fit_side *s, const responses *r, const uint8_t *is_skin,
                         const mesh *targets, error *err)
{
    const points_order *order = face_order(s->face);
    double *value = malloc((s->gram.column_count + (size_t)1) * sizeof *value);
    double *offset = malloc((3 * (size_t)targets->target_count + 1) * sizeof *offset);
    mrt_result result = value != NULL && offset != NULL ? MRT_OK : no_memory(err);
    for (uint32_t slot = 0; result == MRT_OK && slot < order->count; slot++) {
        size_t vertex = order->file_of_slot[slot];
        if (!is_skin[vertex])
            continue;
        for (size_t t = 0; t < targets->target_count; t++)
            for (size_t a = 0; a < 3; a++)
                offset[3 * t + a] = (double)targets->target[t].offset[3 * vertex + a];
        value_at(s, r, value, slot, (uint32_t)vertex);
        fit_gram_add_vertex(&s->gram, value, offset);
    }
    free(value);
    free(offset);
    fit_gram_finish(&s->gram);
    return result;
}

static mrt_result create_gram(fit_side *s, const csrbf_settings *settings, const uint8_t *is_skin,
                              const mesh *targets, error *err)
{
    mrt_result result =
        fit_gram_create(&s->gram, face_bones(s->face), s->contact_count,
                        s->contact_count * s->binding->bone_count, targets->target_count, err);
    if (result < 0)
        return result;
    responses r = {0};
    result = create_responses(s, &r, settings, err);
    if (result == MRT_OK)
        result = fit_gram_begin(&s->gram, err);
    if (result == MRT_OK)
        result = sum_up(s, &r, is_skin, targets, err);
    free(r.row);
    return result;
}

csrbf_settings fit_side_settings(const rig *r, const csrbf_settings *asked)
{
    csrbf_settings settings = asked->radius > 0 ? *asked : r->solver;
    if (!(settings.radius > 0))
        settings.radius = RADIUS_MM;
    settings.stretch_most = -1.0; /* a fit uses whole pulls and measures folds itself */
    return settings;
}

mrt_result fit_side_create(fit_side *out, const rig *r, const mesh *m, binding *b,
                           const uint32_t *contact, const uint32_t *vertex, uint32_t contact_count,
                           const csrbf_settings *settings, const uint8_t *is_skin,
                           const mesh *targets, double ridge, error *err)
{
    size_t room = contact_count + (size_t)1;
    *out = (fit_side){.contact_count = contact_count,
                      .vertex = vertex,
                      .start = malloc(room * sizeof(vec3)),
                      .pull = calloc(3 * room, sizeof(double)),
                      .end = calloc(3 * room, sizeof(double))};
    if (out->start == NULL || out->pull == NULL || out->end == NULL) {
        fit_side_destroy(out);
        binding_destroy(b);
        return no_memory(err);
    }
    for (uint32_t k = 0; k < contact_count; k++)
        out->start[k] = mesh_position(m, vertex[k]);
    mrt_result result = face_create_bound(&out->face, r, m, b, contact_count + 1, err);
    if (result == MRT_OK) {
        out->binding = face_binding(out->face);
        result = engage(out, contact, r != NULL, settings, err);
    }
    if (result == MRT_OK)
        result = create_gram(out, settings, is_skin, targets, err);
    if (result == MRT_OK)
        result = fit_solver_create(&out->solver, face_bones(out->face), &out->gram, ridge, err);
    if (result != MRT_OK)
        fit_side_destroy(out);
    return result;
}

void fit_side_destroy(fit_side *s)
{
    fit_solver_destroy(&s->solver);
    fit_gram_destroy(&s->gram);
    face_destroy(s->face);
    free(s->start);
    free(s->pull);
    free(s->end);
    *s = (fit_side){0};
}

/* ---- one target ---- */

/* Returns where a contact lands: sum_b w_b T_b(start + m g), exactly at start if nothing moves. */
static vec3 landing(const fit_side *s, const rigid *pose, uint32_t contact)
{
    const double *g = s->pull + 3 * (size_t)contact;
    uint32_t vertex = s->vertex[contact];
    double mobility = (double)s->binding->mobility[vertex];
    vec3 start = s->start[contact];
    vec3 pulled = vec3_add(start, vec3_scale((vec3){g[0], g[1], g[2]}, mobility)), sum = start;
    for (uint32_t b = 0; b < s->binding->bone_count; b++) {
        vec3 moved = vec3_sub(rigid_apply(&pose[b], pulled), start);
        sum = vec3_add(sum, vec3_scale(moved, (double)share_of(s, b, vertex)));
    }
    return sum;
}

mrt_result fit_side_solve(fit_side *s, float *out_dof, uint32_t target, error *err)
{
    const bones *b = face_bones(s->face);
    rigid pose[RIG_BONES_MAX];
    memset(out_dof, 0, b->dof_count * sizeof *out_dof);
    (void)fit_solve_pose(&s->solver, s->pull, out_dof, target);
    bones_pose(pose, b, out_dof);
    for (uint32_t k = 0; k < s->contact_count; k++) {
        vec3 end = landing(s, pose, k);
        memcpy(s->end + 3 * (size_t)k, &end, sizeof end);
    }
    return face_pull(s->face, s->end, out_dof, err);
}
