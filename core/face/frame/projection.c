#include "face/frame/projection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FLOOR_PASSES = 6 };
static const double floor_part = 0.4, floor_most_mm = 2.0, band_most_mm = 3.0;
static const float part_least = 1e-6f; /* 1e-4 mm at 100 mm from the centre: less is not moved */

static proxy_frame frame_of(const rig_proxy *proxy, const rigid *pose)
{
    const rigid *on = &pose[proxy->bone];
    const rigid into = rigid_inverse(on);
    const double centre[3] = {proxy->centre.x, proxy->centre.y, proxy->centre.z};
    const double radii[3] = {proxy->radii.x, proxy->radii.y, proxy->radii.z};
    const double t[3] = {into.t.x, into.t.y, into.t.z};
    proxy_frame f = {.centre = rigid_apply(on, proxy->centre)};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            f.row[i][j] = into.r[i][j] / radii[i];
        f.row[i][3] = (t[i] - centre[i]) / radii[i];
        for (int j = 0; j < 4; ++j)
            f.narrow_row[i][j] = (float)f.row[i][j];
    }
    f.narrow_centre[0] = (float)f.centre.x;
    f.narrow_centre[1] = (float)f.centre.y;
    f.narrow_centre[2] = (float)f.centre.z;
    return f;
}

/* |q| */
static double scaled_size(const proxy_frame *f, vec3 x)
{
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        double q = f->row[i][0] * x.x + f->row[i][1] * x.y + f->row[i][2] * x.z + f->row[i][3];
        sum += q * q;
    }
    return sqrt(sum);
}

/* ---- the frame, in float ---- */

typedef struct block_sizes {
    float squared[POINTS_BLOCK]; /* |q|^2 */
} block_sizes;

/* False: no vertex of the block is lower than at rest. */
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

typedef enum easing { EASED = 0, FLOORED } easing; /* FLOORED: out of other ellipsoids' way only */

/* part: by how much of its distance from the centre each vertex is moved away from it; sunk: the
 * same as far as its floor, negative above. Every lane is computed, whatever comes of it: so the
 * loop runs on whole vectors. */
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

static float squared_distance(const proxy_frame *f, const points *p, size_t slot)
{
    float dx = p->x[slot] - f->narrow_centre[0], dy = p->y[slot] - f->narrow_centre[1];
    float dz = p->z[slot] - f->narrow_centre[2];
    return dx * dx + dy * dy + dz * dz;
}

static void move_away(float *restrict x, const float *restrict part, float centre)
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float moved = x[i] + part[i] * (x[i] - centre);
        x[i] = part[i] > 0.0f ? moved : x[i];
    }
}

static double deepest_mm(const proxy_frame *f, const float *sunk, const points *p, size_t first)
{
    double deepest = 0.0;
    int any = 0;
    for (int i = 0; i < POINTS_BLOCK; ++i)
        any |= sunk[i] > 0.0f;
    for (size_t i = 0; any && i < POINTS_BLOCK; ++i)
        if (sunk[i] > 0.0f) {
            double way = (double)sqrtf(squared_distance(f, p, first + i));
            deepest = fmax(deepest, (double)sunk[i] * way);
        }
    return deepest;
}

/* left: vertices from the block's first on; beyond are copies of the last. */
static uint32_t count_moved(const float *part, uint32_t left)
{
    uint32_t moved = 0;
    for (uint32_t i = 0; i < POINTS_BLOCK; ++i)
        moved += part[i] > 0.0f && i < left;
    return moved;
}

/* Returns how many vertices it moved. */
static uint32_t project_block(const proxy_frame *f, const projection_block *b, points *shown,
                              easing rule, double *depth_mm)
{
    block_sizes sizes;
    float part[POINTS_BLOCK], sunk[POINTS_BLOCK];
    size_t first = (size_t)b->block * POINTS_BLOCK;
    if (!measure_block(&sizes, f, b, shown))
        return 0;
    ease_block(part, sunk, &sizes, b, rule);
    *depth_mm = fmax(*depth_mm, deepest_mm(f, sunk, shown, first));
    uint32_t moved = count_moved(part, shown->count - (uint32_t)first);
    if (moved == 0)
        return 0;
    move_away(shown->x + first, part, f->narrow_centre[0]);
    move_away(shown->y + first, part, f->narrow_centre[1]);
    move_away(shown->z + first, part, f->narrow_centre[2]);
    points_update_block(shown, b->block);
    return moved;
}

/* The proxies of the block, in turn. Returns by which one it was moved last: 1 + index; 0: none. */
static uint32_t ease_in_turn(const projection *p, const proxy_frame *frame, points *shown,
                             uint32_t first, uint32_t end, projection_done *done)
{
    uint32_t moved_by = 0;
    for (uint32_t i = first; i < end; ++i) {
        const projection_block *b = &p->block[i];
        double depth_mm = 0.0;
        uint32_t moved_count = project_block(&frame[b->proxy], b, shown, EASED, &depth_mm);
        if (moved_count > 0)
            moved_by = 1 + b->proxy;
        if (done)
            done[i] = (projection_done){moved_count, depth_mm};
    }
    return moved_by;
}

/* Puts back onto each floor what another proxy has pushed below it; returns who did so last, or
 * moved_by: there was nothing. */
static uint32_t floor_in_turn(const projection *p, const proxy_frame *frame, points *shown,
                              uint32_t first, uint32_t end, uint32_t moved_by, bool *out_any)
{
    *out_any = false;
    for (uint32_t i = first; i < end; ++i) {
        const projection_block *b = &p->block[i];
        double depth_mm = 0.0;
        if (moved_by == 1 + b->proxy ||
            project_block(&frame[b->proxy], b, shown, FLOORED, &depth_mm) == 0)
            continue;
        moved_by = 1 + b->proxy;
        *out_any = true;
    }
    return moved_by;
}

/* done: of all blocks and proxies, or NULL. True: some vertex has moved. */
static bool apply(const projection *p, const proxy_frame *frame, points *shown, uint32_t block,
                  projection_done *done)
{
    uint32_t first = p->block_count > 0 ? p->first[block] : 0;
    uint32_t end = p->block_count > 0 ? p->first[block + 1] : 0;
    uint32_t moved_by = ease_in_turn(p, frame, shown, first, end, done);
    bool is_moved = moved_by != 0, again = is_moved && end - first > 1;
    for (int i = 0; again && i < FLOOR_PASSES; ++i)
        moved_by = floor_in_turn(p, frame, shown, first, end, moved_by, &again);
    return is_moved;
}

bool projection_apply(projection *p, points *shown, uint32_t block)
{
    return apply(p, p->frame, shown, block, p->done);
}

void projection_apply_still(const projection *p, points *at)
{
    for (uint32_t block = 0; block < at->block_count; ++block)
        (void)apply(p, p->still, at, block, NULL);
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
}

projection_report projection_reported(const projection *p)
{
    projection_report report = {0};
    for (uint32_t i = 0; i < p->block_count; ++i) {
        report.depth_mm = fmax(report.depth_mm, p->done[i].depth_mm);
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
            double size = scaled_size(&f, x), lowest = 1.0 + (double)b->floor[v];
            if (b->band[v] > 0.0f && size < lowest && size > 1e-6)
                deepest =
                    fmax(deepest, (lowest - size) / size * vec3_length(vec3_sub(x, f.centre)));
        }
    }
    return deepest;
}

/* ---- made from a rig ---- */

static void fill_vertex(projection_block *out, size_t lane, double height, double mm_per_height)
{
    double lowest = fmin(floor_part * height, floor_most_mm / mm_per_height);
    double band = fmin((1.0 - floor_part) * height, band_most_mm / mm_per_height);
    double edge = 1.0 + lowest + band;
    out->floor[lane] = (float)lowest;
    out->band[lane] = (float)band;
    /* Less by what float may get wrong: the easing is flat there. */
    out->inside[lane] = (float)(edge * edge * (1.0 - 8e-6));
}

/* False: no vertex of the block is in reach. */
static bool fill_block(projection_block *out, const proxy_frame *f, const points *rest,
                       const float *mobility)
{
    bool any = false;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        size_t slot = (size_t)out->block * POINTS_BLOCK + i;
        vec3 x = points_position(rest, slot);
        double size = scaled_size(f, x), height = size - 1.0;
        double mm_per_height = vec3_length(vec3_sub(x, f->centre)) / size;
        out->inside[i] = -1.0f;
        if (!(mobility[slot] > 0.0f && height > 1e-6 &&
              height * mm_per_height <= PROJECTION_REACH_MM))
            continue;
        fill_vertex(out, i, height, mm_per_height);
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
    out->done = calloc(room + 1, sizeof *out->done);
    out->first = calloc((size_t)rest->block_count + 1, sizeof *out->first);
    if (!out->block || !out->done || !out->first) {
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
    *p = (projection){0};
}
