/* Limits the motion of skin after the pulls: by the seal of the lips (face_lips.c), and by the
 * skull and teeth under the skin (projection.h). Where the seal folds skin or bends an edge too
 * far, less of it is applied. Where lips that only touch, the skull or teeth do so, pulls are
 * reduced: first the pulls near that skin, then all. */
#include "face/frame/limit.h"
#include "face/frame/rows.h"

#include <math.h>
#include <string.h>

/* ---- one group ---- */

/* Returns the least area of the group's triangles, projected along the normals that the bones turn,
 * over the area at rest. Sets limit.candidate to the triangles whose edges may be bent too far. */
static float see_group(face *f, size_t group, const float (*row)[4])
{
    face_limit *l = &f->limit;
    const limit_patch *patch = &l->patch[group];
    const strain_corners at = {row, f->skin + 3 * GROUP * group, limit_group_size(f, group)};
    const angle_sincos apart = limit_half_apart(f, &l->group[group]);
    const strain_turns may_turn = {patch->turn_cosine, patch->turn_sine, (float)apart.cos,
                                   (float)apart.sin};
    strain_seen seen;
    float least = 1.0f;
    limit_turn_normals(f, group);
    l->loops->seen(&seen, &at, (const float(*)[GROUP])patch->along, &may_turn);
    l->candidate_count = 0;
    for (size_t i = 0; i < GROUP; ++i) {
        least = seen.area[i] < least ? seen.area[i] : least;
        if (seen.turned[i] > 0.0f)
            l->candidate[l->candidate_count++] = (uint32_t)(GROUP * group + i);
    }
    return least;
}

/* Returns true if an edge of a candidate is bent too far in row_after, and further than in
 * row_before. */
static bool candidates_are_bent(face *f, const float (*row_before)[4], const float (*row_after)[4])
{
    face_limit *l = &f->limit;
    const float *before[3], *after[3];
    for (uint32_t i = 0; i < l->candidate_count; ++i) {
        uint32_t around[6];
        if (!surface_meter_around(f->surface_meter, l->candidate[i], around))
            continue;
        for (int k = 0; k < 6; ++k) {
            limit_set_vertex(&l->shown_before, around[k], row_before[around[k]]);
            limit_set_vertex(&l->shown_after, around[k], row_after[around[k]]);
        }
    }
    return surface_meter_bend(f->surface_meter, &limit_bends, l->candidate, l->candidate_count,
                              points_streams(&l->shown_before, before),
                              points_streams(&l->shown_after, after)) > 1.0;
}

/* ---- reducing the pulls ---- */

/* Sets limit.tip_share to how near each control is to the groups in limit.harmed, 0..1; the nearest
 * has 1. Sets shapes.strain to how much each shape acts there. */
static void find_harmed_controls(face *f)
{
    face_limit *l = &f->limit;
    memset(l->tip_share, 0, f->control_count * sizeof *l->tip_share);
    for (uint32_t i = 0; i < f->shapes.count; ++i)
        f->shapes.strain[i] = 0.0;
    for (uint32_t i = 0; i < l->harmed_count; ++i) {
        const size_t triangle = (size_t)GROUP * l->harmed[i];
        double nearest = 1e-6;
        limit_strain_shapes(f, l->harmed[i], 2.0);
        for (uint32_t k = 0; k < f->control_count; ++k)
            nearest = fmax(nearest, limit_near_grip(f, triangle, k));
        for (uint32_t k = 0; k < f->control_count; ++k)
            l->tip_share[k] = fmax(l->tip_share[k], limit_near_grip(f, triangle, k) / nearest);
    }
}

/* Reduces the pulls limit.centre and the shapes limit.shaped. less 0: not at all; 1: by tip_share
 * and shape_share; 2: to 0. Linear in between. */
static void give_less(face *f, double less)
{
    face_limit *l = &f->limit;
    const double near = fmin(less, 1.0), all = fmax(less - 1.0, 0.0);
    for (size_t i = 0; i < (size_t)3 * f->control_count; ++i)
        l->g[i] = l->centre[i] * (1.0 - fmax(near * l->tip_share[i / 3], all));
    for (uint32_t i = 0; i < f->shapes.count; ++i)
        f->shapes.given[i] = l->shaped[i] * (1.0 - fmax(near * l->shape_share[i], all));
    limit_apply(f);
}

/* Reduces the pulls until `harms` returns false for f->given, no further than necessary. Each call
 * of `harms` leaves the shape of f->given. Returns false, without a change, if `harms` is true even
 * without pulls. */
static bool yield_to(face *f, bool (*harms)(face *f))
{
    face_limit *l = &f->limit;
    double low = 0.0, high = 1.0;
    find_harmed_controls(f);
    l->gives_less = true;
    memcpy(l->centre, l->g, (size_t)3 * f->control_count * sizeof *l->g);
    for (uint32_t i = 0; i < f->shapes.count; ++i) {
        l->shaped[i] = f->shapes.given[i];
        l->shape_share[i] = f->shapes.strain[i];
    }
    give_less(f, high);
    if (harms(f)) {
        low = 1.0, high = 2.0;
        give_less(f, high);
        if (harms(f)) {
            give_less(f, 0.0);
            (void)harms(f);
            return false;
        }
    }
    for (int i = 0; i < HALVINGS; ++i) {
        double middle = 0.5 * (low + high);
        give_less(f, middle);
        if (harms(f))
            low = middle;
        else
            high = middle;
    }
    give_less(f, high);
    (void)harms(f);
    limit_solve_fields(f);
    f->is_held = true;
    limit_note_held_back(f);
    return true;
}

/* ---- the lips ---- */

static const float lips_rounding = 1e-4f; /* of an area */
static const double yield_reach = 0.2;    /* of the width of the mouth */

/* Computes lips.bare: the skin in reach of the seal, moved by bones and pulls alone. */
static void find_bare_lips(face *f)
{
    columns_weigh(&f->columns, f->given, f->columns.count);
    for (uint32_t i = 0; i < f->lips.block_count; ++i)
        limit_write_block(f, f->lips.bare, f->origin, f->lips.block[i]);
}

/* Computes lips.sealed: the same with the seal. */
static void find_sealed_lips(face *f)
{
    const face_lips *l = &f->lips;
    for (uint32_t i = 0; i < l->block_count; ++i) {
        float sum[3][POINTS_BLOCK];
        size_t first = (size_t)l->block[i] * POINTS_BLOCK;
        memset(sum, 0, sizeof sum);
        face_lips_sum(f, sum, l->block[i]);
        for (size_t v = 0; v < POINTS_BLOCK; v += 4) {
            rows_four r[4];
            rows_from(r, sum[0] + v, sum[1] + v, sum[2] + v);
            for (size_t k = 0; k < 4; ++k)
                rows_store(l->sealed[first + v + k], rows_load(l->bare[first + v + k]) + r[k]);
        }
    }
}

/* Returns true if the seal folds a triangle in lips.group i, or bends an edge too far, and bones
 * and pulls alone do not. */
static bool is_harmed_by_lips(face *f, uint32_t i)
{
    const float(*bare)[4] = (const float(*)[4])f->lips.bare;
    const float(*sealed)[4] = (const float(*)[4])f->lips.sealed;
    size_t group = f->lips.group[i];
    float least = see_group(f, group, sealed);
    if (f->limit.candidate_count > 0 && !limit_is_shaped(f) && candidates_are_bent(f, bare, sealed))
        return true;
    return least < STRAIN_FOLD_ROOM &&
           least < fminf(see_group(f, group, bare), STRAIN_FOLD_ROOM) - lips_rounding;
}

/* Returns true if the bounds of the gradients of pulls and seal allow such harm. */
static bool may_lips_harm(face *f, uint32_t i)
{
    const face_lips *l = &f->lips;
    const limit_group *g = &f->limit.group[l->group[i]];
    bool is_bounded = f->origin == &f->base && !f->limit.gives_less &&
                      (f->control_count == 0 || !(f->settings.stretch_most < 0.0));
    float steepness =
        limit_is_shaped(f) && isfinite(g->steepness) ? limit_shaped_steepness : g->steepness;
    float most = (f->limit.pull_bound[l->group[i]] + l->steepness[i]) * steepness;
    return !is_bounded || f->limit.measures_all_groups || !(most < 1.0f) ||
           !(most < limit_room(f, l->group[i]));
}

/* Returns true if the seal at that strength harms skin. */
static bool lips_harm(face *f, double strength)
{
    const face_lips *l = &f->lips;
    if (l->count == 0)
        return false;
    face_lips_solve(f, strength);
    face_lips_bound(f);
    find_sealed_lips(f);
    for (uint32_t i = 0; l->is_meeting && i < l->group_count; ++i)
        if (may_lips_harm(f, i) && is_harmed_by_lips(f, i))
            return true;
    return false;
}

/* Computes lips.near: how near each station is to skin that the seal harms, 0..1. */
static void find_harmed_stations(face *f)
{
    face_lips *l = &f->lips;
    const double reach_mm = yield_reach * f->binding.lips.width_mm;
    memset(l->near, 0, l->count * sizeof *l->near);
    for (uint32_t i = 0; i < l->group_count; ++i) {
        const uint32_t *corner = f->skin + (size_t)3 * GROUP * l->group[i];
        if (!is_harmed_by_lips(f, i))
            continue;
        for (uint32_t k = 0; k < l->count; ++k) {
            vec3 way = vec3_sub(points_position(&f->rest, *corner), vec3_row(l->rest, k));
            double q = vec3_dot(way, way) / (reach_mm * reach_mm);
            l->near[k] = fmax(l->near[k], q < 1.0 ? (1.0 - q) * (1.0 - q) : 0.0);
        }
    }
}

/* Sets limit.harmed to the groups that the current seal harms. */
static void list_harmed_by_lips(face *f)
{
    f->limit.harmed_count = 0;
    for (uint32_t i = 0; i < f->lips.group_count; ++i)
        if (is_harmed_by_lips(f, i))
            f->limit.harmed[f->limit.harmed_count++] = f->lips.group[i];
}

static bool touching_lips_harm(face *f)
{
    find_bare_lips(f);
    return lips_harm(f, 0.0);
}

/* Sets *share to the greatest value with which the seal harms nothing. Returns false, with 0, if it
 * always does. */
static bool find_share(face *f, double *share)
{
    double low = 0.0, high = 1.0;
    for (int i = 0; i < HALVINGS; ++i) {
        *share = 0.5 * (low + high);
        if (lips_harm(f, 1.0))
            high = *share;
        else
            low = *share;
    }
    *share = low;
    return !lips_harm(f, 1.0);
}

void limit_lips(face *f)
{
    face_lips *l = &f->lips;
    l->share = l->share_near = 1.0;
    face_lips_solve(f, 1.0);
    if (!l->is_meeting)
        return;
    limit_begin_pose(f);
    find_bare_lips(f);
    if (!lips_harm(f, 1.0))
        return;
    if (f->control_count > 0 && !(f->settings.stretch_most < 0.0) && f->origin == &f->base &&
        lips_harm(f, 0.0)) {
        list_harmed_by_lips(f);
        (void)yield_to(f, touching_lips_harm);
    }
    if (!lips_harm(f, 1.0))
        return;
    find_harmed_stations(f);
    if (!find_share(f, &l->share_near))
        (void)find_share(f, &l->share);
}

/* ---- skull and teeth ---- */

static const float slid_least = 0.02f; /* least share of its area at rest that a triangle keeps */

/* Copies a block of f->shown to limit.slid, once per judgement. */
static void copy_slid_block(face *f, uint32_t block)
{
    const size_t first = (size_t)block * POINTS_BLOCK;
    if (f->limit.is_slid[block])
        return;
    f->limit.is_slid[block] = 1;
    for (size_t slot = first; slot < first + POINTS_BLOCK; slot += 4) {
        rows_four r[4];
        rows_from(r, f->shown.x + slot, f->shown.y + slot, f->shown.z + slot);
        for (size_t i = 0; i < 4; ++i)
            rows_store(f->limit.slid[slot + i], r[i]);
    }
}

/* Returns true if the group is folded in f->shown, or bent too far and further than by the bones
 * alone. */
static bool is_harmed_as_shown(face *f, size_t group)
{
    face_limit *l = &f->limit;
    const limit_group *g = &l->group[group];
    for (uint32_t i = g->first_block; i < g[1].first_block; ++i)
        copy_slid_block(f, l->block[i]);
    if (see_group(f, group, (const float(*)[4])l->slid) < slid_least)
        return true;
    if (l->candidate_count == 0 || limit_is_shaped(f))
        return false;
    columns_weigh(&f->columns, l->pose_weight, f->columns.count);
    for (uint32_t i = 0; i < l->candidate_count; ++i) {
        uint32_t around[6];
        if (!surface_meter_around(f->surface_meter, l->candidate[i], around))
            continue;
        for (int k = 0; k < 6; ++k) {
            copy_slid_block(f, around[k] / POINTS_BLOCK);
            limit_pose_block(f, around[k] / POINTS_BLOCK);
        }
    }
    columns_weigh(&f->columns, f->given, f->columns.count);
    return candidates_are_bent(f, (const float(*)[4])l->posed, (const float(*)[4])l->slid);
}

/* Sets limit.is_marked for the groups with a vertex that skull or teeth have pushed. */
static void mark_pushed(face *f, const uint64_t *pushed)
{
    face_limit *l = &f->limit;
    memset(l->is_marked, 0, limit_group_count(f));
    for (uint32_t block = 0; block < f->rest.block_count; ++block)
        for (uint32_t i = l->first_of[block]; pushed[block] && i < l->first_of[block + 1]; ++i)
            l->is_marked[l->group_of[i].group] |= (l->group_of[i].corners & pushed[block]) != 0;
}

/* Sets limit.harmed to the groups that skull or teeth push, and that are folded or bent too far.
 * Returns true if there are any. */
static bool slid_skin_is_harmed(face *f)
{
    face_limit *l = &f->limit;
    const uint64_t *pushed = projection_pushed(&f->projection);
    l->harmed_count = 0;
    if (!pushed)
        return false;
    memset(l->is_slid, 0, f->rest.block_count);
    mark_pushed(f, pushed);
    for (uint32_t group = 0; group < limit_group_count(f); ++group)
        if (l->is_marked[group] && is_harmed_as_shown(f, group))
            l->harmed[l->harmed_count++] = group;
    return l->harmed_count > 0;
}

static bool sliding_harms(face *f)
{
    find_bare_lips(f);
    bool is_harmed = lips_harm(f, 1.0);
    face_write(f);
    return slid_skin_is_harmed(f) || is_harmed;
}

void face_limit_slide(face *f)
{
    if (f->control_count == 0 || f->origin != &f->base || f->settings.stretch_most < 0.0)
        return;
    limit_begin_pose(f);
    if (slid_skin_is_harmed(f))
        (void)yield_to(f, sliding_harms);
}
