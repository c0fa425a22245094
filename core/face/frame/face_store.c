/* The state of a face as bytes, with everything that later frames depend on. Columns are not
 * stored; loading computes them again. */
#include "base/bytes.h"
#include "face/frame/frame.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { STORE_VERSION = 2 };
static const char store_mark[4] = {'F', 'A', 'C', 'E'};

enum { ORIGIN_BASE = 0, ORIGIN_FREE = 1 };

/* Valid range of a stored grip. It is wider than the values of face_grip.c, but keeps a pull
 * finite. */
static const double share_most = 2.0, belonging_least = 0.01;
static const double mobility_least = 0.01, mobility_most = 100.0;

/* ---- shapes: stored only if they differ from the rest shape ---- */

static bool are_equal(const points *a, const points *b)
{
    size_t size = (size_t)a->padded_count * sizeof(float);
    return memcmp(a->x, b->x, size) == 0 && memcmp(a->y, b->y, size) == 0 &&
           memcmp(a->z, b->z, size) == 0;
}

static void write_shape(bytes_out *out, const points *p, const points *rest)
{
    bool is_moved = !are_equal(p, rest);
    bytes_write_u32(out, is_moved);
    if (!is_moved)
        return;
    const float *const stream[3] = {p->x, p->y, p->z};
    for (int axis = 0; axis < 3; ++axis)
        bytes_write(out, stream[axis], (size_t)p->padded_count * sizeof(float));
}

static void read_shape(bytes_in *in, points *out, const points *rest)
{
    if (bytes_read_u32(in) == 0) {
        points_copy(out, rest);
        return;
    }
    float *const stream[3] = {out->x, out->y, out->z};
    for (int axis = 0; axis < 3; ++axis)
        bytes_read(in, stream[axis], (size_t)out->padded_count * sizeof(float));
    in->failed |= !points_are_usable(out);
    points_update_bounds(out);
}

/* ---- grips and settings ---- */

static void write_grip(bytes_out *out, const face *f, const face_grip *grip)
{
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        bytes_write_f64(out, grip->share[b]);
        bytes_write_u32(out, grip->belongs[b]);
    }
    const double values[] = {grip->mobility, grip->riding, grip->start.x, grip->start.y,
                             grip->start.z};
    bytes_write(out, values, sizeof values);
    bytes_write_u32(out, grip->contact);
    bytes_write_u32(out, grip->is_dropped);
}

static void read_grip(bytes_in *in, const face *f, face_grip *out)
{
    memset(out, 0, sizeof *out);
    uint32_t bones_held = 0;
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        out->share[b] = bytes_read_f64(in);
        out->belongs[b] = bytes_read_u32(in) != 0;
        bones_held += out->belongs[b];
        in->failed |= fabs(out->share[b]) > share_most ||
                      (out->belongs[b] && !(out->share[b] > belonging_least));
    }
    out->mobility = bytes_read_f64(in);
    out->riding = bytes_read_f64(in);
    out->start.x = bytes_read_f64(in);
    out->start.y = bytes_read_f64(in);
    out->start.z = bytes_read_f64(in);
    out->contact = bytes_read_u32(in);
    out->is_dropped = bytes_read_u32(in) != 0;
    in->failed |= bones_held > FACE_BONES_PER_CONTROL || out->contact > f->contact_count ||
                  !(out->mobility > mobility_least) || !(out->mobility < mobility_most) ||
                  !(out->riding >= 0.0 && out->riding <= 1.0) ||
                  !(vec3_length(out->start) <= (double)POINTS_REACH) ||
                  out->is_dropped != (bones_held == 0);
}

static void write_settings(bytes_out *out, const csrbf_settings *s)
{
    bytes_write_u32(out, (uint32_t)s->kernel);
    bytes_write_u32(out, (uint32_t)s->polynomial);
    bytes_write_f64(out, s->radius);
    bytes_write_f64(out, s->ridge);
    bytes_write_f64(out, s->stretch_most);
}

static void read_settings(bytes_in *in, csrbf_settings *out)
{
    out->kernel = (csrbf_kernel)bytes_read_u32(in);
    out->polynomial = (csrbf_polynomial)bytes_read_u32(in);
    out->radius = bytes_read_f64(in);
    out->ridge = bytes_read_f64(in);
    out->stretch_most = bytes_read_f64(in);
    in->failed |= !isfinite(out->stretch_most) || out->kernel > CSRBF_WENDLAND_C6 ||
                  out->polynomial > CSRBF_WINDOWED;
}

/* Flag in the count: the requested least weights follow. */
#define SHAPES_ARE_ASKED 0x80000000u

static void write_shape_weights(bytes_out *out, const face_shapes *s)
{
    bool are_asked = false;
    for (uint32_t i = 0; i < s->count; ++i)
        are_asked |= s->asked[i] > 0.0;
    if (s->count > 0)
        bytes_write_u32(out, s->count | (are_asked ? SHAPES_ARE_ASKED : 0u));
    for (uint32_t i = 0; i < s->count; ++i)
        bytes_write_f64(out, s->weight[i]);
    for (uint32_t i = 0; i < s->count && are_asked; ++i)
        bytes_write_f64(out, s->asked[i]);
}

size_t face_save(const face *f, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write(&out, store_mark, sizeof store_mark);
    bytes_write_u32(&out, STORE_VERSION);
    bytes_write_u32(&out, f->rest.count);
    bytes_write_u32(&out, f->bone_count);
    bytes_write_u32(&out, f->contact_count);
    bytes_write_u32(&out, f->bones.dof_count);
    for (uint32_t i = 0; i < f->bones.dof_count; ++i)
        bytes_write_f64(&out, (double)f->dof[i]);
    face_springs_write(&out, f);
    write_shape_weights(&out, &f->shapes);
    bytes_write_u32(&out, f->origin == &f->free ? ORIGIN_FREE : ORIGIN_BASE);
    write_shape(&out, &f->base, &f->rest);
    if (f->origin == &f->free)
        write_shape(&out, &f->free, &f->rest);
    bytes_write_u32(&out, f->control_count);
    if (f->control_count == 0)
        return out.size;
    write_settings(&out, &f->settings);
    for (uint32_t k = 0; k < f->control_count; ++k)
        write_grip(&out, f, &f->grip[k]);
    bytes_write_u32(&out, f->control_column_count);
    bytes_write(&out, f->weight, (size_t)3 * f->control_column_count * sizeof *f->weight);
    return out.size;
}

/* ---- loading ---- */

static float read_float(bytes_in *in)
{
    double value = bytes_read_f64(in);
    bool fits = fabs(value) <= (double)FLT_MAX;
    in->failed |= !fits;
    return fits ? (float)value : 0.0f;
}

static bool is_of_this_face(bytes_in *in, const face *f)
{
    char mark[sizeof store_mark];
    bytes_read(in, mark, sizeof mark);
    bool fits = memcmp(mark, store_mark, sizeof mark) == 0;
    fits &= bytes_read_u32(in) == STORE_VERSION;
    fits &= bytes_read_u32(in) == f->rest.count;
    fits &= bytes_read_u32(in) == f->bone_count;
    fits &= bytes_read_u32(in) == f->contact_count;
    fits &= bytes_read_u32(in) == f->bones.dof_count;
    return fits && !in->failed;
}

/* Engages the stored controls again. Returns false if that is not possible. */
static bool read_controls(bytes_in *in, face *f)
{
    csrbf_settings settings = {0};
    uint32_t count = bytes_read_u32(in);
    if (count == 0 && !in->failed)
        return true;
    if (in->failed || count > f->control_capacity || f->origin == &f->free)
        return false;
    read_settings(in, &settings);
    for (uint32_t k = 0; k < count; ++k)
        read_grip(in, f, &f->grip[k]);
    if (in->failed)
        return false;
    f->settings = settings;
    f->control_count = count;
    face_assign(f, f->grip, count);
    if (face_hold(f, NULL) < 0 || bytes_read_u32(in) != f->control_column_count)
        return false;
    bytes_read(in, f->weight, (size_t)3 * f->control_column_count * sizeof *f->weight);
    for (size_t i = 0; i < (size_t)3 * f->control_column_count; ++i)
        in->failed |= !(fabs(f->weight[i]) <= (double)POINTS_REACH);
    return !in->failed;
}

static void read_shares(bytes_in *in, double *out, uint32_t count)
{
    for (uint32_t i = 0; i < count && !in->failed; ++i) {
        double share = bytes_read_f64(in);
        in->failed |= !(share >= 0.0 && share <= 1.0);
        out[i] = in->failed ? 0.0 : share;
    }
}

static void read_shape_weights(bytes_in *in, face *f)
{
    face_shapes *s = &f->shapes;
    if (s->count == 0)
        return;
    uint32_t count = bytes_read_u32(in);
    in->failed |= (count & ~SHAPES_ARE_ASKED) != s->count;
    read_shares(in, s->weight, s->count);
    if (count & SHAPES_ARE_ASKED)
        read_shares(in, s->asked, s->count);
}

mrt_result face_load(face *f, const void *bytes, size_t size, error *err)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    float dof[MRT_MAX_DOFS] = {0};
    rigid pose[RIG_BONES_MAX];
    face_reset(f);
    if (!is_of_this_face(&in, f))
        return error_set(
            err, MRT_ERR_FORMAT,
            "the stored state belongs to another face, or to another version of marotte");
    for (uint32_t i = 0; i < f->bones.dof_count; ++i)
        dof[i] = read_float(&in);
    face_springs_read(&in, f);
    read_shape_weights(&in, f);
    bool is_free = bytes_read_u32(&in) == ORIGIN_FREE;
    read_shape(&in, &f->base, &f->rest);
    if (is_free)
        read_shape(&in, &f->free, &f->rest);
    if (in.failed)
        goto damaged;
    f->origin = is_free ? &f->free : &f->base;
    face_mark_all_stale(f);
    face_pose_bones(f, pose, dof);
    face_set_pose(f, dof, pose);
    if (!read_controls(&in, f) || in.at != in.end)
        goto damaged;
    face_pose_columns(f);
    face_pose_weights(f, f->weight, f->pose);
    face_show(f);
    return MRT_OK;
damaged:
    face_reset(f);
    return error_set(err, MRT_ERR_FORMAT, "the stored state of the face is damaged");
}
