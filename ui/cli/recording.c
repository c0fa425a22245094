#include "cli/recording.h"

#include "base/percentile.h"
#include "face/face_weights.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

recording_use recording_use_of(const exports_file *file, uint32_t count)
{
    if (exports_need_names(file, count))
        return RECORDING_WEIGHTS;
    if (exports_need_shapes(file, count))
        return RECORDING_KEEPS;
    return exports_need_clip(file, count) ? RECORDING_TABLES : RECORDING_MEASURES;
}

static mrt_result prepare_names(recording *self, const face_file *of, error *err)
{
    bool is_said[ARKIT_CHANNELS];
    mrt_result result = face_file_weights(&self->weights, of, err);
    for (uint32_t i = 0; i < ARKIT_CHANNELS && result >= 0; ++i)
        is_said[i] = face_weights_source(self->weights, i) != FACE_NAME_NONE;
    if (result >= 0)
        clip_set_arkit(self->clip, is_said);
    return result;
}

mrt_result recording_create(recording *out, const face_file *of, double fps, recording_use use,
                            error *err)
{
    const mesh *m = &of->mesh;
    *out = (recording){.mesh = m, .use = use, .min_determinant = 1.0, .min_step_determinant = 1.0};
    if (use == RECORDING_MEASURES)
        return MRT_OK;
    out->clip = clip_create(m, fps, NULL, err);
    if (!out->clip)
        return MRT_ERR_IO;
    out->rows = malloc((size_t)m->vertex_count * 3 * sizeof *out->rows);
    mrt_result result =
        out->rows ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the recording");
    if (result >= 0 && use == RECORDING_WEIGHTS)
        result = prepare_names(out, of, err);
    if (result < 0)
        recording_destroy(out);
    return result;
}

static void pull_finish(clip_pull *pull)
{
    free(pull->name);
    free(pull->response);
    *pull = (clip_pull){0};
}

static void free_columns(recording *self)
{
    free(self->column);
    free(self->scale);
    free(self->vector);
    free(self->name);
    free(self->names);
    self->column_capacity = 0;
}

void recording_destroy(recording *self)
{
    if (!self)
        return;
    clip_destroy(self->clip);
    face_weights_destroy(self->weights);
    free(self->rows);
    free_columns(self);
    for (uint32_t k = 0; k < MRT_MAX_VECTORS; ++k)
        pull_finish(&self->pull[k]);
    free(self->value);
    free(self->work_ms);
    *self = (recording){0};
}

static mrt_result keep_work(recording *self, int64_t work_ns, error *err)
{
    if (self->frame_count == self->frame_capacity) {
        uint32_t capacity = self->frame_capacity ? 2 * self->frame_capacity : 1024;
        double *work_ms = realloc(self->work_ms, capacity * sizeof *work_ms);
        if (!work_ms)
            return error_set(err, MRT_ERR_MEMORY, "no memory for the recording");
        self->work_ms = work_ms;
        self->frame_capacity = capacity;
    }
    self->work_ms[self->frame_count++] = (double)work_ns * 1e-6;
    return MRT_OK;
}

static mrt_result make_room(recording *self, uint32_t count, error *err)
{
    if (count <= self->column_capacity)
        return MRT_OK;
    free_columns(self);
    self->column = malloc((size_t)count * self->mesh->vertex_count * sizeof *self->column);
    self->scale = calloc(count, sizeof *self->scale);
    self->vector = calloc((size_t)count * 3, sizeof *self->vector);
    self->name = calloc((size_t)count + 1, sizeof *self->name);
    self->names = calloc((size_t)count + 1, sizeof *self->names);
    if (!self->column || !self->scale || !self->vector || !self->name || !self->names)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the recording");
    self->column_capacity = count;
    return MRT_OK;
}

/* Columns of bones are lengths in mm, but other programs expect morph targets near 1. Divides the
 * column by the smallest power of two that is at least its greatest value, if that is above 1.
 * Multiplying the vector by the same power keeps the product equal to the bit. */
static double normalise_column(float *column, uint32_t count)
{
    float greatest = 0.0f;
    double scale = 1.0;
    for (uint32_t v = 0; v < count; ++v)
        greatest = fmaxf(greatest, fabsf(column[v]));
    while (scale < (double)greatest && scale < 1e30)
        scale *= 2.0;
    for (uint32_t v = 0; scale > 1.0 && v < count; ++v)
        column[v] *= (float)(1.0 / scale);
    return scale;
}

/* ---- curves that a person edits ---- */

/* Returns the offsets of the face in mm when only one degree of freedom moves to `to`. NULL: no
 * memory. */
static float *shape_of_dof(const recording *self, const face *f, uint32_t dof, float to)
{
    const binding *held = face_binding(f);
    const bones *b = face_bones(f);
    float only[MRT_MAX_DOFS] = {0};
    rigid pose[RIG_BONES_MAX];
    uint32_t vertex_count = self->mesh->vertex_count;
    float *out = calloc((size_t)vertex_count * 3 + 1, sizeof *out);
    only[dof] = to;
    bones_pose(pose, b, only);
    for (uint32_t bone = 0; out && bone < b->bone_count; ++bone) {
        const float *weight = held->weight + (size_t)bone * vertex_count;
        for (uint32_t v = 0; b->moves[bone] && v < vertex_count; ++v) {
            const float *at = self->mesh->position + (size_t)v * 3;
            if (weight[v] == 0.0f)
                continue;
            vec3 rest = {(double)at[0], (double)at[1], (double)at[2]};
            vec3 way = vec3_sub(rigid_apply(&pose[bone], rest), rest);
            out[(size_t)v * 3] += weight[v] * (float)way.x;
            out[(size_t)v * 3 + 1] += weight[v] * (float)way.y;
            out[(size_t)v * 3 + 2] += weight[v] * (float)way.z;
        }
    }
    return out;
}

static mrt_result add_dof_curve(recording *self, const face *f, uint32_t dof, error *err)
{
    const bones_dof *of = &face_bones(f)->dof[dof];
    char name[sizeof of->name], unit[8];
    (void)snprintf(name, sizeof name, "%s", of->name);
    (void)snprintf(unit, sizeof unit, "%s", of->unit);
    clip_curve curve = {.name = name,
                        .unit = unit,
                        .min = fmin((double)of->min, 0.0),
                        .max = fmax((double)of->max, 0.0)};
    const bool wants_min = curve.min < 0.0 && self->use != RECORDING_TABLES;
    const bool wants_max = curve.max > 0.0 && self->use != RECORDING_TABLES;
    mrt_result result = MRT_OK;
    if (wants_min)
        curve.at_min = shape_of_dof(self, f, dof, of->min);
    if (wants_max)
        curve.at_max = shape_of_dof(self, f, dof, of->max);
    if ((wants_min && !curve.at_min) || (wants_max && !curve.at_max))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the shape of %s", of->name);
    else
        result = clip_add_curve(self->clip, &curve, err);
    free(curve.at_min);
    free(curve.at_max);
    return result;
}

/* Adds three curves: how far a contact is pulled along each axis. */
static mrt_result add_contact_curves(recording *self, const mrt_contact *contact, error *err)
{
    mrt_result result = MRT_OK;
    for (int axis = 0; axis < 3 && result >= 0; ++axis) {
        char name[128], unit[] = "mm";
        (void)snprintf(name, sizeof name, "%s.%c", contact->name, "xyz"[axis]);
        result = clip_add_curve(self->clip, &(clip_curve){.name = name, .unit = unit}, err);
    }
    return result;
}

/* Returns the offsets of the mesh's target with that name. NULL: none. */
static const float *own_offset(const recording *self, const char *name)
{
    for (uint32_t i = 0; i < self->mesh->target_count; ++i)
        if (strcmp(self->mesh->target[i].name, name) == 0)
            return self->mesh->target[i].offset;
    return NULL;
}

/* Returns whether the learnt shape is still that of the file. Motion of bones, and motion that
 * would fold, is removed from a learnt shape. If much was removed, it is another shape. */
static bool is_as_in_file(const float *learnt, const float *own, size_t count)
{
    double apart = 0.0, whole = 0.0;
    for (size_t i = 0; i < count; ++i) {
        double off = (double)learnt[i] - (double)own[i];
        apart += off * off;
        whole += (double)own[i] * (double)own[i];
    }
    return apart < 0.1 * whole;
}

static mrt_result add_shape_curve(recording *self, const face *f, uint32_t index, error *err)
{
    size_t count = (size_t)self->mesh->vertex_count * 3;
    const char *called = face_shape_name(f, index);
    float *learnt = malloc(count * sizeof *learnt);
    char name[192], unit[] = "";
    uint32_t same = 1;
    if (!learnt)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the shape %s", called);
    face_shape_offset(f, index, learnt);
    for (uint32_t i = 0; i < index; ++i)
        same += strcmp(face_shape_name(f, i), called) == 0;
    const float *own = same == 1 ? own_offset(self, called) : NULL;
    bool is_own = own && is_as_in_file(learnt, own, count);
    if (is_own)
        memcpy(learnt, own, count * sizeof *learnt);
    int used =
        snprintf(name, sizeof name, "%.120s%s", called, is_own || same > 1 ? "" : " beside bones");
    if (same > 1)
        (void)snprintf(name + used, sizeof name - (size_t)used, " %u", same);
    mrt_result result =
        clip_add_curve(self->clip,
                       &(clip_curve){.name = name,
                                     .unit = unit,
                                     .max = 1.0,
                                     .at_max = self->use == RECORDING_TABLES ? NULL : learnt,
                                     .is_own = is_own},
                       err);
    free(learnt);
    return result;
}

/* Adds curves for the shapes of the mesh file. */
static mrt_result add_shape_curves(recording *self, const face *f, error *err)
{
    mrt_result result = MRT_OK;
    self->first_shape = clip_curve_count(self->clip);
    for (uint32_t i = 0; i < face_shape_count(f) && result >= 0; ++i)
        result = add_shape_curve(self, f, i, err);
    return result;
}

/* Names of the curves that describe the engagement and the field. */
static const char *const solver_curve[] = {"solver.anchor",     "solver.commit",
                                           "solver.radius",     "solver.kernel",
                                           "solver.polynomial", "solver.stretch_most"};
enum { SOLVER_CURVES = sizeof solver_curve / sizeof *solver_curve };

/* Adds the bones that turn, parents first. self->bone: their index in the rig. */
static mrt_result add_bones(recording *self, const face *f, error *err)
{
    const bones *b = face_bones(f);
    uint32_t index[RIG_BONES_MAX];
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < b->bone_count && b->rig && result >= 0; ++i) {
        const rig_bone *bone = &b->rig->bone[b->order[i]];
        uint32_t parent = bone->parent;
        while (parent != RIG_NONE && !b->moves[parent])
            parent = b->rig->bone[parent].parent;
        index[b->order[i]] = CLIP_NO_BONE;
        if (!b->moves[b->order[i]])
            continue;
        vec3 centre = bone->kind == BONE_JAW ? b->hinge.middle : bone->centre;
        char name[128];
        (void)snprintf(name, sizeof name, "%s", bone->name);
        result = clip_add_bone(self->clip,
                               &(clip_bone){name,
                                            parent == RIG_NONE ? CLIP_NO_BONE : index[parent],
                                            {centre.x, centre.y, centre.z}},
                               err);
        index[b->order[i]] = self->bone_count;
        self->bone[self->bone_count++] = b->order[i];
    }
    return result;
}

static mrt_result add_pose(recording *self, const face *f, error *err)
{
    const bones *b = face_bones(f);
    float dof[MRT_MAX_DOFS] = {0};
    rigid pose[RIG_BONES_MAX];
    double out[RIG_BONES_MAX * 7];
    if (self->bone_count == 0)
        return MRT_OK;
    bones_unlimit(dof, b, face_metered(f)->dof);
    bones_pose(pose, b, dof);
    for (uint32_t i = 0; i < self->bone_count; ++i) {
        const rigid *now = &pose[self->bone[i]];
        const double *centre = clip_bone_at(self->clip, i)->centre_mm;
        vec3 at = rigid_apply(now, (vec3){centre[0], centre[1], centre[2]});
        rigid_to_quaternion(now, out + 7 * i);
        out[7 * i + 4] = at.x;
        out[7 * i + 5] = at.y;
        out[7 * i + 6] = at.z;
    }
    return clip_add_pose(self->clip, out, err);
}

/* Adds all curves: degrees of freedom, contacts, shapes, then the solver. */
static mrt_result add_curves(recording *self, const face *f, error *err)
{
    uint32_t contact_count;
    const mrt_contact *contact = face_contacts(f, &contact_count);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < face_bones(f)->dof_count && result >= 0; ++i)
        result = add_dof_curve(self, f, i, err);
    for (uint32_t i = 0; i < contact_count && result >= 0; ++i)
        result = add_contact_curves(self, &contact[i], err);
    if (result >= 0)
        result = add_shape_curves(self, f, err);
    for (size_t i = 0; i < SOLVER_CURVES && result >= 0; ++i) {
        char name[32], unit[] = "";
        (void)snprintf(name, sizeof name, "%s", solver_curve[i]);
        result = clip_add_curve(self->clip, &(clip_curve){.name = name, .unit = unit}, err);
    }
    if (result >= 0)
        result = add_bones(self, f, err);
    self->value = calloc((size_t)clip_curve_count(self->clip) + 1, sizeof *self->value);
    if (result >= 0 && !self->value)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the curves of the performance");
    self->has_curves = true;
    return result;
}

static bool has_rig(const face *f)
{
    uint32_t contact_count;
    (void)face_contacts(f, &contact_count);
    return face_bones(f)->dof_count + contact_count > 0;
}

/* Adds a column to the response of its control. The response is the sum of the control's
 * columns. */
static void add_response(recording *self, const face_column *of, uint32_t j)
{
    const uint32_t vertex_count = self->mesh->vertex_count;
    const float *column = self->column + (size_t)j * vertex_count;
    float *response = self->pull[of->control].response;
    for (uint32_t v = 0; v < vertex_count; ++v)
        response[v] += column[v];
}

/* Sets the controls of the segment: name, place and response (add_response). The pull of a control
 * is the weight of the column of its main bone. So a control on the head is described in the frame
 * of the head. columns: as in self->column, before scaling. */
static mrt_result set_pulls(recording *self, const face *f, uint32_t column_count, error *err)
{
    const bool has_response = self->use != RECORDING_TABLES;
    uint32_t contact_count;
    const mrt_contact *contact = face_contacts(f, &contact_count);
    double share[MRT_MAX_VECTORS] = {0};
    self->pull_count = face_control_count(f);
    for (uint32_t k = 0; k < self->pull_count; ++k) {
        clip_pull *to = &self->pull[k];
        face_control control = face_control_at(f, k);
        char name[128];
        pull_finish(to);
        self->main[k] = RECORDING_NO_COLUMN;
        if (control.contact > 0)
            (void)snprintf(name, sizeof name, "%s", contact[control.contact - 1].name);
        else
            (void)snprintf(name, sizeof name, "control%u", k + 1);
        *to = (clip_pull){.name = strdup(name),
                          .place_mm = {control.start.x, control.start.y, control.start.z},
                          .response = has_response ? calloc(self->mesh->vertex_count, sizeof(float))
                                                   : NULL};
        if (!to->name || (has_response && !to->response))
            return error_set(err, MRT_ERR_MEMORY, "no memory for what %s moves", name);
    }
    for (uint32_t j = 0; j < column_count; ++j) {
        face_column of = face_column_at(f, j);
        if (of.control == FACE_NO_CONTROL)
            continue;
        if (of.share > share[of.control]) {
            share[of.control] = of.share;
            self->main[of.control] = j;
        }
        if (has_response)
            add_response(self, &of, j);
    }
    return MRT_OK;
}

static void write_solver(double *out, composer *from)
{
    const csrbf_settings settings = face_settings(composer_face(from));
    out[0] = composer_pull(from)->anchor;
    out[1] = composer_pull(from)->commit;
    out[2] = settings.radius;
    out[3] = settings.kernel;
    out[4] = settings.polynomial;
    out[5] = settings.stretch_most;
}

static void write_vec3(double *out, vec3 at)
{
    out[0] = at.x;
    out[1] = at.y;
    out[2] = at.z;
}

/* Adds the values of the curves, and the free points, of the last added frame. */
static mrt_result add_named(recording *self, composer *from, const face_columns *now, error *err)
{
    const face *f = composer_face(from);
    composer_target asked[MRT_MAX_VECTORS];
    double free_point[MRT_MAX_VECTORS * 6], pulled[MRT_MAX_VECTORS * 3] = {0};
    double *value = self->value;
    uint32_t asked_count = composer_targets(from, asked), dof_count = face_bones(f)->dof_count;
    uint32_t count = clip_curve_count(self->clip), free_count = 0;
    for (uint32_t i = 0; i < count; ++i)
        value[i] = i < dof_count ? (double)face_metered(f)->dof[i] : (double)NAN;
    for (uint32_t k = 0; k < asked_count; ++k) {
        if (asked[k].contact > 0) {
            write_vec3(value + dof_count + 3 * (asked[k].contact - 1), asked[k].way);
            continue;
        }
        write_vec3(free_point + 6 * free_count, asked[k].start);
        write_vec3(free_point + 6 * free_count++ + 3, asked[k].end);
    }
    for (uint32_t i = 0; i < face_shape_count(f); ++i)
        value[self->first_shape + i] = face_shape_weight(f, i);
    if (asked_count > 0)
        write_solver(value + count - SOLVER_CURVES, from);
    bool is_pulled = composer_is_anchored(from) && self->pull_count > 0;
    for (uint32_t k = 0; is_pulled && k < self->pull_count; ++k)
        if (self->main[k] != RECORDING_NO_COLUMN)
            memcpy(pulled + 3 * k, now->weight + 3 * self->main[k], 3 * sizeof *pulled);
    mrt_result result = clip_add_named(self->clip, value, is_pulled ? pulled : NULL, err);
    if (result >= 0)
        result = add_pose(self, f, err);
    return result < 0 ? result : clip_add_controls(self->clip, free_point, free_count, err);
}

/* Adds the weights of ARKit shapes of the last added frame. */
static mrt_result add_names(recording *self, const face *f, error *err)
{
    if (!self->weights)
        return MRT_OK;
    points_to_rows(self->rows, face_shown(f), face_order(f));
    const face_channels *channels =
        face_weights_solve(self->weights, self->rows, face_metered(f)->dof);
    self->residual_mm = fmax(self->residual_mm, channels->residual_mm);
    return clip_add_arkit(self->clip, channels->arkit, err);
}

/* ---- frames ---- */

/* Begins a segment without columns: tables need only its first frame and its controls. */
static mrt_result begin_bare_segment(recording *self, const face *f, const face_columns *now,
                                     error *err)
{
    points_to_rows(self->rows, now->base, face_order(f));
    mrt_result result = has_rig(f) ? set_pulls(self, f, now->count, err) : MRT_OK;
    if (result >= 0)
        result = clip_begin_segment(self->clip, self->rows, NULL, NULL, 0, err);
    return result < 0 ? result : clip_set_pulls(self->clip, self->pull, self->pull_count, err);
}

/* Begins a segment with the columns of the face, in the order of the file. */
static mrt_result begin_segment(recording *self, const face *f, const face_columns *now, error *err)
{
    const points_order *order = face_order(f);
    mrt_result result = make_room(self, now->count, err);
    if (result < 0)
        return result;
    points_to_rows(self->rows, now->base, order);
    for (uint32_t k = 0; k < now->count; ++k) {
        float *column = self->column + (size_t)k * order->count;
        for (uint32_t v = 0; v < order->count; ++v)
            column[order->file_of_slot[v]] = now->column[k * now->stride + v];
        face_column_name(f, k, self->name[k]);
        self->names[k] = self->name[k];
    }
    if (has_rig(f))
        result = set_pulls(self, f, now->count, err);
    for (uint32_t k = 0; k < now->count; ++k)
        self->scale[k] = normalise_column(self->column + (size_t)k * order->count, order->count);
    if (result >= 0)
        result =
            clip_begin_segment(self->clip, self->rows, self->column, self->names, now->count, err);
    return result < 0 ? result : clip_set_pulls(self->clip, self->pull, self->pull_count, err);
}

static void meter_folds(recording *self, const face *f)
{
    self->penetration_mm = fmax(self->penetration_mm, face_penetration_mm(f));
    if (face_metered(f)->slope_bound < 1.0 && face_bones(f)->dof_count == 0)
        return;
    double determinant = face_min_determinant(f);
    if (!(determinant > 0.0))
        self->folded_frames += 1;
    self->min_determinant = fmin(self->min_determinant, determinant);
}

/* Measures the shown mesh, whatever moved it. */
static void meter_surface(recording *self, const face *f)
{
    face_surface now = face_measure_surface(f);
    surface_state *worst = &self->worst;
    worst->stretch = fmax(worst->stretch, now.skin.stretch);
    worst->bend_deg = fmax(worst->bend_deg, now.skin.bend_deg);
    if (now.skin.bent_count > worst->bent_count)
        worst->bent_count = now.skin.bent_count;
    if (now.skin.inside_out_count > worst->inside_out_count)
        worst->inside_out_count = now.skin.inside_out_count;
    self->held_back_mm = fmax(self->held_back_mm, now.held_back_mm);
    self->held_frames += now.held_back_mm > 0.0;
}

static mrt_result add_anchored(recording *self, const face_columns *now, error *err)
{
    if (self->use == RECORDING_TABLES)
        return clip_add_anchored(self->clip, NULL, err);
    for (size_t i = 0; i < (size_t)now->count * 3; ++i)
        self->vector[i] = now->weight[i] * self->scale[i / 3];
    return clip_add_anchored(self->clip, self->vector, err);
}

static mrt_result add_free(recording *self, const face *f, error *err)
{
    points_to_rows(self->rows, face_shown(f), face_order(f));
    return clip_add_free(self->clip, self->rows, err);
}

static void measure_motion(recording *self, const face *f)
{
    const points *a = face_shown(f), *b = face_rest(f);
    float furthest = 0.0f;
    for (uint32_t v = 0; v < a->count; ++v) {
        float x = a->x[v] - b->x[v], y = a->y[v] - b->y[v], z = a->z[v] - b->z[v];
        furthest = fmaxf(furthest, x * x + y * y + z * z);
    }
    self->furthest_mm = fmax(self->furthest_mm, sqrt((double)furthest));
}

/* Returns the hand of that side in the topmost layer where it is visible. NULL: none. */
static const mrt_hand *hand_shown(performer *from, uint32_t side)
{
    const mrt_hand *best = NULL;
    const performer_voice *above = NULL;
    for (uint32_t i = 0; i < PERFORMER_VOICES_MAX; ++i) {
        const performer_voice *voice = &from->voice[i];
        const mrt_hand *hand = voice->layer ? &voice->layer->frame.hand[side] : NULL;
        if (!hand || !voice->is_seen || !(voice->weight > 0.0) || !hand->present)
            continue;
        if (above && (voice->lane < above->lane ||
                      (voice->lane == above->lane && voice->rank < above->rank)))
            continue;
        above = voice;
        best = hand;
    }
    return best;
}

static mrt_result add_hands(recording *self, performer *from, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT && result >= 0; ++side) {
        const mrt_hand *hand = hand_shown(from, side);
        double joint[MRT_JOINTS * 3];
        for (size_t i = 0; hand && i < MRT_JOINTS; ++i) {
            joint[i * 3] = (double)hand->joint[i].x;
            joint[i * 3 + 1] = (double)hand->joint[i].y;
            joint[i * 3 + 2] = (double)hand->joint[i].z;
        }
        if (hand)
            result = clip_add_hand(self->clip, side, joint, err);
    }
    return result;
}

static mrt_result keep_frame(recording *self, composer *from, const face_columns *now, error *err)
{
    const face *f = composer_face(from);
    bool is_anchored = composer_is_anchored(from), is_exact = is_anchored && now->is_exact;
    mrt_result result = self->has_curves ? MRT_OK : add_curves(self, f, err);
    if (result >= 0 && is_anchored && (!self->has_segment || now->engagement != self->engagement)) {
        result = self->use == RECORDING_TABLES ? begin_bare_segment(self, f, now, err)
                                               : begin_segment(self, f, now, err);
        self->has_segment = true;
        self->engagement = now->engagement;
    }
    if (result >= 0)
        result = is_exact ? add_anchored(self, now, err) : add_free(self, f, err);
    if (result >= 0)
        result = add_named(self, from, now, err);
    return result < 0 ? result : add_names(self, f, err);
}

/* The composer counts from its creation on, so its last counts are the totals. */
static void meter_steps(recording *self, const composer_counts *counts)
{
    self->folded_steps = counts->folded_steps;
    self->min_step_determinant = counts->min_determinant;
}

mrt_result recording_add_face(recording *self, composer *from, int64_t work_ns, error *err)
{
    const face *f = composer_face(from);
    bool is_anchored = composer_is_anchored(from);
    mrt_result result = keep_work(self, work_ns, err);
    if (result < 0)
        return result;
    measure_motion(self, f);
    meter_surface(self, f);
    meter_steps(self, composer_get_counts(from));
    face_columns now = face_columns_now(f);
    if (is_anchored)
        meter_folds(self, f);
    if (is_anchored && !now.is_exact)
        self->inexact_frames += 1;
    return self->clip ? keep_frame(self, from, &now, err) : MRT_OK;
}

mrt_result recording_add(recording *self, performer *performed, int64_t work_ns, error *err)
{
    mrt_result result = recording_add_face(self, performed->composer, work_ns, err);
    return result < 0 || !self->clip ? result : add_hands(self, performed, err);
}

double recording_median_ms(recording *self)
{
    return percentile(self->work_ms, self->frame_count, 0.5);
}

double recording_worst_ms(recording *self)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < self->frame_count; ++i)
        worst = fmax(worst, self->work_ms[i]);
    return worst;
}

void recording_report_surface(const recording *self, facts *told)
{
    const surface_state *worst = &self->worst;
    facts_number(told, "range_of_motion_mm", "range of motion", self->furthest_mm, 2, "mm");
    const double folds = self->folded_frames + (double)self->folded_steps;
    (folds > 0.0 ? facts_warning : facts_number)(told, "folds", "folds", folds, 0,
                                                 "frames or steps");
    facts_number(told, "min_determinant", "least determinant",
                 fmin(self->min_determinant, self->min_step_determinant), 3, "");
    facts_number(told, "stretch", "greatest stretch", worst->stretch, 2,
                 "of an edge: its length over that at rest, or in an own shape");
    facts_number(told, "bend_deg", "greatest bend", worst->bend_deg, 1,
                 "degrees of an edge, beyond what it has there");
    facts_number(told, "bent_edges", "bent edges", worst->bent_count, 0,
                 "beyond 120 degrees, but not at rest, in the worst frame");
    facts_number(told, "inside_out", "inside out", worst->inside_out_count, 0,
                 "triangles in the worst frame");
    facts_number(told, "held_back_mm", "held back", self->held_back_mm, 2,
                 "mm at most, where the skin would fold or tear");
    if (self->held_frames)
        facts_number(told, "held_frames", "held back in", self->held_frames, 0, "frames");
    if (self->weights)
        facts_number(told, "arkit_residual_mm", "beyond ARKit's shapes", self->residual_mm, 2,
                     "mm, root mean square over the face, in the worst frame");
}
