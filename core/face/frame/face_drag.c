#include "face/frame/frame.h"

#include <math.h>
#include <string.h>

/* The shape shown becomes one that is dragged: bones at rest, no controls. */
static void let_go(face *f)
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

static vec3 row_of(const double *rows, uint32_t k)
{
    const double *row = rows + (size_t)3 * k;
    return (vec3){row[0], row[1], row[2]};
}

static void set_row(double *rows, uint32_t k, vec3 value)
{
    double *row = rows + (size_t)3 * k;
    row[0] = value.x;
    row[1] = value.y;
    row[2] = value.z;
}

/* f->from, f->to, f->gain: the way with the bones at rest. */
static void carry_back(face *f, const double *from, const double *to, uint32_t count,
                       const rigid *pose)
{
    for (uint32_t k = 0; k < count; ++k) {
        face_grip *grip = &f->next_grip[k];
        face_grip_at(grip, f, row_of(from, k), 0);
        blend posed = face_blend_at(f, grip, pose);
        double held = face_share_held(f, grip) * grip->mobility;
        f->gain[k] = grip->is_dropped ? 0.0 : 1.0 / held;
        set_row(f->from, k, grip->start);
        set_row(f->to, k, blend_undo(&posed, row_of(to, k)));
    }
}

static mrt_result check_way(const face *f, const double *from, const double *to, uint32_t count,
                            error *err)
{
    if (count > f->control_capacity)
        return error_set(err, MRT_ERR_ARGUMENT, "%u controls: the face has room for %u", count,
                         f->control_capacity);
    for (size_t i = 0; i < (size_t)3 * count; ++i)
        if (!(fabs(from[i]) <= (double)POINTS_REACH && fabs(to[i]) <= (double)POINTS_REACH))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "control %u: its way from %g to %g is not within +-%g",
                             (uint32_t)(i / 3), from[i], to[i], (double)POINTS_REACH);
    return MRT_OK;
}

/* The fields that some control is in. */
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
    bones_pose(pose, &f->bones, resolved);
    carry_back(f, from, to, count, pose);
    let_go(f);
    face_assign(f, f->next_grip, count);
    f->control_column_count = f->shape_column_count;
    result = drag_free(f, settings, count, out_step, err);
    if (result >= 0)
        face_limit_drag(f, settings, count, out_step);
    if (result >= 0 && out_step->substeps > 0)
        face_touch_changed(f, &f->free, &f->before);
    if (result < 0) {
        show_free(f);
        return result;
    }
    face_take_pose(f, resolved, pose);
    face_shapes_settle(f, resolved);
    show_free(f);
    for (uint32_t k = 0; out_reached && k < count; ++k) {
        blend posed = face_blend_at(f, &f->next_grip[k], pose);
        set_row(out_reached, k,
                out_step->limited || f->limit.tip_share[k] < 1.0
                    ? blend_apply(&posed, row_of(f->position, k))
                    : row_of(to, k));
    }
    return MRT_OK;
}

static void ease(face *f, const points *towards, double rate_per_s, double dt_s)
{
    points_copy(&f->before, &f->free);
    shape_ease(&f->free, towards, rate_per_s, dt_s);
    face_touch_changed(f, &f->free, &f->before);
}

void face_leak(face *f, double rate_per_s, double dt_s)
{
    let_go(f);
    ease(f, &f->base, rate_per_s, dt_s);
    show_free(f);
}

void face_restore(face *f, double part)
{
    double amount = part < 1.0 ? part / (1.0 - part) : 1e300;
    let_go(f);
    ease(f, &f->rest, amount, 1.0);
    shape_ease(&f->base, &f->rest, amount, 1.0);
    show_free(f);
}
