#include "face/frame/frame.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- columns of the bones ---- */

/* Computes w (x - c) for one axis in one block. */
static void fill_block(float *restrict out, const float *restrict weight, const float *restrict x,
                       double centre)
{
    for (int i = 0; i < POINTS_BLOCK; ++i)
        out[i] = (float)((double)weight[i] * ((double)x[i] - centre));
}

/* Fills the four columns of a bone where it carries vertices: w (x - c) along each axis, and w.
 * wanted: the blocks to fill; NULL: all. */
static void fill_carried(face *f, const face_field *field, const uint8_t *wanted)
{
    float *row[FACE_POSE_COLUMNS];
    for (uint32_t i = 0; i < FACE_POSE_COLUMNS; ++i)
        row[i] = columns_row(&f->columns, field->pose_column + i);
    for (size_t block = 0; block < f->rest.block_count; ++block) {
        size_t first = block * POINTS_BLOCK;
        const float *weight = field->weight + first;
        if (!field->carried[block] || (wanted && !wanted[block]))
            continue;
        fill_block(row[0] + first, weight, f->origin->x + first, field->pivot.x);
        fill_block(row[1] + first, weight, f->origin->y + first, field->pivot.y);
        fill_block(row[2] + first, weight, f->origin->z + first, field->pivot.z);
        memcpy(row[3] + first, weight, POINTS_BLOCK * sizeof *weight);
    }
}

void face_pose_columns(face *f)
{
    uint32_t column = f->control_column_count;
    bool is_pose_alone = column == f->shape_column_count,
         is_noted = is_pose_alone && f->is_pose_noted;
    if (!is_noted)
        face_discard_columns(f);
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        face_field *field = &f->field[b];
        if (!f->bones.moves[b])
            continue;
        field->pose_column = column;
        column += FACE_POSE_COLUMNS;
        if (!is_noted) /* the vertices of a bone do not change */
            memset(columns_row(&f->columns, field->pose_column), 0,
                   FACE_POSE_COLUMNS * f->columns.stride * sizeof(float));
        /* if the origin has changed since they were filled, the shape shown is stale, too */
        fill_carried(f, field, is_noted ? f->blocks.is_stale : NULL);
    }
    if (!is_pose_alone)
        columns_note_groups(&f->columns, f->shape_column_count, column, 1);
    else if (!is_noted)
        columns_note_groups(&f->columns, f->shape_column_count, column, FACE_POSE_COLUMNS);
    f->is_pose_noted = is_pose_alone;
    f->engagement += 1;
    bool limits_bones_alone = f->shape_column_count > 0 || f->lips.count > 0;
    if (!is_pose_alone || (limits_bones_alone && f->origin == &f->base))
        face_limit_engage(f);
    face_lips_engage(f);
}

static void set_row(double *row, double x, double y, double z)
{
    row[0] = x;
    row[1] = y;
    row[2] = z;
}

void face_weigh_bone(const face *f, double *weight, uint32_t bone, const rigid *pose)
{
    const face_field *field = &f->field[bone];
    double *row = weight + (size_t)3 * field->pose_column;
    const rigid *p = &pose[bone];
    vec3 shift = vec3_sub(rigid_apply(p, field->pivot), field->pivot);
    set_row(row, p->r[0][0] - 1.0, p->r[1][0], p->r[2][0]);
    set_row(row + 3, p->r[0][1], p->r[1][1] - 1.0, p->r[2][1]);
    set_row(row + 6, p->r[0][2], p->r[1][2], p->r[2][2] - 1.0);
    set_row(row + 9, shift.x, shift.y, shift.z);
}

void face_pose_weights(face *f, double *weight, const rigid *pose)
{
    f->is_given = false;
    face_shapes_weigh(f, weight, pose);
    for (uint32_t b = 0; b < f->bone_count; ++b)
        if (f->bones.moves[b])
            face_weigh_bone(f, weight, b, pose);
}

/* ---- the shape without its pose ---- */

bool face_is_posed(const face *f)
{
    const rigid still = rigid_identity();
    for (uint32_t b = 0; b < f->bone_count; ++b)
        if (f->bones.moves[b] && memcmp(&f->pose[b], &still, sizeof still) != 0)
            return true;
    return false;
}

/* Carries the controls' displacement in a block back through the bones' motion. */
static void unpose_block(const face *f, float sum[3][POINTS_BLOCK], uint32_t block)
{
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        vec3 moved = {(double)sum[0][i], (double)sum[1][i], (double)sum[2][i]};
        double share[RIG_BONES_MAX];
        if (moved.x == 0.0 && moved.y == 0.0 && moved.z == 0.0)
            continue;
        for (uint32_t b = 0; b < f->bone_count; ++b)
            share[b] = (double)f->field[b].weight[(size_t)block * POINTS_BLOCK + i];
        blend here = blend_of(share, f->pose, f->bones.moves, f->bone_count);
        moved = blend_undo_direction(&here, moved);
        sum[0][i] = (float)moved.x;
        sum[1][i] = (float)moved.y;
        sum[2][i] = (float)moved.z;
    }
}

static void copy_block(points *out, const points *from, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK, size = POINTS_BLOCK * sizeof(float);
    memcpy(out->x + first, from->x + first, size);
    memcpy(out->y + first, from->y + first, size);
    memcpy(out->z + first, from->z + first, size);
    out->block[block] = from->block[block];
}

void face_bake(face *f, points *out)
{
    columns *c = &f->columns;
    bool posed = face_is_posed(f);
    memcpy(f->next_weight, f->given, (size_t)3 * f->control_column_count * sizeof *f->given);
    face_shapes_unlead(f, f->next_weight);
    columns_weigh(c, f->next_weight, f->control_column_count);
    for (uint32_t block = 0; block < c->block_count; ++block) {
        float sum[3][POINTS_BLOCK] = {{0.0f}};
        if (!face_reaches(c, c->weights.live, block)) {
            if (out != f->origin)
                copy_block(out, f->origin, block);
            continue;
        }
        columns_sum(c, sum, 0, block);
        if (posed)
            unpose_block(f, sum, block);
        columns_add(out, f->origin, sum, block);
        face_mark_stale(f, block, out);
    }
}

/* ---- frames ---- */

void face_set_pose(face *f, const float *dof, const rigid *pose)
{
    memcpy(f->dof, dof, sizeof f->dof);
    memcpy(f->pose, pose, sizeof f->pose);
    face_note_dofs(f, dof);
}

void face_note_dofs(face *f, const float *dof)
{
    float posed[MRT_MAX_DOFS] = {0};
    bones_limit(f->meter.driven, &f->bones, dof);
    face_add_swing(f, posed, dof);
    bones_limit(f->meter.dof, &f->bones, posed);
}

static void release_controls(face *f)
{
    f->control_count = 0;
    f->control_column_count = f->shape_column_count;
    f->meter.dropped_count = 0;
    f->meter.slope_bound = 0.0;
    f->origin = &f->base;
    face_shapes_settle(f, f->dof);
    face_pose_columns(f);
    face_pose_weights(f, f->weight, f->pose);
}

void face_commit(face *f)
{
    face_limit_pull(f);
    face_bake(f, &f->base);
    release_controls(f);
}

void face_reset(face *f)
{
    const float still[MRT_MAX_DOFS] = {0};
    rigid pose[RIG_BONES_MAX];
    for (uint32_t b = 0; b < RIG_BONES_MAX; ++b)
        pose[b] = rigid_identity();
    face_springs_rest(f);
    face_set_pose(f, still, pose);
    face_set_least_weights(f, NULL);
    points_copy(&f->base, &f->rest);
    f->origin = &f->base;
    face_mark_all_stale(f);
    release_controls(f);
    face_show_rest(f);
}

/* ---- readings ---- */

bool face_is_near(const face *f, const double *point, uint32_t count, double radius)
{
    return shape_is_near(f->control_count > 0 ? &f->base : &f->shown, point, count, radius);
}

static const char *bone_name(const face *f, uint32_t bone)
{
    return f->rig ? f->rig->bone[bone].name : "face";
}

static void name_control(const face *f, uint32_t bone, uint32_t control, char *out)
{
    const face_grip *grip = &f->grip[control];
    uint32_t holders = 0;
    for (uint32_t b = 0; b < f->bone_count; ++b)
        holders += grip->belongs[b];
    const char *on = holders > 1 ? bone_name(f, bone) : "", *at = holders > 1 ? "@" : "";
    if (grip->contact > 0)
        snprintf(out, FACE_COLUMN_NAME, "%.80s%s%.64s", f->contact[grip->contact - 1].name, at, on);
    else
        snprintf(out, FACE_COLUMN_NAME, "control%u%s%.64s", control + 1, at, on);
}

void face_column_name(const face *f, uint32_t column, char out[FACE_COLUMN_NAME])
{
    static const char *const motions[FACE_POSE_COLUMNS] = {"turn_x", "turn_y", "turn_z", "shift"};
    out[0] = '\0';
    if (column < f->shape_column_count) {
        uint32_t carrier;
        const char *name = face_shapes_column_name(f, column, &carrier);
        snprintf(out, FACE_COLUMN_NAME, "%.80s.%c%s%.64s", name, "xyz"[column % 3],
                 carrier != RIG_NONE ? "@" : "", carrier != RIG_NONE ? bone_name(f, carrier) : "");
    }
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        if (column < f->control_column_count && column >= field->first_column &&
            column - field->first_column < field->control_count)
            name_control(f, b, field->control[column - field->first_column], out);
        if (column >= f->control_column_count && f->bones.moves[b] &&
            column - field->pose_column < FACE_POSE_COLUMNS)
            snprintf(out, FACE_COLUMN_NAME, "%.80s.%s", bone_name(f, b),
                     motions[column - field->pose_column]);
    }
}

face_column face_column_at(const face *f, uint32_t column)
{
    for (uint32_t b = 0; b < f->bone_count && column < f->control_column_count; ++b) {
        const face_field *field = &f->field[b];
        if (column < field->first_column || column - field->first_column >= field->control_count)
            continue;
        uint32_t control = field->control[column - field->first_column];
        return (face_column){control, f->grip[control].share[b]};
    }
    return (face_column){FACE_NO_CONTROL, 0.0};
}

csrbf_settings face_settings(const face *f)
{
    return f->settings;
}

face_control face_control_at(const face *f, uint32_t control)
{
    return (face_control){f->grip[control].start, f->grip[control].contact};
}

vec3 face_contact_now(const face *f, uint32_t contact)
{
    return points_position(&f->shown, f->contact_slot[contact - 1]);
}

face_columns face_columns_now(const face *f)
{
    return (face_columns){.base = f->origin,
                          .column = f->columns.value,
                          .stride = f->columns.stride,
                          .weight = f->given,
                          .count = f->columns.count,
                          .engagement = f->engagement,
                          .is_exact = f->is_exact};
}

uint32_t face_control_count(const face *f)
{
    return f->control_count;
}

const face_meter *face_metered(const face *f)
{
    return &f->meter;
}

double face_penetration_mm(const face *f)
{
    return projection_depth_mm(&f->projection, &f->shown, f->pose);
}
