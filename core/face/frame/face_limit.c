/* Limits pulls that would fold or tear the skin. face_limit_pull, at the end of the file, goes
 * through these steps:
 *
 * 1. Strain (measure_strain). The bones pose a triangle. The controls add a displacement with a
 *    gradient G in it. A part s of the pulls, 0..1, maps the posed triangle by I + s G. Let m be
 *    how much G compresses the triangle: the negated least eigenvalue of the symmetric part of G
 *    in its plane. Let t be how steep G is along its normal. The strain of the triangle is
 *      s (m / M + t / T),   M < 1 and T as in strain.h.
 *    At a strain of 1 or less I + s G is positive definite in the plane of the triangle. Then the
 *    triangle does not turn over, and its normal turns by less than atan T. The strain is
 *    proportional to s, so 1 over the largest strain of all triangles is the part that can be
 *    given.
 *    Two corrections follow. An edge that becomes too long also counts as strain
 *    (measure_stretches). Where the bones have already tilted a triangle, T is smaller
 *    (leave_tilts), unless its projected area shows that it does not turn over (flip_strain).
 * 2. Yielding (yield_pulls). Where the strain is above 1, the pulls near it first yield to each
 *    other. They are softened by a ridge that grows with the strain (csrbf/soften.h). If that is
 *    not enough, one factor reduces all pulls. The result is a function of the pulls and the pose,
 *    and does not depend on earlier frames.
 * 3. Bends (unbend). Triangles that turn far are compared edge by edge with their neighbours, as
 *    they will be shown. Pulls near an edge that is bent too far are reduced.
 * 4. A head with its own shapes (part_shaped). Its strain is that of a fold (strain_fold), which is
 *    not proportional to the pulls. So the part that can be given is found by a search.
 * 5. A face without a rig (unfold). Its field is defined in space and can fold off the skin, where
 *    there is no triangle. The result is the largest part that keeps the determinant of the field's
 *    map above a bound.
 * 6. The seal of the lips, and the skull and teeth under the skin, move the skin after that:
 *    face_limit_shown.c.
 *
 * For speed, triangles are judged in groups of GROUP. face_limit_engage computes once per
 * engagement how steep each column is at most in a group. Together with the weights of the columns
 * this bounds the strain of the group, and only groups with a bound above 1 are measured. The other
 * groups cannot exceed 1, so skipping them changes no result.
 *
 * face_drag.c judges a drag. */
#include "csrbf/soften.h"
#include "face/frame/limit.h"
#include "face/frame/rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* If the bones alone have used up the stretch that an edge is allowed, pulls may still lengthen it
 * by this part of the allowance. Otherwise a pull nearby would be cancelled completely. */
static const float room_least = 0.05f;
enum { SOFTENINGS = 5 };
/* The ridge of the first softening, per 1 of excess strain, and the factor for each further
 * softening. Controls near each other need little: they yield only where they differ. */
static const double softening = 0.02, softening_more = 3.0;
/* Cap of a triangle's strain, so that a sliver does not outweigh the rest. */
static const double strain_most = 8.0;

/* 1 / tan(STRAIN_SEEN_RAD). The first 17 degrees of tilt by bones do not count against that. */
static const float inv_tan_seen = 0.0524078f;
static const angle_sincos tilt_free = {.cos = 0.9563048, .sin = 0.2923717};

/* Several of the head's own shapes together may stretch an edge by this factor more than each
 * alone. */
static const float made_stretch = 1.5f;

/* If a group's bound exceeds its limit by this factor, the group is measured directly. Below, its
 * gradient is measured first, which is cheaper and often sufficient. */
static const float excess_surely = 2.0f;

/* For part_shaped: tries, steps of bisection, and the strain that counts as 1. */
enum { PARTINGS = 4 };
static const double shaped_most = 1.001;

enum { UNBENDINGS = 8, BEND_YIELDS = 3, UNFOLDINGS = 16 }; /* tries */
/* For unfold: the least determinant of the field's map at the vertices, and its tolerance. */
static const double determinant_least = 0.05, determinant_rounding = 1e-4;

/* Subject of a pass: triangles that are strained too much, or triangles that have turned so far
 * that their edges may be bent too far. */
typedef enum limit_looks { AT_STRAINS = 0, AT_TURNS } limit_looks;

_Static_assert(CARRIERS <= 32, "a bit for each in limit_group.bones_around");
_Static_assert((int)POINTS_BLOCK == (int)SURFACE_BLOCK, "a surface has the blocks of its points");

/* fmaxf without a call; a NaN in b is ignored. */
static inline float larger(float a, float b)
{
    return b > a ? b : a;
}

/* ---- creation ---- */

/* Measures the angle by which a triangle may turn. If two neighbours turn by at most this angle,
 * the edge between them is not bent too far. */
static void measure_turns(face *f)
{
    const double pi = 3.14159265358979323846, least = 0.5 * SURFACE_CREASE_DEG - 1.0;
    for (size_t t = 0; t < f->skin_count; ++t) {
        double bent = surface_meter_bent_at_rest(f->surface_meter, (uint32_t)t);
        double angle_rad = fmax(0.5 * (limit_bends.bend_deg - bent), least) * pi / 180.0;
        limit_patch *patch = &f->limit.patch[t / GROUP];
        patch->inv_tan_turn[t % GROUP] = (float)(1.0 / tan(angle_rad));
        patch->turn_cosine[t % GROUP] = (float)cos(angle_rad);
        patch->turn_sine[t % GROUP] = (float)sin(angle_rad);
    }
}

static void measure_rest(face *f)
{
    for (size_t t = 0; t < f->skin_count; ++t) {
        const uint32_t *corner = f->skin + 3 * t;
        for (size_t e = 0; e < 3; ++e) {
            vec3 from = points_position(&f->rest, corner[e]);
            vec3 to = points_position(&f->rest, corner[e == 2 ? 0 : e + 1]);
            f->limit.longest[t][e] = (float)vec3_length(vec3_sub(to, from));
        }
        const points *p = &f->rest;
        limit_patch *patch = &f->limit.patch[t / GROUP];
        float a[3] = {p->x[corner[1]] - p->x[corner[0]], p->y[corner[1]] - p->y[corner[0]],
                      p->z[corner[1]] - p->z[corner[0]]};
        float b[3] = {p->x[corner[2]] - p->x[corner[0]], p->y[corner[2]] - p->y[corner[0]],
                      p->z[corner[2]] - p->z[corner[0]]};
        patch->rest_normal[0][t % GROUP] = a[1] * b[2] - a[2] * b[1];
        patch->rest_normal[1][t % GROUP] = a[2] * b[0] - a[0] * b[2];
        patch->rest_normal[2][t % GROUP] = a[0] * b[1] - a[1] * b[0];
    }
}

static void measure_still(face *f)
{
    for (uint32_t b = 0; b < f->bone_count; ++b)
        for (size_t slot = 0; slot < f->rest.padded_count && !f->bones.moves[b]; ++slot)
            f->limit.still[slot] += f->field[b].weight[slot];
}

/* Lists the blocks of each group's corners, each once, with bits for the corner vertices. */
static void list_blocks(face *f)
{
    face_limit *l = &f->limit;
    uint32_t count = 0;
    for (size_t group = 0; group < limit_group_count(f); ++group) {
        const uint32_t *corner = f->skin + 3 * GROUP * group;
        uint32_t first = l->group[group].first_block = count;
        for (size_t i = 0; i < 3 * limit_group_size(f, group); ++i) {
            uint32_t block = corner[i] / POINTS_BLOCK, at = first;
            while (at < count && l->block[at] != block)
                ++at;
            l->block[at] = block;
            l->corners[at] |= UINT64_C(1) << corner[i] % POINTS_BLOCK;
            count += at == count;
        }
    }
    l->group[limit_group_count(f)].first_block = count;
}

/* Lists for each block the groups with a corner in it. */
static void list_groups(face *f)
{
    face_limit *l = &f->limit;
    const uint32_t groups = (uint32_t)limit_group_count(f), count = l->group[groups].first_block;
    for (uint32_t i = 0; i < count; ++i)
        l->first_of[l->block[i] + 1] += 1;
    for (uint32_t block = 0; block < f->rest.block_count; ++block)
        l->first_of[block + 1] += l->first_of[block];
    for (uint32_t group = groups; group-- > 0;) /* going backwards turns the counts into begins */
        for (uint32_t i = l->group[group].first_block; i < l->group[group + 1].first_block; ++i)
            l->group_of[--l->first_of[l->block[i] + 1]] = (limit_member){group, l->corners[i]};
    for (uint32_t block = 0; block < f->rest.block_count; ++block)
        l->first_of[block] = l->first_of[block + 1];
    l->first_of[f->rest.block_count] = count;
}

mrt_result face_limit_create(face *f, error *err)
{
    face_limit *l = &f->limit;
    arrays *a = &f->arrays;
    size_t vertices = f->rest.padded_count, blocks = f->rest.block_count;
    size_t controls = f->control_capacity, groups = limit_group_count(f) + 1;
    size_t weighed = f->columns.capacity, skin = f->skin_count;
    l->loops = strain_loops_now();
    l->posed = arrays_add(a, vertices, sizeof *l->posed);
    l->added = arrays_add(a, vertices, sizeof *l->added);
    l->share = arrays_add(a, vertices, sizeof *l->share);
    l->step = arrays_add(a, vertices, sizeof *l->step);
    l->still = arrays_add(a, vertices, sizeof *l->still);
    l->bones_around = arrays_add(a, vertices, sizeof *l->bones_around);
    l->is_posed = arrays_add(a, blocks, 1);
    l->is_added = arrays_add(a, blocks, 1);
    l->is_changed = arrays_add(a, blocks, 1);
    l->group = arrays_add(a, groups, sizeof *l->group);
    l->patch = arrays_add(a, groups, sizeof *l->patch);
    l->shape = arrays_add(a, groups, sizeof *l->shape);
    l->known = arrays_add(a, groups, sizeof *l->known);
    l->pull_bound = arrays_add(a, groups, sizeof *l->pull_bound);
    l->change = arrays_add(a, groups, sizeof *l->change);
    l->wanted = arrays_add(a, groups, sizeof *l->wanted);
    l->carried = arrays_add(a, groups * CARRIERS, sizeof *l->carried);
    l->steepest = arrays_add(a, groups * (weighed + 1), sizeof *l->steepest);
    l->apart = arrays_add(a, (size_t)CARRIERS * CARRIERS, sizeof *l->apart);
    l->block = arrays_add(a, 3 * skin, sizeof *l->block);
    l->candidate = arrays_add(a, skin, sizeof *l->candidate);
    l->harmed = arrays_add(a, groups, sizeof *l->harmed);
    l->shaped = arrays_add(a, f->shapes.count, sizeof *l->shaped);
    l->shape_share = arrays_add(a, f->shapes.count, sizeof *l->shape_share);
    l->slid = arrays_add(a, vertices, sizeof *l->slid);
    l->is_slid = arrays_add(a, blocks, 1);
    l->group_of = arrays_add(a, 3 * skin, sizeof *l->group_of);
    l->first_of = arrays_add(a, blocks + 1, sizeof *l->first_of);
    l->group_strain = arrays_add(a, groups, sizeof *l->group_strain);
    l->group_flip = arrays_add(a, groups, sizeof *l->group_flip);
    l->is_marked = arrays_add(a, groups, sizeof *l->is_marked);
    l->corners = arrays_add(a, 3 * skin, sizeof *l->corners);
    l->longest = arrays_add(a, skin, sizeof *l->longest);
    l->bounded = arrays_add(a, 3 * weighed, sizeof *l->bounded);
    l->pose_weight = arrays_add(a, 3 * weighed, sizeof *l->pose_weight);
    l->g = arrays_add(a, 3 * controls, sizeof *l->g);
    l->asked = arrays_add(a, 3 * controls, sizeof *l->asked);
    l->centre = arrays_add(a, 3 * controls, sizeof *l->centre);
    l->ridge = arrays_add(a, controls, sizeof *l->ridge);
    l->strain = arrays_add(a, controls, sizeof *l->strain);
    l->tip_share = arrays_add(a, controls, sizeof *l->tip_share);
    l->likeness = arrays_add(a, controls * controls, sizeof *l->likeness);
    l->scratch = arrays_add(a, CSRBF_SOFTEN_SCRATCH(controls), sizeof *l->scratch);
    if (a->failed)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the limits of %u triangles",
                         f->skin_count);
    measure_rest(f);
    measure_turns(f);
    measure_still(f);
    list_blocks(f);
    list_groups(f);
    return limit_rooms_create(f, err);
}

/* ---- triangles ---- */

double face_stretch_most(const csrbf_settings *settings)
{
    return settings->stretch_most > 0.0 ? fmax(settings->stretch_most, 1.1) : CSRBF_STRETCH_MOST;
}

/* Writes origin + sum as rows. Also leaves it in `sum`. */
static void write_rows(float (*restrict row)[4], const points *origin, float sum[3][POINTS_BLOCK],
                       uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    const float *const at[3] = {origin ? origin->x + first : NULL,
                                origin ? origin->y + first : NULL,
                                origin ? origin->z + first : NULL};
    for (int axis = 0; axis < 3 && origin; ++axis)
        for (size_t i = 0; i < POINTS_BLOCK; ++i)
            sum[axis][i] = at[axis][i] + sum[axis][i];
    for (size_t i = 0; i < POINTS_BLOCK; i += 4) {
        rows_four r[4];
        rows_from(r, sum[0] + i, sum[1] + i, sum[2] + i);
        for (size_t k = 0; k < 4; ++k)
            rows_store(row[first + i + k], r[k]);
    }
}

/* ---- bounds: where the skin can be strained at all ----
 *
 * The displacement added by the controls has a gradient of at most B over the origin. B is its
 * length when it was last measured, plus its possible growth since then. The growth is the sum over
 * the columns of the change of their weights times their steepness. Bones leave some room for B
 * (face_limit_room.c), and a group is measured only if B may exceed that room. B depends on earlier
 * frames, but the result does not. */

/* Returns a bound of the relative rounding error of the sum of the columns. */
static float rounding_of(const face *f)
{
    return 4.0f * (float)(f->columns.count + 4) * 6e-8f;
}

/* Returns the largest length of a row's gradient in the group. */
static float steepest_in(const float *row, const uint32_t *corner, const strain_shapes *of,
                         size_t count, float rounding)
{
    float steepest = 0.0f;
    for (size_t i = 0; i < count; ++i, corner += 3) {
        float o = row[corner[0]], a = row[corner[1]], b = row[corner[2]];
        float p = (a - o) * of->inv_first[i];
        float q = (b - o - of->along[i] * p) * of->inv_height[i];
        float large = fabsf(o) + fabsf(a) + fabsf(b);
        float thin =
            of->inv_first[i] + of->inv_height[i] * (1.0f + fabsf(of->along[i]) * of->inv_first[i]);
        steepest = fmaxf(steepest, sqrtf(p * p + q * q) + rounding * large * thin);
    }
    return steepest;
}

/* Subtracts `less` from an angle. The angle and the result are given as 1 over their tangent. */
static double angle_subtract(double of_angle, angle_sincos less)
{
    double left = less.cos - of_angle * less.sin;
    return left > 0.0 ? (of_angle * less.cos + less.sin) / left : (double)INFINITY;
}

static angle_sincos angle_of_cosine(double cosine)
{
    return (angle_sincos){.cos = cosine, .sin = sqrt(fmax(1.0 - cosine * cosine, 0.0))};
}

static angle_sincos angle_of_sine(double sine)
{
    sine = fmin(sine, 1.0);
    return (angle_sincos){.cos = sqrt(1.0 - sine * sine), .sin = sine};
}

/* Adds two angles, with a maximum of 90 degrees. */
static angle_sincos angle_add(angle_sincos a, angle_sincos b)
{
    double cosine = a.cos * b.cos - a.sin * b.sin;
    return cosine > 0.0 ? (angle_sincos){.cos = cosine, .sin = a.sin * b.cos + a.cos * b.sin}
                        : (angle_sincos){.cos = 0.0, .sin = 1.0};
}

/* Returns the greatest strain and turn by a gradient of length 1, for triangles of the group that
 * have turned from rest by up to `tilt`. */
static float steepness_of(const limit_group *g, angle_sincos tilt)
{
    const double sure = 1.05; /* margin for the rounding of values derived from sums */
    double inv_tan_tilt =
        fmax(1.0 / (double)STRAIN_TILT_MOST, angle_subtract((double)inv_tan_seen, tilt));
    double inv_tan_turn = angle_subtract((double)g->inv_tan_turn, tilt);
    double squeezed = 1.0 / (double)(STRAIN_SQUEEZE_MOST * STRAIN_SQUEEZE_MOST);
    return (float)(sure * fmax(sqrt(squeezed + inv_tan_tilt * inv_tan_tilt),
                               sqrt(1.0 + inv_tan_turn * inv_tan_turn)));
}

/* The same for the three columns of a shape together. */
static float steepest_shape(const face *f, size_t column, size_t group)
{
    const uint32_t *corner = f->skin + 3 * GROUP * group;
    float square = 0.0f;
    for (uint32_t axis = 0; axis < 3; ++axis) {
        float one = steepest_in(columns_row(&f->columns, (uint32_t)column + axis), corner,
                                &f->limit.patch[group].origin.shape, limit_group_size(f, group),
                                rounding_of(f));
        square += one * one;
    }
    return 1.01f * sqrtf(square);
}

/* Computes the group's steepness and the effect of rounding. */
static void bound_group(face *f, size_t group)
{
    limit_group *g = &f->limit.group[group];
    const limit_patch *patch = &f->limit.patch[group];
    const uint32_t *corner = f->skin + 3 * GROUP * group;
    size_t count = limit_group_size(f, group);
    float rounding = 0.0f;
    bool is_squashed = false; /* then there is no bound */
    g->inv_tan_turn = 0.0f;
    g->tilt_cosine = 1.0f;
    for (size_t i = 0; i < count; ++i) {
        vec3 normal = {(double)patch->origin.normal[0][i], (double)patch->origin.normal[1][i],
                       (double)patch->origin.normal[2][i]};
        vec3 rest = vec3_normalised(face_skin_area(&f->rest, corner + 3 * i), normal);
        double cosine = fmin(vec3_dot(rest, normal), 1.0);
        if (cosine < 1.0 - 1e-6) /* a smaller difference is rounding */
            g->tilt_cosine = fminf(g->tilt_cosine, fmaxf((float)cosine, 0.0f));
        g->inv_tan_turn = fmaxf(g->inv_tan_turn, patch->inv_tan_turn[i]);
        is_squashed = is_squashed || !(patch->origin.shape.inv_height[i] > 0.0f);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const float *row = axis == 0 ? f->origin->x : axis == 1 ? f->origin->y : f->origin->z;
        float with = steepest_in(row, corner, &patch->origin.shape, count, rounding_of(f));
        float without = steepest_in(row, corner, &patch->origin.shape, count, 0.0f);
        rounding += fmaxf(with - without, 0.0f) + rounding_of(f);
    }
    g->steepness =
        is_squashed ? INFINITY : steepness_of(g, angle_of_cosine((double)g->tilt_cosine));
    g->rounding = rounding;
}

/* Computes the ball around a group. */
static void enclose_group(face *f, size_t group)
{
    limit_group *g = &f->limit.group[group];
    const uint32_t *corner = f->skin + 3 * GROUP * group;
    size_t count = 3 * limit_group_size(f, group);
    double centre[3] = {0}, square = 0.0;
    for (size_t i = 0; i < count; ++i) {
        double at[3];
        points_at(at, f->origin, corner[i]);
        for (int axis = 0; axis < 3; ++axis)
            centre[axis] += at[axis] / (double)count;
    }
    for (size_t i = 0; i < count; ++i) {
        vec3 middle = {centre[0], centre[1], centre[2]};
        vec3 way = vec3_sub(points_position(f->origin, corner[i]), middle);
        square = fmax(square, vec3_dot(way, way));
    }
    for (int axis = 0; axis < 3; ++axis)
        g->centre[axis] = (float)centre[axis];
    g->radius = (float)sqrt(square);
}

static const float *carrier_row(const face *f, uint32_t bone)
{
    if (bone == STILL)
        return f->limit.still;
    return bone < f->bone_count && f->bones.moves[bone] ? f->field[bone].weight : NULL;
}

/* Returns the gradient of a row at a triangle of the group. */
static vec3 gradient_at(const float *row, const uint32_t *corner, const strain_frames *frames,
                        size_t i)
{
    const strain_shapes *of = &frames->shape;
    float o = row[corner[0]], a = row[corner[1]], b = row[corner[2]];
    float p = (a - o) * of->inv_first[i];
    float q = (b - o - of->along[i] * p) * of->inv_height[i];
    return (vec3){(double)(p * frames->first[0][i] + q * frames->second[0][i]),
                  (double)(p * frames->first[1][i] + q * frames->second[1][i]),
                  (double)(p * frames->first[2][i] + q * frames->second[2][i])};
}

static void find_gradient(limit_carried *out, const float *row, const uint32_t *corner,
                          const strain_frames *frames, size_t count)
{
    vec3 mean = {0, 0, 0};
    double apart = 0.0;
    for (size_t i = 0; i < count; ++i)
        mean = vec3_add(
            mean, vec3_scale(gradient_at(row, corner + 3 * i, frames, i), 1.0 / (double)count));
    for (size_t i = 0; i < count; ++i)
        apart =
            fmax(apart, vec3_length(vec3_sub(gradient_at(row, corner + 3 * i, frames, i), mean)));
    out->gradient[0] = (float)mean.x;
    out->gradient[1] = (float)mean.y;
    out->gradient[2] = (float)mean.z;
    out->apart = (float)apart;
}

static float spread_of(const float *row, const uint32_t *corner, size_t count)
{
    float spread = 0.0f;
    for (size_t i = 0; i < 3 * count; ++i) {
        size_t next = i % 3 == 2 ? i - 2 : i + 1;
        spread = larger(spread, fabsf(row[corner[next]] - row[corner[i]]));
    }
    return spread;
}

static void find_shares(float *out, const float *row, const uint32_t *corner, size_t count)
{
    for (size_t i = 0; i < GROUP; ++i, corner += 3)
        out[i] =
            row && i < count ? (row[corner[0]] + row[corner[1]] + row[corner[2]]) / 3.0f : 0.0f;
}

/* Finds the bone that carries the group most, and lists the other bones. Returns the index where
 * the list of the next group begins. */
static uint32_t carry_group(face *f, size_t group, const strain_frames *frames)
{
    limit_group *g = &f->limit.group[group];
    const uint32_t *corner = f->skin + 3 * GROUP * group;
    size_t count = limit_group_size(f, group);
    uint32_t next = g->first_carried;
    float main_weight = -1.0f, most[CARRIERS] = {0.0f};
    for (uint32_t bone = 0; bone < CARRIERS; ++bone) {
        const float *row = carrier_row(f, bone);
        float sum = 0.0f;
        for (size_t i = 0; row && i < 3 * count; ++i) {
            most[bone] = fmaxf(most[bone], row[corner[i]]);
            sum += row[corner[i]];
        }
        if (sum > main_weight) {
            main_weight = sum;
            g->main_bone = bone;
        }
    }
    find_shares(f->limit.patch[group].main_share, carrier_row(f, g->main_bone), corner, count);
    for (uint32_t bone = 0; bone < CARRIERS; ++bone) {
        limit_carried *c = &f->limit.carried[next];
        if (bone == g->main_bone || !(most[bone] > 0.0f))
            continue;
        *c = (limit_carried){.bone = bone,
                             .weight = most[bone],
                             .spread = spread_of(carrier_row(f, bone), corner, count)};
        find_gradient(c, carrier_row(f, bone), corner, frames, count);
        find_shares(c->share, carrier_row(f, bone), corner, count);
        next += 1;
    }
    return next;
}

/* Finds the main bones of the groups that share a vertex with each group. */
static void find_bones_around(face *f)
{
    face_limit *l = &f->limit;
    memset(l->bones_around, 0, f->rest.padded_count * sizeof *l->bones_around);
    for (size_t t = 0; t < f->skin_count; ++t)
        for (size_t i = 0; i < 3; ++i)
            l->bones_around[f->skin[3 * t + i]] |= 1u << l->group[t / GROUP].main_bone;
    for (size_t group = 0; group < limit_group_count(f); ++group)
        l->group[group].bones_around = 0;
    for (size_t t = 0; t < f->skin_count; ++t)
        for (size_t i = 0; i < 3; ++i)
            l->group[t / GROUP].bones_around |= l->bones_around[f->skin[3 * t + i]];
}

void face_limit_engage(face *f)
{
    face_limit *l = &f->limit;
    const columns *c = &f->columns;
    size_t groups = limit_group_count(f), shapes = f->shape_column_count;
    memset(l->steepest + shapes * groups, 0, (c->count - shapes) * groups * sizeof *l->steepest);
    memset(l->pull_bound, 0, groups * sizeof *l->pull_bound);
    memset(l->bounded, 0, (size_t)3 * c->count * sizeof *l->bounded);
    l->is_pose_known = false;
    for (uint32_t block = 0; block < f->rest.block_count; ++block) {
        float none[3][POINTS_BLOCK] = {{0.0f}};
        write_rows(l->posed, f->origin, none, block);
    }
    for (size_t group = 0; group < groups; ++group) {
        const uint32_t *corner = f->skin + 3 * GROUP * group;
        size_t count = limit_group_size(f, group);
        const strain_corners at = limit_corners(f, group, l->posed);
        strain_frames *frames = &l->patch[group].origin, before = *frames;
        l->loops->frames(frames, &at);
        bool is_known = memcmp(frames, &before, sizeof before) ==
                        0; /* shapes keep their values if the frames are equal */
        l->shape[group] = frames->shape;
        for (size_t column = 0; column < shapes && !is_known; ++column)
            l->steepest[column * groups + group] = 0.0f;
        bound_group(f, group);
        enclose_group(f, group);
        l->group[group + 1].first_carried = carry_group(f, group, &l->patch[group].origin);
        for (uint32_t word = 0; word < c->mark_words; ++word) {
            uint64_t marks = 0;
            for (size_t i = 0; i < 3 * count; ++i)
                marks |= c->mark[corner[i] / POINTS_BLOCK * (size_t)c->mark_words + word];
            for (; marks != 0; marks &= marks - 1) {
                size_t column = (size_t)word * COLUMNS_WORD + (size_t)__builtin_ctzll(marks);
                float *steepest = &l->steepest[column * groups + group];
                if (column >= shapes && column < f->control_column_count)
                    *steepest = steepest_in(columns_row(c, (uint32_t)column), corner,
                                            &l->patch[group].origin.shape, count, rounding_of(f));
                else if (column < shapes && !is_known) {
                    steepest = &l->steepest[column / 3 * 3 * groups + group];
                    *steepest = steepest_shape(f, column / 3 * 3, group);
                }
            }
        }
    }
    find_bones_around(f);
    limit_rooms_engage(f);
}

void limit_begin_pose(face *f)
{
    face_limit *l = &f->limit;
    if (l->is_begun)
        return;
    l->is_begun = true;
    if (f->origin == &f->free) /* the free shape changes without an engagement */
        l->is_pose_known = false;
    bool was_at_rest = l->is_pose_known && l->is_at_rest;
    l->is_pose_known = true;
    l->is_at_rest = !face_is_posed(f);
    for (uint32_t b = 0; b < f->bone_count; ++b)
        for (int i = 0; i < 9; ++i)
            l->turned[b][i] = (float)(f->pose[b].r[i / 3][i % 3] - (i % 4 == 0 ? 1.0 : 0.0));
    if (l->is_at_rest && was_at_rest)
        return;
    memset(l->pose_weight, 0, (size_t)3 * f->control_column_count * sizeof *l->pose_weight);
    memcpy(l->pose_weight + (size_t)3 * f->control_column_count,
           f->weight + (size_t)3 * f->control_column_count,
           (size_t)3 * (f->columns.count - f->control_column_count) * sizeof *l->pose_weight);
    memset(l->is_posed, 0, f->rest.block_count);
    for (size_t i = 0; i < (size_t)CARRIERS * CARRIERS; ++i)
        l->apart[i].rotation = -1.0;
    for (size_t group = 0; group < limit_group_count(f); ++group) {
        l->group_strain[group] = l->group_flip[group] = INFINITY;
    }
    memset(l->known, 0, limit_group_count(f));
    limit_rooms_pose(f);
}

/* Returns an upper bound of the angle between the rotations of a triangle of the group and of the
 * main bone. */
static angle_sincos blend_apart(face *f, const limit_group *g)
{
    double most = 0.0;
    for (uint32_t i = g->first_carried; i < g[1].first_carried; ++i)
        most += (double)f->limit.carried[i].weight *
                limit_apart_of(f, g->main_bone, f->limit.carried[i].bone)->rotation;
    return angle_of_sine(most);
}

/* Returns an upper bound of the norm of the change of a shape's three weights, a 3 x 3 matrix. */
static double size_of_change(const double *now, const double *before)
{
    double most_row = 0.0, most_column = 0.0, column[3] = {0};
    for (int i = 0; i < 3; ++i) {
        double row = 0.0;
        for (int k = 0; k < 3; ++k) {
            double d = fabs(now[3 * i + k] - before[3 * i + k]);
            row += d;
            column[k] += d;
        }
        most_row = fmax(most_row, row);
    }
    for (int k = 0; k < 3; ++k)
        most_column = fmax(most_column, column[k]);
    return sqrt(most_row * most_column);
}

/* Updates pull_bound to f->given. Sets `change` to its possible growth. */
static void follow_pulls(face *f)
{
    face_limit *l = &f->limit;
    size_t groups = limit_group_count(f);
    memset(l->change, 0, groups * sizeof *l->change);
    for (uint32_t column = 0; column < f->shape_column_count; column += 3) {
        const double *now = f->given + (size_t)3 * column;
        double *before = l->bounded + (size_t)3 * column;
        float size = (float)size_of_change(now, before);
        memcpy(before, now, 9 * sizeof *now);
        if (size > 0.0f)
            l->loops->add(l->change, l->steepest + column * groups, size, groups);
    }
    for (uint32_t column = f->shape_column_count; column < f->control_column_count; ++column) {
        const double *now = f->given + (size_t)3 * column;
        double *before = l->bounded + (size_t)3 * column;
        vec3 way = vec3_sub(vec3_row(now, 0), vec3_row(before, 0));
        float size = (float)vec3_length(way);
        memcpy(before, now, 3 * sizeof *now);
        if (size > 0.0f)
            l->loops->add(l->change, l->steepest + column * groups, size, groups);
    }
    l->loops->add(l->pull_bound, l->change, 1.0f, groups);
}

bool limit_is_shaped(const face *f)
{
    return f->shapes.count > 0 && f->shapes.amount > 0.0;
}

static strain_bounds bounds_now(face *f)
{
    face_limit *l = &f->limit;
    strain_bounds out = {.pull = l->pull_bound,
                         .change = l->change,
                         .shaped = limit_is_shaped(f) ? limit_shaped_steepness : 0.0f,
                         .strain = l->group_strain,
                         .flip = l->group_flip};
    limit_rooms_bounds(f, &out);
    return out;
}

/* Returns how far the gradient's bound in the group exceeds its limit: above 1 it allows too much
 * strain. */
static float excess_of(const strain_bounds *of, size_t group)
{
    const bool is_shaped = of->shaped > 0.0f && isfinite(of->steepness[group]);
    const float most = of->pull[group] * (is_shaped ? of->shaped : of->steepness[group]);
    const float left = of->room[group] < 1.0f ? of->room[group] : 1.0f;
    return most > 0.0f ? most / left : 0.0f;
}

/* Called for a group whose bounds allow too much. Returns whether the last measurement allows too
 * much as well. */
static bool may_be_strained(face *f, const strain_bounds *of, size_t group, limit_looks looks)
{
    face_limit *l = &f->limit;
    const float change = l->change[group], room = of->room[group];
    if (limit_is_shaped(f))
        return true;
    if (change > 0.0f) {
        float more = room > 0.0f ? change * of->steepness[group] / room : INFINITY;
        l->group_strain[group] += more;
        l->group_flip[group] += more;
    }
    return !(l->group_strain[group] < 1.0f) ||
           (looks == AT_TURNS && !(l->group_flip[group] < 1.0f));
}

void limit_write_block(const face *f, float (*row)[4], const points *origin, uint32_t block)
{
    float sum[3][POINTS_BLOCK] = {{0.0f}};
    if (face_reaches(&f->columns, f->columns.weights.live, block))
        columns_sum(&f->columns, sum, 0, block);
    write_rows(row, origin, sum, block);
}

void limit_pose_block(face *f, uint32_t block)
{
    if (f->limit.is_posed[block])
        return;
    limit_write_block(f, f->limit.posed, f->origin, block);
    f->limit.is_posed[block] = 1;
}

bool face_limit_has_sum(const face *f, uint32_t block)
{
    return f->limit.is_added_given && f->limit.is_added[block];
}

void face_limit_added(const face *f, float sum[3][POINTS_BLOCK], uint32_t block)
{
    const float(*row)[4] = (const float(*)[4])f->limit.added + (size_t)block * POINTS_BLOCK;
    for (size_t i = 0; i < POINTS_BLOCK; i += 4)
        rows_into(sum[0] + i, sum[1] + i, sum[2] + i, row + i);
}

/* Computes the displacement by the controls in a block. */
static void add_block(face *f, uint32_t block)
{
    if (f->limit.is_added[block])
        return;
    limit_write_block(f, f->limit.added, NULL, block);
    f->limit.is_added[block] = 1;
}

/* ---- measuring strain ---- */

/* Writes for each triangle of the group the largest share of the stretch left to an edge that the
 * pulls use. */
static void measure_stretches(float out[GROUP], const face *f, size_t group, float stretch)
{
    const face_limit *l = &f->limit;
    const strain_corners posed = limit_corners(f, group, l->posed);
    const strain_corners added = limit_corners(f, group, l->added);
    float longest[GROUP][3];
    for (size_t i = 0; i < posed.count; ++i)
        for (size_t e = 0; e < 3; ++e) {
            size_t t = GROUP * group + i;
            longest[i][e] = stretch * l->longest[t][e];
            if (limit_is_shaped(f)) /* the head's own shapes may stretch it */
                longest[i][e] = larger(longest[i][e], made_stretch * f->shapes.longest[t][e]);
        }
    l->loops->stretches(out, &posed, &added, (const float(*)[3])longest, room_least);
}

double limit_near_grip(const face *f, size_t t, uint32_t control)
{
    double radius = f->settings.radius;
    vec3 way = vec3_sub(points_position(f->origin, f->skin[3 * t]), f->grip[control].start);
    double q = vec3_dot(way, way) / (radius * radius);
    return q < 1.0 ? (1.0 - q) * (1.0 - q) : 0.0;
}

/* Adds the excess strain of a triangle to the controls around it, weighted by distance. */
static void strain_controls(face *f, size_t t, double strain)
{
    for (uint32_t k = 0; k < f->control_count; ++k)
        f->limit.strain[k] = fmax(f->limit.strain[k], (strain - 1.0) * limit_near_grip(f, t, k));
}

/* Computes patch.inv_tan_tilt_posed. */
static void leave_tilts(face *f, size_t group)
{
    const limit_group *g = &f->limit.group[group];
    const float *turn_cosine = f->limit.patch[group].turn_cosine_posed;
    limit_patch *patch = &f->limit.patch[group];
    const angle_sincos less = angle_add(blend_apart(f, g), angle_of_cosine((double)g->tilt_cosine));
    const bool is_known = less.sin < tilt_free.sin;
    const double enough = tilt_free.cos * less.cos + tilt_free.sin * less.sin;
    float of_angle[GROUP], cosine[GROUP];
    f->limit.known[group] |= LIMIT_TILTS;
    for (size_t i = 0; i < GROUP; ++i) {
        of_angle[i] = inv_tan_seen;
        cosine[i] = 1.0f;
        if (i >= limit_group_size(f, group) || (is_known && (double)turn_cosine[i] > enough))
            continue;
        const uint32_t *corner = f->skin + 3 * (GROUP * group + i);
        vec3 along = vec3_normalised(face_skin_along(f, corner), (vec3){0, 0, 0});
        cosine[i] = (float)((double)patch->posed.normal[0][i] * along.x +
                            (double)patch->posed.normal[1][i] * along.y +
                            (double)patch->posed.normal[2][i] * along.z);
    }
    f->limit.loops->turns(patch->inv_tan_tilt_posed, of_angle, cosine);
    for (size_t i = 0; i < GROUP; ++i)
        patch->inv_tan_tilt_posed[i] =
            larger(patch->inv_tan_tilt_posed[i], 1.0f / STRAIN_TILT_MOST);
}

/* Computes patch.inv_tan_turn_posed. Neighbours on other bones have turned another way. */
static void leave_turns(face *f, size_t group, const float *turn_cosine)
{
    limit_patch *patch = &f->limit.patch[group];
    const float cosine = (float)limit_half_apart(f, &f->limit.group[group]).cos;
    float inv_tan_turn[GROUP], apart[GROUP];
    const float *left = patch->inv_tan_turn;
    if (cosine < 1.0f) {
        for (size_t i = 0; i < GROUP; ++i)
            apart[i] = cosine;
        f->limit.loops->turns(inv_tan_turn, left, apart);
        left = inv_tan_turn;
    }
    f->limit.loops->turns(patch->inv_tan_turn_posed, left, turn_cosine);
}

void limit_strain_shapes(face *f, size_t group, double strain)
{
    const face_shapes *s = &f->shapes;
    size_t groups = limit_group_count(f);
    for (uint32_t p = 0; p < s->part_count; ++p) {
        uint32_t own = s->part[p].shape;
        double weight = s->amount * s->weight[own];
        double steep = (double)f->limit.steepest[s->part[p].column * groups + group];
        if (!(weight > 0.0))
            continue;
        s->strain[own] = fmax(s->strain[own], (strain - 1.0) * fmin(1.0, 4.0 * weight * steep));
    }
}

static void frame_group(face *f, size_t group)
{
    face_limit *l = &f->limit;
    const limit_group *g = &l->group[group];
    limit_patch *patch = &l->patch[group];
    const strain_corners posed = limit_corners(f, group, l->posed);
    const rigid motion = limit_motion_of(f, g->main_bone);
    float rotation[9];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            rotation[3 * i + j] = (float)motion.r[i][j];
    l->loops->frames(&patch->posed, &posed);
    l->loops->turned(patch->turn_cosine_posed, &patch->origin, &patch->posed, rotation);
    leave_turns(f, group, patch->turn_cosine_posed);
    l->known[group] |= LIMIT_FRAME;
}

void limit_turn_normals(face *f, size_t group)
{
    const face_limit *l = &f->limit;
    const limit_group *g = &l->group[group];
    limit_patch *patch = &l->patch[group];
    const float(*rest)[GROUP] = (const float(*)[GROUP])patch->rest_normal;
    if (l->known[group] & LIMIT_ALONG)
        return;
    l->known[group] |= LIMIT_ALONG;
    memcpy(patch->along, patch->rest_normal, sizeof patch->along);
    if (g->main_bone != STILL)
        l->loops->turn_normals(patch->along, rest, patch->main_share, l->turned[g->main_bone]);
    for (uint32_t i = g->first_carried; i < g[1].first_carried; ++i)
        if (l->carried[i].bone != STILL)
            l->loops->turn_normals(patch->along, rest, l->carried[i].share,
                                   l->turned[l->carried[i].bone]);
}

/* Returns strain_flip of a triangle of the group. */
static float flip_strain(face *f, size_t group, size_t i)
{
    const face_limit *l = &f->limit;
    const uint32_t *corner = f->skin + 3 * (GROUP * group + i);
    float e[2][3], d[2][3], n[3];
    limit_turn_normals(f, group);
    for (int axis = 0; axis < 3; ++axis) {
        n[axis] = l->patch[group].along[axis][i];
        for (int k = 0; k < 2; ++k) {
            e[k][axis] = l->posed[corner[1 + k]][axis] - l->posed[corner[0]][axis];
            d[k][axis] = l->added[corner[1 + k]][axis] - l->added[corner[0]][axis];
        }
    }
    return strain_flip((const float(*)[3])e, (const float(*)[3])d, n);
}

static double measure_shaped(face *f, size_t group, float stretch)
{
    const face_limit *l = &f->limit;
    const strain_corners posed = limit_corners(f, group, l->posed);
    const strain_corners added = limit_corners(f, group, l->added);
    strain_folds found;
    float greatest = 0.0f, drawn = 0.0f, stretched[GROUP];
    limit_turn_normals(f, group);
    l->loops->folds(&found, &posed, &added, (const float(*)[GROUP])l->patch[group].along);
    for (size_t i = 0; i < posed.count; ++i)
        drawn = larger(drawn, found.drawn[i]);
    if (drawn > 0.0f)
        measure_stretches(stretched, f, group, stretch);
    for (size_t i = 0; i < posed.count; ++i) {
        size_t t = GROUP * group + i;
        float strain = found.fold[i];
        float tears = found.drawn[i] > 0.0f ? stretched[i] : 0.0f;
        strain = tears > strain ? tears : strain;
        if (strain > 1.0f) {
            strain_controls(f, t, fmin((double)strain, strain_most));
            limit_strain_shapes(f, group, fmin((double)strain, strain_most));
        }
        greatest = strain > greatest ? strain : greatest;
    }
    return (double)greatest;
}

/* Finds the strains of a posed group. Strains of at most 1 may be upper bounds. */
static void find_strains(strain_found *out, face *f, size_t group)
{
    face_limit *l = &f->limit;
    const limit_patch *patch = &l->patch[group];
    const strain_corners added = limit_corners(f, group, l->added);
    const bool has_tilts = l->known[group] & LIMIT_TILTS;
    const float *tilts = patch->inv_tan_tilt_posed;
    float bound[GROUP], most = l->measures_all_groups ? INFINITY : 0.0f;
    if (!has_tilts) {
        const float tilted = limit_tilted(f, group);
        for (size_t i = 0; i < GROUP; ++i)
            bound[i] = tilted;
        tilts = bound;
    }
    l->loops->strains(out, &patch->posed, &l->shape[group], tilts, patch->inv_tan_turn_posed,
                      &added);
    for (size_t i = 0; i < GROUP; ++i)
        most = larger(most, out->strain[i]);
    if (has_tilts || !(most > 1.0f))
        return;
    leave_tilts(f, group);
    l->loops->strains(out, &patch->posed, &l->shape[group], patch->inv_tan_tilt_posed,
                      patch->inv_tan_turn_posed, &added);
}

static double measure_group(face *f, size_t group, float stretch)
{
    face_limit *l = &f->limit;
    const size_t count = limit_group_size(f, group);
    strain_found found;
    float greatest = 0.0f, flips = 0.0f, sizes = 0.0f, stretched[GROUP] = {0.0f};
    if (!(l->known[group] & LIMIT_FRAME))
        frame_group(f, group);
    find_strains(&found, f, group);
    for (size_t i = 0; i < GROUP; ++i) {
        greatest = larger(greatest, found.strain[i]);
        flips = larger(flips, found.flip[i]);
        sizes = larger(sizes, found.size[i]);
    }
    if (sizes > 1.0f) {
        measure_stretches(stretched, f, group, stretch);
        for (size_t i = 0; i < GROUP; ++i)
            greatest = larger(greatest, found.size[i] > 1.0f ? stretched[i] : 0.0f);
    }
    l->pull_bound[group] = found.steepest;
    l->group_strain[group] = larger(greatest, sizes);
    l->group_flip[group] = flips;
    if (!(greatest > 1.0f) && !(flips > 1.0f))
        return 0.0;
    greatest = 0.0f;
    for (size_t i = 0; i < count; ++i) {
        float strain = found.strain[i], tears = found.size[i] > 1.0f ? stretched[i] : 0.0f;
        size_t t = GROUP * group + i;
        if (strain > 1.0f &&
            strain > found.alone[i]) /* tilted by bones: check whether a fold is near */
            strain = fmaxf(found.alone[i], fminf(strain, flip_strain(f, group, i)));
        strain = tears > strain ? tears : strain;
        if (strain > 1.0f) {
            strain_controls(f, t, fmin((double)strain, strain_most));
            limit_strain_shapes(f, group, fmin((double)strain, strain_most));
        }
        if (found.flip[i] > 1.0f)
            l->candidate[l->candidate_count++] = (uint32_t)t;
        greatest = strain > greatest ? strain : greatest;
    }
    return (double)greatest;
}

/* Returns the greatest strain of f->given. Sets limit.strain to the excess around each control, and
 * limit.candidate to the triangles that may be bent too far against their neighbours. */
static double measure_strain(face *f, limit_looks looks)
{
    face_limit *l = &f->limit;
    const float stretch = (float)face_stretch_most(&f->settings);
    double greatest = 0.0;
    size_t wanted = 0, groups = limit_group_count(f);
    memset(l->strain, 0, f->control_count * sizeof *l->strain);
    for (uint32_t i = 0; i < f->shapes.count; ++i)
        f->shapes.strain[i] = 0.0;
    memset(l->is_added, 0, f->rest.block_count);
    l->is_added_given = true;
    l->candidate_count = 0;
    follow_pulls(f);
    const strain_bounds bounds = bounds_now(f);
    const bool is_shaped = limit_is_shaped(f);
    l->loops->may_strain(l->is_marked, &bounds, groups);
    columns_weigh(&f->columns, f->given, f->control_column_count);
    for (size_t group = 0; group < groups; ++group) {
        const limit_group *g = &l->group[group];
        if (!l->measures_all_groups &&
            (!l->is_marked[group] || !may_be_strained(f, &bounds, group, looks)))
            continue;
        for (uint32_t i = g->first_block; i < g[1].first_block; ++i)
            add_block(f, l->block[i]);
        if (!l->measures_all_groups && (is_shaped || excess_of(&bounds, group) < excess_surely)) {
            const strain_corners added = limit_corners(f, group, l->added);
            l->pull_bound[group] = l->loops->steepest(&l->shape[group], &added);
            if (!(excess_of(&bounds, group) >= 1.0f))
                continue;
        }
        l->wanted[wanted++] = (uint32_t)group;
    }
    columns_weigh(&f->columns, l->pose_weight, f->columns.count);
    for (size_t i = 0; i < wanted; ++i) {
        size_t group = l->wanted[i];
        const limit_group *g = &l->group[group];
        for (uint32_t k = g->first_block; k < g[1].first_block; ++k)
            limit_pose_block(f, l->block[k]);
        greatest = fmax(greatest, is_shaped ? measure_shaped(f, group, stretch)
                                            : measure_group(f, group, stretch));
    }
    return greatest;
}

/* ---- the part that is given ---- */

/* Sets likeness: how far two controls ride on the same bones, 0..1. */
static void compare_controls(face *f)
{
    face_limit *l = &f->limit;
    uint32_t count = f->control_count;
    for (size_t i = 0; i < count; ++i) {
        const face_grip *a = &f->grip[i];
        vec3_set_row(l->centre, i, a->start);
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

/* Sets limit.asked to the weights of the controls' columns, with the bones at rest. */
static void find_asked(face *f)
{
    memset(f->limit.asked, 0, (size_t)3 * f->control_count * sizeof *f->limit.asked);
    for (uint32_t b = f->bone_count; b-- > 0;) {
        const face_field *field = &f->field[b];
        const rigid back = rigid_inverse(&f->pose[b]);
        for (uint32_t i = 0; i < field->control_count; ++i) {
            const double *w = f->weight + (size_t)3 * (field->first_column + i);
            double *g = f->limit.asked + (size_t)3 * field->control[i];
            vec3 pull = vec3_row(w, 0);
            if (f->bones.moves[b])
                pull = rigid_rotate(&back, pull);
            vec3_set_row(g, 0, pull);
        }
    }
}

void limit_apply(face *f)
{
    f->limit.is_added_given = false;
    face_shapes_apply(f);
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        for (uint32_t i = 0; i < field->control_count; ++i) {
            const double *g = f->limit.g + (size_t)3 * field->control[i];
            double *w = f->given + (size_t)3 * (field->first_column + i);
            vec3 pull = vec3_row(g, 0);
            if (f->bones.moves[b])
                pull = rigid_rotate(&f->pose[b], pull);
            vec3_set_row(w, 0, pull);
        }
    }
}

void limit_solve_fields(face *f)
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

void limit_note_held_back(face *f)
{
    double most = 0.0;
    for (uint32_t k = 0; k < f->control_count; ++k) {
        vec3 missing = vec3_sub(vec3_row(f->limit.asked, k), vec3_row(f->limit.g, k));
        missing = vec3_scale(missing, f->grip[k].mobility);
        missing = vec3_add(missing, face_shapes_missing(f, k));
        most = fmax(most, vec3_length(missing));
    }
    f->meter.held_back_mm = most;
}

static void give_part(face *f, double part)
{
    for (size_t i = 0; i < (size_t)3 * f->control_count; ++i)
        f->limit.g[i] *= part;
    for (uint32_t i = 0; i < f->shapes.count; ++i)
        f->shapes.given[i] *= part;
    limit_apply(f);
}

/* Scales f->given on a head with shapes until no skin is strained too much. 1 / strain is exact for
 * other heads, and here usually good enough at the second try. Otherwise bisection finds a factor
 * above 0. */
static void part_shaped(face *f)
{
    double strain = measure_strain(f, AT_STRAINS), low = 0.0, high = 1.0, part = 1.0;
    for (int i = 0; i < PARTINGS && strain > shaped_most && isfinite(strain); ++i) {
        give_part(f, 1.0 / strain);
        strain = measure_strain(f, AT_STRAINS);
    }
    if (!(strain > shaped_most))
        return;
    for (int i = 0; i < HALVINGS; ++i) {
        double middle = 0.5 * (low + high);
        give_part(f, middle / part);
        part = middle;
        if (measure_strain(f, AT_STRAINS) > shaped_most)
            high = middle;
        else
            low = middle;
    }
    give_part(f, low / part);
}

/* Softens the pulls where they strain the skin. Returns the factor for all pulls that is still
 * needed. */
static double yield_pulls(face *f, double strain)
{
    face_limit *l = &f->limit;
    size_t numbers = (size_t)3 * f->control_count;
    compare_controls(f);
    memset(l->ridge, 0, f->control_count * sizeof *l->ridge);
    double ridge = softening;
    for (int i = 0; i < SOFTENINGS && strain > 1.0; ++i, ridge *= softening_more) {
        for (uint32_t k = 0; k < f->control_count; ++k)
            l->ridge[k] += ridge * l->strain[k];
        for (uint32_t k = 0; k < f->shapes.count; ++k)
            f->shapes.given[k] /= 1.0 + f->shapes.strain[k];
        memcpy(l->g, l->asked, numbers * sizeof *l->g);
        csrbf_soften(l->g, &f->settings, l->centre, l->likeness, l->ridge, f->control_count,
                     l->scratch);
        limit_apply(f);
        strain = measure_strain(f, AT_STRAINS);
    }
    strain = measure_strain(f, AT_TURNS);
    return strain > 1.0 ? (isfinite(strain) ? 1.0 / strain : 0.0) : 1.0;
}

/* Poses the vertices around the candidates: by the bones alone in shown_before, and with this part
 * of the controls' displacement in shown_after. */
static void pose_candidates(face *f, float part)
{
    face_limit *l = &f->limit;
    for (uint32_t i = 0; i < l->candidate_count; ++i) {
        uint32_t around[6];
        if (!surface_meter_around(f->surface_meter, l->candidate[i], around))
            continue;
        for (int k = 0; k < 6; ++k) {
            uint32_t slot = around[k];
            const float *posed = l->posed[slot], *added = l->added[slot];
            limit_set_vertex(&l->shown_before, slot, posed);
            l->shown_after.x[slot] = posed[0] + part * added[0];
            l->shown_after.y[slot] = posed[1] + part * added[1];
            l->shown_after.z[slot] = posed[2] + part * added[2];
        }
    }
}

/* Computes `added` and `posed` in the blocks around the candidates. */
static void find_candidates(face *f)
{
    face_limit *l = &f->limit;
    for (int weighed = 0; weighed < 2; ++weighed) {
        if (weighed == 0)
            columns_weigh(&f->columns, f->given, f->control_column_count);
        else
            columns_weigh(&f->columns, l->pose_weight, f->columns.count);
        for (uint32_t i = 0; i < l->candidate_count; ++i) {
            uint32_t around[6];
            if (!surface_meter_around(f->surface_meter, l->candidate[i], around))
                continue;
            for (int k = 0; k < 6; ++k)
                if (weighed == 0)
                    add_block(f, around[k] / POINTS_BLOCK);
                else
                    limit_pose_block(f, around[k] / POINTS_BLOCK);
        }
    }
}

/* Returns the greatest bend of the candidates' edges over its limit, with that part of the
 * controls' displacement. */
static double bend_of_part(face *f, double part)
{
    face_limit *l = &f->limit;
    const float *before[3], *after[3];
    pose_candidates(f, (float)part);
    return surface_meter_bend(f->surface_meter, &limit_bends, l->candidate, l->candidate_count,
                              points_streams(&l->shown_before, before),
                              points_streams(&l->shown_after, after));
}

/* Returns a part of the controls' displacement with which no candidate is bent too far. */
static double part_unbent(face *f)
{
    double low = 0.0, high = 1.0;
    if (!(bend_of_part(f, 1.0) > 1.0))
        return 1.0;
    for (int i = 0; i < UNBENDINGS; ++i) {
        double middle = 0.5 * (low + high);
        if (bend_of_part(f, middle) > 1.0)
            high = middle;
        else
            low = middle;
    }
    return low;
}

/* Reduces controls near edges that are bent too far, at most to `part` of their pulls. */
static void yield_to_bends(face *f, double part)
{
    face_limit *l = &f->limit;
    const float *before[3], *after[3];
    const double most = bend_of_part(f, 1.0);
    for (uint32_t k = 0; k < f->control_count; ++k)
        l->tip_share[k] = 1.0;
    for (uint32_t i = 0; i < l->candidate_count; ++i) {
        double nearest = 1e-6;
        double bend = surface_meter_bend(f->surface_meter, &limit_bends, l->candidate + i, 1,
                                         points_streams(&l->shown_before, before),
                                         points_streams(&l->shown_after, after));
        if (!(bend > 1.0))
            continue;
        for (uint32_t k = 0; k < f->control_count; ++k)
            nearest = fmax(nearest, limit_near_grip(f, l->candidate[i], k));
        for (uint32_t k = 0; k < f->control_count; ++k) {
            double near =
                limit_near_grip(f, l->candidate[i], k) / nearest * (bend - 1.0) / (most - 1.0);
            l->tip_share[k] = fmin(l->tip_share[k], 1.0 - (1.0 - part) * near);
        }
    }
    for (size_t i = 0; i < (size_t)3 * f->control_count; ++i)
        l->g[i] *= l->tip_share[i / 3];
}

/* Judges the candidates edge by edge and reduces the pulls near edges that are bent too far. Takes
 * and returns the part of f->given to apply; the returned part corrects the rest. */
static double unbend(face *f, double part)
{
    find_candidates(f);
    if (!(bend_of_part(f, part) > 1.0))
        return part;
    if (part < 1.0) {
        give_part(f, part);
        (void)measure_strain(f, AT_TURNS);
        find_candidates(f);
    }
    for (int i = 0; i < BEND_YIELDS && (part = part_unbent(f)) < 1.0; ++i) {
        yield_to_bends(f, part);
        limit_apply(f);
        (void)measure_strain(f, AT_TURNS);
        find_candidates(f);
    }
    return part_unbent(f);
}

/* Gives this part of limit.centre. Returns face_min_determinant minus its least allowed value. */
static double room_of_part(face *f, double part)
{
    for (size_t i = 0; i < (size_t)3 * f->control_count; ++i)
        f->limit.g[i] = part * f->limit.centre[i];
    limit_solve_fields(f);
    return face_min_determinant(f) - determinant_least;
}

/* Reduces the pulls of a face without a rig. Its field is defined in space and can fold off the
 * skin, where no triangle shows it. Finds the root by the Illinois variant of false position. */
static void unfold(face *f)
{
    const double slope_safe =
        1.0 - cbrt(determinant_least); /* (1 - slope)^3 is a lower bound of the determinant */
    face_limit *l = &f->limit;
    if (f->rig || f->meter.slope_bound <= slope_safe)
        return;
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
    limit_apply(f);
    f->is_held = true;
}

static void limit_pulls(face *f)
{
    memcpy(f->given, f->weight, (size_t)3 * f->columns.count * sizeof *f->given);
    f->is_given = true;
    for (uint32_t i = 0; i < f->shapes.count; ++i)
        f->shapes.given[i] = 1.0;
    if (f->origin == &f->free) /* keep the result of the drag's own limit */
        return;
    f->meter.held_back_mm = 0.0;
    bool moves = f->control_count > 0 || face_shapes_weigh_something(f);
    find_asked(f);
    memcpy(f->limit.g, f->limit.asked, (size_t)3 * f->control_count * sizeof *f->limit.g);
    if (!moves || (f->control_count > 0 && f->settings.stretch_most < 0.0))
        return;
    limit_begin_pose(f);
    double strain = measure_strain(f, AT_TURNS), part = 1.0;
    f->is_held = strain > 1.0;
    if (strain > 1.0)
        part = yield_pulls(f, strain);
    if (f->limit.candidate_count > 0)
        part = unbend(f, part);
    if (part < 1.0)
        give_part(f, part);
    if (part < 1.0 && limit_is_shaped(f))
        part_shaped(f);
    f->is_held = memcmp(f->limit.g, f->limit.asked,
                        (size_t)3 * f->control_count * sizeof *f->limit.g) != 0 ||
                 face_shapes_are_held(f);
    if (f->is_held)
        limit_solve_fields(f);
    unfold(f);
    if (f->is_held)
        limit_note_held_back(f);
}

void face_limit_pull(face *f)
{
    f->limit.is_added_given = false;
    if (f->is_given)
        return;
    f->limit.is_begun = f->limit.gives_less = false;
    projection_pose(&f->projection, f->pose, f->blocks.is_stale);
    limit_pulls(f);
    limit_lips(f);
}
