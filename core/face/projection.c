#include "face/projection.h"

#include <math.h>
#include <stdlib.h>

enum { FLOOR_PASSES = 6 };
static const double floor_part = 0.4;
static const double counted_mm = 1e-4;

/* From the face to the scaled space of a proxy on its bone, and back. */
typedef struct proxy_frame {
    rigid into; /* the bone's own frame */
    rigid out;
    vec3 centre, radii;
    float row[3][4]; /* the whole way in, for float */
} proxy_frame;

static proxy_frame frame_of(const rig_proxy *proxy, const rigid *pose)
{
    proxy_frame f = {.into = rigid_inverse(&pose[proxy->bone]),
                     .out = pose[proxy->bone],
                     .centre = proxy->centre,
                     .radii = proxy->radii};
    const double centre[3] = {f.centre.x, f.centre.y, f.centre.z};
    const double radii[3] = {f.radii.x, f.radii.y, f.radii.z};
    const double t[3] = {f.into.t.x, f.into.t.y, f.into.t.z};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            f.row[i][j] = (float)(f.into.r[i][j] / radii[i]);
        f.row[i][3] = (float)((t[i] - centre[i]) / radii[i]);
    }
    return f;
}

static vec3 scaled(const proxy_frame *f, vec3 x)
{
    vec3 local = vec3_sub(rigid_apply(&f->into, x), f->centre);
    return (vec3){local.x / f->radii.x, local.y / f->radii.y, local.z / f->radii.z};
}

static vec3 unscaled(const proxy_frame *f, vec3 q)
{
    vec3 local = {q.x * f->radii.x, q.y * f->radii.y, q.z * f->radii.z};
    return rigid_apply(&f->out, vec3_add(local, f->centre));
}

static vec3 vertex_at(const points *p, size_t slot)
{
    double x[3];
    points_at(x, p, slot);
    return (vec3){x[0], x[1], x[2]};
}

/* ---- the easing ---- */

typedef double (*height_rule)(double height, double rest);

/* For what one ellipsoid pushed into another. */
static double floored(double height, double rest)
{
    return fmax(height, floor_part * rest);
}

static double eased(double height, double rest)
{
    double lowest = floor_part * rest, half = (1.0 - floor_part) * rest;
    double above = height - lowest + half;
    if (height >= lowest + half)
        return height;
    return above <= 0.0 ? lowest : lowest + above * above / (4.0 * half);
}

static bool is_suspect(const proxy_frame *f, const projection_block *b, const points *shown)
{
    const float *x = shown->x + (size_t)b->block * POINTS_BLOCK;
    const float *y = shown->y + (size_t)b->block * POINTS_BLOCK;
    const float *z = shown->z + (size_t)b->block * POINTS_BLOCK;
    const float a0 = f->row[0][0], a1 = f->row[0][1], a2 = f->row[0][2], a3 = f->row[0][3];
    const float b0 = f->row[1][0], b1 = f->row[1][1], b2 = f->row[1][2], b3 = f->row[1][3];
    const float c0 = f->row[2][0], c1 = f->row[2][1], c2 = f->row[2][2], c3 = f->row[2][3];
    int below = 0;
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float qx = a0 * x[i] + a1 * y[i] + a2 * z[i] + a3;
        float qy = b0 * x[i] + b1 * y[i] + b2 * z[i] + b3;
        float qz = c0 * x[i] + c1 * y[i] + c2 * z[i] + c3;
        below |= qx * qx + qy * qy + qz * qz < b->inside[i];
    }
    return below != 0;
}

/* A vertex of a proxy's block: where it is in the scaled space. False: it is not lower than at
 * rest, or in the very centre. */
static bool is_low(const proxy_frame *f, const projection_block *b, const points *shown, size_t i,
                   vec3 *out_q, double *out_size)
{
    if (!(b->height[i] > 0.0f))
        return false;
    *out_q = scaled(f, vertex_at(shown, (size_t)b->block * POINTS_BLOCK + i));
    *out_size = vec3_length(*out_q);
    return *out_size > 1e-6 && *out_size - 1.0 < (double)b->height[i];
}

/* Length of what lies between two heights along q, mm. */
static double between_mm(const proxy_frame *f, vec3 q, double size, double from, double to)
{
    vec3 step = vec3_scale(q, (to - from) / size);
    return vec3_length((vec3){step.x * f->radii.x, step.y * f->radii.y, step.z * f->radii.z});
}

static double depth_mm(const proxy_frame *f, vec3 q, double size, double rest)
{
    double lowest = floor_part * rest;
    return size - 1.0 < lowest ? between_mm(f, q, size, size - 1.0, lowest) : 0.0;
}

static void project_block(const proxy_frame *f, const projection_block *b, points *shown,
                          height_rule rule, projection_report *report)
{
    bool moved = false;
    size_t first = (size_t)b->block * POINTS_BLOCK;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        vec3 q;
        double size, rest = (double)b->height[i];
        if (!is_low(f, b, shown, i, &q, &size))
            continue;
        double height = rule(size - 1.0, rest);
        report->depth_mm = fmax(report->depth_mm, depth_mm(f, q, size, rest));
        if (!(between_mm(f, q, size, size - 1.0, height) > counted_mm))
            continue;
        vec3 x = unscaled(f, vec3_scale(q, (1.0 + height) / size));
        shown->x[first + i] = (float)x.x;
        shown->y[first + i] = (float)x.y;
        shown->z[first + i] = (float)x.z;
        report->moved_count += first + i < shown->count;
        moved = true;
    }
    if (moved)
        points_update_block(shown, b->block);
}

static projection_report pass(const projection *p, points *shown, const rigid *pose,
                              height_rule rule)
{
    projection_report report = {0};
    proxy_frame f;
    for (uint32_t i = 0; i < p->block_count; ++i) {
        const projection_block *b = &p->block[i];
        if (i == 0 || b->proxy != p->block[i - 1].proxy)
            f = frame_of(&p->proxy[b->proxy], pose);
        if (is_suspect(&f, b, shown))
            project_block(&f, b, shown, rule, &report);
    }
    return report;
}

projection_report projection_apply(const projection *p, points *shown, const rigid *pose)
{
    projection_report report = pass(p, shown, pose, eased);
    bool again = p->proxy_count > 1 && report.moved_count > 0;
    for (int i = 0; again && i < FLOOR_PASSES; ++i)
        again = pass(p, shown, pose, floored).moved_count > 0;
    return report;
}

double projection_depth_mm(const projection *p, const points *shown, const rigid *pose)
{
    double deepest = 0.0;
    for (uint32_t i = 0; i < p->block_count; ++i) {
        const projection_block *b = &p->block[i];
        proxy_frame f = frame_of(&p->proxy[b->proxy], pose);
        for (size_t v = 0; v < POINTS_BLOCK; ++v) {
            vec3 q;
            double size;
            if (is_low(&f, b, shown, v, &q, &size))
                deepest = fmax(deepest, depth_mm(&f, q, size, (double)b->height[v]));
        }
    }
    return deepest;
}

/* ---- made from a rig ---- */

static bool fill_block(projection_block *out, const proxy_frame *f, const points *rest,
                       const float *mobility)
{
    bool any = false;
    double thinnest = fmin(f->radii.x, fmin(f->radii.y, f->radii.z));
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        size_t slot = (size_t)out->block * POINTS_BLOCK + i;
        double height = vec3_length(scaled(f, vertex_at(rest, slot))) - 1.0;
        bool in_reach =
            mobility[slot] > 0.0f && height > 1e-6 && height * thinnest <= PROJECTION_REACH_MM;
        out->height[i] = in_reach ? (float)height : 0.0f;
        /* Less by what float may get wrong: the easing is flat there. */
        out->inside[i] = in_reach ? (float)((1.0 + height) * (1.0 + height) * (1.0 - 4e-6)) : -1.0f;
        any = any || in_reach;
    }
    return any;
}

static mrt_result check_proxy(const rig *r, uint32_t proxy, error *err)
{
    const rig_proxy *p = &r->proxy[proxy];
    vec3 c = p->centre;
    bool sound = p->bone < r->bone_count && isfinite(c.x + c.y + c.z) && p->radii.x > 1e-3 &&
                 p->radii.y > 1e-3 && p->radii.z > 1e-3 &&
                 isfinite(p->radii.x + p->radii.y + p->radii.z);
    if (sound)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT,
                     "skull_proxy %u: expected an ellipsoid on a bone with radii of at least "
                     "0.001 mm",
                     proxy);
}

mrt_result projection_create(projection *out, const rig *r, const points *rest,
                             const float *mobility, error *err)
{
    *out = (projection){0};
    if (!r || r->proxy_count == 0)
        return MRT_OK;
    if (r->proxy_count > PROJECTION_PROXIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%u skull proxies: at most %d are possible",
                         r->proxy_count, PROJECTION_PROXIES_MAX);
    rigid still[RIG_BONES_MAX];
    for (int b = 0; b < RIG_BONES_MAX; ++b)
        still[b] = rigid_identity();
    out->proxy = r->proxy;
    out->proxy_count = r->proxy_count;
    size_t room = (size_t)r->proxy_count * rest->block_count;
    out->block = malloc((room + 1) * sizeof *out->block);
    if (!out->block)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u skull proxies", r->proxy_count);
    for (uint32_t proxy = 0; proxy < r->proxy_count; ++proxy) {
        mrt_result result = check_proxy(r, proxy, err);
        if (result < 0) {
            projection_destroy(out);
            return result;
        }
        proxy_frame f = frame_of(&r->proxy[proxy], still);
        for (uint32_t block = 0; block < rest->block_count; ++block) {
            projection_block *b = &out->block[out->block_count];
            *b = (projection_block){.proxy = proxy, .block = block};
            out->block_count += fill_block(b, &f, rest, mobility);
        }
    }
    return MRT_OK;
}

void projection_destroy(projection *p)
{
    if (!p)
        return;
    free(p->block);
    *p = (projection){0};
}
