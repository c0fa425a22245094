/* No performance folds: near a fold, or a tear, less of a pull is given, and no more than that.
 *
 * Anchored: of each triangle of skin, as the bones alone pose it, the gradient G of what the
 * controls add. With m the most that G squeezes it (the least eigenvalue of the symmetric part of G
 * in its plane, negated) and t how steeply G tilts it, the triangle under I + s G keeps its side
 * and its normal turns by less than atan T as long as s (m / M + t / T) <= 1 with M < 1: in its
 * plane I + s G is positive definite then. That strain grows in proportion to the pulls, so one
 * number says how much of them can be given. Where it is above 1 the pulls around give way to each
 * other (csrbf/soften.h), the more the further it is above; and what is left of it is taken from
 * all alike. Nothing here remembers a frame: the same pulls, the same face. Only triangles that can
 * be strained too much are looked at: how steep each column is at most in a group of them is known
 * since the engagement, and that bounds what its weights can do there.
 *
 * Without a rig the field is one of space: what lies behind the skin may fold where no triangle
 * tells, so the field is looked at too, and the largest part of the pulls given that leaves room.
 *
 * Unanchored: what a sample has moved is looked at on the surface itself, against the rest shape,
 * which no field knows of: its map folds nowhere, and gets finer than the mesh all the same. Tips
 * near which too much of the room before a limit is used go less far. */
#include "csrbf/soften.h"
#include "face/frame/face_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float squeeze_most = 0.85f; /* M */
static const float tilt_most = 2.7f;     /* T: the tangent of 70 degrees */
static const float room_least = 0.05f;   /* of the stretch that is allowed, where it is used up */
enum { SOFTENINGS = 5, GROUP = 16 };
/* Ridge for each 1 of strain that is too much, at first: tips near each other need little, and give
 * way where they differ alone; each time so many times more. */
static const double softening = 0.02, softening_more = 3.0;
static const double strain_most = 8.0;

enum { PARTS = 4, UNFOLDINGS = 16 }; /* tries */
/* Of the field of a face without a rig, at its vertices: how much of the room around them is left
 * at least, and how exactly that is met. */
static const double determinant_least = 0.05, determinant_rounding = 1e-4;
static const surface_limits bends = {.stretch = 2.0, .bend_deg = 117.0, .area = 0.02};
static const surface_limits clay = {.stretch = 0.0, .bend_deg = 89.0, .area = 0.02};

/* Of GROUP triangles, by axis: where its first edge points, across it in its plane, its normal; 1
 * over the first edge's length, how far the second one goes along it, 1 over the height. */
typedef struct limit_frames {
    float first[3][GROUP], second[3][GROUP], normal[3][GROUP];
    float of_a[GROUP], along[GROUP], of_height[GROUP];
    float of_turn[GROUP]; /* 1 over the tangent of how far it may turn whatever its neighbours do */
} limit_frames;

/* Of GROUP triangles. */
typedef struct limit_group {
    float of_bound; /* what is strained by no more than 1 / of_bound need not be looked at */
    float rounding; /* of the origin: what it may turn and stretch a triangle by */
    bool is_framed; /* its frames are those of the skin as posed */
    bool is_wanted;
} limit_group;

_Static_assert((int)POINTS_BLOCK == (int)SURFACE_BLOCK, "a surface has the blocks of its points");

/* ---- made and unmade ---- */

static size_t group_count(const face *f)
{
    return ((size_t)f->skin_count + GROUP - 1) / GROUP;
}

static size_t group_size(const face *f, size_t group)
{
    size_t left = f->skin_count - group * GROUP;
    return left < GROUP ? left : GROUP;
}

/* Two triangles that turn by this each bend no edge between them too far. */
static void measure_turns(face *f)
{
    const double pi = 3.14159265358979323846, least = 0.5 * SURFACE_CREASE_DEG - 1.0;
    for (size_t t = 0; t < f->skin_count; ++t) {
        double bent = surface_meter_bent_at_rest(f->surface_meter, (uint32_t)t);
        double turn = fmax(0.5 * (bends.bend_deg - bent), least) * pi / 180.0;
        f->limit.frames[t / GROUP].of_turn[t % GROUP] = (float)(1.0 / tan(turn));
    }
}

static void measure_rest(face *f)
{
    for (size_t t = 0; t < f->skin_count; ++t) {
        const uint32_t *corner = f->skin + 3 * t;
        for (size_t e = 0; e < 3; ++e) {
            double a[3], b[3];
            points_at(a, &f->rest, corner[e]);
            points_at(b, &f->rest, corner[e == 2 ? 0 : e + 1]);
            f->limit.longest[t][e] =
                (float)vec3_length((vec3){b[0] - a[0], b[1] - a[1], b[2] - a[2]});
            f->limit.has_skin[corner[e] / POINTS_BLOCK] = 1;
        }
    }
}

mrt_result face_limit_create(face *f, error *err)
{
    face_limit *l = &f->limit;
    size_t vertices = (size_t)f->rest.padded_count + 1, blocks = (size_t)f->rest.block_count + 1;
    size_t controls = (size_t)f->control_capacity + 1, groups = group_count(f) + 1;
    l->posed = calloc(vertices, sizeof *l->posed);
    l->added = calloc(vertices, sizeof *l->added);
    l->share = calloc(vertices, sizeof *l->share);
    l->has_skin = calloc(blocks, 1);
    l->is_reached = calloc(blocks, 1);
    l->is_wanted = calloc(blocks, 1);
    l->is_posed = calloc(blocks, 1);
    l->is_changed = calloc(blocks, 1);
    l->frames = calloc(groups, sizeof *l->frames);
    l->group = calloc(groups, sizeof *l->group);
    l->pull_bound = calloc(groups, sizeof *l->pull_bound);
    l->pose_bound = calloc(groups, sizeof *l->pose_bound);
    l->steepest = calloc(groups * ((size_t)f->columns.capacity + 1), sizeof *l->steepest);
    l->g = calloc(3 * controls, sizeof *l->g);
    l->longest = calloc((size_t)f->skin_count + 1, sizeof *l->longest);
    l->pose_weight = calloc((size_t)3 * f->columns.capacity + 1, sizeof *l->pose_weight);
    l->asked = calloc(3 * controls, sizeof *l->asked);
    l->centre = calloc(3 * controls, sizeof *l->centre);
    l->step = calloc(vertices, sizeof *l->step);
    l->ridge = calloc(controls, sizeof *l->ridge);
    l->strain = calloc(controls, sizeof *l->strain);
    l->tip_share = calloc(controls, sizeof *l->tip_share);
    l->likeness = calloc(controls * controls, sizeof *l->likeness);
    l->scratch = calloc(CSRBF_SOFTEN_SCRATCH(controls), sizeof *l->scratch);
    if (!l->posed || !l->added || !l->frames || !l->g || !l->share || !l->has_skin ||
        !l->is_reached || !l->is_wanted || !l->is_posed || !l->group || !l->pull_bound ||
        !l->pose_bound || !l->steepest || !l->is_changed || !l->longest || !l->pose_weight ||
        !l->asked || !l->centre || !l->step || !l->ridge || !l->strain || !l->tip_share ||
        !l->likeness || !l->scratch)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the limits of %u triangles",
                         f->skin_count);
    measure_rest(f);
    measure_turns(f);
    return MRT_OK;
}

void face_limit_destroy(face *f)
{
    face_limit *l = &f->limit;
    free(l->posed);
    free(l->added);
    free(l->share);
    free(l->frames);
    free(l->g);
    free(l->has_skin);
    free(l->is_reached);
    free(l->is_wanted);
    free(l->is_posed);
    free(l->group);
    free(l->pull_bound);
    free(l->pose_bound);
    free(l->steepest);
    free(l->is_changed);
    free(l->longest);
    free(l->pose_weight);
    free(l->asked);
    free(l->centre);
    free(l->step);
    free(l->ridge);
    free(l->strain);
    free(l->tip_share);
    free(l->likeness);
    free(l->scratch);
    *l = (face_limit){0};
}

static double stretch_of(const csrbf_settings *settings)
{
    return settings->stretch_most > 0.0 ? fmax(settings->stretch_most, 1.1) : CSRBF_STRETCH_MOST;
}

/* ---- anchored: how much the skin is strained ---- */

static const float *const *streams(const points *p, const float *out[3])
{
    out[0] = p->x;
    out[1] = p->y;
    out[2] = p->z;
    return out;
}

static void put_rows(float (*row)[4], const points *origin, float sum[3][POINTS_BLOCK],
                     uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        row[first + i][0] = (origin ? origin->x[first + i] : 0.0f) + sum[0][i];
        row[first + i][1] = (origin ? origin->y[first + i] : 0.0f) + sum[1][i];
        row[first + i][2] = (origin ? origin->z[first + i] : 0.0f) + sum[2][i];
    }
}

/* The corners of GROUP triangles as two edges from the first corner, by axis. */
typedef struct limit_edges {
    float a[3][GROUP], b[3][GROUP];
} limit_edges;

static void gather(limit_edges *out, float (*row)[4], const uint32_t *corner, size_t count)
{
    for (size_t i = 0; i < GROUP; ++i) {
        const uint32_t *c = corner + 3 * (i < count ? i : 0);
        const float *o = row[c[0]], *p = row[c[1]], *q = row[c[2]];
        for (size_t axis = 0; axis < 3; ++axis) {
            out->a[axis][i] = p[axis] - o[axis];
            out->b[axis][i] = q[axis] - o[axis];
        }
    }
}

/* What is squashed to nothing by the bones has no frame, and is not strained. */
static void find_frames(limit_frames *out, const limit_edges *e)
{
    for (size_t i = 0; i < GROUP; ++i) {
        float ax = e->a[0][i], ay = e->a[1][i], az = e->a[2][i];
        float bx = e->b[0][i], by = e->b[1][i], bz = e->b[2][i];
        float nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
        float aa = ax * ax + ay * ay + az * az, nn = nx * nx + ny * ny + nz * nz;
        bool is_good = (aa > 1e-20f) & (nn > 1e-30f);
        float of_a = is_good ? 1.0f / sqrtf(is_good ? aa : 1.0f) : 0.0f;
        float of_n = is_good ? 1.0f / sqrtf(is_good ? nn : 1.0f) : 0.0f;
        float fx = ax * of_a, fy = ay * of_a, fz = az * of_a;
        nx *= of_n, ny *= of_n, nz *= of_n;
        out->first[0][i] = fx, out->first[1][i] = fy, out->first[2][i] = fz;
        out->normal[0][i] = nx, out->normal[1][i] = ny, out->normal[2][i] = nz;
        out->second[0][i] = ny * fz - nz * fy;
        out->second[1][i] = nz * fx - nx * fz;
        out->second[2][i] = nx * fy - ny * fx;
        out->of_a[i] = of_a;
        out->along[i] = bx * fx + by * fy + bz * fz;
        out->of_height[i] = is_good ? of_n / of_a : 0.0f;
    }
}

static bool is_still(const face *f)
{
    const rigid still = rigid_identity();
    for (uint32_t b = 0; b < f->bone_count; ++b)
        if (f->bones.moves[b] && memcmp(&f->pose[b], &still, sizeof still) != 0)
            return false;
    return true;
}

/* ---- anchored: where the skin can be strained at all ----
 *
 * What columns add to a triangle has the gradient sum of weight_j by gradient of column_j, and no
 * more than the sum of their lengths. With B that of the controls and P that of the bones, both
 * over the origin, the skin as posed has the gradient G with |G| <= B / (1 - P). Rounding is
 * counted in: each column's part of it is in its steepness. */

/* The greatest of all rounding in a sum of so many columns, over the sum of its terms' sizes. */
static float rounding_of(const face *f)
{
    return 4.0f * (float)(f->columns.count + 4) * 6e-8f;
}

/* How steep a column is in the group at most, over the origin. edges: its frames' triangles. */
static float steepest_in(const float *row, const uint32_t *corner, const limit_frames *frames,
                         size_t count, float rounding)
{
    float steepest = 0.0f;
    for (size_t i = 0; i < count; ++i, corner += 3) {
        float o = row[corner[0]], a = row[corner[1]], b = row[corner[2]];
        float p = (a - o) * frames->of_a[i];
        float q = (b - o - frames->along[i] * p) * frames->of_height[i];
        float large = fabsf(o) + fabsf(a) + fabsf(b);
        float thin = frames->of_a[i] +
                     frames->of_height[i] * (1.0f + fabsf(frames->along[i]) * frames->of_a[i]);
        steepest = fmaxf(steepest, sqrtf(p * p + q * q) + rounding * large * thin);
    }
    return steepest;
}

/* limit_group of the origin. */
static void bound_group(face *f, size_t group, const limit_frames *frames)
{
    limit_group *g = &f->limit.group[group];
    const uint32_t *corner = f->skin + 3 * GROUP * group;
    const float of_strain =
        sqrtf(1.0f / (squeeze_most * squeeze_most) + 1.0f / (tilt_most * tilt_most));
    const float sure = 1.05f; /* beside the rounding of sums: that of what is made of them */
    float most = of_strain, rounding = 0.0f;
    for (size_t i = 0; i < group_size(f, group); ++i) {
        float of_turn = f->limit.frames[group].of_turn[i];
        most = fmaxf(most, sqrtf(1.0f + of_turn * of_turn));
        if (!(frames->of_height[i] > 0.0f)) /* squashed: how steep, nobody can say */
            most = INFINITY;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const float *row = axis == 0 ? f->origin->x : axis == 1 ? f->origin->y : f->origin->z;
        float with = steepest_in(row, corner, frames, group_size(f, group), rounding_of(f));
        float without = steepest_in(row, corner, frames, group_size(f, group), 0.0f);
        rounding += fmaxf(with - without, 0.0f) + rounding_of(f);
    }
    g->of_bound = most * sure;
    g->rounding = rounding;
}

void face_limit_engage(face *f)
{
    face_limit *l = &f->limit;
    const columns *c = &f->columns;
    size_t groups = group_count(f);
    memset(l->steepest, 0, c->count * groups * sizeof *l->steepest);
    for (uint32_t block = 0; block < f->rest.block_count; ++block) {
        float none[3][POINTS_BLOCK] = {{0.0f}};
        put_rows(l->posed, f->origin, none, block);
    }
    for (size_t group = 0; group < groups; ++group) {
        const uint32_t *corner = f->skin + 3 * GROUP * group;
        size_t count = group_size(f, group);
        limit_edges edges;
        limit_frames frames;
        gather(&edges, l->posed, corner, count);
        find_frames(&frames, &edges);
        bound_group(f, group, &frames);
        for (uint32_t word = 0; word < c->mark_words; ++word) {
            uint64_t marks = 0;
            for (size_t i = 0; i < 3 * count; ++i)
                marks |= c->mark[corner[i] / POINTS_BLOCK * (size_t)c->mark_words + word];
            for (; marks != 0; marks &= marks - 1) {
                size_t column = (size_t)word * COLUMNS_WORD + (size_t)__builtin_ctzll(marks);
                l->steepest[column * groups + group] = steepest_in(
                    columns_row(c, (uint32_t)column), corner, &frames, count, rounding_of(f));
            }
        }
    }
}

/* bound: by group, what these columns can do to the gradient there. */
static void bound_columns(const face *f, float *restrict bound, const double *weight,
                          uint32_t first, uint32_t end)
{
    size_t groups = group_count(f);
    memset(bound, 0, groups * sizeof *bound);
    for (uint32_t column = first; column < end; ++column) {
        const double *w = weight + (size_t)3 * column;
        const float *restrict steepest = f->limit.steepest + column * groups;
        float size = (float)sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        if (size == 0.0f)
            continue;
        for (size_t group = 0; group < groups; ++group)
            bound[group] += size * steepest[group];
    }
}

/* What the bones do, of which nothing is known yet but that. */
static void begin_pose(face *f)
{
    face_limit *l = &f->limit;
    bool is_at_rest = is_still(f);
    if (is_at_rest && l->is_at_rest && l->engagement == f->engagement)
        return;
    memset(l->pose_weight, 0, (size_t)3 * f->control_column_count * sizeof *l->pose_weight);
    memcpy(l->pose_weight + (size_t)3 * f->control_column_count,
           f->weight + (size_t)3 * f->control_column_count,
           (size_t)3 * (f->columns.count - f->control_column_count) * sizeof *l->pose_weight);
    bound_columns(f, l->pose_bound, l->pose_weight, f->control_column_count, f->columns.count);
    memset(l->is_posed, 0, f->rest.block_count);
    for (size_t group = 0; group < group_count(f); ++group)
        l->group[group].is_framed = false;
    l->is_at_rest = is_at_rest;
    l->engagement = f->engagement;
}

/* Groups that the pulls can strain too much, and the blocks of their corners. */
static void find_wanted(face *f)
{
    face_limit *l = &f->limit;
    bound_columns(f, l->pull_bound, f->given, 0, f->control_column_count);
    memset(l->is_wanted, 0, f->rest.block_count);
    for (size_t group = 0; group < group_count(f); ++group) {
        limit_group *g = &l->group[group];
        float left = 1.0f - l->pose_bound[group] - g->rounding;
        const uint32_t *corner = f->skin + 3 * GROUP * group;
        g->is_wanted = l->pull_bound[group] != 0.0f &&
                       !(left > 0.0f && l->pull_bound[group] * g->of_bound < left);
        for (size_t i = 0; g->is_wanted && i < 3 * group_size(f, group); ++i)
            l->is_wanted[corner[i] / POINTS_BLOCK] = 1;
    }
}

/* Where the bones alone have the blocks that are wanted. */
static void pose_wanted(face *f)
{
    face_limit *l = &f->limit;
    columns *c = &f->columns;
    columns_weigh(c, l->pose_weight, c->count);
    for (uint32_t block = 0; block < f->rest.block_count; ++block) {
        float sum[3][POINTS_BLOCK] = {{0.0f}};
        if (!l->is_wanted[block] || l->is_posed[block])
            continue;
        if (face_reaches(c, c->weights.live, block))
            columns_sum(c, sum, block);
        put_rows(l->posed, f->origin, sum, block);
        l->is_posed[block] = 1;
    }
}

/* What the columns as weighed add to them. */
static void add_wanted(face *f)
{
    face_limit *l = &f->limit;
    const columns *c = &f->columns;
    for (uint32_t block = 0; block < f->rest.block_count; ++block) {
        float sum[3][POINTS_BLOCK] = {{0.0f}};
        bool was_reached = l->is_reached[block] != 0;
        if (!l->is_wanted[block])
            continue;
        l->is_reached[block] = face_reaches(c, c->weights.live, block);
        if (l->is_reached[block])
            columns_sum(c, sum, block);
        if (l->is_reached[block] || was_reached)
            put_rows(l->added, NULL, sum, block);
    }
}

/* What the controls add to them. */
static void add_pulls(face *f)
{
    columns_weigh(&f->columns, f->given, f->control_column_count);
    add_wanted(f);
}

/* Squeezed and tilted; size: the sum of squares of the gradient. */
static void find_strains(float strain[GROUP], float turn[GROUP], float size[GROUP],
                         const limit_frames *f, const limit_edges *e)
{
    const float of_squeeze = 1.0f / squeeze_most, of_tilt = 1.0f / tilt_most;
    for (size_t i = 0; i < GROUP; ++i) {
        float px = e->a[0][i] * f->of_a[i], py = e->a[1][i] * f->of_a[i],
              pz = e->a[2][i] * f->of_a[i];
        float qx = (e->b[0][i] - f->along[i] * px) * f->of_height[i];
        float qy = (e->b[1][i] - f->along[i] * py) * f->of_height[i];
        float qz = (e->b[2][i] - f->along[i] * pz) * f->of_height[i];
        float pp = f->first[0][i] * px + f->first[1][i] * py + f->first[2][i] * pz;
        float sp = f->second[0][i] * px + f->second[1][i] * py + f->second[2][i] * pz;
        float np = f->normal[0][i] * px + f->normal[1][i] * py + f->normal[2][i] * pz;
        float pq = f->first[0][i] * qx + f->first[1][i] * qy + f->first[2][i] * qz;
        float qq = f->second[0][i] * qx + f->second[1][i] * qy + f->second[2][i] * qz;
        float nq = f->normal[0][i] * qx + f->normal[1][i] * qy + f->normal[2][i] * qz;
        float mean = 0.5f * (pp + qq), apart = 0.5f * (pp - qq), shear = 0.5f * (sp + pq);
        float squeeze = sqrtf(apart * apart + shear * shear) - mean;
        float tilt = sqrtf(np * np + nq * nq);
        squeeze = squeeze > 0.0f ? squeeze : 0.0f;
        strain[i] = squeeze * of_squeeze + tilt * of_tilt;
        turn[i] = squeeze + tilt * f->of_turn[i];
        size[i] = px * px + py * py + pz * pz + qx * qx + qy * qy + qz * qz;
    }
}

static float length_of(const float *row_a, const float *row_b)
{
    float x = row_b[0] - row_a[0], y = row_b[1] - row_a[1], z = row_b[2] - row_a[2];
    return sqrtf(x * x + y * y + z * z);
}

/* How much of the length that an edge may still gain is added to it: the worst of three. */
static float stretch_strain(const face *f, size_t t, float stretch)
{
    const face_limit *l = &f->limit;
    const uint32_t *corner = f->skin + 3 * t;
    float worst = 0.0f;
    for (size_t e = 0; e < 3; ++e) {
        uint32_t a = corner[e], b = corner[e == 2 ? 0 : e + 1];
        float longest = stretch * l->longest[t][e], least = room_least * longest;
        float room = longest - length_of(l->posed[a], l->posed[b]);
        float strain = length_of(l->added[a], l->added[b]) / (room > least ? room : least);
        worst = strain > worst ? strain : worst;
    }
    return worst;
}

/* What is too much strains the controls around it, by how near they are. */
static void strain_controls(face *f, size_t t, double strain)
{
    double at[3], radius = f->settings.radius;
    points_at(at, f->origin, f->skin[3 * t]);
    for (uint32_t k = 0; k < f->control_count; ++k) {
        vec3 way = vec3_sub((vec3){at[0], at[1], at[2]}, f->grip[k].start);
        double q = vec3_dot(way, way) / (radius * radius);
        double near = q < 1.0 ? (1.0 - q) * (1.0 - q) : 0.0;
        f->limit.strain[k] = fmax(f->limit.strain[k], (strain - 1.0) * near);
    }
}

static double measure_group(face *f, size_t group, float stretch)
{
    float strain[GROUP], turn[GROUP], size[GROUP];
    double greatest = 0.0;
    limit_edges edges;
    size_t count = group_size(f, group), first = GROUP * group;
    if (!f->limit.group[group].is_framed) {
        gather(&edges, f->limit.posed, f->skin + 3 * first, count);
        find_frames(&f->limit.frames[group], &edges);
        f->limit.group[group].is_framed = true;
    }
    gather(&edges, f->limit.added, f->skin + 3 * first, count);
    find_strains(strain, turn, size, &f->limit.frames[group], &edges);
    for (size_t i = 0; i < count; ++i) {
        f->limit.may_bend |= turn[i] > 1.0f;
        if (size[i] > 1.0f)
            strain[i] = fmaxf(strain[i], stretch_strain(f, first + i, stretch));
        if (strain[i] > 1.0f)
            strain_controls(f, first + i, fmin((double)strain[i], strain_most));
        greatest = fmax(greatest, (double)strain[i]);
    }
    return greatest;
}

/* The greatest that is above 1; limit.strain: how far each control's surroundings are above it. */
static double measure_strain(face *f)
{
    const float stretch = (float)stretch_of(&f->settings);
    double greatest = 0.0;
    memset(f->limit.strain, 0, f->control_count * sizeof *f->limit.strain);
    f->limit.may_bend = false;
    find_wanted(f);
    pose_wanted(f);
    add_pulls(f);
    for (size_t group = 0; group < group_count(f); ++group)
        if (f->limit.group[group].is_wanted)
            greatest = fmax(greatest, measure_group(f, group, stretch));
    return greatest;
}

/* ---- anchored: what is given ---- */

/* How much two controls are in the fields of the same bones. */
static void compare_controls(face *f)
{
    face_limit *l = &f->limit;
    uint32_t count = f->control_count;
    for (size_t i = 0; i < count; ++i) {
        const face_grip *a = &f->grip[i];
        l->centre[3 * i] = a->start.x;
        l->centre[3 * i + 1] = a->start.y;
        l->centre[3 * i + 2] = a->start.z;
        for (size_t j = 0; j < count; ++j) {
            const face_grip *b = &f->grip[j];
            double ab = 0.0, aa = 0.0, bb = 0.0;
            for (uint32_t bone = 0; bone < f->bone_count; ++bone) {
                ab += a->share[bone] * b->share[bone];
                aa += a->share[bone] * a->share[bone];
                bb += b->share[bone] * b->share[bone];
            }
            l->likeness[i * count + j] = ab / sqrt(fmax(aa * bb, 1e-30));
        }
    }
}

/* limit.asked := what f->weight pulls, with the bones at rest. */
static void find_asked(face *f)
{
    memset(f->limit.asked, 0, (size_t)3 * f->control_count * sizeof *f->limit.asked);
    for (uint32_t b = f->bone_count; b-- > 0;) {
        const face_field *field = &f->field[b];
        const rigid back = rigid_inverse(&f->pose[b]);
        for (uint32_t i = 0; i < field->control_count; ++i) {
            const double *w = f->weight + (size_t)3 * (field->first_column + i);
            double *g = f->limit.asked + (size_t)3 * field->control[i];
            vec3 pull = {w[0], w[1], w[2]};
            if (f->bones.moves[b])
                pull = rigid_rotate(&back, pull);
            g[0] = pull.x;
            g[1] = pull.y;
            g[2] = pull.z;
        }
    }
}

/* f->given := what limit.g pulls. */
static void give(face *f)
{
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        for (uint32_t i = 0; i < field->control_count; ++i) {
            const double *g = f->limit.g + (size_t)3 * field->control[i];
            double *w = f->given + (size_t)3 * (field->first_column + i);
            vec3 pull = {g[0], g[1], g[2]};
            if (f->bones.moves[b])
                pull = rigid_rotate(&f->pose[b], pull);
            w[0] = pull.x;
            w[1] = pull.y;
            w[2] = pull.z;
        }
    }
}

/* The fields too: whoever asks them for their slopes means those of the shape shown. */
static void give_fields(face *f)
{
    f->meter.slope_bound = 0.0;
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        for (uint32_t i = 0; i < field->control_count; ++i)
            memcpy(f->scratch + (size_t)3 * i, f->limit.g + (size_t)3 * field->control[i],
                   3 * sizeof *f->scratch);
        if (field->control_count > 0 && csrbf_solve(field->solver, f->scratch, NULL) >= 0)
            f->meter.slope_bound =
                fmax(f->meter.slope_bound, csrbf_diagnose(field->solver).slope_bound);
    }
}

static void note_held_back(face *f)
{
    double most = 0.0;
    for (uint32_t k = 0; k < f->control_count; ++k) {
        const double *asked = f->limit.asked + (size_t)3 * k, *given = f->limit.g + (size_t)3 * k;
        vec3 missing = {asked[0] - given[0], asked[1] - given[1], asked[2] - given[2]};
        most = fmax(most, vec3_length(missing) * f->grip[k].mobility);
    }
    f->meter.held_back_mm = most;
}

static void give_part(face *f, double part)
{
    for (size_t i = 0; i < (size_t)3 * f->control_count; ++i)
        f->limit.g[i] *= part;
    give(f);
}

/* As surface_meter_bend of the skin with so much of what the controls add. */
static double bend_of_skin(face *f, float part)
{
    points *p = &f->before; /* of use to drags alone */
    for (uint32_t block = 0; block < p->block_count; ++block)
        for (size_t slot = (size_t)block * POINTS_BLOCK;
             f->limit.has_skin[block] && slot < (size_t)(block + 1) * POINTS_BLOCK; ++slot) {
            const float *posed = f->limit.posed[slot], *added = f->limit.added[slot];
            p->x[slot] = posed[0] + part * added[0];
            p->y[slot] = posed[1] + part * added[1];
            p->z[slot] = posed[2] + part * added[2];
        }
    const float *at[3];
    return surface_meter_bend(f->surface_meter, &bends, streams(p, at));
}

/* The pulls give way where they strain the skin; then all of them by what is left. */
static void yield_pulls(face *f, double strain)
{
    face_limit *l = &f->limit;
    size_t numbers = (size_t)3 * f->control_count;
    find_asked(f);
    compare_controls(f);
    memset(l->ridge, 0, f->control_count * sizeof *l->ridge);
    memcpy(l->g, l->asked, numbers * sizeof *l->g);
    double ridge = softening;
    for (int i = 0; i < SOFTENINGS && strain > 1.0; ++i, ridge *= softening_more) {
        for (uint32_t k = 0; k < f->control_count; ++k)
            l->ridge[k] += ridge * l->strain[k];
        memcpy(l->g, l->asked, numbers * sizeof *l->g);
        csrbf_soften(l->g, &f->settings, l->centre, l->likeness, l->ridge, f->control_count,
                     l->scratch);
        give(f);
        strain = measure_strain(f);
    }
    give_part(f, strain > 1.0 ? (isfinite(strain) ? 1.0 / strain : 0.0) : 1.0);
}

/* Edges that were sharp before may be too sharp now though each of their triangles has turned as
 * little as it may: that is looked at edge by edge, and all pulls give way to it. */
static void unbend(face *f)
{
    double posed = 0.0;
    memcpy(f->limit.is_wanted, f->limit.has_skin, f->rest.block_count);
    add_wanted(f); /* as the strain was measured */
    pose_wanted(f);
    for (int i = 0; i < PARTS; ++i) {
        double bend = bend_of_skin(f, 1.0f);
        if (i == 0 && bend > 1.0)
            posed = bend_of_skin(f, 0.0f); /* what the bones bend is not in the pulls */
        bend /= fmax(posed, 1.0);
        if (!(bend > 1.0))
            return;
        if (i == 0 && !f->is_held) {
            find_asked(f);
            memcpy(f->limit.g, f->limit.asked, (size_t)3 * f->control_count * sizeof *f->limit.g);
            f->is_held = true;
        }
        give_part(f, 1.0 / bend);
        add_pulls(f);
    }
}

/* As face_min_determinant, beyond the least that there may be, of so much of limit.centre, which is
 * given then. */
static double room_of_part(face *f, double part)
{
    for (size_t i = 0; i < (size_t)3 * f->control_count; ++i)
        f->limit.g[i] = part * f->limit.centre[i];
    give_fields(f);
    return face_min_determinant(f) - determinant_least;
}

/* Without a rig the field is one of space, and may fold beside the skin, along its normals, where
 * no triangle tells: so much of the pulls is given that it does not. The root is found by false
 * position, with the weight of an end that stays halved. */
static void unfold(face *f)
{
    const double slope_safe =
        1.0 - cbrt(determinant_least); /* (1 - slope)^3 bounds it from below */
    face_limit *l = &f->limit;
    if (f->rig || f->meter.slope_bound <= slope_safe)
        return;
    if (!f->is_held) {
        find_asked(f);
        memcpy(l->g, l->asked, (size_t)3 * f->control_count * sizeof *l->g);
    }
    memcpy(l->centre, l->g, (size_t)3 * f->control_count * sizeof *l->g);
    double low = 0.0, high = 1.0, room_low = 1.0 - determinant_least;
    double room = room_of_part(f, 1.0), room_high = room;
    if (!(room < 0.0))
        return;
    for (int i = 0, side = 0; i < UNFOLDINGS && !(fabs(room) < determinant_rounding); ++i) {
        double part = low + (high - low) * room_low / (room_low - room_high);
        room = room_of_part(f, part);
        if (room < 0.0) {
            high = part, room_high = room;
            room_low *= side < 0 ? 0.5 : 1.0;
            side = -1;
        } else {
            low = part, room_low = room;
            room_high *= side > 0 ? 0.5 : 1.0;
            side = 1;
        }
    }
    give(f);
    f->is_held = true;
}

void face_limit_pull(face *f)
{
    if (f->is_given)
        return;
    memcpy(f->given, f->weight, (size_t)3 * f->columns.count * sizeof *f->given);
    f->is_given = true;
    if (f->origin == &f->free) /* what a drag has held back stands */
        return;
    f->meter.held_back_mm = 0.0;
    if (f->control_count == 0 || f->settings.stretch_most < 0.0)
        return;
    f->is_held = false;
    begin_pose(f);
    double strain = measure_strain(f);
    if (strain > 1.0)
        yield_pulls(f, strain);
    f->is_held = strain > 1.0;
    if (f->limit.may_bend)
        unbend(f);
    if (f->is_held)
        give_fields(f);
    unfold(f);
    if (f->is_held)
        note_held_back(f);
}

/* ---- unanchored ---- */

static void note_changed(face *f)
{
    const points *a = &f->before, *b = &f->free;
    for (uint32_t block = 0; block < a->block_count; ++block) {
        size_t first = (size_t)block * POINTS_BLOCK, size = POINTS_BLOCK * sizeof(float);
        f->limit.is_changed[block] = memcmp(a->x + first, b->x + first, size) != 0 ||
                                     memcmp(a->y + first, b->y + first, size) != 0 ||
                                     memcmp(a->z + first, b->z + first, size) != 0;
    }
}

/* Clay as the skull lets it be seen. */
static const points *show_clay(const face *f, points *out, const points *from)
{
    if (f->projection.block_count == 0)
        return from;
    points_copy(out, from);
    projection_apply_still(&f->projection, out);
    return out;
}

static double yield(face *f, const csrbf_settings *settings)
{
    const float *before[3], *after[3];
    surface_limits limits = clay;
    const points *from = show_clay(f, &f->limit.shown_before, &f->before);
    const points *to = show_clay(f, &f->limit.shown_after, &f->free);
    limits.stretch = stretch_of(settings);
    note_changed(f);
    return (double)surface_meter_yield(f->surface_meter, &limits, streams(from, before),
                                       streams(to, after), f->limit.is_changed, f->limit.share);
}

/* How near a place is to a tip: 1 there, 0 from the radius on. */
static double nearness(const double at[3], const double *tip, double radius)
{
    vec3 way = {at[0] - tip[0], at[1] - tip[1], at[2] - tip[2]};
    double q = vec3_dot(way, way) / (radius * radius);
    return q < 1.0 ? (1.0 - q) * (1.0 - q) : 0.0;
}

/* Of those, that of the nearest. */
static double nearest_tip(const face *f, const double at[3], double radius, uint32_t count)
{
    double most = 1e-6;
    for (uint32_t k = 0; k < count; ++k)
        most = fmax(most, nearness(at, f->from + (size_t)3 * k, radius));
    return most;
}

/* Each tip may go as far as what is near it may. */
static void shorten_tips(face *f, double radius, uint32_t count)
{
    face_limit *l = &f->limit;
    memcpy(l->strain, l->tip_share, count * sizeof *l->strain);
    for (uint32_t slot = 0; slot < f->before.count; ++slot) {
        double at[3], share = (double)l->share[slot];
        if (!(share < 1.0))
            continue;
        points_at(at, &f->before, slot);
        double nearest = nearest_tip(f, at, radius, count);
        for (uint32_t k = 0; k < count; ++k) {
            double near = nearness(at, f->from + (size_t)3 * k, radius) / nearest;
            double own = l->strain[k] * (1.0 - near * (1.0 - share));
            l->tip_share[k] = fmin(l->tip_share[k], own);
        }
    }
}

/* The part of the step that is taken at a place: as its tips go, by how near they are. */
static double part_at(const face *f, const double at[3], double radius, uint32_t count)
{
    double part = 1.0, nearest = nearest_tip(f, at, radius, count);
    for (uint32_t k = 0; k < count; ++k) {
        double near = nearness(at, f->from + (size_t)3 * k, radius) / nearest;
        part = fmin(part, 1.0 - (1.0 - f->limit.tip_share[k]) * near);
    }
    return part;
}

/* f->free := what is taken of the step; all: of the whole of it, beside what tips take. */
static void take_part(face *f, double radius, uint32_t count, double all)
{
    for (uint32_t block = 0; block < f->free.block_count; ++block) {
        if (!f->limit.is_changed[block])
            continue;
        for (size_t slot = (size_t)block * POINTS_BLOCK; slot < (size_t)(block + 1) * POINTS_BLOCK;
             ++slot) {
            const float *step = f->limit.step[slot];
            double at[3];
            points_at(at, &f->before, slot);
            float part = (float)(all * part_at(f, at, radius, count));
            f->free.x[slot] = f->before.x[slot] + part * step[0];
            f->free.y[slot] = f->before.y[slot] + part * step[1];
            f->free.z[slot] = f->before.z[slot] + part * step[2];
        }
        points_update_block(&f->free, block);
    }
}

static void keep_step(face *f)
{
    for (size_t slot = 0; slot < f->free.padded_count; ++slot) {
        float *step = f->limit.step[slot];
        step[0] = f->free.x[slot] - f->before.x[slot];
        step[1] = f->free.y[slot] - f->before.y[slot];
        step[2] = f->free.z[slot] - f->before.z[slot];
    }
}

/* share: the least that some vertex may take of the step. */
static void shorten_step(face *f, const csrbf_settings *settings, uint32_t count, double share)
{
    double all = 1.0;
    keep_step(f);
    for (int i = 0; i < PARTS && share < 1.0; ++i) {
        shorten_tips(f, settings->radius, count);
        take_part(f, settings->radius, count, 1.0);
        share = yield(f, settings);
    }
    for (int i = 0; i < PARTS && share < 1.0; ++i) { /* of what no tip is near enough to */
        all *= i == 0 ? share : 0.5 * share;
        take_part(f, settings->radius, count, all);
        share = yield(f, settings);
    }
    if (share < 1.0) {
        points_copy(&f->free, &f->before);
        all = 0.0;
    }
    for (uint32_t k = 0; k < count; ++k) { /* strain: scratch */
        double *tip = f->position + (size_t)3 * k, *from = f->from + (size_t)3 * k;
        f->limit.strain[k] = all * part_at(f, from, settings->radius, count);
        for (int i = 0; i < 3; ++i)
            tip[i] = from[i] + f->limit.strain[k] * (tip[i] - from[i]);
    }
    memcpy(f->limit.tip_share, f->limit.strain, count * sizeof *f->limit.strain);
}

static void note_held_tips(face *f, uint32_t count)
{
    double most = 0.0;
    for (uint32_t k = 0; k < count; ++k) {
        const double *to = f->to + (size_t)3 * k, *at = f->position + (size_t)3 * k;
        if (f->limit.tip_share[k] < 1.0)
            most = fmax(most, vec3_length((vec3){to[0] - at[0], to[1] - at[1], to[2] - at[2]}));
    }
    f->meter.held_back_mm = most;
}

void face_limit_drag(face *f, const csrbf_settings *settings, uint32_t count,
                     const shape_step *step)
{
    f->meter.held_back_mm = 0.0;
    for (uint32_t k = 0; k < count; ++k)
        f->limit.tip_share[k] = 1.0;
    if (settings->stretch_most < 0.0 || step->substeps == 0)
        return;
    double share = yield(f, settings);
    if (!(share < 1.0))
        return;
    shorten_step(f, settings, count, share);
    note_held_tips(f, count);
}
