#include "recording.h"

#include <math.h>
#include <stdlib.h>

mrt_result recording_create(recording *out, const mesh *m, double fps, recording_use use,
                            error *err)
{
    *out = (recording){.mesh = m, .min_determinant = 1.0, .min_step_determinant = 1.0};
    if (use == RECORDING_MEASURES)
        return MRT_OK;
    out->clip = clip_create(m, fps, NULL, err);
    if (!out->clip)
        return MRT_ERR_IO;
    out->rows = malloc((size_t)m->vertex_count * 3 * sizeof *out->rows);
    if (out->rows)
        return MRT_OK;
    recording_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for the recording");
}

void recording_destroy(recording *self)
{
    if (!self)
        return;
    clip_destroy(self->clip);
    free(self->rows);
    free(self->column);
    free(self->scale);
    free(self->vector);
    free(self->name);
    free(self->names);
    free(self->work_ms);
    *self = (recording){0};
}

static mrt_result keep_work(recording *self, int64_t work_ns, error *err)
{
    if (self->frame_count == self->frame_capacity) {
        uint32_t capacity = self->frame_capacity ? 2 * self->frame_capacity : 1024;
        float *work_ms = realloc(self->work_ms, capacity * sizeof *work_ms);
        if (!work_ms)
            return error_set(err, MRT_ERR_MEMORY, "no memory for the recording");
        self->work_ms = work_ms;
        self->frame_capacity = capacity;
    }
    self->work_ms[self->frame_count++] = (float)((double)work_ns * 1e-6);
    return MRT_OK;
}

static mrt_result make_room(recording *self, uint32_t count, error *err)
{
    if (count <= self->column_capacity)
        return MRT_OK;
    free(self->column);
    free(self->scale);
    free(self->vector);
    free(self->name);
    free(self->names);
    self->column_capacity = 0;
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

/* The columns of bones are lengths in mm; other programs like morph targets near 1. Divides the
 * column by the least power of two that is not less than its greatest value, if that is above 1:
 * with the vector multiplied by it, the bits of the product are the same. */
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

/* The columns of the face as a segment, in the file's order. */
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
        self->scale[k] = normalise_column(column, order->count);
        face_column_name(f, k, self->name[k]);
        self->names[k] = self->name[k];
    }
    return clip_begin_segment(self->clip, self->rows, self->column, self->names, now->count, err);
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

/* The mesh as it is shown, whatever moved it. */
static void meter_surface(recording *self, const face *f)
{
    face_surface now = face_judge(f);
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

static mrt_result add_anchored(recording *self, const face *f, const face_columns *now, error *err)
{
    mrt_result result = MRT_OK;
    if (!self->has_segment || now->engagement != self->engagement)
        result = begin_segment(self, f, now, err);
    if (result < 0)
        return result;
    self->has_segment = true;
    self->engagement = now->engagement;
    for (size_t i = 0; i < (size_t)now->count * 3; ++i)
        self->vector[i] = now->weight[i] * self->scale[i / 3];
    return clip_add_anchored(self->clip, self->vector, err);
}

static mrt_result add_free(recording *self, const face *f, error *err)
{
    points_to_rows(self->rows, face_shown(f), face_order(f));
    return clip_add_free(self->clip, self->rows, err);
}

/* The control vectors of the frame, for the text export. */
static mrt_result add_controls(recording *self, const mrt_pull *pull, error *err)
{
    double ends[MRT_MAX_VECTORS * 6];
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        const float row[6] = {v->start.x, v->start.y, v->start.z, v->end.x, v->end.y, v->end.z};
        for (int k = 0; k < 6; ++k)
            ends[6 * i + (uint32_t)k] = (double)row[k];
    }
    return clip_add_controls(self->clip, ends, pull->count, err);
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

static mrt_result keep_frame(recording *self, composer *from, const face_columns *now, error *err)
{
    const face *f = composer_face(from);
    bool is_exact = composer_is_anchored(from) && now->is_exact;
    mrt_result result = is_exact ? add_anchored(self, f, now, err) : add_free(self, f, err);
    return result < 0 ? result : add_controls(self, composer_pull(from), err);
}

/* The composer counts since its face was there: what is told last is the whole. */
static void meter_steps(recording *self, const composer_counts *counts)
{
    self->folded_steps = counts->folded_steps;
    self->min_step_determinant = counts->min_determinant;
}

mrt_result recording_add(recording *self, composer *from, int64_t work_ns, error *err)
{
    const face *f = composer_face(from);
    bool is_anchored = composer_is_anchored(from);
    mrt_result result = keep_work(self, work_ns, err);
    if (result < 0)
        return result;
    measure_motion(self, f);
    meter_surface(self, f);
    meter_steps(self, composer_counted(from));
    face_columns now = face_columns_now(f);
    if (is_anchored)
        meter_folds(self, f);
    if (is_anchored && !now.is_exact)
        self->inexact_frames += 1;
    return self->clip ? keep_frame(self, from, &now, err) : MRT_OK;
}

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

double recording_median_ms(recording *self)
{
    if (self->frame_count == 0)
        return 0.0;
    qsort(self->work_ms, self->frame_count, sizeof *self->work_ms, by_size);
    return (double)self->work_ms[self->frame_count / 2];
}

double recording_worst_ms(recording *self)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < self->frame_count; ++i)
        worst = fmax(worst, (double)self->work_ms[i]);
    return worst;
}

void recording_tell_surface(const recording *self, facts *told)
{
    const surface_state *worst = &self->worst;
    facts_number(told, "range_of_motion_mm", "range of motion", self->furthest_mm, 2, "mm");
    facts_number(told, "folds", "folds", self->folded_frames + (double)self->folded_steps, 0,
                 "frames or steps");
    facts_number(told, "min_determinant", "least determinant",
                 fmin(self->min_determinant, self->min_step_determinant), 3, "");
    facts_number(told, "stretch", "greatest stretch", worst->stretch, 2,
                 "of an edge: its length over that at rest");
    facts_number(told, "bend_deg", "greatest bend", worst->bend_deg, 1,
                 "degrees of an edge, beyond what it has at rest");
    facts_number(told, "bent_edges", "bent edges", worst->bent_count, 0,
                 "beyond 120 degrees, but not at rest, in the worst frame");
    facts_number(told, "inside_out", "inside out", worst->inside_out_count, 0,
                 "triangles in the worst frame");
    facts_number(told, "held_back_mm", "held back", self->held_back_mm, 2,
                 "mm at most, where the skin would fold or tear");
    if (self->held_frames)
        facts_number(told, "held_frames", "held back in", self->held_frames, 0, "frames");
}
