#include "face/frame/projection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FLOOR_PASSES = 6 };
static const double floor_part = 0.4, floor_most_mm = 2.0, band_most_mm = 3.0;
static const double size_most = 1e3; /* bound of q, since floats take it to its 8th power */
static const double teeth_band_most_mm = 4.0, teeth_apart_mm = 0.5, teeth_kept = 0.3;
static const float pushed_least_mm = 0.02f; /* smaller motions fold nothing */
static const float part_least =
    1e-6f; /* 1e-4 mm at 100 mm from the centre: smaller motions are dropped */

static proxy_frame frame_of(const rig_proxy *proxy, const rigid *pose)
{
    const rigid *on = &pose[proxy->bone];
    const rigid into = rigid_inverse(on);
    const double centre[3] = {proxy->centre.x, proxy->centre.y, proxy->centre.z};
    const double radii[3] = {proxy->radii.x, proxy->radii.y, proxy->radii.z};
    const double t[3] = {into.t.x, into.t.y, into.t.z};
    proxy_frame f = {.centre = rigid_apply(on, proxy->centre), .kind = proxy->kind};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            f.row[i][j] = into.r[i][j] / radii[i];
        f.row[i][3] = (t[i] - centre[i]) / radii[i];
        for (int j = 0; j < 4; ++j)
            f.narrow_row[i][j] = (float)f.row[i][j];
    }
    f.core = rig_teeth_core(proxy);
    f.narrow_height_mm = (float)proxy->radii.y;
    for (int i = 0; i < 3; ++i)
        f.narrow_up[i] = (float)on->r[i][1];
    f.narrow_centre[0] = (float)f.centre.x;
    f.narrow_centre[1] = (float)f.centre.y;
    f.narrow_centre[2] = (float)f.centre.z;
    return f;
}

static double square(double x)
{
    return x * x;
}

static double to_8(double x)
{
    return square(square(square(x)));
}

static double root_8(double x)
{
    return sqrt(sqrt(sqrt(x)));
}

static vec3 scaled(const proxy_frame *f, vec3 x)
{
    double q[3];
    for (int i = 0; i < 3; ++i)
        q[i] = f->row[i][0] * x.x + f->row[i][1] * x.y + f->row[i][2] * x.z + f->row[i][3];
    return (vec3){q[0], q[1], q[2]};
}

/* Returns the size of q. out_way: vector to x from the point that x is pushed away from, mm; level:
 * 1 / w for teeth. */
static double scaled_size(const proxy_frame *f, vec3 x, double level, vec3 *out_way)
{
    vec3 q = scaled(f, x), way = vec3_sub(x, f->centre);
    *out_way = way;
    if (f->kind != PROXY_TEETH)
        return sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
    double out = sqrt(q.x * q.x + q.z * q.z), beyond = fmax(out - f->core, 0.0);
    vec3 up = {(double)f->narrow_up[0], (double)f->narrow_up[1], (double)f->narrow_up[2]};
    up = vec3_scale(up, vec3_dot(up, way));
    double part = out > 0.0 ? beyond / out : 0.0;
    *out_way = vec3_add(up, vec3_scale(vec3_sub(way, up), part));
    return root_8(to_8(beyond * level) + to_8(q.y));
}

/* ---- the frame, in float ---- */

typedef struct block_sizes {
    float squared[POINTS_BLOCK]; /* |q|^2 */
    /* For teeth: the part of the level vector that is beyond the core; the vertical component,
     * mm. */
    float beyond[POINTS_BLOCK], up_mm[POINTS_BLOCK];
} block_sizes;

/* Returns false if no vertex of the block is lower than at rest. */
static bool measure_block(block_sizes *out, const proxy_frame *f, const projection_block *b,
                          const points *shown)
{
    const float *x = shown->x + (size_t)b->block * POINTS_BLOCK;
    const float *y = shown->y + (size_t)b->block * POINTS_BLOCK;
    const float *z = shown->z + (size_t)b->block * POINTS_BLOCK;
    const float a0 = f->narrow_row[0][0], a1 = f->narrow_row[0][1], a2 = f->narrow_row[0][2];
    const float b0 = f->narrow_row[1][0], b1 = f->narrow_row[1][1], b2 = f->narrow_row[1][2];
    const float c0 = f->narrow_row[2][0], c1 = f->narrow_row[2][1], c2 = f->narrow_row[2][2];
    const float a3 = f->narrow_row[0][3], b3 = f->narrow_row[1][3], c3 = f->narrow_row[2][3];
    int below = 0;
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float qx = a0 * x[i] + a1 * y[i] + a2 * z[i] + a3;
        float qy = b0 * x[i] + b1 * y[i] + b2 * z[i] + b3;
        float qz = c0 * x[i] + c1 * y[i] + c2 * z[i] + c3;
        float squared = qx * qx + qy * qy + qz * qz;
        out->squared[i] = squared;
        below |= squared < b->inside[i];
    }
    return below != 0;
}

/* The same for teeth. */
static bool measure_teeth(block_sizes *out, const proxy_frame *f, const projection_block *b,
                          const points *shown)
{
    const float *x = shown->x + (size_t)b->block * POINTS_BLOCK;
    const float *y = shown->y + (size_t)b->block * POINTS_BLOCK;
    const float *z = shown->z + (size_t)b->block * POINTS_BLOCK;
    const float a0 = f->narrow_row[0][0], a1 = f->narrow_row[0][1], a2 = f->narrow_row[0][2];
    const float b0 = f->narrow_row[1][0], b1 = f->narrow_row[1][1], b2 = f->narrow_row[1][2];
    const float c0 = f->narrow_row[2][0], c1 = f->narrow_row[2][1], c2 = f->narrow_row[2][2];
    const float a3 = f->narrow_row[0][3], b3 = f->narrow_row[1][3], c3 = f->narrow_row[2][3];
    const float core = (float)f->core, height_mm = f->narrow_height_mm;
    int below = 0;
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float qx = a0 * x[i] + a1 * y[i] + a2 * z[i] + a3;
        float qy = b0 * x[i] + b1 * y[i] + b2 * z[i] + b3;
        float qz = c0 * x[i] + c1 * y[i] + c2 * z[i] + c3;
        float level_out = sqrtf(qx * qx + qz * qz + 1e-12f), past = level_out - core;
        past = past > 0.0f ? past : 0.0f;
        float flat = past * b->level[i], up = qy * qy;
        flat = flat * flat;
        flat = flat * flat;
        up = up * up;
        float squared = sqrtf(sqrtf(flat * flat + up * up));
        out->beyond[i] = past / level_out;
        out->up_mm[i] = qy * height_mm;
        out->squared[i] = squared;
        below |= squared < b->inside[i];
    }
    return below != 0;
}

typedef enum easing {
    EASED = 0,
    FLOORED
} easing; /* FLOORED: only moves vertices out of other ellipsoids */

/* Eases a block. part: how far each vertex moves away from the centre, as a share of its distance.
 * sunk: the same up to its floor only, negative above it. Computes every lane, even if unused, so
 * that the loop runs on whole vectors. */
static void ease_block(float *restrict part, float *restrict sunk, const block_sizes *sizes,
                       const projection_block *b, easing rule)
{
    const float least = part_least, curved = rule == EASED ? 1.0f : 0.0f;
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float lowest = b->floor[i], half = b->band[i] + 1e-12f;
        float squared = sizes->squared[i] + 1e-12f;
        float size = sqrtf(squared), height = size - 1.0f;
        float above = height - lowest + half;
        above = above > 0.0f ? above * curved : 0.0f;
        float target = lowest + above * above / (4.0f * half);
        float away = (target - height) / size, under = (lowest - height) / size;
        away = away > least ? away : 0.0f;
        part[i] = squared < b->inside[i] ? away : 0.0f;
        sunk[i] = squared < b->inside[i] ? under : -1.0f;
    }
}

static void move_away(float *restrict x, const float *restrict part, float centre)
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float moved = x[i] + part[i] * (x[i] - centre);
        x[i] = part[i] > 0.0f ? moved : x[i];
    }
}

/* The same, away from the nearest point of the core of a row of teeth. */
static void move_from_core(float *restrict x, const float *restrict part,
                           const block_sizes *restrict sizes, float centre, float up)
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float level = sizes->beyond[i], way = level * (x[i] - centre);
        way += (1.0f - level) * (sizes->up_mm[i] * up);
        float moved = x[i] + part[i] * way;
        x[i] = part[i] > 0.0f ? moved : x[i];
    }
}

/* Returns the vertices of a block, as bits, that are moved far enough to fold skin. */
static uint64_t pushed_in(const proxy_frame *f, const float *restrict part, const points *shown,
                          size_t first)
{
    uint8_t is_pushed[POINTS_BLOCK];
    uint64_t bits = 0;
    const float *restrict x = shown->x + first, *restrict y = shown->y + first;
    const float *restrict z = shown->z + first, *centre = f->narrow_centre;
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float dx = x[i] - centre[0], dy = y[i] - centre[1], dz = z[i] - centre[2];
        float square = part[i] * part[i] * (dx * dx + dy * dy + dz * dz);
        is_pushed[i] = square > pushed_least_mm * pushed_least_mm;
    }
    for (int i = 0; i < POINTS_BLOCK; ++i)
        bits |= (uint64_t)is_pushed[i] << i;
    return bits;
}

static double deepest_mm(const proxy_frame *f, const float *sunk, const points *p, size_t first)
{
    double deepest = 0.0;
    int any = 0;
    for (int i = 0; i < POINTS_BLOCK; ++i)
        any |= sunk[i] > 0.0f;
    for (size_t i = 0; any && i < POINTS_BLOCK; ++i)
        if (sunk[i] > 0.0f) {
            vec3 way;
            (void)scaled_size(f, points_position(p, first + i), 1.0, &way);
            deepest = fmax(deepest, (double)sunk[i] * vec3_length(way));
        }
    return deepest;
}

/* left: number of vertices from the block's first one on; further slots are copies of the last. */
static uint32_t count_moved(const float *part, uint32_t left)
{
    uint32_t moved = 0;
    for (uint32_t i = 0; i < POINTS_BLOCK; ++i)
        moved += part[i] > 0.0f && i < left;
    return moved;
}

/* Returns how far |at| exceeds reach, or 0. */
static float past(float at, float reach)
{
    float left = fabsf(at) - reach;
    return left > 0.0f ? left : 0.0f;
}

/* Returns true if the bounds of the block show that no vertex of it is within its band. */
static bool is_clear(const proxy_frame *f, const projection_block *b, const points *shown)
{
    const points_bounds *box = &shown->block[b->block];
    float q[3];
    for (int i = 0; i < 3; ++i) {
        float at = f->narrow_row[i][3], reach = 0.0f;
        for (int k = 0; k < 3; ++k) {
            at += f->narrow_row[i][k] * 0.5f * (box->low[k] + box->high[k]);
            reach += fabsf(f->narrow_row[i][k]) * 0.5f * (box->high[k] - box->low[k]);
        }
        q[i] = past(at, reach);
    }
    float level = q[0] * q[0] + q[2] * q[2], size = level + q[1] * q[1];
    if (f->kind == PROXY_TEETH) {
        float flat = past(sqrtf(level), (float)f->core) * b->least_level;
        size = flat > q[1] ? flat * flat : q[1] * q[1];
    }
    return size > b->most_inside;
}

/* Projects a block. moved_count is 0 if nothing moved. pushed: bits of the block, or NULL. */
static projection_done project_block(const proxy_frame *f, const projection_block *b, points *shown,
                                     easing rule, uint64_t *pushed)
{
    block_sizes sizes;
    float part[POINTS_BLOCK], sunk[POINTS_BLOCK];
    size_t first = (size_t)b->block * POINTS_BLOCK;
    projection_done done = {0};
    if (is_clear(f, b, shown))
        return done;
    bool is_lower = f->kind == PROXY_TEETH ? measure_teeth(&sizes, f, b, shown)
                                           : measure_block(&sizes, f, b, shown);
    if (!is_lower)
        return done;
    ease_block(part, sunk, &sizes, b, rule);
    done.depth_mm = deepest_mm(f, sunk, shown, first);
    done.moved_count = count_moved(part, shown->count - (uint32_t)first);
    if (done.moved_count == 0)
        return done;
    if (pushed)
        *pushed |= pushed_in(f, part, shown, first);
    float *const axis[3] = {shown->x + first, shown->y + first, shown->z + first};
    for (int i = 0; i < 3; ++i)
        if (f->kind == PROXY_TEETH)
            move_from_core(axis[i], part, &sizes, f->narrow_centre[i], f->narrow_up[i]);
        else
            move_away(axis[i], part, f->narrow_centre[i]);
    points_update_block(shown, b->block);
    return done;
}

/* Applies the proxies of the block in turn. Returns 1 + index of the last proxy that moved it, or
 * 0. */
static uint32_t ease_in_turn(const projection *p, const proxy_frame *frame, points *shown,
                             uint32_t first, uint32_t end, projection_done *done, uint64_t *pushed)
{
    uint32_t moved_by = 0;
    for (uint32_t i = first; i < end; ++i) {
        const projection_block *b = &p->block[i];
        const projection_done one = project_block(&frame[b->proxy], b, shown, EASED, pushed);
        if (one.moved_count > 0)
            moved_by = 1 + b->proxy;
        if (done)
            done[i] = one;
    }
    return moved_by;
}

/* Moves vertices that another proxy has pushed below a floor back onto it. Returns 1 + index of the
 * last proxy that did so, or moved_by if there was none. */
static uint32_t floor_in_turn(const projection *p, const proxy_frame *frame, points *shown,
                              uint32_t first, uint32_t end, uint32_t moved_by, bool *out_any,
                              uint64_t *pushed)
{
    *out_any = false;
    for (uint32_t i = first; i < end; ++i) {
        const projection_block *b = &p->block[i];
        if (moved_by == 1 + b->proxy ||
            project_block(&frame[b->proxy], b, shown, FLOORED, pushed).moved_count == 0)
            continue;
        moved_by = 1 + b->proxy;
        *out_any = true;
    }
    return moved_by;
}

/* done: of all blocks and proxies; pushed: of the block; both may be NULL. Returns true if some
 * vertex has moved. */
static bool apply(const projection *p, const proxy_frame *frame, points *shown, uint32_t block,
                  projection_done *done, uint64_t *pushed)
{
    uint32_t first = p->block_count > 0 ? p->first[block] : 0;
    uint32_t end = p->block_count > 0 ? p->first[block + 1] : 0;
    uint32_t moved_by = ease_in_turn(p, frame, shown, first, end, done, pushed);
    bool is_moved = moved_by != 0, again = is_moved && end - first > 1;
    for (int i = 0; again && i < FLOOR_PASSES; ++i)
        moved_by = floor_in_turn(p, frame, shown, first, end, moved_by, &again, pushed);
    return is_moved;
}

bool projection_apply(projection *p, points *shown, uint32_t block)
{
    if (p->block_count == 0)
        return false;
    p->pushed[block] = 0;
    return apply(p, p->frame, shown, block, p->done, &p->pushed[block]);
}

vec3 projection_at(const projection *p, uint32_t slot, vec3 at)
{
    const uint32_t block = slot / POINTS_BLOCK, lane = slot % POINTS_BLOCK;
    const uint32_t end = p->block_count > 0 ? p->first[block + 1] : 0;
    for (uint32_t i = p->block_count > 0 ? p->first[block] : 0; i < end; ++i) {
        const projection_block *b = &p->block[i];
        vec3 way;
        double size = scaled_size(&p->frame[b->proxy], at, (double)b->level[lane], &way);
        if (!(size * size < (double)b->inside[lane]))
            continue;
        double lowest = (double)b->floor[lane], half = (double)b->band[lane] + 1e-12;
        double above = fmax(size - 1.0 - lowest + half, 0.0);
        double target = lowest + above * above / (4.0 * half);
        at = vec3_add(at, vec3_scale(way, fmax(target - (size - 1.0), 0.0) / fmax(size, 1e-6)));
    }
    return at;
}

void projection_apply_still(const projection *p, points *at, uint32_t block)
{
    (void)apply(p, p->still, at, block, NULL, NULL);
}

void projection_pose(projection *p, const rigid *pose, uint8_t *is_stale)
{
    bool has_moved[PROJECTION_PROXIES_MAX];
    for (uint32_t i = 0; i < p->proxy_count; ++i) {
        const rigid *now = &pose[p->proxy[i].bone];
        has_moved[i] = memcmp(&p->posed[i], now, sizeof *now) != 0;
        if (!has_moved[i])
            continue;
        p->posed[i] = *now;
        p->frame[i] = frame_of(&p->proxy[i], pose);
    }
    for (uint32_t i = 0; i < p->block_count; ++i)
        if (has_moved[p->block[i].proxy])
            is_stale[p->block[i].block] = 1;
}

void projection_rest(projection *p)
{
    for (uint32_t i = 0; i < p->block_count; ++i)
        p->done[i] = (projection_done){0};
    if (p->block_count > 0)
        memset(p->pushed, 0, p->pushed_count * sizeof *p->pushed);
}

const uint64_t *projection_pushed(const projection *p)
{
    return p->block_count > 0 ? p->pushed : NULL;
}

projection_report projection_reported(const projection *p)
{
    projection_report report = {0};
    for (uint32_t i = 0; i < p->block_count; ++i) {
        if (p->done[i].depth_mm > report.depth_mm) /* with fmax, gcc 12 fails here for arm64 */
            report.depth_mm = p->done[i].depth_mm;
        report.moved_count += p->done[i].moved_count;
    }
    return report;
}

double projection_depth_mm(const projection *p, const points *shown, const rigid *pose)
{
    double deepest = 0.0;
    for (uint32_t i = 0; i < p->block_count; ++i) {
        const projection_block *b = &p->block[i];
        proxy_frame f = frame_of(&p->proxy[b->proxy], pose);
        for (size_t v = 0; v < POINTS_BLOCK; ++v) {
            vec3 x = points_position(shown, (size_t)b->block * POINTS_BLOCK + v);
            vec3 way;
            double size = scaled_size(&f, x, (double)b->level[v], &way);
            double lowest = 1.0 + (double)b->floor[v];
            if (b->band[v] > 0.0f && size < lowest && size > 1e-6)
                deepest = fmax(deepest, (lowest - size) / size * vec3_length(way));
        }
    }
    return deepest;
}

/* ---- creation from a rig ---- */

/* Computes floor and band of a vertex. The floor of teeth is part of the width. */
static void fill_vertex(projection_block *out, size_t lane, double height, double mm_per_height,
                        rig_proxy_kind kind)
{
    double lowest = fmin(floor_part * height, floor_most_mm / mm_per_height);
    double band = fmin((1.0 - floor_part) * height, band_most_mm / mm_per_height);
    if (kind == PROXY_TEETH) {
        lowest = 0.0;
        band = fmin(height, teeth_band_most_mm / mm_per_height);
    }
    double edge = 1.0 + lowest + band;
    out->floor[lane] = (float)lowest;
    out->band[lane] = (float)band;
    /* Reduced by the rounding of float, since the easing is flat there. */
    out->inside[lane] = (float)(edge * edge * (1.0 - 8e-6));
}

static double smoothstep(double low, double high, double x)
{
    double t = (x - low) / (high - low);
    t = t < 0.0 ? 0.0 : (t > 1.0 ? 1.0 : t);
    return t * t * (3.0 - 2.0 * t);
}

/* Returns 1 / w for a row of teeth, or size_most for a vertex that is never moved. */
static double level_of(const proxy_frame *f, vec3 rest)
{
    const vec3 q = scaled(f, rest), way = vec3_sub(rest, f->centre);
    const vec3 up = {(double)f->narrow_up[0], (double)f->narrow_up[1], (double)f->narrow_up[2]};
    const double out = sqrt(q.x * q.x + q.z * q.z), depth = 1.0 - f->core;
    const double level_mm = vec3_length(vec3_sub(way, vec3_scale(up, vec3_dot(up, way))));
    double width = depth + teeth_kept * fmax(out - 1.0, 0.0);
    double apart = 1.0 + teeth_apart_mm * out / (depth * fmax(level_mm, 1e-6));
    double left = to_8(apart) - to_8(q.y);
    if (left > 0.0) /* with this w its size at rest is `apart` */
        width = fmin(width, fmax(out - f->core, 0.0) / root_8(left));
    width *= smoothstep(-0.5, 0.0, q.z / fmax(out, 1e-6));
    width *= 1.0 - smoothstep(0.2, 0.6, (1.0 - out) / depth);
    return 1.0 / fmax(width, 1.0 / size_most);
}

/* Returns false if no vertex of the block is in reach. */
static bool fill_block(projection_block *out, const proxy_frame *f, const points *rest,
                       const float *mobility)
{
    const double reach_mm =
        f->kind == PROXY_TEETH ? PROJECTION_TEETH_REACH_MM : PROJECTION_REACH_MM;
    bool any = false;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        size_t slot = (size_t)out->block * POINTS_BLOCK + i;
        vec3 x = points_position(rest, slot);
        vec3 way, whole_way;
        double whole = scaled_size(f, x, 1.0 / (1.0 - f->core), &whole_way);
        out->level[i] = (float)(f->kind == PROXY_TEETH ? level_of(f, x) : 1.0);
        double size = scaled_size(f, x, (double)out->level[i], &way), height = size - 1.0;
        out->inside[i] = -1.0f;
        if (!(mobility[slot] > 0.0f && height > 1e-6 && height < size_most &&
              (double)out->level[i] < size_most &&
              (whole - 1.0) * vec3_length(whole_way) / whole <= reach_mm))
            continue;
        fill_vertex(out, i, height, vec3_length(way) / size, f->kind);
        out->least_level = any ? fminf(out->least_level, out->level[i]) : out->level[i];
        out->most_inside = fmaxf(out->most_inside, out->inside[i] * (1.0f + 1e-4f));
        any = true;
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
                     "skull_proxy %u: expected a bone and radii of at least 0.001 mm", proxy);
}

mrt_result projection_create(projection *out, const rig *r, const points *rest,
                             const float *mobility, error *err)
{
    *out = (projection){0};
    if (!r || r->proxy_count == 0)
        return MRT_OK;
    if (r->proxy_count > PROJECTION_PROXIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the rig has %u skull proxies, but at most %d are supported",
                         r->proxy_count, PROJECTION_PROXIES_MAX);
    rigid still[RIG_BONES_MAX];
    for (int b = 0; b < RIG_BONES_MAX; ++b)
        still[b] = rigid_identity();
    out->proxy = r->proxy;
    out->proxy_count = r->proxy_count;
    size_t room = (size_t)r->proxy_count * rest->block_count;
    out->block = malloc((room + 1) * sizeof *out->block);
    out->done = calloc(room + 1, sizeof *out->done);
    out->first = calloc((size_t)rest->block_count + 1, sizeof *out->first);
    out->pushed_count = rest->block_count;
    out->pushed = calloc((size_t)rest->block_count + 1, sizeof *out->pushed);
    if (!out->block || !out->done || !out->first || !out->pushed) {
        projection_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u skull proxies", r->proxy_count);
    }
    for (uint32_t i = 0; i < r->proxy_count; ++i) {
        mrt_result result = check_proxy(r, i, err);
        if (result < 0) {
            projection_destroy(out);
            return result;
        }
        out->posed[i] = still[0];
        out->frame[i] = out->still[i] = frame_of(&r->proxy[i], still);
    }
    for (uint32_t block = 0; block < rest->block_count; ++block) {
        out->first[block] = out->block_count;
        for (uint32_t i = 0; i < r->proxy_count; ++i) {
            projection_block *b = &out->block[out->block_count];
            *b = (projection_block){.proxy = i, .block = block};
            out->block_count += fill_block(b, &out->frame[i], rest, mobility);
        }
    }
    out->first[rest->block_count] = out->block_count;
    return MRT_OK;
}

void projection_destroy(projection *p)
{
    if (!p)
        return;
    free(p->block);
    free(p->done);
    free(p->first);
    free(p->pushed);
    *p = (projection){0};
}
