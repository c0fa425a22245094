#include "face/frame/frame.h"
#include "base/large.h"
#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float weight_least = 1e-6f; /* smaller weights have no visible effect */

static mrt_result check_binding(const binding *b, const rig *r, const mesh *m, error *err)
{
    uint32_t bone_count = r ? r->bone_count : 1;
    if (b->vertex_count != m->vertex_count || b->bone_count != bone_count || !b->weight ||
        !b->mobility)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the binding has %u vertices and %u bones: expected %u and %u",
                         b->vertex_count, b->bone_count, m->vertex_count, bone_count);
    size_t weight_count = (size_t)b->bone_count * b->vertex_count;
    for (size_t i = 0; i < weight_count; ++i)
        if (!(b->weight[i] >= 0.0f && b->weight[i] <= 1.0f + 1e-5f))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "bone %zu, vertex %zu: weight %g: expected 0..1", i / b->vertex_count,
                             i % b->vertex_count, (double)b->weight[i]);
    for (size_t i = 0; i < b->vertex_count; ++i)
        if (!(b->mobility[i] >= 0.0f && b->mobility[i] <= 1.0f + 1e-5f))
            return error_set(err, MRT_ERR_ARGUMENT, "vertex %zu: mobility %g: expected 0..1", i,
                             (double)b->mobility[i]);
    for (uint32_t i = 0; r && i < r->contact_count; ++i)
        if (r->contact[i].vertex >= m->vertex_count)
            return error_set(err, MRT_ERR_FORMAT,
                             "contact %s: vertex %u does not exist, the mesh has %u vertices",
                             r->contact[i].name, r->contact[i].vertex, m->vertex_count);
    return MRT_OK;
}

/* Finds the foremost vertex of the jaw, among its rigid ones if there are any. */
static vec3 find_incisor(const rig *r, const mesh *m, const binding *b)
{
    uint32_t jaw = 0, found = RIG_NONE;
    bool found_rigid = false;
    while (r && jaw < r->bone_count && r->bone[jaw].kind != BONE_JAW)
        ++jaw;
    if (!r || jaw == r->bone_count)
        return (vec3){0, 0, 0};
    const float *weight = b->weight + (size_t)jaw * b->vertex_count;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        bool rigid_one = weight[v] > 0.999f && b->mobility[v] < 1e-3f;
        if (weight[v] < 0.95f || (found_rigid && !rigid_one))
            continue;
        bool is_better = found == RIG_NONE || (rigid_one && !found_rigid) ||
                         m->position[(size_t)3 * v + 2] > m->position[(size_t)3 * found + 2];
        found = is_better ? v : found;
        found_rigid = found_rigid || rigid_one;
    }
    if (found == RIG_NONE)
        return (vec3){0, 0, 0};
    return mesh_position(m, found);
}

/* Returns 1 + the bone that a vertex is rigid on, or 0 for skin. */
static uint32_t part_of(const binding *b, uint32_t vertex)
{
    uint32_t bone = 0;
    while (bone < b->bone_count && b->weight[(size_t)bone * b->vertex_count + vertex] < 1.0f)
        ++bone;
    return bone < b->bone_count && b->mobility[vertex] < weight_least ? 1 + bone : 0;
}

/* Orders skin first, then the rigid vertices of each bone, keeping the order within each group. So
 * few blocks of vertices are moved only in part by a bone or control. */
static void group_order(points_order *order, const binding *b, uint32_t *scratch)
{
    uint32_t slot = 0;
    if (b->bone_count < 2)
        return;
    for (uint32_t part = 0; part <= b->bone_count; ++part)
        for (uint32_t i = 0; i < order->count; ++i)
            if (part_of(b, order->file_of_slot[i]) == part)
                scratch[slot++] = order->file_of_slot[i];
    for (uint32_t i = 0; i < order->count; ++i) {
        order->file_of_slot[i] = scratch[i];
        order->slot_of_file[scratch[i]] = i;
    }
}

static mrt_result create_order(face *f, const mesh *m, error *err)
{
    mrt_result result = points_order_create(&f->order, m->position, m->vertex_count, err);
    if (result < 0)
        return result;
    uint32_t *scratch = calloc((size_t)m->vertex_count + 1, sizeof *scratch);
    if (!scratch)
        return error_set(err, MRT_ERR_MEMORY, "no memory to order %u vertices", m->vertex_count);
    group_order(&f->order, &f->binding, scratch);
    free(scratch);
    return MRT_OK;
}

static mrt_result create_points(face *f, const mesh *m, error *err)
{
    points *const all[] = {&f->rest,
                           &f->base,
                           &f->shown,
                           &f->free,
                           &f->before,
                           &f->limit.shown_before,
                           &f->limit.shown_after};
    mrt_result result = create_order(f, m, err);
    for (size_t i = 0; result >= 0 && i < sizeof all / sizeof *all; ++i)
        result = points_create(all[i], &f->order, m->position, err);
    f->origin = &f->base;
    return result;
}

static float *create_stream(const face *f)
{
    return large_alloc(((size_t)f->rest.padded_count + LARGE_ALIGNMENT) * sizeof(float));
}

/* Converts a row from the file's order to the engine's. Slots beyond the count repeat the last
 * vertex. */
static void order_stream(const face *f, float *out, const float *row)
{
    for (uint32_t slot = 0; slot < f->rest.padded_count; ++slot) {
        uint32_t last = f->rest.count - 1;
        float value = row[f->order.file_of_slot[slot < last ? slot : last]];
        value = value < weight_least ? 0.0f : value;
        out[slot] = value > 1.0f ? 1.0f : value;
    }
}

static vec3 pivot_of(const face *f, uint32_t bone)
{
    for (uint32_t at = bone; f->rig && at != RIG_NONE; at = f->rig->bone[at].parent) {
        const rig_bone *one = &f->rig->bone[at];
        if (one->kind == BONE_JAW)
            return f->bones.hinge.middle;
        if (one->kind == BONE_BALL)
            return one->centre;
    }
    return (vec3){0, 0, 0};
}

static mrt_result create_field(face *f, uint32_t bone, error *err)
{
    face_field *field = &f->field[bone];
    field->solver = csrbf_solver_create(f->control_capacity);
    field->weight = create_stream(f);
    field->pull = create_stream(f);
    field->wanted = arrays_add(&f->arrays, f->rest.block_count, 1);
    field->carried = arrays_add(&f->arrays, f->rest.block_count, 1);
    field->control = arrays_add(&f->arrays, f->control_capacity, sizeof *field->control);
    if (!field->solver || !field->weight || !field->pull || f->arrays.failed)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the fields of %u bones",
                         f->bone_count);
    field->pivot = pivot_of(f, bone);
    field->is_whole = true;
    order_stream(f, field->weight, f->binding.weight + (size_t)bone * f->binding.vertex_count);
    for (uint32_t slot = 0; slot < f->rest.padded_count; ++slot) {
        float pull = field->weight[slot] * f->mobility[slot];
        field->pull[slot] = pull < weight_least ? 0.0f : pull;
        if (field->weight[slot] > 0.0f)
            field->carried[slot / POINTS_BLOCK] = 1;
        if (field->pull[slot] > 0.0f)
            field->wanted[slot / POINTS_BLOCK] = 1;
        field->is_whole = field->is_whole && !(pull < 1.0f);
    }
    return MRT_OK;
}

static mrt_result create_fields(face *f, error *err)
{
    f->mobility = create_stream(f);
    if (!f->mobility)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the mobility");
    order_stream(f, f->mobility, f->binding.mobility);
    for (uint32_t bone = 0; bone < f->bone_count; ++bone) {
        mrt_result result = create_field(f, bone, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static mrt_result create_columns(face *f, error *err)
{
    uint32_t moving = 0;
    for (uint32_t bone = 0; bone < f->bone_count; ++bone)
        moving += f->bones.moves[bone];
    uint32_t each = f->bone_count < FACE_BONES_PER_CONTROL ? f->bone_count : FACE_BONES_PER_CONTROL;
    uint64_t capacity =
        (uint64_t)each * f->control_capacity + FACE_POSE_COLUMNS * moving + f->shape_column_count;
    if (capacity > COLUMNS_CAPACITY)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%u controls on %u bones are too many; use fewer controls",
                         f->control_capacity, f->bone_count);
    mrt_result result = columns_create(&f->columns, &f->rest, (uint32_t)capacity, err);
    if (result >= 0)
        face_shapes_fill(f);
    return result;
}

/* Creates one point per control. */
static mrt_result create_grip_positions(face *f, error *err)
{
    size_t count = f->control_capacity > 0 ? f->control_capacity : 1;
    points_order order = {0};
    float *zeros = calloc(3 * count, sizeof *zeros);
    if (!zeros)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %zu controls", count);
    mrt_result result = points_order_create(&order, zeros, (uint32_t)count, err);
    if (result >= 0)
        result = points_create(&f->grip_position, &order, zeros, err);
    points_order_destroy(&order);
    free(zeros);
    return result;
}

static mrt_result create_controls(face *f, error *err)
{
    arrays *a = &f->arrays;
    size_t controls = f->control_capacity, rows_of_columns = f->columns.capacity;
    double **const rows[] = {&f->g,    &f->position, &f->scratch, &f->gain, &f->tip,
                             &f->step, &f->pull,     &f->from,    &f->to};
    double **const weights[] = {&f->weight, &f->next_weight, &f->given};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i)
        *rows[i] = arrays_add(a, 3 * controls, sizeof **rows[i]);
    for (size_t i = 0; i < sizeof weights / sizeof *weights; ++i)
        *weights[i] = arrays_add(a, 3 * rows_of_columns, sizeof **weights[i]);
    f->grip = arrays_add(a, controls, sizeof *f->grip);
    f->rotation = arrays_add(a, controls, sizeof *f->rotation);
    f->next_grip = arrays_add(a, controls, sizeof *f->next_grip);
    mrt_result result = create_grip_positions(f, err);
    if (result < 0)
        return result;
    size_t cross_rows = f->bone_count > 1 ? rows_of_columns : 0;
    f->cross = arrays_add(a, cross_rows * f->grip_position.padded_count, sizeof *f->cross);
    return a->failed
               ? error_set(err, MRT_ERR_MEMORY, "no memory for %u controls", f->control_capacity)
               : MRT_OK;
}

static uint32_t main_bone(const face *f, uint32_t vertex)
{
    uint32_t best = 0;
    const float *weight = f->binding.weight + vertex;
    size_t stride = f->binding.vertex_count;
    for (uint32_t bone = 1; bone < f->bone_count; ++bone)
        if (weight[bone * stride] > weight[best * stride])
            best = bone;
    return best;
}

static mrt_vec3 narrowed(vec3 v)
{
    return (mrt_vec3){(float)v.x, (float)v.y, (float)v.z};
}

static mrt_result create_contacts(face *f, const mesh *m, error *err)
{
    const rig *r = f->rig;
    f->contact_count = r ? r->contact_count : 0;
    f->contact = arrays_add(&f->arrays, f->contact_count, sizeof *f->contact);
    f->contact_slot = arrays_add(&f->arrays, f->contact_count, sizeof *f->contact_slot);
    if (f->arrays.failed)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u contacts", f->contact_count);
    for (uint32_t i = 0; i < f->contact_count; ++i) {
        const rig_contact *c = &r->contact[i];
        const float *at = m->position + (size_t)3 * c->vertex;
        uint32_t bone = c->bone < f->bone_count ? c->bone : main_bone(f, c->vertex);
        vec3 normal = f->binding.contact_normal ? f->binding.contact_normal[i] : (vec3){0, 0, 1};
        f->contact_slot[i] = f->order.slot_of_file[c->vertex];
        f->contact[i] = (mrt_contact){.name = c->name,
                                      .bone = r->bone[bone].name,
                                      .rest = {at[0], at[1], at[2]},
                                      .normal = narrowed(normal)};
    }
    return MRT_OK;
}

static mrt_result create_parts(face *f, const mesh *m, error *err)
{
    mrt_result result = check_binding(&f->binding, f->rig, m, err);
    if (result >= 0)
        result = bones_init(&f->bones, f->rig, find_incisor(f->rig, m, &f->binding), err);
    if (result < 0)
        return result;
    f->bone_count = f->bones.bone_count;
    result = create_points(f, m, err);
    if (result >= 0)
        result = create_fields(f, err);
    if (result >= 0)
        result = face_skin_create(f, m, err);
    if (result >= 0)
        result = face_shapes_create(f, m, err);
    if (result >= 0)
        result = create_columns(f, err);
    if (result >= 0)
        result = create_controls(f, err);
    if (result >= 0)
        result = create_contacts(f, m, err);
    if (result >= 0)
        result = projection_create(&f->projection, f->rig, &f->rest, f->mobility, err);
    if (result >= 0)
        result = face_limit_create(f, err);
    if (result >= 0)
        result = face_lips_create(f, err);
    if (result >= 0)
        face_tongue_create(f);
    if (result >= 0)
        face_springs_create(f);
    if (result >= 0)
        result = face_shown_create(f, err);
    return result;
}

static mrt_result create(face **out, const rig *r, const mesh *m, binding *b,
                         uint32_t control_capacity, bool wants_shapes, error *err)
{
    *out = NULL;
    face *f = calloc(1, sizeof *f);
    if (!f) {
        binding_destroy(b);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a face");
    }
    f->rig = r;
    f->wants_shapes = wants_shapes;
    f->binding = *b;
    *b = (binding){0};
    f->control_capacity = control_capacity;
    mrt_result result = create_parts(f, m, err);
    if (result < 0) {
        face_destroy(f);
        return result;
    }
    face_reset(f);
    *out = f;
    return MRT_OK;
}

mrt_result face_create_bound(face **out, const rig *r, const mesh *m, binding *b,
                             uint32_t control_capacity, error *err)
{
    return create(out, r, m, b, control_capacity, false, err);
}

mrt_result face_create_shaped(face **out, const rig *r, const mesh *m, binding *b,
                              uint32_t control_capacity, error *err)
{
    return create(out, r, m, b, control_capacity, true, err);
}

mrt_result face_create(face **out, const rig *r, const mesh *m, const topology *t,
                       uint32_t control_capacity, error *err)
{
    binding b = {0};
    *out = NULL;
    mrt_result result = binding_create(&b, r, m, t, err);
    return result < 0 ? result : face_create_bound(out, r, m, &b, control_capacity, err);
}

void face_destroy(face *f)
{
    if (!f)
        return;
    points *const all[] = {&f->rest,
                           &f->base,
                           &f->shown,
                           &f->free,
                           &f->before,
                           &f->grip_position,
                           &f->limit.shown_before,
                           &f->limit.shown_after};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        points_destroy(all[i]);
    for (uint32_t bone = 0; bone < RIG_BONES_MAX; ++bone) {
        csrbf_solver_destroy(f->field[bone].solver);
        large_free(f->field[bone].weight);
        large_free(f->field[bone].pull);
    }
    binding_destroy(&f->binding);
    projection_destroy(&f->projection);
    free(f->shapes.learnt);
    stamps_destroy(&f->blocks.written);
    points_order_destroy(&f->order);
    columns_destroy(&f->columns);
    face_lips_destroy(f);
    large_free(f->mobility);
    surface_meter_destroy(f->surface_meter);
    arrays_free(&f->arrays);
    free(f);
}

const points_order *face_order(const face *f)
{
    return &f->order;
}

const points *face_rest(const face *f)
{
    return &f->rest;
}

const binding *face_binding(const face *f)
{
    return &f->binding;
}

const bones *face_bones(const face *f)
{
    return &f->bones;
}

const mrt_contact *face_contacts(const face *f, uint32_t *out_count)
{
    *out_count = f->contact_count;
    return f->contact;
}
