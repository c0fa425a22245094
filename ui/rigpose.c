#include "rigpose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t most_pulls(const rig *r)
{
    uint32_t most = 1;
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (r->pose[i].pull_count > most)
            most = r->pose[i].pull_count;
    return most;
}

static csrbf_settings solver_of(const rig *r, const mesh *m)
{
    csrbf_settings solver = r->solver;
    float low[3], high[3];
    mesh_bounds(m, low, high);
    if (!(solver.radius > 0.0))
        solver.radius = 0.25 * fmax((double)high[1] - (double)low[1], 1.0);
    return solver;
}

mrt_result rigpose_stage_init(rigpose_stage *out, const rig *r, const mesh *m, const topology *t,
                              error *err)
{
    *out = (rigpose_stage){.rig = r, .mesh = m, .solver = solver_of(r, m)};
    mrt_result result = face_create(&out->face, r, m, t, most_pulls(r), err);
    if (result >= 0) {
        out->position = malloc((size_t)m->vertex_count * 3 * sizeof *out->position + 1);
        if (!out->position)
            result = error_set(err, MRT_ERR_MEMORY, "no memory for the pose");
    }
    if (result < 0)
        rigpose_stage_finish(out);
    return result;
}

void rigpose_stage_finish(rigpose_stage *self)
{
    if (!self)
        return;
    face_destroy(self->face);
    free(self->position);
    *self = (rigpose_stage){0};
}

static void read_dofs(float out_dof[MRT_MAX_DOFS], const bones *b, const rig_pose *pose)
{
    memset(out_dof, 0, MRT_MAX_DOFS * sizeof *out_dof);
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        for (uint32_t k = 0; k < b->dof_count; ++k)
            if (strcmp(b->dof[k].name, pose->dof_name[i]) == 0)
                out_dof[k] = (float)pose->dof_value[i];
}

/* With all bones at rest, as face_reset left them. */
static mrt_result take_hold(rigpose_stage *self, const rig_pose *pose, error *err)
{
    face_control *control = calloc(pose->pull_count + 1u, sizeof *control);
    if (!control)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the pulls");
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        uint32_t contact = 1 + pose->pull_contact[i];
        control[i] = (face_control){face_contact_now(self->face, contact), contact};
    }
    mrt_result result = face_engage(self->face, &self->solver, control, pose->pull_count, err);
    free(control);
    return result;
}

static mrt_result pull(rigpose_stage *self, const rig_pose *pose, error *err)
{
    float dof[MRT_MAX_DOFS];
    read_dofs(dof, face_bones(self->face), pose);
    double *end = calloc(pose->pull_count * (size_t)3 + 1, sizeof *end);
    uint8_t *rides = malloc(pose->pull_count + (size_t)1);
    mrt_result result =
        end && rides ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the pulls");
    if (result >= 0) {
        for (uint32_t i = 0; i < pose->pull_count; ++i) {
            end[3 * i] = pose->pull_mm[i].x;
            end[3 * i + 1] = pose->pull_mm[i].y;
            end[3 * i + 2] = pose->pull_mm[i].z;
        }
        memset(rides, 1, pose->pull_count);
        face_ride(self->face, end, rides, dof);
        result = face_pull(self->face, end, dof, err);
    }
    free(end);
    free(rides);
    return result;
}

mrt_result rigpose_show(rigpose_stage *self, uint32_t pose, error *err)
{
    const rig_pose *wanted = &self->rig->pose[pose];
    error why = {""};
    face_reset(self->face);
    mrt_result result = take_hold(self, wanted, &why);
    if (result >= 0)
        result = pull(self, wanted, &why);
    if (result < 0)
        return error_set(err, result, "%s: pose \"%s\": %s", self->rig->path, wanted->name,
                         why.text);
    points_to_rows(self->position, face_shown(self->face), face_order(self->face));
    return MRT_OK;
}

rigpose_measure rigpose_measured(const rigpose_stage *self)
{
    rigpose_measure out = {.least_determinant = face_min_determinant(self->face),
                           .penetration_mm = face_penetration_mm(self->face)};
    for (uint32_t v = 0; v < self->mesh->vertex_count; ++v) {
        const float *rest = self->mesh->position + (size_t)v * 3;
        const float *now = self->position + (size_t)v * 3;
        vec3 moved = {(double)now[0] - (double)rest[0], (double)now[1] - (double)rest[1],
                      (double)now[2] - (double)rest[2]};
        double distance_mm = vec3_length(moved);
        if (distance_mm > out.furthest_mm) {
            out.furthest_mm = distance_mm;
            out.furthest_vertex = v;
        }
    }
    return out;
}
