#include "face/frame/frame.h"

#include <math.h>
#include <string.h>

static mrt_result check_controls(const face *f, const face_control *control, uint32_t count,
                                 error *err)
{
    if (!points_are_usable(&f->shown))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the shape has moved beyond +-%g; reset it first", (double)POINTS_REACH);
    if (count > f->control_capacity)
        return error_set(err, MRT_ERR_ARGUMENT, "%u controls: the face has room for only %u", count,
                         f->control_capacity);
    for (uint32_t k = 0; k < count; ++k) {
        vec3 at = control[k].start;
        double size = fmax(fabs(at.x), fmax(fabs(at.y), fabs(at.z)));
        if (!isfinite(at.x + at.y + at.z) || !(size <= (double)POINTS_REACH))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "control %u: its start (%g, %g, %g) is not within +-%g", k, at.x, at.y,
                             at.z, (double)POINTS_REACH);
        if (control[k].contact > f->contact_count)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "control %u: has contact %u, but the face has only %u", k,
                             control[k].contact, f->contact_count);
    }
    return MRT_OK;
}

/* Factors each field at its controls. */
static mrt_result factor_fields(face *f, const csrbf_settings *settings, const face_grip *grip,
                                error *err)
{
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        for (uint32_t i = 0; i < field->control_count; ++i) {
            vec3 start = grip[field->control[i]].start;
            vec3_set_row(f->position, i, start);
        }
        mrt_result result =
            csrbf_factor(field->solver, settings, f->position, NULL, field->control_count, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static void set_grip_positions(face *f)
{
    points *p = &f->grip_position;
    for (uint32_t slot = 0; slot < p->padded_count && f->control_count > 0; ++slot) {
        vec3 at = f->grip[slot < f->control_count ? slot : 0].start;
        p->x[slot] = (float)at.x;
        p->y[slot] = (float)at.y;
        p->z[slot] = (float)at.z;
    }
    points_update_bounds(p);
}

static void scale_rows(face *f, const face_field *field)
{
    for (uint32_t i = 0; i < field->control_count; ++i) {
        float *restrict row = columns_row(&f->columns, field->first_column + i);
        const float *restrict pull = field->pull;
        for (uint32_t slot = 0; slot < f->rest.padded_count; ++slot)
            row[slot] *= pull[slot];
    }
}

/* Computes the columns of the controls, and their values at the starts of all controls (cross). */
static void respond(face *f)
{
    set_grip_positions(f);
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        face_field *field = &f->field[b];
        if (field->control_count == 0)
            continue;
        csrbf_limit_gain(field->solver, &f->base, SHAPE_GAIN_LIMIT);
        csrbf_responses_in(field->solver, columns_row(&f->columns, field->first_column),
                           f->columns.stride, &f->base, field->wanted);
        if (!field->is_whole)
            scale_rows(f, field);
        if (f->bone_count > 1)
            csrbf_responses(field->solver,
                            f->cross + (size_t)field->first_column * f->grip_position.padded_count,
                            f->grip_position.padded_count, &f->grip_position);
    }
}

static void count_dropped(face *f)
{
    f->meter.dropped_count = 0;
    for (uint32_t k = 0; k < f->control_count; ++k)
        f->meter.dropped_count += f->grip[k].is_dropped;
}

mrt_result face_hold(face *f, error *err)
{
    mrt_result result = factor_fields(f, &f->settings, f->grip, err);
    if (result < 0)
        return result;
    respond(f);
    face_shapes_engage(f);
    count_dropped(f);
    return MRT_OK;
}

static void swap_grips(face *f)
{
    face_grip *old = f->grip;
    f->grip = f->next_grip;
    f->next_grip = old;
}

mrt_result face_engage(face *f, const csrbf_settings *settings, const face_control *control,
                       uint32_t count, error *err)
{
    mrt_result result = check_controls(f, control, count, err);
    if (result < 0)
        return result;
    face_limit_pull(f);
    for (uint32_t k = 0; k < count; ++k)
        face_grip_at(&f->next_grip[k], f, control[k].start, control[k].contact);
    uint32_t old_columns = f->control_column_count;
    face_assign(f, f->next_grip, count);
    uint32_t new_columns = f->control_column_count;
    result = factor_fields(f, settings, f->next_grip, err);
    if (result < 0) {
        face_assign(f, f->grip, f->control_count);
        if (f->control_count > 0 && factor_fields(f, &f->settings, f->grip, NULL) < 0)
            face_commit(f); /* cannot fail: they were factored before */
        return result;
    }
    f->control_column_count = old_columns;
    face_bake(f, &f->base);
    f->control_column_count = new_columns;
    f->origin = &f->base;
    f->control_count = count;
    f->settings = *settings;
    swap_grips(f);
    respond(f);
    face_shapes_engage(f);
    face_shapes_settle(f, f->dof);
    face_pose_columns(f);
    memset(f->weight, 0, (size_t)3 * f->columns.count * sizeof *f->weight);
    face_pose_weights(f, f->weight, f->pose);
    count_dropped(f);
    return MRT_OK;
}

void face_set_stretch_most(face *f, double factor)
{
    f->settings.stretch_most = factor;
    f->is_given = false;
}
