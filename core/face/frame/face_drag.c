#include "face/frame/frame.h"

#include <math.h>
#include <string.h>

enum { PARTS = 4 }; /* tries */
/* The stretch limit is that of the pulls, see yield. */
static const surface_limits clay = {.bend_deg = 89.0, .area = 0.02};

/* Turns the shape shown into one that can be dragged: bones at rest, no controls. */
static void begin_drag(face *f)
{
    face_limit_pull(f);
    if (f->origin != &f->free)
        face_bake(f, &f->free);
    f->origin = &f->free;
    f->control_count = 0;
    f->control_column_count = f->shape_column_count;
    face_shapes_settle(f, f->dof);
    f->meter.dropped_count = 0;
    f->meter.slope_bound = 0.0;
}

static void show_free(face *f)
{
    face_pose_columns(f);
    face_pose_weights(f, f->weight, f->pose);
    face_show(f);
}

/* Sets f->from, f->to and f->gain: the path with the bones at rest. */
static void carry_back(face *f, const double *from, const double *to, uint32_t count,
                       const rigid *pose)
{
    for (uint32_t k = 0; k < count; ++k) {
        face_grip *grip = &f->next_grip[k];
        face_grip_at(grip, f, vec3_row(from, k), 0);
        blend posed = face_blend_at(f, grip, pose);
        double held = face_share_held(f, grip) * grip->mobility;
        f->gain[k] = grip->is_dropped ? 0.0 : 1.0 / held;
        vec3_set_row(f->from, k, grip->start);
        vec3_set_row(f->to, k, blend_undo(&posed, vec3_row(to, k)));
    }
}

static mrt_result check_way(const face *f, const double *from, const double *to, uint32_t count,
                            error *err)
{
    if (count > f->control_capacity)
        return error_set(err, MRT_ERR_ARGUMENT, "%u controls: the face has room for only %u", count,
                         f->control_capacity);
    for (size_t i = 0; i < (size_t)3 * count; ++i)
        if (!(fabs(from[i]) <= (double)POINTS_REACH && fabs(to[i]) <= (double)POINTS_REACH))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "control %u: moves from %g to %g, which is not within +-%g",
                             (uint32_t)(i / 3), from[i], to[i], (double)POINTS_REACH);
    return MRT_OK;
}

/* Lists the fields with at least one control. */
static uint32_t list_layers(const face *f, drag_layer *out)
{
    uint32_t count = 0;
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        if (field->control_count > 0)
            out[count++] = (drag_layer){.solver = field->solver,
                                        .weight = field->is_whole ? NULL : field->pull,
                                        .wanted = field->is_whole ? NULL : field->wanted,
                                        .control = field->control,
                                        .control_count = field->control_count};
    }
    return count;
}

static mrt_result drag_free(face *f, const csrbf_settings *settings, uint32_t count,
                            shape_step *out_step, error *err)
{
    drag_layer layer[RIG_BONES_MAX];
    const drag d = {.moved = &f->free,
                    .before = &f->before,
                    .layer = layer,
                    .layer_count = list_layers(f, layer),
                    .control_capacity = f->control_capacity,
                    .tip = f->tip,
                    .step = f->step,
                    .pull = f->pull};
    const drag_way way = {.from = f->from, .to = f->to, .gain = f->gain, .count = count};
    return drag_along(&d, settings, &way, f->position, out_step, err);
}

/* ---- limit of a step ----
 *
 * The result of a step is measured on the surface against the rest shape, which the fields do not
 * know. The map of a field does not fold in space, but it can become finer than the mesh. Tips move
 * less far if skin near them uses too much of the room before a limit. */

static void note_changed(face *f)
{
    const points *a = &f->before, *b = &f->free;
    for (uint32_t block = 0; block < a->block_count; ++block) {
        size_t first = (size_t)block * POINTS_BLOCK, size = POINTS_BLOCK * sizeof(float);
        f->limit.is_changed[block] = memcmp(a->x + first, b->x + first, size) != 0 ||
                                     memcmp(a->y + first, b->y + first, size) != 0 ||
                                     memcmp(a->z + first, b->z + first, size) != 0;
    }
}

/* Projects the dragged shape as the skull and teeth would, in the blocks that are read. */
static const points *show_clay(const face *f, points *out, const points *from)
{
    if (f->projection.block_count == 0)
        return from;
    for (uint32_t block = 0; block < from->block_count; ++block) {
        if (!f->limit.is_slid[block])
            continue;
        points_copy_block(out, from, block);
        projection_apply_still(&f->projection, out, block);
    }
    return out;
}

static double yield(face *f, const csrbf_settings *settings)
{
    const float *before[3], *after[3];
    surface_limits limits = clay;
    limits.stretch = face_stretch_most(settings);
    note_changed(f);
    memset(f->limit.is_slid, 0, f->free.block_count); /* scratch: the blocks that are read */
    surface_meter_reads(f->surface_meter, f->limit.is_changed, f->limit.is_slid);
    const points *from = show_clay(f, &f->limit.shown_before, &f->before);
    const points *to = show_clay(f, &f->limit.shown_after, &f->free);
    return (double)surface_meter_yield(f->surface_meter, &limits, points_streams(from, before),
                                       points_streams(to, after), f->limit.is_changed,
                                       f->limit.share);
}

/* Returns the influence of a tip on a point: 1 at the tip, 0 from the radius on. */
static double nearness(const double at[3], const double *tip, double radius)
{
    vec3 way = {at[0] - tip[0], at[1] - tip[1], at[2] - tip[2]};
    double q = vec3_dot(way, way) / (radius * radius);
    return q < 1.0 ? (1.0 - q) * (1.0 - q) : 0.0;
}

/* Writes the influence of each tip at a point to `near` (limit.ridge, as scratch). Returns the
 * greatest. */
static double find_nearness(double *near, const face *f, const double at[3], double radius,
                            uint32_t count)
{
    double most = 1e-6;
    for (uint32_t k = 0; k < count; ++k) {
        near[k] = nearness(at, f->from + (size_t)3 * k, radius);
        most = near[k] > most ? near[k] : most;
    }
    return most;
}

/* Sets each tip's share of the step to the least share of a vertex near it. */
static void shorten_tips(face *f, double radius, uint32_t count)
{
    face_limit *l = &f->limit;
    memcpy(l->strain, l->tip_share, count * sizeof *l->strain);
    for (uint32_t slot = 0; slot < f->before.count; ++slot) {
        double at[3], *near = l->ridge, share = (double)l->share[slot];
        if (!(share < 1.0))
            continue;
        points_at(at, &f->before, slot);
        double nearest = find_nearness(near, f, at, radius, count);
        for (uint32_t k = 0; k < count; ++k) {
            double own = l->strain[k] * (1.0 - near[k] / nearest * (1.0 - share));
            l->tip_share[k] = fmin(l->tip_share[k], own);
        }
    }
}

/* Returns the share of the step at a point: the tips' shares, weighted by their influence there. */
static double part_at(const face *f, const double at[3], double radius, uint32_t count)
{
    double part = 1.0, *near = f->limit.ridge, nearest = find_nearness(near, f, at, radius, count);
    for (uint32_t k = 0; k < count; ++k) {
        double own = 1.0 - (1.0 - f->limit.tip_share[k]) * (near[k] / nearest);
        part = f->limit.tip_share[k] < 1.0 && own < part ? own : part;
    }
    return part;
}

/* Sets f->free to the reduced step. all: factor of the whole step, in addition to the tips'
 * shares. */
static void apply_part(face *f, double radius, uint32_t count, double all)
{
    for (uint32_t block = 0; block < f->free.block_count; ++block) {
        if (!f->limit.is_changed[block])
            continue;
        for (size_t slot = (size_t)block * POINTS_BLOCK; slot < (size_t)(block + 1) * POINTS_BLOCK;
             ++slot) {
            const float *step = f->limit.step[slot];
            double at[3];
            if (step[0] == 0.0f && step[1] == 0.0f && step[2] == 0.0f)
                continue; /* no field reaches it */
            points_at(at, &f->before, slot);
            float part = (float)(all * part_at(f, at, radius, count));
            f->free.x[slot] = f->before.x[slot] + part * step[0];
            f->free.y[slot] = f->before.y[slot] + part * step[1];
            f->free.z[slot] = f->before.z[slot] + part * step[2];
        }
        points_update_block(&f->free, block);
    }
}

static void keep_step(face *f)
{
    for (size_t slot = 0; slot < f->free.padded_count; ++slot) {
        float *step = f->limit.step[slot];
        step[0] = f->free.x[slot] - f->before.x[slot];
        step[1] = f->free.y[slot] - f->before.y[slot];
        step[2] = f->free.z[slot] - f->before.z[slot];
    }
}

/* share: the least share of the step that some vertex allows. */
static void shorten_step(face *f, const csrbf_settings *settings, uint32_t count, double share)
{
    double all = 1.0;
    keep_step(f);
    for (int i = 0; i < PARTS && share < 1.0; ++i) {
        shorten_tips(f, settings->radius, count);
        apply_part(f, settings->radius, count, 1.0);
        share = yield(f, settings);
    }
    for (int i = 0; i < PARTS && share < 1.0;
         ++i) { /* for vertices that no tip is near enough to */
        all *= i == 0 ? share : 0.5 * share;
        apply_part(f, settings->radius, count, all);
        share = yield(f, settings);
    }
    if (share < 1.0) {
        points_copy(&f->free, &f->before);
        all = 0.0;
    }
    for (uint32_t k = 0; k < count; ++k) { /* strain is used as scratch */
        double *tip = f->position + (size_t)3 * k, *from = f->from + (size_t)3 * k;
        f->limit.strain[k] = all * part_at(f, from, settings->radius, count);
        for (int i = 0; i < 3; ++i)
            tip[i] = from[i] + f->limit.strain[k] * (tip[i] - from[i]);
    }
    memcpy(f->limit.tip_share, f->limit.strain, count * sizeof *f->limit.strain);
}

static void note_held_tips(face *f, uint32_t count)
{
    double most = 0.0;
    for (uint32_t k = 0; k < count; ++k) {
        vec3 missing = vec3_sub(vec3_row(f->to, k), vec3_row(f->position, k));
        if (f->limit.tip_share[k] < 1.0)
            most = fmax(most, vec3_length(missing));
    }
    f->meter.held_back_mm = most;
}

/* Reduces a drag of f->free from f->before along f->from -> f->to that goes too far. Sets
 * f->position to the tips, and limit.tip_share to 1 for tips that reach their end. */
static void limit_drag(face *f, const csrbf_settings *settings, uint32_t count,
                       const shape_step *step)
{
    f->meter.held_back_mm = 0.0;
    for (uint32_t k = 0; k < count; ++k)
        f->limit.tip_share[k] = 1.0;
    if (settings->stretch_most < 0.0 || step->substeps == 0)
        return;
    double share = yield(f, settings);
    if (!(share < 1.0))
        return;
    shorten_step(f, settings, count, share);
    note_held_tips(f, count);
}

/* ---- one sample of a drag ---- */

mrt_result face_drag(face *f, const csrbf_settings *settings, const double *from, const double *to,
                     uint32_t count, const float *dof, double *out_reached, shape_step *out_step,
                     error *err)
{
    float resolved[MRT_MAX_DOFS];
    rigid pose[RIG_BONES_MAX];
    *out_step = (shape_step){.min_determinant = 1.0};
    mrt_result result = check_way(f, from, to, count, err);
    if (result >= 0)
        result = face_resolve_dofs(f, resolved, dof, NULL, err);
    if (result < 0)
        return result;
    face_pose_bones(f, pose, resolved);
    carry_back(f, from, to, count, pose);
    begin_drag(f);
    face_assign(f, f->next_grip, count);
    f->control_column_count = f->shape_column_count;
    result = drag_free(f, settings, count, out_step, err);
    if (result >= 0)
        limit_drag(f, settings, count, out_step);
    if (result >= 0 && out_step->substeps > 0)
        face_mark_changed_stale(f, &f->free, &f->before);
    if (result < 0) {
        show_free(f);
        return result;
    }
    face_set_pose(f, resolved, pose);
    face_shapes_settle(f, resolved);
    show_free(f);
    for (uint32_t k = 0; out_reached && k < count; ++k) {
        blend posed = face_blend_at(f, &f->next_grip[k], pose);
        vec3_set_row(out_reached, k,
                     out_step->limited || f->limit.tip_share[k] < 1.0
                         ? blend_apply(&posed, vec3_row(f->position, k))
                         : vec3_row(to, k));
    }
    return MRT_OK;
}

static void ease(face *f, const points *towards, double rate_per_s, double dt_s)
{
    points_copy(&f->before, &f->free);
    shape_ease(&f->free, towards, rate_per_s, dt_s);
    face_mark_changed_stale(f, &f->free, &f->before);
}

void face_leak(face *f, double rate_per_s, double dt_s)
{
    begin_drag(f);
    ease(f, &f->base, rate_per_s, dt_s);
    show_free(f);
}

void face_restore(face *f, double part)
{
    double amount = part < 1.0 ? part / (1.0 - part) : 1e300;
    begin_drag(f);
    ease(f, &f->rest, amount, 1.0);
    shape_ease(&f->base, &f->rest, amount, 1.0);
    show_free(f);
}
