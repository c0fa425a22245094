#include "stage/mapping/isolate_wire.h"
#include "base/bytes.h"
#include "base/clock.h"

#include <linux/futex.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

_Static_assert(sizeof(_Atomic uint32_t) == sizeof(uint32_t), "a futex is a plain 32-bit word");

enum { FACE_THINGS_MAX = 4096 };

void isolate_sleep_until_ns(const _Atomic uint32_t *word, uint32_t seen, int64_t time_ns)
{
    struct timespec until = {.tv_sec = (time_t)(time_ns / NS_PER_S),
                             .tv_nsec = (long)(time_ns % NS_PER_S)};
    syscall(SYS_futex, word, FUTEX_WAIT_BITSET, seen, &until, NULL, FUTEX_BITSET_MATCH_ANY);
}

void isolate_wake(const _Atomic uint32_t *word)
{
    syscall(SYS_futex, word, FUTEX_WAKE, INT32_MAX, NULL, NULL, 0);
}

uint32_t isolate_param_sum(const mrt_plugin_type *type)
{
    uint32_t sum = 2166136261u;
    for (uint32_t i = 0; i < type->param_count; ++i)
        sum = (sum ^ type->params[i].id) * 16777619u;
    return sum;
}

bool isolate_is_table_of(const isolate_block *block, const mrt_plugin_type *type)
{
    return block->param_count == type->param_count && block->param_sum == isolate_param_sum(type);
}

/* ---- the inputs of a frame ---- */

static void copy_text(char *out, size_t capacity, const char *text)
{
    size_t length = strlen(text);
    if (length >= capacity)
        length = capacity - 1;
    memcpy(out, text, length);
    out[length] = '\0';
}

void isolate_inputs_write(isolate_block *block, const mrt_frame *frame)
{
    for (uint32_t i = 0; i < frame->input_count && i < MRT_MAX_INPUTS; ++i) {
        const mrt_channels *from = &frame->inputs[i];
        isolate_input *to = &block->input[i];
        to->as = *from;
        copy_text(to->name, sizeof to->name, from->name);
        for (uint32_t c = 0; c < from->count && c < MRT_MAX_CHANNELS; ++c) {
            to->channel[c] = from->channel[c];
            copy_text(to->channel_name[c], ISOLATE_NAME, from->channel[c].name);
            copy_text(to->unit[c], ISOLATE_NAME, from->channel[c].unit);
            to->value[c] = from->value[c];
        }
    }
}

void isolate_inputs_read(isolate_block *block, mrt_channels out[MRT_MAX_INPUTS])
{
    for (uint32_t i = 0; i < block->frame.input_count && i < MRT_MAX_INPUTS; ++i) {
        isolate_input *from = &block->input[i];
        for (uint32_t c = 0; c < from->as.count && c < MRT_MAX_CHANNELS; ++c) {
            from->channel[c].name = from->channel_name[c];
            from->channel[c].unit = from->unit[c];
        }
        out[i] = from->as;
        out[i].name = from->name;
        out[i].channel = from->channel;
        out[i].value = from->value;
    }
    block->frame.inputs = out;
}

/* ---- a face as bytes ---- */

static void write_name(bytes_out *out, const char *text)
{
    char name[ISOLATE_NAME] = "";
    size_t length = strlen(text);
    memcpy(name, text, length < sizeof name ? length : sizeof name - 1);
    bytes_write(out, name, sizeof name);
}

size_t isolate_face_write(void *bytes, size_t capacity, const mrt_face *face)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write_u32(&out, face->contact_count);
    bytes_write_u32(&out, face->dof_count);
    bytes_write(&out, &face->low, sizeof face->low);
    bytes_write(&out, &face->high, sizeof face->high);
    for (uint32_t i = 0; i < face->contact_count; ++i) {
        const mrt_contact *c = &face->contacts[i];
        write_name(&out, c->name);
        write_name(&out, c->bone);
        bytes_write(&out, &c->rest, sizeof c->rest);
        bytes_write(&out, &c->normal, sizeof c->normal);
    }
    for (uint32_t i = 0; i < face->dof_count; ++i) {
        const mrt_dof *d = &face->dofs[i];
        write_name(&out, d->name);
        write_name(&out, d->unit);
        bytes_write(&out, &d->min, sizeof d->min);
        bytes_write(&out, &d->max, sizeof d->max);
    }
    return out.size;
}

static const char *read_name(bytes_in *in, char out[ISOLATE_NAME])
{
    bytes_read(in, out, ISOLATE_NAME);
    out[ISOLATE_NAME - 1] = '\0';
    return out;
}

static mrt_result make_room(isolate_face *out, uint32_t contact_count, uint32_t dof_count)
{
    if (contact_count > FACE_THINGS_MAX || dof_count > MRT_MAX_DOFS)
        return MRT_ERR_FORMAT;
    out->contact = calloc((size_t)contact_count + 1, sizeof *out->contact);
    out->dof = calloc((size_t)dof_count + 1, sizeof *out->dof);
    out->name = calloc(2 * ((size_t)contact_count + dof_count) + 1, sizeof *out->name);
    if (!out->contact || !out->dof || !out->name)
        return MRT_ERR_MEMORY;
    out->face.contacts = out->contact;
    out->face.dofs = out->dof;
    out->face.contact_count = contact_count;
    out->face.dof_count = dof_count;
    return MRT_OK;
}

/* Accepts a zeroed struct. */
static void isolate_face_finish(isolate_face *f)
{
    free(f->contact);
    free(f->dof);
    free(f->name);
    *f = (isolate_face){0};
}

static mrt_result isolate_face_take(isolate_face *out, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    *out = (isolate_face){0};
    uint32_t contact_count = bytes_read_u32(&in), dof_count = bytes_read_u32(&in);
    bytes_read(&in, &out->face.low, sizeof out->face.low);
    bytes_read(&in, &out->face.high, sizeof out->face.high);
    mrt_result result = make_room(out, contact_count, dof_count);
    char(*name)[ISOLATE_NAME] = out->name;
    for (uint32_t i = 0; i < contact_count && result >= 0; ++i) {
        mrt_contact *c = &out->contact[i];
        c->name = read_name(&in, *name++);
        c->bone = read_name(&in, *name++);
        bytes_read(&in, &c->rest, sizeof c->rest);
        bytes_read(&in, &c->normal, sizeof c->normal);
    }
    for (uint32_t i = 0; i < dof_count && result >= 0; ++i) {
        mrt_dof *d = &out->dof[i];
        d->name = read_name(&in, *name++);
        d->unit = read_name(&in, *name++);
        bytes_read(&in, &d->min, sizeof d->min);
        bytes_read(&in, &d->max, sizeof d->max);
    }
    if (result >= 0 && (in.failed || in.at != in.end))
        result = MRT_ERR_FORMAT;
    if (result < 0)
        isolate_face_finish(out);
    return result;
}

/* ---- a face with the poses of its rig, as bytes: poses first, then the face ---- */

static size_t pose_bytes(uint32_t contact_count, uint32_t dof_count)
{
    return sizeof(uint32_t) + ISOLATE_NAME + (size_t)contact_count * sizeof(mrt_vec3) +
           (size_t)dof_count * sizeof(float);
}

size_t isolate_mapped_write(void *bytes, size_t capacity, const mrt_face *face,
                            const mrt_rig_pose *poses, uint32_t pose_count)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write_u32(&out, pose_count);
    bytes_write_u32(&out, face->contact_count);
    bytes_write_u32(&out, face->dof_count);
    for (uint32_t i = 0; i < pose_count; ++i) {
        bytes_write_u32(&out, poses[i].part);
        write_name(&out, poses[i].name);
        bytes_write(&out, poses[i].pulls, (size_t)face->contact_count * sizeof *poses[i].pulls);
        bytes_write(&out, poses[i].dofs, (size_t)face->dof_count * sizeof *poses[i].dofs);
    }
    void *rest = bytes && out.size < capacity ? (unsigned char *)bytes + out.size : NULL;
    return out.size + isolate_face_write(rest, rest ? capacity - out.size : 0, face);
}

/* Allocates memory for the poses. Refuses counts that need more than `left` bytes. */
static mrt_result make_poses(isolate_mapped *out, uint32_t contact_count, uint32_t dof_count,
                             size_t left)
{
    if (contact_count > FACE_THINGS_MAX || dof_count > MRT_MAX_DOFS ||
        out->pose_count > left / pose_bytes(contact_count, dof_count))
        return MRT_ERR_FORMAT;
    const size_t count = out->pose_count;
    out->pose = calloc(count + 1, sizeof *out->pose);
    out->pull = calloc(count * contact_count + 1, sizeof *out->pull);
    out->dof = calloc(count * dof_count + 1, sizeof *out->dof);
    out->name = calloc(count + 1, sizeof *out->name);
    return out->pose && out->pull && out->dof && out->name ? MRT_OK : MRT_ERR_MEMORY;
}

mrt_result isolate_mapped_read(isolate_mapped *out, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    *out = (isolate_mapped){.pose_count = bytes_read_u32(&in)};
    const uint32_t contact_count = bytes_read_u32(&in), dof_count = bytes_read_u32(&in);
    mrt_result result = in.failed
                            ? MRT_ERR_FORMAT
                            : make_poses(out, contact_count, dof_count, (size_t)(in.end - in.at));
    for (uint32_t i = 0; i < out->pose_count && result >= 0; ++i) {
        mrt_vec3 *pulls = out->pull + (size_t)i * contact_count;
        float *dofs = out->dof + (size_t)i * dof_count;
        const uint32_t part = bytes_read_u32(&in);
        out->pose[i] = (mrt_rig_pose){read_name(&in, out->name[i]), pulls, dofs, part};
        bytes_read(&in, pulls, contact_count * sizeof *pulls);
        bytes_read(&in, dofs, dof_count * sizeof *dofs);
        if (part > MRT_POSE_UPPER)
            result = MRT_ERR_FORMAT;
    }
    if (result >= 0)
        result = isolate_face_take(&out->face, in.at, (size_t)(in.end - in.at));
    if (result >= 0 &&
        (out->face.face.contact_count != contact_count || out->face.face.dof_count != dof_count))
        result = MRT_ERR_FORMAT;
    if (result < 0)
        isolate_mapped_finish(out);
    return result;
}

void isolate_mapped_finish(isolate_mapped *m)
{
    isolate_face_finish(&m->face);
    free(m->pose);
    free(m->pull);
    free(m->dof);
    free(m->name);
    *m = (isolate_mapped){0};
}

/* ---- names and samples of a face output ---- */

static uint32_t name_count(const mrt_face_names *n)
{
    return n->bone_count + n->shape_count + n->weight_count;
}

size_t isolate_names_write(void *bytes, size_t capacity, const mrt_face_names *names)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write_u32(&out, names->bone_count);
    bytes_write_u32(&out, names->shape_count);
    bytes_write_u32(&out, names->weight_count);
    bytes_write_u32(&out, names->vertex_count);
    for (uint32_t i = 0; i < names->bone_count; ++i) {
        write_name(&out, names->bones[i]);
        bytes_write(&out, &names->parents[i], sizeof names->parents[i]);
        bytes_write(&out, &names->pivots[i], sizeof names->pivots[i]);
    }
    for (uint32_t i = 0; i < names->shape_count; ++i)
        write_name(&out, names->shapes[i]);
    for (uint32_t i = 0; i < names->weight_count; ++i)
        write_name(&out, names->weights[i]);
    void *rest = bytes && out.size < capacity ? (unsigned char *)bytes + out.size : NULL;
    return out.size + isolate_face_write(rest, rest ? capacity - out.size : 0, names->face);
}

static mrt_result make_names(isolate_names *out)
{
    const mrt_face_names *n = &out->names;
    if (n->bone_count > FACE_THINGS_MAX || n->shape_count > FACE_THINGS_MAX ||
        n->weight_count > FACE_THINGS_MAX)
        return MRT_ERR_FORMAT;
    out->text = calloc((size_t)name_count(n) + 1, sizeof *out->text);
    out->name = calloc((size_t)name_count(n) + 1, sizeof *out->name);
    out->parent = calloc((size_t)n->bone_count + 1, sizeof *out->parent);
    out->pivot = calloc((size_t)n->bone_count + 1, sizeof *out->pivot);
    return out->text && out->name && out->parent && out->pivot ? MRT_OK : MRT_ERR_MEMORY;
}

mrt_result isolate_names_read(isolate_names *out, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    *out = (isolate_names){0};
    mrt_face_names *n = &out->names;
    n->bone_count = bytes_read_u32(&in);
    n->shape_count = bytes_read_u32(&in);
    n->weight_count = bytes_read_u32(&in);
    n->vertex_count = bytes_read_u32(&in);
    mrt_result result = make_names(out);
    for (uint32_t i = 0; result >= 0 && i < name_count(n); ++i) {
        out->text[i] = read_name(&in, out->name[i]);
        if (i >= n->bone_count)
            continue;
        bytes_read(&in, &out->parent[i], sizeof out->parent[i]);
        bytes_read(&in, &out->pivot[i], sizeof out->pivot[i]);
        if (out->parent[i] < -1 || out->parent[i] >= (int32_t)n->bone_count)
            result = MRT_ERR_FORMAT;
    }
    if (result >= 0 && in.failed)
        result = MRT_ERR_FORMAT;
    if (result >= 0)
        result = isolate_face_take(&out->face, in.at, (size_t)(in.end - in.at));
    n->face = &out->face.face;
    n->parents = out->parent;
    n->pivots = out->pivot;
    n->bones = out->text;
    n->shapes = out->text ? out->text + n->bone_count : NULL;
    n->weights = out->text ? n->shapes + n->shape_count : NULL;
    if (result < 0)
        isolate_names_finish(out);
    return result;
}

void isolate_names_finish(isolate_names *n)
{
    isolate_face_finish(&n->face);
    free(n->text);
    free(n->name);
    free(n->parent);
    free(n->pivot);
    *n = (isolate_names){0};
}

enum { POSE_FLOATS = sizeof(mrt_bone_pose) / sizeof(float) };

size_t isolate_sample_floats(const mrt_face_names *names, bool has_vertices)
{
    return POSE_FLOATS * (size_t)names->bone_count + names->face->dof_count +
           3 * (size_t)names->face->contact_count + names->shape_count + names->weight_count +
           (has_vertices ? 3 * (size_t)names->vertex_count : 0);
}

void isolate_sample_at(mrt_face_sample *sample, const mrt_face_names *names, const float *value,
                       bool has_vertices)
{
    sample->bones = (const mrt_bone_pose *)(const void *)value;
    value += POSE_FLOATS * (size_t)names->bone_count;
    sample->dofs = value;
    value += names->face->dof_count;
    sample->contacts = (const mrt_vec3 *)(const void *)value;
    value += 3 * (size_t)names->face->contact_count;
    sample->shapes = value;
    value += names->shape_count;
    sample->weights = value;
    value += names->weight_count;
    sample->vertices = has_vertices ? (const mrt_vec3 *)(const void *)value : NULL;
}

size_t isolate_sample_write(void *bytes, size_t capacity, const mrt_face_names *names,
                            const mrt_face_sample *sample)
{
    bytes_out out = {.data = bytes, .capacity = capacity};
    size_t floats = isolate_sample_floats(names, sample->vertices != NULL);
    bytes_write(&out, &sample->time_ns, sizeof sample->time_ns);
    bytes_write(&out, &sample->take_ns, sizeof sample->take_ns);
    bytes_write(&out, &sample->number, sizeof sample->number);
    bytes_write(&out, sample->bones, floats * sizeof(float));
    return out.size;
}

mrt_result isolate_sample_read(mrt_face_sample *out, float *value, const mrt_face_names *names,
                               const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    bytes_read(&in, &out->time_ns, sizeof out->time_ns);
    bytes_read(&in, &out->take_ns, sizeof out->take_ns);
    bytes_read(&in, &out->number, sizeof out->number);
    size_t left = (size_t)(in.end - in.at);
    bool has_vertices = left != isolate_sample_floats(names, false) * sizeof *value;
    if (in.failed || left != isolate_sample_floats(names, has_vertices) * sizeof *value)
        return MRT_ERR_FORMAT;
    bytes_read(&in, value, left);
    isolate_sample_at(out, names, value, has_vertices);
    return MRT_OK;
}
