/* Computes how much room the bones leave for pulls, as a bound for each group of triangles.
 *
 * The main bone of a group is the bone that carries most of it. Relative to that bone, a pose maps
 * the group by
 *   A = B + sum_b u_b g_b^T + E,   B = I + sum_b w_b (R_b - I),
 * summed over the other bones that carry it. w_b is the share of a bone, g_b the gradient of the
 * share, M_b = (R_b, t_b) its motion relative to the main bone, and u_b = M_b x - x. E covers the
 * differences of shares within a triangle.
 * Let d_b be the norm of R_b - I. B turns a vector by at most the sum of w_b d_b. As the shares add
 * up to 1, B leaves of a unit vector
 *   |B x|^2 = 1 - sum_{b<c} w_b w_c |R_b x - R_c x|^2,   |R_b x - R_c x| <= d_b + d_c,
 * which is close to 1: blending rotations shrinks by the square of their angle. The steepest u g^T
 * counts with its direction, so that stretching does not count as squeezing. The others and E count
 * by their norm. From this strain_rooms bounds how much A shrinks a vector, and how far it tilts a
 * triangle. So a gradient over the origin is bounded in the posed skin. */
#include "face/frame/limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The entries of strain_blends that belong to a pair of bones. They begin at the end of the pair
 * before. */
typedef struct limit_pair {
    uint32_t main_bone, bone, end; /* end index */
} limit_pair;

typedef struct limit_rooms {
    strain_blends blend;
    strain_rooms of;
    float *room;                    /* of each group */
    uint32_t *group;                /* group of each entry */
    float *share, *spread;          /* of each entry: limit_carried */
    float *shares, *total;          /* of each group: sums over its entries, see add_blends */
    uint32_t *beside, beside_count; /* groups with neighbours that have another main bone */
    limit_pair *pair;
    uint32_t pair_count;
    bool is_known; /* in this pose */
} limit_rooms;

mrt_result limit_rooms_create(face *f, error *err)
{
    arrays *a = &f->arrays;
    const size_t groups = limit_group_count(f) + 1, entries = groups * CARRIERS;
    limit_rooms *r = f->limit.rooms = arrays_add(a, 1, sizeof *r);
    if (!r)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the limits of %u triangles",
                         f->skin_count);
    strain_blends *b = &r->blend;
    float **const of_entries[] = {&b->centre[0],   &b->centre[1],   &b->centre[2],   &b->radius,
                                  &b->gradient[0], &b->gradient[1], &b->gradient[2], &b->length,
                                  &b->off,         &b->along,       &b->steep,       &r->share,
                                  &r->spread};
    float **const of_groups[] = {&r->of.blended, &r->of.unlike,    &r->of.along,    &r->of.steep,
                                 &r->of.lost,    &r->of.apart,     &r->of.rounding, &r->of.tilt,
                                 &r->of.turn,    &r->of.steepness, &r->of.tilted,   &r->room,
                                 &r->shares,     &r->total};
    for (size_t i = 0; i < sizeof of_entries / sizeof *of_entries; ++i)
        *of_entries[i] = arrays_add(a, entries, sizeof(float));
    for (size_t i = 0; i < sizeof of_groups / sizeof *of_groups; ++i)
        *of_groups[i] = arrays_add(a, groups, sizeof(float));
    r->group = arrays_add(a, entries, sizeof *r->group);
    r->beside = arrays_add(a, groups, sizeof *r->beside);
    r->pair = arrays_add(a, (size_t)CARRIERS * CARRIERS, sizeof *r->pair);
    return a->failed ? error_set(err, MRT_ERR_MEMORY, "no memory for the limits of %u triangles",
                                 f->skin_count)
                     : MRT_OK;
}

/* ---- an engagement ---- */

static void set_entry(limit_rooms *r, uint32_t at, uint32_t group, const limit_group *g,
                      const limit_carried *c)
{
    float square = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        r->blend.centre[axis][at] = g->centre[axis];
        r->blend.gradient[axis][at] = c->gradient[axis];
        square += c->gradient[axis] * c->gradient[axis];
    }
    r->blend.radius[at] = g->radius;
    r->blend.length[at] = sqrtf(square);
    r->blend.off[at] = c->apart;
    r->share[at] = c->weight;
    r->spread[at] = c->spread;
    r->group[at] = group;
}

/* Lists the groups with this main bone that `bone` carries, too. Returns the new end. */
static uint32_t list_pair(face *f, uint32_t main_bone, uint32_t bone, uint32_t at)
{
    const face_limit *l = &f->limit;
    for (uint32_t group = 0; group < limit_group_count(f); ++group) {
        const limit_group *g = &l->group[group];
        if (g->main_bone != main_bone)
            continue;
        for (uint32_t i = g->first_carried; i < g[1].first_carried; ++i)
            if (l->carried[i].bone == bone)
                set_entry(l->rooms, at++, group, g, &l->carried[i]);
    }
    return at;
}

void limit_rooms_engage(face *f)
{
    limit_rooms *r = f->limit.rooms;
    uint32_t carriers = 0, end = 0;
    r->pair_count = r->beside_count = 0;
    for (uint32_t group = 0; group < limit_group_count(f); ++group) {
        const limit_group *g = &f->limit.group[group];
        carriers |= 1u << g->main_bone;
        for (uint32_t i = g->first_carried; i < g[1].first_carried; ++i)
            carriers |= 1u << f->limit.carried[i].bone;
        r->of.apart[group] = 0.0f;
        if ((g->bones_around & ~(1u << g->main_bone)) != 0)
            r->beside[r->beside_count++] = group;
        r->of.rounding[group] = g->rounding;
        r->of.tilt[group] = acosf(g->tilt_cosine);
        r->of.turn[group] = atanf(1.0f / g->inv_tan_turn);
        r->of.steepness[group] = g->steepness;
    }
    for (uint32_t a = carriers; a != 0; a &= a - 1)
        for (uint32_t b = carriers; b != 0; b &= b - 1) {
            const uint32_t main_bone = (uint32_t)__builtin_ctz(a),
                           bone = (uint32_t)__builtin_ctz(b);
            const uint32_t first = end;
            end = list_pair(f, main_bone, bone, first);
            if (end > first)
                r->pair[r->pair_count++] = (limit_pair){main_bone, bone, end};
        }
}

/* ---- a pose ---- */

rigid limit_motion_of(const face *f, uint32_t bone)
{
    return bone == STILL ? rigid_identity() : f->pose[bone];
}

const limit_apart *limit_apart_of(face *f, uint32_t main_bone, uint32_t bone)
{
    limit_apart *out = &f->limit.apart[main_bone * CARRIERS + bone];
    if (out->rotation >= 0.0)
        return out;
    const rigid main_motion = limit_motion_of(f, main_bone), motion = limit_motion_of(f, bone);
    const rigid back = rigid_inverse(&main_motion);
    double square = 0.0;
    out->motion = rigid_compose(&back, &motion);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double off = out->motion.r[i][j] - (i == j ? 1.0 : 0.0);
            square += off * off;
        }
    out->rotation = sqrt(0.5 * square);
    return out;
}

static double half_apart(face *f, const limit_group *g)
{
    double most = 0.0;
    for (uint32_t left = g->bones_around & ~(1u << g->main_bone); left != 0; left &= left - 1) {
        double turn = limit_apart_of(f, g->main_bone, (uint32_t)__builtin_ctz(left))->rotation;
        most = 0.5 * turn > most ? 0.5 * turn : most;
    }
    return most < 1.0 ? most : 1.0;
}

angle_sincos limit_half_apart(face *f, const limit_group *g)
{
    const double sine = half_apart(f, g);
    return (angle_sincos){.cos = sqrt(1.0 - sine * sine), .sin = sine};
}

/* Adds the effect of a pair's bone to its groups. of.unlike becomes sum w d^2; of.lost includes |u|
 * |g| of all but the steepest blend. */
static void add_blends(limit_rooms *r, uint32_t first, uint32_t end, float turn)
{
    for (uint32_t i = first; i < end; ++i) {
        const uint32_t g = r->group[i];
        const float w = r->share[i], n = r->blend.steep[i], by = w * turn;
        r->shares[g] += w;
        r->total[g] += by * by;
        r->of.blended[g] += by;
        r->of.unlike[g] += by * turn;
        r->of.lost[g] += r->spread[i] * turn;
        if (n > r->of.steep[g]) {
            r->of.lost[g] += r->of.steep[g];
            r->of.steep[g] = n;
            r->of.along[g] = r->blend.along[i];
        } else {
            r->of.lost[g] += n;
        }
    }
}

/* Completes sum_{b<c} w_b w_c (d_b + d_c)^2, where the main bone (d = 0, w <= 1) is one of the
 * bones. add_blends has already summed the pairs with the main bone. */
static void add_cross_terms(limit_rooms *r, size_t groups)
{
    float *restrict unlike = r->of.unlike;
    const float *restrict shares = r->shares, *restrict total = r->total,
                          *restrict blended = r->of.blended;
    for (size_t i = 0; i < groups; ++i)
        unlike[i] += shares[i] * unlike[i] + blended[i] * blended[i] - 2.0f * total[i];
}

void limit_rooms_pose(face *f)
{
    f->limit.rooms->is_known = false;
}

static limit_rooms *find_rooms(face *f)
{
    limit_rooms *r = f->limit.rooms;
    if (r->is_known)
        return r;
    r->is_known = true;
    const size_t groups = limit_group_count(f);
    float *const sums[] = {r->of.blended, r->of.unlike, r->of.along, r->of.steep,
                           r->of.lost,    r->shares,    r->total};
    for (size_t i = 0; i < sizeof sums / sizeof *sums; ++i)
        memset(sums[i], 0, groups * sizeof(float));
    for (uint32_t i = 0; i < r->pair_count; ++i) {
        const limit_pair *pair = &r->pair[i];
        const uint32_t first = i > 0 ? pair[-1].end : 0;
        const limit_apart *apart = limit_apart_of(f, pair->main_bone, pair->bone);
        const rigid *by = &apart->motion;
        const float motion[12] = {(float)(by->r[0][0] - 1.0), (float)by->r[0][1],
                                  (float)by->r[0][2],         (float)by->t.x,
                                  (float)by->r[1][0],         (float)(by->r[1][1] - 1.0),
                                  (float)by->r[1][2],         (float)by->t.y,
                                  (float)by->r[2][0],         (float)by->r[2][1],
                                  (float)(by->r[2][2] - 1.0), (float)by->t.z};
        f->limit.loops->blends(&r->blend, motion, (float)apart->rotation, first, pair->end);
        add_blends(r, first, pair->end, (float)apart->rotation);
    }
    add_cross_terms(r, groups);
    for (uint32_t i = 0; i < r->beside_count; ++i) {
        const uint32_t group = r->beside[i];
        const float sine = (float)half_apart(f, &f->limit.group[group]);
        r->of.apart[group] = sine + 0.5708f * sine * sine * sine;
    }
    f->limit.loops->rooms(r->room, &r->of, groups);
    return r;
}

float limit_room(face *f, size_t group)
{
    return find_rooms(f)->room[group];
}

float limit_tilted(face *f, size_t group)
{
    return find_rooms(f)->of.tilted[group];
}

void limit_rooms_bounds(face *f, strain_bounds *out)
{
    const limit_rooms *r = find_rooms(f);
    out->steepness = r->of.steepness;
    out->room = r->room;
}
