#include "stage/output/board.h"

#include <stdlib.h>
#include <string.h>

/* ---- [main] ---- */

typedef struct described { /* memory for the names while they are copied */
    const char *bone[RIG_BONES_MAX];
    int32_t parent[RIG_BONES_MAX];
    mrt_vec3 pivot[RIG_BONES_MAX];
    const char **shape;
} described;

static mrt_vec3 narrow(vec3 v)
{
    return (mrt_vec3){(float)v.x, (float)v.y, (float)v.z};
}

static void describe_bones(described *out, const rig *r, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const rig_bone *bone = &r->bone[i];
        vec3 hinge = vec3_scale(vec3_add(bone->hinge_left, bone->hinge_right), 0.5);
        out->bone[i] = bone->name;
        out->parent[i] = bone->parent == RIG_NONE ? -1 : (int32_t)bone->parent;
        out->pivot[i] = narrow(bone->kind == BONE_JAW ? hinge : bone->centre);
    }
}

/* Makes an own copy of the names by writing and reading them as bytes. */
static mrt_result copy_names(isolate_names *out, const mrt_face_names *names)
{
    size_t size = isolate_names_write(NULL, 0, names);
    unsigned char *bytes = malloc(size);
    if (!bytes)
        return MRT_ERR_MEMORY;
    (void)isolate_names_write(bytes, size, names);
    mrt_result result = isolate_names_read(out, bytes, size);
    free(bytes);
    return result;
}

enum { WEIGHTS = ARKIT_CHANNELS + FACE_EXPRESSIONS + FACE_VISEMES };

static void name_weights(const char *out[WEIGHTS])
{
    for (uint32_t i = 0; i < ARKIT_CHANNELS; ++i)
        *out++ = arkit_name[i];
    for (uint32_t i = 0; i < FACE_EXPRESSIONS; ++i)
        *out++ = face_expression_name[i];
    for (uint32_t i = 0; i < FACE_VISEMES; ++i)
        *out++ = face_viseme_name[i];
}

static mrt_result describe_names(face_board *self, composer *of)
{
    const char *weight[WEIGHTS];
    described about = {.shape = NULL};
    const face *f = composer_face(of);
    const bones *b = face_bones(f);
    uint32_t shape_count = face_shape_count(f);
    about.shape = calloc((size_t)shape_count + 1, sizeof *about.shape);
    if (!about.shape)
        return MRT_ERR_MEMORY;
    for (uint32_t i = 0; i < shape_count; ++i)
        about.shape[i] = face_shape_name(f, i);
    uint32_t bone_count = b->rig ? b->bone_count : 0;
    describe_bones(&about, b->rig, bone_count);
    name_weights(weight);
    bool has_weights = self->file->rig || shape_count > 0;
    const mrt_face_names names = {.face = composer_about(of),
                                  .bones = about.bone,
                                  .parents = about.parent,
                                  .pivots = about.pivot,
                                  .shapes = about.shape,
                                  .weights = weight,
                                  .weight_count = has_weights ? WEIGHTS : 0,
                                  .bone_count = bone_count,
                                  .shape_count = shape_count,
                                  .vertex_count = face_order(f)->count};
    mrt_result result = copy_names(&self->of, &names);
    free(about.shape);
    return result;
}

mrt_result face_board_create(face_board **out, composer *of, const face_file *file, error *err)
{
    *out = NULL;
    face_board *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for outputs");
    atomic_init(&self->references, 1);
    self->file = file;
    slot_init(&self->slot);
    mrt_result result = describe_names(self, of);
    for (int i = 0; i < 3 && result >= 0; ++i) {
        self->face[i].value =
            calloc(isolate_sample_floats(&self->of.names, true) + 1, sizeof(float));
        if (!self->face[i].value)
            result = MRT_ERR_MEMORY;
    }
    if (result >= 0) {
        *out = self;
        return MRT_OK;
    }
    face_board_release(self);
    return error_set(err, result,
                     "cannot send the face: it has too many names, or memory "
                     "is out");
}

face_board *face_board_retain(face_board *self)
{
    atomic_fetch_add(&self->references, 1);
    return self;
}

void face_board_release(face_board *self)
{
    if (!self || atomic_fetch_sub(&self->references, 1) > 1)
        return;
    for (int i = 0; i < 3; ++i)
        free(self->face[i].value);
    isolate_names_finish(&self->of);
    face_weights_destroy(self->weights);
    free(self);
}

/* ---- [frame] ---- */

static float *write_bones(float *out, const face *f, uint32_t count)
{
    rigid pose[RIG_BONES_MAX];
    float dof[MRT_MAX_DOFS] = {
        0}; /* unlimited values: bones_pose applies the limits, which must not be applied twice */
    if (count > 0) {
        bones_unlimit(dof, face_bones(f), face_metered(f)->dof);
        bones_pose(pose, face_bones(f), dof);
    }
    for (uint32_t i = 0; i < count; ++i, out += 7) {
        double quaternion[4];
        rigid_to_quaternion(&pose[i], quaternion);
        for (int k = 0; k < 4; ++k)
            out[k] = (float)quaternion[k];
        out[4] = (float)pose[i].t.x;
        out[5] = (float)pose[i].t.y;
        out[6] = (float)pose[i].t.z;
    }
    return out;
}

static float *write_contacts(float *out, const face *f, const mrt_face *about)
{
    for (uint32_t i = 0; i < about->contact_count; ++i, out += 3) {
        const vec3 now = face_contact_now(f, i + 1);
        out[0] = (float)(now.x - (double)about->contacts[i].rest.x);
        out[1] = (float)(now.y - (double)about->contacts[i].rest.y);
        out[2] = (float)(now.z - (double)about->contacts[i].rest.z);
    }
    return out;
}

static void write_vertices(float *restrict out, const face *f, uint32_t count)
{
    const points *p = face_shown(f);
    const uint32_t *restrict file_of_slot = face_order(f)->file_of_slot;
    for (uint32_t slot = 0; slot < count; ++slot) {
        float *row = out + (size_t)file_of_slot[slot] * 3;
        row[0] = p->x[slot];
        row[1] = p->y[slot];
        row[2] = p->z[slot];
    }
}

/* Copies only the vertices that the weights need. */
static void write_points(float *out, const face *f, const face_weights *weights)
{
    const points *p = face_shown(f);
    const uint32_t *slot_of_file = face_order(f)->slot_of_file;
    uint32_t count;
    const uint32_t *vertex = face_weights_points(weights, &count);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t slot = slot_of_file[vertex[i]];
        float *row = out + (size_t)vertex[i] * 3;
        row[0] = p->x[slot];
        row[1] = p->y[slot];
        row[2] = p->z[slot];
    }
}

/* Returns whether the face and the names have the same number of contacts, bones, shapes and
 * vertices. */
static bool is_like(const face_board *self, const composer *of, const face *f)
{
    const mrt_face_names *n = &self->of.names;
    const bones *b = face_bones(f);
    return composer_about(of)->contact_count == n->face->contact_count &&
           composer_about(of)->dof_count == n->face->dof_count &&
           (b->rig ? b->bone_count : 0) == n->bone_count && face_shape_count(f) == n->shape_count &&
           face_order(f)->count == n->vertex_count;
}

void face_board_fill(face_board *self, composer *of, int64_t time_ns, int64_t take_ns,
                     bool with_vertices)
{
    const mrt_face_names *n = &self->of.names;
    const face *f = composer_face(of);
    board_face *into = &self->face[slot_back(&self->slot)];
    if (!is_like(self, of, f))
        return;
    float *out = write_bones(into->value, f, n->bone_count);
    memcpy(out, face_metered(f)->dof, n->face->dof_count * sizeof *out);
    out = write_contacts(out + n->face->dof_count, f, n->face);
    for (uint32_t i = 0; i < n->shape_count; ++i)
        *out++ = (float)face_shape_weight(f, i);
    out += n->weight_count;
    bool has_weights = n->weight_count > 0, is_final = atomic_load(&self->has_final_weights);
    if (with_vertices || (has_weights && !is_final))
        write_vertices(out, f, n->vertex_count);
    else if (has_weights && self->weights)
        write_points(out, f, self->weights);
    into->has_vertices = with_vertices;
    into->time_ns = time_ns;
    into->take_ns = take_ns;
    into->number = ++self->number;
    slot_publish(&self->slot);
}

/* ---- [taker] ---- */

void face_board_prepare(face_board *self)
{
    error ignored = {""}; /* without weights the values are 0 */
    if (atomic_load(&self->has_final_weights))
        return;
    if (self->of.names.weight_count > 0 &&
        face_file_weights(&self->weights, self->file, &ignored) < 0)
        self->weights = NULL;
    atomic_store(&self->has_final_weights, true);
}

static float *write_channels(float *out, const double *channels, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        *out++ = (float)channels[i];
    return out;
}

/* Writes the weights of a face into its values. */
static void write_weights(face_board *self, const board_face *from)
{
    const mrt_face_names *n = &self->of.names;
    mrt_face_sample sample;
    isolate_sample_at(&sample, n, from->value, true);
    float *out = from->value + (sample.weights - from->value);
    if (!self->weights) {
        memset(out, 0, n->weight_count * sizeof *out);
        return;
    }
    const face_channels *channels =
        face_weights_solve(self->weights, &sample.vertices->x, sample.dofs);
    self->residual_mm = channels->residual_mm;
    out = write_channels(out, channels->arkit, ARKIT_CHANNELS);
    out = write_channels(out, channels->expression, FACE_EXPRESSIONS);
    (void)write_channels(out, channels->viseme, FACE_VISEMES);
}

const board_face *face_board_read(face_board *self)
{
    if (!slot_receive(&self->slot))
        return NULL;
    const board_face *from = &self->face[slot_front(&self->slot)];
    face_board_prepare(self);
    if (self->of.names.weight_count > 0)
        write_weights(self, from);
    return from;
}
