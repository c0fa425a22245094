#include "face/rig/rig_poses.h"

#include "base/arrays.h"
#include "mesh/arkit.h"
#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

csrbf_settings rig_poses_solver(const rig *r, const mesh *m)
{
    csrbf_settings solver = r ? r->solver : (csrbf_settings){0};
    float low[3], high[3];
    mesh_bounds(m, low, high);
    if (!(solver.radius > 0.0))
        solver.radius = 0.25 * fmax((double)high[1] - (double)low[1], 1.0);
    solver.stretch_most = -1.0; /* show poses that fold, too */
    return solver;
}

static mrt_result create_stage(rig_poses_stage *out, const rig *r, const topology *t, error *err)
{
    binding b = {0};
    mrt_result result = rig_copy(&out->rig, r, err);
    if (result >= 0)
        result = binding_create(&b, &out->rig, out->mesh, t, err);
    if (result >= 0)
        result = face_create_shaped(&out->face, &out->rig, out->mesh, &b, MRT_MAX_VECTORS, err);
    if (result < 0)
        return result;
    face_set_shapes(out->face, r->shapes);
    return rig_poses_complete(&out->rig, 0, out->face, &out->solver, err);
}

mrt_result rig_poses_stage_init(rig_poses_stage *out, const rig *r, const mesh *m,
                                const topology *t, error *err)
{
    *out = (rig_poses_stage){.mesh = m, .solver = rig_poses_solver(r, m)};
    mrt_result result = create_stage(out, r, t, err);
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
    rig_destroy(&self->rig);
    free(self->position);
    *self = (rig_poses_stage){0};
}

/* ---- the halves of a face ---- */

static bool starts(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}

static rig_pose_part part_of_name(const char *name)
{
    static const char *const upper[] = {"brow",   "forehead", "eye",       "lid",
                                        "temple", "glabella", "nose.root", "nose.bridge"};
    static const char *const mouth[] = {"mouth", "lip",        "jaw",   "chin",  "cheek",
                                        "nose",  "nasolabial", "teeth", "tongue"};
    for (size_t i = 0; i < sizeof upper / sizeof *upper; ++i)
        if (starts(name, upper[i]))
            return POSE_UPPER;
    for (size_t i = 0; i < sizeof mouth / sizeof *mouth; ++i)
        if (starts(name, mouth[i]))
            return POSE_MOUTH;
    return POSE_WHOLE;
}

rig_pose_part rig_poses_dof_part(const char *name)
{
    return part_of_name(name);
}

void rig_poses_contact_parts(rig_pose_part *out, const rig *r, const vec3 *at)
{
    double lowest = (double)INFINITY, highest = -(double)INFINITY;
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        out[i] = part_of_name(r->contact[i].name);
        if (out[i] == POSE_UPPER)
            lowest = fmin(lowest, at[i].y);
        else if (out[i] == POSE_MOUTH)
            highest = fmax(highest, at[i].y);
    }
    const double border = 0.5 * (lowest + highest);
    for (uint32_t i = 0; i < r->contact_count && isfinite(border); ++i)
        if (out[i] == POSE_WHOLE)
            out[i] = at[i].y > border ? POSE_UPPER : POSE_MOUTH;
}

/* ---- poses on a face ---- */

static void read_dofs(float out_dof[MRT_MAX_DOFS], const bones *b, const rig_pose *pose)
{
    memset(out_dof, 0, MRT_MAX_DOFS * sizeof *out_dof);
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        for (uint32_t k = 0; k < b->dof_count; ++k)
            if (strcmp(b->dof[k].name, pose->dof_name[i]) == 0)
                out_dof[k] = (float)pose->dof_value[i];
}

/* Engages contacts with all bones at rest, as after face_reset. */
static mrt_result engage_contacts(face *f, const csrbf_settings *solver, const uint32_t *contact,
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

static bool can_hold_all(uint32_t contact_count)
{
    return contact_count <= MRT_MAX_VECTORS;
}

static void set_row(double *rows, uint32_t k, vec3 value)
{
    rows[3 * k] = value.x;
    rows[3 * k + 1] = value.y;
    rows[3 * k + 2] = value.z;
}

/* The contacts that are held, and the pull of each. */
typedef struct held {
    uint32_t contact[MRT_MAX_VECTORS], count;
    vec3 pull_mm[MRT_MAX_VECTORS];
} held;

static void hold(held *out, uint32_t contact)
{
    for (uint32_t i = 0; i < out->count; ++i)
        if (out->contact[i] == contact)
            return;
    if (out->count == MRT_MAX_VECTORS)
        return;
    out->contact[out->count] = contact;
    out->pull_mm[out->count++] = (vec3){0, 0, 0};
}

static void hold_all(held *out, uint32_t contact_count)
{
    for (uint32_t i = 0; can_hold_all(contact_count) && i < contact_count; ++i)
        hold(out, i);
}

static void set_pulls(held *out, const rig_pose *pose, uint32_t pull_count)
{
    for (uint32_t i = 0; i < pull_count; ++i) {
        hold(out, pose->pull_contact[i]);
        for (uint32_t k = 0; k < out->count; ++k)
            if (out->contact[k] == pose->pull_contact[i])
                out->pull_mm[k] = pose->pull_mm[i];
    }
}

static mrt_result pull(face *f, const held *h, const float *dof, error *err)
{
    double end[3 * MRT_MAX_VECTORS];
    uint8_t rides[MRT_MAX_VECTORS];
    for (uint32_t i = 0; i < h->count; ++i)
        set_row(end, i, h->pull_mm[i]);
    memset(rides, 1, sizeof rides);
    face_ride(f, end, rides, dof);
    return face_pull(f, end, dof, err);
}

/* ---- mouthClose, which closes the lips of an open jaw ---- */

static const rig_pose *find_pose(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (strcmp(r->pose[i].name, name) == 0)
            return &r->pose[i];
    return NULL;
}

typedef struct summed_pose { /* names are not owned */
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
    for (uint32_t i = 0; i < pose->pull_count + pose->follow_count; ++i) {
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

/* Returns the pose to show: mouthClose is added to the rig's jawOpen in `sum`. */
static const rig_pose *shown_pose(summed_pose *sum, const rig *r, const rig_pose *pose)
{
    const rig_pose *jaw = find_pose(r, "jawOpen");
    if (!jaw || strcmp(pose->name, "mouthClose") != 0)
        return pose;
    *sum = (summed_pose){.pose = {.name = pose->name}};
    sum->pose.dof_name = sum->dof_name;
    sum->pose.dof_value = sum->dof_value;
    sum->pose.pull_contact = sum->pull_contact;
    sum->pose.pull_mm = sum->pull_mm;
    add_pose(sum, jaw);
    add_pose(sum, pose);
    return &sum->pose;
}

/* `engages`: false if all contacts of the rig are engaged on the face already. */
static mrt_result show_on(face *f, const rig *r, uint32_t pose, const csrbf_settings *solver,
                          bool engages, error *err)
{
    summed_pose sum;
    const rig_pose *wanted = shown_pose(&sum, r, &r->pose[pose]);
    held all = {.count = 0};
    float dof[MRT_MAX_DOFS];
    error why = {""};
    hold_all(&all, r->contact_count);
    set_pulls(&all, wanted, wanted->pull_count + wanted->follow_count);
    read_dofs(dof, face_bones(f), wanted);
    mrt_result result = MRT_OK;
    if (engages) {
        face_reset(f);
        result = engage_contacts(f, solver, all.contact, all.count, &why);
    }
    face_set_stretch_most(f, solver->stretch_most);
    if (result >= 0)
        result = pull(f, &all, dof, &why);
    if (result < 0)
        return error_set(err, result, "%s: pose \"%s\": %s", r->path, wanted->name, why.text);
    return MRT_OK;
}

mrt_result rig_poses_show_on(face *f, const rig *r, uint32_t pose, const csrbf_settings *solver,
                             error *err)
{
    return show_on(f, r, pose, solver, true, err);
}

mrt_result rig_poses_show(rig_poses_stage *self, uint32_t pose, error *err)
{
    mrt_result result = rig_poses_show_on(self->face, &self->rig, pose, &self->solver, err);
    if (result >= 0)
        points_to_rows(self->position, face_shown(self->face), face_order(self->face));
    return result;
}

/* ---- contacts that a pose does not name ---- */

static const double least_follow_mm = 0.05;

static bool can_follow(const rig *r)
{
    return r->contact_count > 0 && can_hold_all(r->contact_count);
}

/* A small face with only the contacts as vertices. Positions follow the formula of face.h without
 * projection and limit, so a pose takes about 0.1 ms. */
typedef struct contacts_alone {
    rig rig;
    mesh mesh;
    face *face;
    vec3 *rest;
    rig_pose_part *part;
    arrays arrays;
} contacts_alone;

/* from: of r. incisor: of the jaw. */
static mrt_result contacts_alone_create(contacts_alone *out, const rig *r, const binding *from,
                                        vec3 incisor, error *err)
{
    const uint32_t count = r->contact_count;
    *out = (contacts_alone){.rig = {.path = r->path,
                                    .name = r->name,
                                    .mm_per_unit = r->mm_per_unit,
                                    .bone_count = r->bone_count,
                                    .contact_count = count}};
    arrays *a = &out->arrays;
    float *position = arrays_add(a, 3 * (size_t)count, sizeof *position);
    out->rig.bone = arrays_add(a, r->bone_count, sizeof *out->rig.bone);
    out->rig.contact = arrays_add(a, count, sizeof *out->rig.contact);
    out->rest = arrays_add(a, count, sizeof *out->rest);
    out->part = arrays_add(a, count, sizeof *out->part);
    binding small = {.vertex_count = count, .bone_count = from->bone_count};
    small.weight = malloc((size_t)count * from->bone_count * sizeof *small.weight);
    small.mobility = malloc(count * sizeof *small.mobility);
    if (a->failed || !small.weight || !small.mobility) {
        binding_destroy(&small);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the poses");
    }
    memcpy(out->rig.bone, r->bone, r->bone_count * sizeof *r->bone);
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (r->bone[i].kind == BONE_JAW) {
            out->rig.bone[i].incisor = incisor;
            out->rig.bone[i].has_incisor = true;
        }
    for (uint32_t i = 0; i < count; ++i) {
        const size_t v = r->contact[i].vertex;
        out->rig.contact[i] = r->contact[i];
        out->rig.contact[i].vertex = i;
        out->rest[i] = from->contact_position[i];
        position[3 * (size_t)i] = (float)out->rest[i].x;
        position[3 * (size_t)i + 1] = (float)out->rest[i].y;
        position[3 * (size_t)i + 2] = (float)out->rest[i].z;
        small.mobility[i] = from->mobility[v];
        for (size_t bone = 0; bone < from->bone_count; ++bone)
            small.weight[bone * count + i] = from->weight[bone * from->vertex_count + v];
    }
    rig_poses_contact_parts(out->part, r, out->rest);
    out->mesh = (mesh){.position = position, .vertex_count = count};
    return face_create_bound(&out->face, &out->rig, &out->mesh, &small, count, err);
}

static void contacts_alone_destroy(contacts_alone *self)
{
    face_destroy(self->face);
    arrays_free(&self->arrays);
}

/* Shows a pose with only its named contacts pulled. For a pose of one half, also holds the contacts
 * of the other half at rest. */
static mrt_result show_named(face *f, const rig_pose *pose, const rig_pose *shown,
                             const rig_pose_part *part, uint32_t contact_count,
                             const csrbf_settings *solver, error *err)
{
    held named = {.count = 0};
    float dof[MRT_MAX_DOFS];
    read_dofs(dof, face_bones(f), shown);
    set_pulls(&named, pose, pose->pull_count);
    for (uint32_t i = 0; pose->part != POSE_WHOLE && i < contact_count; ++i)
        if (part[i] != pose->part)
            hold(&named, i);
    face_reset(f);
    mrt_result result = engage_contacts(f, solver, named.contact, named.count, err);
    return result < 0 ? result : pull(f, &named, dof, err);
}

/* Computes the pull of each held contact from its position, with the bones back at rest. */
static void read_pulls(vec3 *out, const face *f, uint32_t count, const vec3 *at, const float *dof)
{
    double end[3 * MRT_MAX_VECTORS];
    for (uint32_t i = 0; i < count; ++i)
        set_row(end, i, at[i]);
    face_unride(f, end, dof);
    for (uint32_t i = 0; i < count; ++i)
        out[i] = (vec3){end[3 * i], end[3 * i + 1], end[3 * i + 2]};
}

static void read_contacts(vec3 *out, const face *f, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        out[i] = face_contact_now(f, 1 + i);
}

/* Iterates to a fixed point, since a contact with low mobility falls short of its end. */
static mrt_result find_follows(held *all, contacts_alone *c, const rig_pose *pose,
                               const rig_pose *shown, const csrbf_settings *solver, error *err)
{
    enum { ROUNDS = 5 };
    const uint32_t count = c->rig.contact_count;
    vec3 at[MRT_MAX_VECTORS], wanted[MRT_MAX_VECTORS], reached[MRT_MAX_VECTORS];
    bool is_named[MRT_MAX_VECTORS] = {false};
    float dof[MRT_MAX_DOFS];
    read_dofs(dof, face_bones(c->face), shown);
    mrt_result result = show_named(c->face, pose, shown, c->part, count, solver, err);
    if (result < 0)
        return result;
    read_contacts(at, c->face, count);
    for (uint32_t i = 0; i < pose->pull_count; ++i)
        is_named[pose->pull_contact[i]] = true;
    *all = (held){.count = 0};
    hold_all(all, count);
    set_pulls(all, pose, pose->pull_count);
    face_reset(c->face);
    result = engage_contacts(c->face, solver, all->contact, all->count, err);
    if (result >= 0)
        read_pulls(wanted, c->face, count, at, dof);
    for (int round = 0; round < ROUNDS && result >= 0; ++round) {
        result = pull(c->face, all, dof, err);
        if (result < 0)
            break;
        read_contacts(at, c->face, count);
        read_pulls(reached, c->face, count, at, dof);
        for (uint32_t i = 0; i < count; ++i)
            if (!is_named[i] && (pose->part == POSE_WHOLE || c->part[i] == pose->part))
                all->pull_mm[i] = vec3_add(all->pull_mm[i], vec3_sub(wanted[i], reached[i]));
    }
    return result;
}

static mrt_result add_follows(rig_pose *pose, const held *all, error *err)
{
    uint32_t *contact = realloc(pose->pull_contact, (all->count + (size_t)1) * sizeof *contact);
    pose->pull_contact = contact ? contact : pose->pull_contact;
    vec3 *way = realloc(pose->pull_mm, (all->count + (size_t)1) * sizeof *way);
    pose->pull_mm = way ? way : pose->pull_mm;
    if (!contact || !way)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the poses");
    for (uint32_t i = 0; i < all->count; ++i) {
        bool is_named = false;
        for (uint32_t k = 0; k < pose->pull_count && !is_named; ++k)
            is_named = contact[k] == all->contact[i];
        const double mm = vec3_length(all->pull_mm[i]);
        if (is_named || !(mm >= least_follow_mm) || !isfinite(mm))
            continue;
        contact[pose->pull_count + pose->follow_count] = all->contact[i];
        way[pose->pull_count + pose->follow_count++] = all->pull_mm[i];
    }
    return MRT_OK;
}

/* Finds where the contacts go that a pose of r does not name. */
static mrt_result complete(rig_pose *pose, const rig *r, contacts_alone *alone,
                           const csrbf_settings *solver, error *err)
{
    summed_pose sum;
    held all;
    error ignored = {""}; /* reported when the pose is performed */
    csrbf_settings free_solver = *solver;
    free_solver.stretch_most = -1.0;
    pose->follow_count = 0;
    if (pose->pull_count == 0)
        return MRT_OK;
    const rig_pose *shown = shown_pose(&sum, r, pose);
    if (find_follows(&all, alone, pose, shown, &free_solver, &ignored) < 0)
        return MRT_OK;
    return add_follows(pose, &all, err);
}

mrt_result rig_poses_complete(rig *r, uint32_t first, const face *f, const csrbf_settings *solver,
                              error *err)
{
    contacts_alone alone;
    for (uint32_t i = first; i < r->pose_count; ++i)
        r->pose[i].follow_count = 0;
    if (first >= r->pose_count || !can_follow(r))
        return MRT_OK;
    mrt_result result =
        contacts_alone_create(&alone, r, face_binding(f), face_bones(f)->incisor, err);
    for (uint32_t i = first; i < r->pose_count && result >= 0; ++i)
        result = complete(&r->pose[i], r, &alone, solver, err);
    contacts_alone_destroy(&alone);
    return result;
}

mrt_result rig_poses_show_named(rig_poses_stage *self, uint32_t pose, error *err)
{
    summed_pose sum;
    const rig *r = &self->rig;
    const rig_pose *shown = shown_pose(&sum, r, &r->pose[pose]);
    rig_pose_part part[MRT_MAX_VECTORS] = {POSE_WHOLE};
    const uint32_t count = r->contact_count;
    if (!can_hold_all(count))
        return rig_poses_show(self, pose, err);
    rig_poses_contact_parts(part, r, face_binding(self->face)->contact_position);
    mrt_result result =
        show_named(self->face, &r->pose[pose], shown, part, count, &self->solver, err);
    if (result >= 0)
        points_to_rows(self->position, face_shown(self->face), face_order(self->face));
    return result;
}

/* ---- a pose from a shape ---- */

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

static bool set_dofs(rig_pose *out, const bones *b, const float *dof)
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

/* Computes the pull of each contact, in groups that can be engaged together. */
static mrt_result find_ways(vec3 *out, face *f, const csrbf_settings *solver, uint32_t first,
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
    mrt_result result = engage_contacts(f, solver, contact, count, err);
    if (result < 0)
        return result;
    face_unride(f, end, dof);
    for (uint32_t i = 0; i < count; ++i)
        out[first + i] = (vec3){end[3 * i], end[3 * i + 1], end[3 * i + 2]};
    return MRT_OK;
}

/* Adds pulls of contacts that the other pulled contacts do not bring to their place. Repeats until
 * no contact is added. way: of each contact, mm; NaN: wherever the others bring it. alone NULL: the
 * rig has too many contacts to follow. */
static mrt_result add_pulls(rig_pose *out, contacts_alone *alone, const rig *r,
                            const csrbf_settings *solver, const vec3 *way, error *err)
{
    uint32_t before = RIG_NONE;
    mrt_result result = MRT_OK;
    while (result >= 0 && before != out->pull_count) {
        rig one = *r;
        uint32_t count = before = out->pull_count;
        one.pose = out;
        one.pose_count = 1;
        if (alone)
            result = complete(out, &one, alone, solver, err);
        vec3 *follow = calloc(r->contact_count + (size_t)1, sizeof *follow);
        bool *is_named = calloc(r->contact_count + (size_t)1, sizeof *is_named);
        for (uint32_t i = 0; follow && is_named && i < count + out->follow_count; ++i) {
            follow[out->pull_contact[i]] = out->pull_mm[i];
            is_named[out->pull_contact[i]] = i < count;
        }
        out->follow_count = 0;
        for (uint32_t i = 0; follow && is_named && i < r->contact_count; ++i) {
            if (is_named[i] || !(vec3_length(vec3_sub(way[i], follow[i])) > least_way_mm))
                continue;
            out->pull_contact[out->pull_count] = i;
            out->pull_mm[out->pull_count++] = way[i];
        }
        if (result >= 0 && (!follow || !is_named))
            result = error_set(err, MRT_ERR_MEMORY, "no memory for a pose");
        free(follow);
        free(is_named);
    }
    return result;
}

mrt_result rig_poses_of(rig_pose *out, const char *name, face *f, uint32_t room, const rig *r,
                        const csrbf_settings *solver, const vec3 *at, const float *dof, error *err)
{
    const bones *b = face_bones(f);
    const uint32_t most = room < MRT_MAX_VECTORS ? room : MRT_MAX_VECTORS;
    const bool follows = can_follow(r);
    contacts_alone alone = {.face = NULL};
    vec3 *way = calloc(r->contact_count + (size_t)1, sizeof *way);
    mrt_result result = MRT_OK;
    if (!allocate_pose(out, name, b->dof_count, r->contact_count) || !set_dofs(out, b, dof) || !way)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a pose");
    for (uint32_t first = 0; result >= 0 && first < r->contact_count; first += most) {
        const uint32_t left = r->contact_count - first;
        result = find_ways(way, f, solver, first, left < most ? left : most, at, dof, err);
    }
    if (result >= 0 && follows)
        result = contacts_alone_create(&alone, r, face_binding(f), face_bones(f)->incisor, err);
    if (result >= 0)
        result = add_pulls(out, follows ? &alone : NULL, r, solver, way, err);
    contacts_alone_destroy(&alone);
    face_reset(f);
    free(way);
    if (result < 0)
        rig_pose_finish(out);
    return result;
}

/* ---- carrying poses to another rig ---- */

/* Access to the contacts of a head. Distances are 0 if a contact is missing. */
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

/* Scale of a part of the face: across, and in the other directions. */
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

/* Returns how far the lower lip moves when the jaw opens fully, mm. */
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

/* Copies a value as the same share of its limit. For mouthClose the share refers to the opening
 * limit, since it closes jawOpen. Returns false if there is no such degree of freedom. */
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

/* Returns the height of the left corner of the mouth above the middle of the lips in mm, or 0 if a
 * contact is missing. */
static double smile_of(const head *of)
{
    vec3 corner, upper, lower;
    if (!contact_position(&corner, of, "mouth.corner.l") ||
        !contact_position(&upper, of, "lip.upper.mid") ||
        !contact_position(&lower, of, "lip.lower.mid"))
        return 0.0;
    return corner.y - 0.5 * (upper.y + lower.y);
}

/* Tests whether a corner of the mouth goes outwards, and further up than out. */
static bool smiles(const rig_pose *pose, const rig *r)
{
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        const char *name = r->contact[pose->pull_contact[i]].name;
        const vec3 way = pose->pull_mm[i];
        const double out = strcmp(name, "mouth.corner.l") == 0   ? way.x
                           : strcmp(name, "mouth.corner.r") == 0 ? -way.x
                                                                 : 0.0;
        if (out > 0.0 && way.y > out)
            return true;
    }
    return false;
}

/* Tests whether a pose is a mouth whose corners go down. */
static bool turns_down(const char *pose)
{
    static const char *const down[] = {"mouthFrown", "mouthStretch", "sadness",
                                       "anger",      "fear",         "disgust"};
    for (size_t i = 0; i < sizeof down / sizeof *down; ++i)
        if (starts(pose, down[i]))
            return true;
    return false;
}

typedef struct carrying {
    head to, from;
    contacts_alone *alone;   /* of `to`; NULL: only what a pose names is carried */
    csrbf_settings solver;   /* of `to` */
    part_scale upper, lower; /* scale for brows, and for everything else */
    double closing;          /* scale of mouthClose */
    double smile_mm;         /* how much more the model's mouth smiles at rest */
    double narrowing; /* 0.5..1, smaller for a narrow mouth: factor of pulls that narrow a mouth;
                         those of a smile are divided by it */
} carrying;

/* If the model's mouth smiles at rest, its poses also correct that smile. On a level mouth this
 * part of a downward pull, `smile_mm` at the corners, would be a frown, so it is left out. */
static double leveled(double down_mm, const char *contact, const carrying *c)
{
    vec3 at, corner;
    bool is_beside = starts(contact, "mouth.corner") || starts(contact, "cheek.lower") ||
                     starts(contact, "lip.upper.side") || starts(contact, "lip.lower.side");
    if (!is_beside || down_mm >= 0.0 || !contact_position(&at, &c->from, contact) ||
        !contact_position(&corner, &c->from, "mouth.corner.l") || !(corner.x > 0.0))
        return down_mm;
    double part = fmin(at.x * at.x / (corner.x * corner.x), 1.0);
    return fmin(down_mm + part * c->smile_mm, 0.0);
}

/* Returns the factor for pulls that narrow a mouth. If the mouth is a smaller part of its face than
 * the model's, full pulls would close it. A smile has more room beside it then. */
static double narrowing_of(const head *to, const head *from, double mouth_across)
{
    double jaw_across = ratio_of(to, from, "jaw.angle.l", "jaw.angle.r");
    return jaw_across > 0.0 ? fmax(0.5, fmin(mouth_across / jaw_across, 1.0)) : 1.0;
}

static bool narrows(const rig_pose *pose, const rig *r)
{
    bool left = false, right = false;
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        const char *name = r->contact[pose->pull_contact[i]].name;
        left = left || (strcmp(name, "mouth.corner.l") == 0 && pose->pull_mm[i].x < 0.0);
        right = right || (strcmp(name, "mouth.corner.r") == 0 && pose->pull_mm[i].x > 0.0);
    }
    return left && right;
}

static vec3 carried_way(vec3 way, const char *contact, const rig_pose *pose, const carrying *c)
{
    bool is_upper = starts(contact, "brow") || starts(contact, "forehead");
    part_scale by = is_upper ? c->upper : c->lower;
    if (!is_upper && narrows(pose, c->from.rig))
        by.across *= c->narrowing;
    if (!is_upper && smiles(pose, c->from.rig))
        by = (part_scale){by.across / c->narrowing, by.along / c->narrowing};
    if (strcmp(pose->name, "mouthClose") == 0)
        by = (part_scale){c->closing, c->closing};
    if (!turns_down(pose->name))
        way.y = leveled(way.y, contact, c);
    return (vec3){by.across * way.x, by.along * way.y, by.along * way.z};
}

/* Adds pulls for contacts that the model's pose does not name, where the named pulls would move
 * them otherwise than on the model. On a smaller mouth the lips are so near to each other and to
 * the nose that a pull moves these, too. */
static mrt_result carry_follows(rig_pose *out, const rig_pose *pose, const carrying *c, error *err)
{
    const rig *r = c->to.rig;
    vec3 way[MRT_MAX_VECTORS];
    if (!c->alone || out->pull_count == 0)
        return MRT_OK;
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        uint32_t at = rig_find_contact(c->from.rig, r->contact[i].name), k = 0;
        bool is_of_part = pose->part == POSE_WHOLE || c->alone->part[i] == pose->part;
        way[i] = (vec3){(double)NAN, (double)NAN, (double)NAN};
        if (at == RIG_NONE || !is_of_part)
            continue;
        while (k < pose->pull_count + pose->follow_count && pose->pull_contact[k] != at)
            k += 1;
        vec3 was = k < pose->pull_count + pose->follow_count ? pose->pull_mm[k] : (vec3){0, 0, 0};
        way[i] = carried_way(was, r->contact[i].name, pose, c);
    }
    return add_pulls(out, c->alone, r, &c->solver, way, err);
}

/* pose: complete. Returns false if the result would not be that pose, or without memory. */
static bool carry_pose(rig_pose *out, const rig_pose *pose, const carrying *c)
{
    error ignored = {""};
    const uint32_t most =
        pose->pull_count > c->to.rig->contact_count ? pose->pull_count : c->to.rig->contact_count;
    bool is_of_eye = starts(pose->name, "eye") || starts(pose->name, "wink_") ||
                     strcmp(pose->name, "sleepy") == 0;
    if (!allocate_pose(out, pose->name, pose->dof_count, most))
        return false;
    out->part = pose->part;
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        if (!carry_dof(out, pose->dof_name[i], pose->dof_value[i], &c->to.bones, &c->from.bones) &&
            is_of_eye)
            return false;
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        const char *name = c->from.rig->contact[pose->pull_contact[i]].name;
        uint32_t at = rig_find_contact(c->to.rig, name);
        if (at == RIG_NONE)
            continue;
        out->pull_contact[out->pull_count] = at;
        out->pull_mm[out->pull_count++] = carried_way(pose->pull_mm[i], name, pose, c);
    }
    if (carry_follows(out, pose, c, &ignored) < 0)
        return false;
    return out->dof_count + out->pull_count > 0 || pose->dof_count + pose->pull_count == 0;
}

static bool is_carried(const char *name)
{
    static const char *const expressions[] = {"joy",  "sadness",   "anger",      "surprise",
                                              "fear", "disgust",   "contempt",   "sleepy",
                                              "smug", "wink_left", "wink_right", "brow_up"};
    for (size_t i = 0; i < sizeof expressions / sizeof *expressions; ++i)
        if (strcmp(name, expressions[i]) == 0)
            return true;
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

static bool is_missing(const rig_pose *pose, const head *of)
{
    return is_carried(pose->name) && !find_pose(of->rig, pose->name) &&
           !has_shape(of->mesh, pose->name);
}

static mrt_result carry_poses(rig *r, const carrying *c, error *err)
{
    const rig *model = c->from.rig;
    rig_pose *grown =
        realloc(r->pose, ((size_t)r->pose_count + model->pose_count + 1) * sizeof *grown);
    if (!grown)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the poses");
    r->pose = grown;
    for (uint32_t i = 0; i < model->pose_count; ++i) {
        const rig_pose *pose = &model->pose[i];
        if (!is_missing(pose, &c->to))
            continue;
        if (carry_pose(&r->pose[r->pose_count], pose, c))
            r->pose_count += 1;
        else
            rig_pose_finish(&r->pose[r->pose_count]);
    }
    return MRT_OK;
}

static mrt_result complete_model(rig *out, const carrying *c, const topology *t, error *err)
{
    binding bound = {0};
    contacts_alone alone = {.face = NULL};
    const csrbf_settings solver = rig_poses_solver(out, c->from.mesh);
    mrt_result result = binding_create(&bound, out, c->from.mesh, t, err);
    if (result >= 0)
        result = contacts_alone_create(&alone, out, &bound, c->from.bones.incisor, err);
    for (uint32_t i = 0; i < out->pose_count && result >= 0; ++i)
        result = complete(&out->pose[i], out, &alone, &solver, err);
    contacts_alone_destroy(&alone);
    binding_destroy(&bound);
    return result;
}

static void measure_heads(carrying *c)
{
    c->upper = scale_of(&c->to, &c->from, "brow.outer.l", "brow.outer.r", "brow.mid.l", "nose.tip");
    c->lower = scale_of(&c->to, &c->from, "mouth.corner.l", "mouth.corner.r", "nose.tip", "chin");
    c->closing = lip_travel(&c->to) / fmax(lip_travel(&c->from), 1.0);
    c->smile_mm =
        c->lower.along > 0.0 ? smile_of(&c->from) - smile_of(&c->to) / c->lower.along : 0.0;
    c->smile_mm = fmax(c->smile_mm, 0.0);
    c->narrowing = narrowing_of(&c->to, &c->from, c->lower.across);
}

mrt_result rig_poses_transfer(rig *r, const mesh *m, const face *f, const rig *model,
                              const mesh *model_mesh, const topology *model_topology, error *err)
{
    rig whole;
    contacts_alone alone = {.face = NULL};
    carrying c = {.to = {r, m, *face_bones(f)}, .from = {.rig = &whole, .mesh = model_mesh}};
    uint32_t missing = 0;
    for (uint32_t i = 0; i < model->pose_count; ++i)
        missing += is_missing(&model->pose[i], &c.to);
    mrt_result result = missing > 0 ? rig_copy(&whole, model, err) : MRT_OK;
    if (missing == 0 || result < 0)
        return result;
    result = bones_init(&c.from.bones, model, (vec3){0, 0, 0}, err);
    if (result >= 0 && can_follow(r) && can_follow(model)) {
        c.alone = &alone;
        c.solver = rig_poses_solver(r, m);
        result = complete_model(&whole, &c, model_topology, err);
        if (result >= 0)
            result = contacts_alone_create(&alone, r, face_binding(f), c.to.bones.incisor, err);
    }
    if (result >= 0) {
        measure_heads(&c);
        result = carry_poses(r, &c, err);
    }
    contacts_alone_destroy(&alone);
    rig_destroy(&whole);
    return result;
}

static void scale_pulls(rig_pose *pose, double by)
{
    for (uint32_t k = 0; k < pose->pull_count + pose->follow_count; ++k)
        pose->pull_mm[k] = vec3_scale(pose->pull_mm[k], by);
}

static void scale_jaw(rig_pose *pose, double by)
{
    for (uint32_t k = 0; k < pose->dof_count; ++k)
        if (starts(pose->dof_name[k], "jaw."))
            pose->dof_value[k] *= by;
}

/* Tests that a pose does not fold the skin, and that the limit does not hold it back. The contacts
 * stay engaged from one pose to the next. */
static mrt_result is_eased(rig_poses_stage *stage, bool *is_engaged, uint32_t pose, bool *out,
                           error *err)
{
    static const double least = 0.05, held_most_mm = 0.3;
    csrbf_settings limited = stage->solver;
    limited.stretch_most = stage->rig.solver.stretch_most;
    mrt_result result = show_on(stage->face, &stage->rig, pose, &stage->solver, !*is_engaged, err);
    *is_engaged = result >= 0;
    *out = result >= 0 && face_min_determinant(stage->face) > least;
    if (*out)
        result = show_on(stage->face, &stage->rig, pose, &limited, false, err);
    *out = *out && result >= 0 && face_metered(stage->face)->held_back_mm <= held_most_mm;
    return result;
}

/* Scales both copies of a pose until is_eased is true: its pulls, and with_jaw also the jaw's
 * motion. *out is false if that never happens; then the pose is unchanged. */
static mrt_result ease(rig_poses_stage *stage, bool *is_engaged, rig_pose *pose, uint32_t index,
                       bool with_jaw, bool *out, error *err)
{
    enum { ROUNDS = 12 };
    static const double part = 0.8;
    rig_pose *const copy[] = {pose, &stage->rig.pose[index]};
    double whole = 1.0;
    mrt_result result = is_eased(stage, is_engaged, index, out, err);
    for (int round = 0; round < ROUNDS && result >= 0 && !*out; ++round) {
        whole *= part;
        for (int i = 0; i < 2; ++i) {
            scale_pulls(copy[i], part);
            scale_jaw(copy[i], with_jaw ? part : 1.0);
        }
        result = is_eased(stage, is_engaged, index, out, err);
    }
    for (int i = 0; i < 2 && !*out; ++i) {
        scale_pulls(copy[i], 1.0 / whole);
        scale_jaw(copy[i], with_jaw ? 1.0 / whole : 1.0);
    }
    return result;
}

static mrt_result take_poses(rig_poses_stage *stage, const rig *r, error *err)
{
    rig copy;
    mrt_result result = rig_copy(&copy, r, err);
    if (result < 0)
        return result;
    rig_pose *had = stage->rig.pose;
    const uint32_t had_count = stage->rig.pose_count;
    stage->rig.pose = copy.pose;
    stage->rig.pose_count = copy.pose_count;
    copy.pose = had;
    copy.pose_count = had_count;
    rig_destroy(&copy);
    return rig_poses_complete(&stage->rig, 0, stage->face, &stage->solver, err);
}

mrt_result rig_poses_reduce(rig *r, uint32_t first, rig_poses_stage *stage, error *err)
{
    bool is_engaged = false;
    mrt_result result = take_poses(stage, r, err);
    for (uint32_t i = first; i < r->pose_count && result >= 0; ++i) {
        bool is_done = false;
        result = ease(stage, &is_engaged, &r->pose[i], i, false, &is_done, err);
        if (result >= 0 && !is_done)
            result = ease(stage, &is_engaged, &r->pose[i], i, true, &is_done, err);
    }
    return result;
}

/* ---- measuring ---- */

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
