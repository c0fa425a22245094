#include "face/rig/rig_poses.h"

#include "mesh/arkit.h"
#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t most_pulls(const rig *r)
{
    uint32_t most = 1;
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (r->pose[i].pull_count > most)
            most = r->pose[i].pull_count;
    return 2 * most < MRT_MAX_VECTORS ? 2 * most : MRT_MAX_VECTORS; /* mouthClose */
}

csrbf_settings rig_poses_solver(const rig *r, const mesh *m)
{
    csrbf_settings solver = r ? r->solver : (csrbf_settings){0};
    float low[3], high[3];
    mesh_bounds(m, low, high);
    if (!(solver.radius > 0.0))
        solver.radius = 0.25 * fmax((double)high[1] - (double)low[1], 1.0);
    solver.stretch_most = -1.0; /* a pose that folds is to be seen */
    return solver;
}

mrt_result rig_poses_stage_init(rig_poses_stage *out, const rig *r, const mesh *m,
                                const topology *t, error *err)
{
    *out = (rig_poses_stage){.rig = r, .mesh = m, .solver = rig_poses_solver(r, m)};
    mrt_result result = face_create(&out->face, r, m, t, most_pulls(r), err);
    if (result >= 0) {
        out->position = malloc((size_t)m->vertex_count * 3 * sizeof *out->position + 1);
        if (!out->position)
            result = error_set(err, MRT_ERR_MEMORY, "no memory for the pose");
    }
    if (result < 0)
        rig_poses_stage_finish(out);
    return result;
}

void rig_poses_stage_finish(rig_poses_stage *self)
{
    if (!self)
        return;
    face_destroy(self->face);
    free(self->position);
    *self = (rig_poses_stage){0};
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
static mrt_result take_hold(face *f, const csrbf_settings *solver, const uint32_t *contact,
                            uint32_t count, error *err)
{
    face_control *control = calloc(count + (size_t)1, sizeof *control);
    if (!control)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the pulls");
    for (uint32_t i = 0; i < count; ++i)
        control[i] = (face_control){face_contact_now(f, 1 + contact[i]), 1 + contact[i]};
    mrt_result result = face_engage(f, solver, control, count, err);
    free(control);
    return result;
}

static mrt_result pull(face *f, const rig_pose *pose, error *err)
{
    float dof[MRT_MAX_DOFS];
    read_dofs(dof, face_bones(f), pose);
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
        face_ride(f, end, rides, dof);
        result = face_pull(f, end, dof, err);
    }
    free(end);
    free(rides);
    return result;
}

/* ---- mouthClose closes the lips of an open jaw ---- */

static const rig_pose *find_pose(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (strcmp(r->pose[i].name, name) == 0)
            return &r->pose[i];
    return NULL;
}

typedef struct summed_pose { /* names are borrowed */
    char *dof_name[MRT_MAX_DOFS];
    double dof_value[MRT_MAX_DOFS];
    uint32_t pull_contact[MRT_MAX_VECTORS];
    vec3 pull_mm[MRT_MAX_VECTORS];
    rig_pose pose;
} summed_pose;

static void add_pose(summed_pose *out, const rig_pose *pose)
{
    rig_pose *to = &out->pose;
    for (uint32_t i = 0; i < pose->dof_count; ++i) {
        uint32_t at = 0;
        while (at < to->dof_count && strcmp(out->dof_name[at], pose->dof_name[i]) != 0)
            at += 1;
        if (at == MRT_MAX_DOFS)
            continue;
        to->dof_count = at == to->dof_count ? at + 1 : to->dof_count;
        out->dof_name[at] = pose->dof_name[i];
        out->dof_value[at] += pose->dof_value[i];
    }
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        uint32_t at = 0;
        while (at < to->pull_count && out->pull_contact[at] != pose->pull_contact[i])
            at += 1;
        if (at == MRT_MAX_VECTORS)
            continue;
        to->pull_count = at == to->pull_count ? at + 1 : to->pull_count;
        out->pull_contact[at] = pose->pull_contact[i];
        out->pull_mm[at] = vec3_add(out->pull_mm[at], pose->pull_mm[i]);
    }
}

mrt_result rig_poses_show_on(face *f, const rig *r, uint32_t pose, const csrbf_settings *solver,
                             error *err)
{
    const rig_pose *wanted = &r->pose[pose], *jaw = find_pose(r, "jawOpen");
    summed_pose sum = {.pose = {.name = wanted->name}};
    error why = {""};
    if (jaw && strcmp(wanted->name, "mouthClose") == 0) {
        sum.pose.dof_name = sum.dof_name;
        sum.pose.dof_value = sum.dof_value;
        sum.pose.pull_contact = sum.pull_contact;
        sum.pose.pull_mm = sum.pull_mm;
        add_pose(&sum, jaw);
        add_pose(&sum, wanted);
        wanted = &sum.pose;
    }
    face_reset(f);
    mrt_result result = take_hold(f, solver, wanted->pull_contact, wanted->pull_count, &why);
    if (result >= 0)
        result = pull(f, wanted, &why);
    if (result < 0)
        return error_set(err, result, "%s: pose \"%s\": %s", r->path, wanted->name, why.text);
    return MRT_OK;
}

mrt_result rig_poses_show(rig_poses_stage *self, uint32_t pose, error *err)
{
    mrt_result result = rig_poses_show_on(self->face, self->rig, pose, &self->solver, err);
    if (result >= 0)
        points_to_rows(self->position, face_shown(self->face), face_order(self->face));
    return result;
}

/* ---- a pose of a shape ---- */

static const double least_way_mm = 0.25, least_dof = 1e-3;

static bool allocate_pose(rig_pose *out, const char *name, uint32_t dofs, uint32_t contacts)
{
    *out = (rig_pose){.name = strdup(name),
                      .dof_name = calloc(dofs + (size_t)1, sizeof *out->dof_name),
                      .dof_value = calloc(dofs + (size_t)1, sizeof *out->dof_value),
                      .pull_contact = calloc(contacts + (size_t)1, sizeof *out->pull_contact),
                      .pull_mm = calloc(contacts + (size_t)1, sizeof *out->pull_mm)};
    return out->name && out->dof_name && out->dof_value && out->pull_contact && out->pull_mm;
}

static bool note_dofs(rig_pose *out, const bones *b, const float *dof)
{
    for (uint32_t i = 0; i < b->dof_count; ++i) {
        if (!(fabs((double)dof[i]) > least_dof))
            continue;
        out->dof_name[out->dof_count] = strdup(b->dof[i].name);
        if (!out->dof_name[out->dof_count])
            return false;
        out->dof_value[out->dof_count++] = (double)dof[i];
    }
    return true;
}

/* As many contacts as can be engaged at once. */
static mrt_result note_pulls(rig_pose *out, face *f, const csrbf_settings *solver, uint32_t first,
                             uint32_t count, const vec3 *at, const float *dof, error *err)
{
    uint32_t contact[MRT_MAX_VECTORS] = {0};
    double end[3 * MRT_MAX_VECTORS];
    for (uint32_t i = 0; i < count; ++i) {
        contact[i] = first + i;
        end[3 * i] = at[first + i].x;
        end[3 * i + 1] = at[first + i].y;
        end[3 * i + 2] = at[first + i].z;
    }
    face_reset(f);
    mrt_result result = take_hold(f, solver, contact, count, err);
    if (result < 0)
        return result;
    face_unride(f, end, dof);
    for (uint32_t i = 0; i < count; ++i) {
        const vec3 way = {end[3 * i], end[3 * i + 1], end[3 * i + 2]};
        if (!(vec3_length(way) > least_way_mm))
            continue;
        out->pull_contact[out->pull_count] = first + i;
        out->pull_mm[out->pull_count++] = way;
    }
    return MRT_OK;
}

mrt_result rig_poses_of(rig_pose *out, const char *name, face *f, uint32_t room, const rig *r,
                        const csrbf_settings *solver, const vec3 *at, const float *dof, error *err)
{
    const bones *b = face_bones(f);
    const uint32_t most = room < MRT_MAX_VECTORS ? room : MRT_MAX_VECTORS;
    mrt_result result = MRT_OK;
    if (!allocate_pose(out, name, b->dof_count, r->contact_count) || !note_dofs(out, b, dof))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a pose");
    for (uint32_t first = 0; result >= 0 && first < r->contact_count; first += most) {
        const uint32_t left = r->contact_count - first;
        result = note_pulls(out, f, solver, first, left < most ? left : most, at, dof, err);
    }
    face_reset(f);
    if (result < 0)
        rig_pose_finish(out);
    return result;
}

/* ---- carried over ---- */

/* Where contacts are on a head, and how far apart: 0 where one is missing. */
typedef struct head {
    const rig *rig;
    const mesh *mesh;
    bones bones;
} head;

static bool contact_position(vec3 *out, const head *of, const char *contact)
{
    uint32_t at = rig_find_contact(of->rig, contact);
    if (at == RIG_NONE || of->rig->contact[at].vertex >= of->mesh->vertex_count)
        return false;
    *out = mesh_position(of->mesh, of->rig->contact[at].vertex);
    return true;
}

static double ratio_of(const head *to, const head *from, const char *a, const char *b)
{
    vec3 at[4];
    if (!contact_position(&at[0], to, a) || !contact_position(&at[1], to, b) ||
        !contact_position(&at[2], from, a) || !contact_position(&at[3], from, b))
        return 0.0;
    double length = vec3_length(vec3_sub(at[2], at[3]));
    return length > 0.0 ? vec3_length(vec3_sub(at[0], at[1])) / length : 0.0;
}

/* How much larger a part of the face is: across, and in the other directions. */
typedef struct part_scale {
    double across, along;
} part_scale;

static part_scale scale_of(const head *to, const head *from, const char *left, const char *right,
                           const char *above, const char *below)
{
    double across = ratio_of(to, from, left, right), high = ratio_of(to, from, above, below);
    across = across > 0.0 ? across : high;
    high = high > 0.0 ? high : across;
    return (part_scale){across, sqrt(across * high)};
}

/* How far the lower lip goes with the jaw wide open, mm. */
static double lip_travel(const head *of)
{
    const bones *b = &of->bones;
    vec3 at;
    float dof[MRT_MAX_DOFS] = {0};
    rigid pose[RIG_BONES_MAX];
    if (b->jaw == RIG_NONE || !contact_position(&at, of, "lip.lower.mid"))
        return 0.0;
    dof[b->first_dof[b->jaw]] = b->dof[b->first_dof[b->jaw]].max;
    bones_pose(pose, b, dof);
    return vec3_length(vec3_sub(rigid_apply(&pose[b->jaw], at), at));
}

static const bones_dof *find_dof(const bones *b, const char *name)
{
    for (uint32_t i = 0; i < b->dof_count; ++i)
        if (strcmp(b->dof[i].name, name) == 0)
            return &b->dof[i];
    return NULL;
}

/* The same share of the way to its limit, of mouthClose back from jawOpen's; false: there is no
 * such degree of freedom. */
static bool carry_dof(rig_pose *out, const char *name, double value, const bones *to,
                      const bones *from)
{
    const bones_dof *is = find_dof(to, name), *was = find_dof(from, name);
    if (!is || !was)
        return false;
    bool is_to_max = value > 0.0 || strcmp(out->name, "mouthClose") == 0;
    double limit = (double)(is_to_max ? is->max : is->min);
    double part = value / (double)(is_to_max ? was->max : was->min);
    out->dof_name[out->dof_count] = strdup(name);
    out->dof_value[out->dof_count] = part * limit;
    out->dof_count += out->dof_name[out->dof_count] != NULL && isfinite(part);
    return true;
}

typedef struct carrying {
    head to, from;
    part_scale upper, lower; /* brows; all else */
    double closing;          /* of lips over an open jaw */
} carrying;

static bool starts(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}

/* False: it would not be that pose, or no memory. */
static bool carry_pose(rig_pose *out, const rig_pose *pose, const carrying *c)
{
    bool is_of_eye = starts(pose->name, "eye"), closes = strcmp(pose->name, "mouthClose") == 0;
    if (!allocate_pose(out, pose->name, pose->dof_count, pose->pull_count))
        return false;
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        if (!carry_dof(out, pose->dof_name[i], pose->dof_value[i], &c->to.bones, &c->from.bones) &&
            is_of_eye)
            return false;
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        const char *name = c->from.rig->contact[pose->pull_contact[i]].name;
        uint32_t at = rig_find_contact(c->to.rig, name);
        part_scale by = starts(name, "brow") || starts(name, "forehead") ? c->upper : c->lower;
        if (closes)
            by = (part_scale){c->closing, c->closing};
        if (at == RIG_NONE)
            continue;
        vec3 way = pose->pull_mm[i];
        out->pull_contact[out->pull_count] = at;
        out->pull_mm[out->pull_count++] =
            (vec3){by.across * way.x, by.along * way.y, by.along * way.z};
    }
    return out->dof_count + out->pull_count > 0 || pose->dof_count + pose->pull_count == 0;
}

static bool is_name_of_others(const char *name)
{
    return arkit_find(name) < ARKIT_SHAPES || starts(name, "viseme_");
}

static bool has_shape(const mesh *m, const char *name)
{
    bool found = false;
    for (uint32_t i = 0; i < m->target_count && !found; ++i)
        found = arkit_is_same_name(m->target[i].name, name);
    for (uint32_t i = 0; i < m->expression_count && !found; ++i)
        found = arkit_is_same_name(m->expression[i].name, name);
    return found;
}

mrt_result rig_poses_carry(rig *r, const mesh *m, const rig *model, const mesh *model_mesh,
                           error *err)
{
    carrying c = {.to = {.rig = r, .mesh = m}, .from = {.rig = model, .mesh = model_mesh}};
    mrt_result result = bones_init(&c.to.bones, r, (vec3){0, 0, 0}, err);
    if (result >= 0)
        result = bones_init(&c.from.bones, model, (vec3){0, 0, 0}, err);
    if (result < 0)
        return result;
    c.upper = scale_of(&c.to, &c.from, "brow.outer.l", "brow.outer.r", "brow.mid.l", "nose.tip");
    c.lower = scale_of(&c.to, &c.from, "mouth.corner.l", "mouth.corner.r", "nose.tip", "chin");
    c.closing = lip_travel(&c.to) / fmax(lip_travel(&c.from), 1.0);
    rig_pose *grown =
        realloc(r->pose, ((size_t)r->pose_count + model->pose_count + 1) * sizeof *grown);
    if (!grown)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the poses");
    r->pose = grown;
    for (uint32_t i = 0; i < model->pose_count; ++i) {
        const rig_pose *pose = &model->pose[i];
        if (!is_name_of_others(pose->name) || find_pose(r, pose->name) || has_shape(m, pose->name))
            continue;
        if (carry_pose(&r->pose[r->pose_count], pose, &c))
            r->pose_count += 1;
        else
            rig_pose_finish(&r->pose[r->pose_count]);
    }
    return MRT_OK;
}

mrt_result rig_poses_ease(rig *r, uint32_t first, const mesh *m, const topology *t, error *err)
{
    static const double least = 0.05, part = 0.8;
    rig_poses_stage stage;
    mrt_result result = rig_poses_stage_init(&stage, r, m, t, err);
    if (result < 0)
        return result;
    for (uint32_t i = first; i < r->pose_count && result >= 0; ++i)
        for (int round = 0; round < 12 && result >= 0; ++round) {
            result = rig_poses_show(&stage, i, err);
            if (result < 0 || face_min_determinant(stage.face) > least)
                break;
            for (uint32_t k = 0; k < r->pose[i].pull_count; ++k)
                r->pose[i].pull_mm[k] = vec3_scale(r->pose[i].pull_mm[k], part);
        }
    rig_poses_stage_finish(&stage);
    return result;
}

/* ---- what it does ---- */

rig_poses_measure rig_poses_measured(const rig_poses_stage *self)
{
    rig_poses_measure out = {.least_determinant = face_min_determinant(self->face),
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
