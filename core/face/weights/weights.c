#include "face/bind.h"
#include "face/weights/pieces.h"
#include "face/weights/weights_follow.h"
#include "face/weights/weights_laplace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fill ripples a little on the far side of the face: what is below this is taken off every
 * filled weight, so that a bone leaves alone what it has nothing to do with. */
#define RIPPLE 0.004f

typedef struct weights {
    const bind_marks *marks, *painted;
    const rig *rig;
    const mesh *mesh;
    const topology *topology;
    uint32_t *component; /* vertex_count: of the surface; component_count for isolated vertices */
    uint32_t component_count;
    uint8_t *is_given, *is_free, *is_settled; /* vertex_count each */
    uint8_t *has_mark;                        /* component_count + 1 */
    laplace laplace;
} weights;

/* ---- what is given ---- */

static float unit_range(float x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static uint32_t root_bone(const rig *r)
{
    for (uint32_t b = 0; b < r->bone_count; b++)
        if (r->bone[b].parent == RIG_NONE)
            return b;
    return 0;
}

/* The nearest bone above `bone` about which the marks of this vertex are silent; else RIG_NONE. */
static uint32_t silent_parent(const rig *r, const bool *is_said, uint32_t bone)
{
    for (uint32_t step = 0; step < r->bone_count; step++) {
        bone = r->bone[bone].parent;
        if (bone >= r->bone_count)
            return RIG_NONE;
        if (!is_said[bone])
            return bone;
    }
    return RIG_NONE;
}

/* Weights that are marked at a vertex, made to sum to 1: what is missing goes to the parent of the
 * bone that is marked most. False: nothing is said, or only that no bone holds it. */
static bool settle_vertex(const weights *w, const bind_marks *marks, float *share, uint32_t v)
{
    const rig *r = w->rig;
    uint32_t count = w->mesh->vertex_count, most = RIG_NONE;
    bool is_said[RIG_BONES_MAX] = {false};
    float sum = 0;
    for (uint32_t b = 0; b < r->bone_count; b++) {
        float mark = marks->weight[(size_t)b * count + v];
        is_said[b] = !isnan(mark);
        share[b] = is_said[b] ? unit_range(mark) : 0;
        sum += share[b];
        if (is_said[b] && (most == RIG_NONE || share[b] > share[most]))
            most = b;
    }
    uint32_t holder = marks->rigid_bone[v];
    if (holder < r->bone_count) {
        memset(share, 0, r->bone_count * sizeof *share);
        share[holder] = 1;
        return true;
    }
    if (most == RIG_NONE)
        return false;
    uint32_t parent = silent_parent(r, is_said, most);
    if (sum < 1 && parent != RIG_NONE) {
        share[parent] += 1 - sum;
        sum = 1;
    }
    if (!(sum > 0))
        return false;
    for (uint32_t b = 0; b < r->bone_count; b++)
        share[b] /= sum;
    return true;
}

static void take_weights(weights *w, float *weight)
{
    uint32_t count = w->mesh->vertex_count;
    for (uint32_t v = 0; v < count; v++) {
        float share[RIG_BONES_MAX] = {0};
        w->is_given[v] = settle_vertex(w, w->marks, share, v);
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            weight[(size_t)b * count + v] = share[b];
    }
}

/* What stands at the first vertex of each point, to its others. */
static void spread(const weights *w, float *value, uint32_t column_count)
{
    size_t count = w->mesh->vertex_count;
    for (uint32_t c = 0; c < column_count && w->mesh->point; c++)
        for (uint32_t v = 0; v < count; v++)
            value[c * count + v] = value[c * count + w->mesh->point[v]];
}

/* A contact about which nothing is said can be pulled: else most rigs could not move. */
static void take_mobility(weights *w, float *mobility)
{
    uint32_t count = w->mesh->vertex_count;
    for (uint32_t v = 0; v < count; v++) {
        float mark = w->marks->mobility[v];
        bool is_rigid = w->marks->rigid_bone[v] < w->rig->bone_count;
        w->is_given[v] = is_rigid || !isnan(mark);
        mobility[v] = is_rigid || isnan(mark) ? 0 : unit_range(mark);
    }
    for (uint32_t c = 0; c < w->rig->contact_count; c++) {
        uint32_t v = w->rig->contact[c].vertex;
        if (v >= count || w->is_given[v])
            continue;
        v = mesh_point(w->mesh, v);
        w->is_given[v] = 1;
        mobility[v] = 1;
    }
    spread(w, mobility, 1);
    for (uint32_t v = 0; v < count; v++)
        w->is_given[v] = w->is_given[mesh_point(w->mesh, v)];
}

/* ---- what is filled ---- */

/* Free: not given, on a piece of surface where something is. */
static bool find_free(weights *w)
{
    bool is_any_given = false;
    memset(w->has_mark, 0, w->component_count + (size_t)1);
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++)
        if (w->is_given[v]) {
            is_any_given = true;
            if (w->component[v] < w->component_count)
                w->has_mark[w->component[v]] = 1;
        }
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++) {
        w->is_settled[v] = w->is_given[v] || w->has_mark[w->component[v]];
        w->is_free[v] = w->is_settled[v] && !w->is_given[v] && mesh_point(w->mesh, v) == v;
    }
    return is_any_given;
}

static void bound_filled(const weights *w, float *value)
{
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++)
        if (w->is_free[v])
            value[v] = unit_range((value[v] - RIPPLE) / (1 - 2 * RIPPLE));
}

static void share_out_filled(const weights *w, float *weight)
{
    uint32_t count = w->mesh->vertex_count, root = root_bone(w->rig);
    for (uint32_t v = 0; v < count; v++) {
        if (!w->is_free[v])
            continue;
        float sum = 0;
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            sum += weight[(size_t)b * count + v];
        if (!(sum > 0)) {
            weight[(size_t)root * count + v] = 1;
            continue;
        }
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            weight[(size_t)b * count + v] /= sum;
    }
}

/* The bound of the fill is imposed afterwards: exact bounds (Jacobson and others 2011) cost an
 * optimisation for each bone and change little. */
static void normalise_filled(const weights *w, float *weight)
{
    for (uint32_t b = 0; b < w->rig->bone_count; b++)
        bound_filled(w, weight + (size_t)b * w->mesh->vertex_count);
    share_out_filled(w, weight);
}

/* What is not settled takes the values of the vertices that it follows, at its roots, and is filled
 * from there. value: column_count by vertex_count. Afterwards is_free says what was filled. */
static mrt_result follow(weights *w, float *value, uint32_t column_count, error *err)
{
    size_t count = w->mesh->vertex_count;
    uint32_t *leader = malloc((count + 1) * sizeof *leader);
    if (leader == NULL)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the weights of %u vertices",
                         w->mesh->vertex_count);
    follow_scene scene = {w->mesh->position,  w->mesh->vertex_count, w->component,
                          w->component_count, w->marks->rigid_bone,  w->is_settled};
    spread(w, value, column_count);
    mrt_result result = follow_find(leader, w->is_given, &scene, err);
    for (size_t v = 0; result == MRT_OK && v < count; v++) {
        w->is_free[v] =
            !w->is_settled[v] && !w->is_given[v] && mesh_point(w->mesh, (uint32_t)v) == v;
        for (uint32_t c = 0; c < column_count && w->is_given[v]; c++)
            value[c * count + v] = value[c * count + leader[v]];
    }
    free(leader);
    if (result == MRT_OK)
        result = laplace_fill(&w->laplace, value, column_count, w->is_free, w->is_given, err);
    return result;
}

static mrt_result fill_weights(weights *w, float *weight, error *err)
{
    uint32_t count = w->mesh->vertex_count;
    take_weights(w, weight);
    if (!find_free(w)) {
        float *root = weight + (size_t)root_bone(w->rig) * count;
        for (uint32_t v = 0; v < count; v++)
            root[v] = 1;
        return MRT_OK;
    }
    mrt_result result =
        laplace_fill(&w->laplace, weight, w->rig->bone_count, w->is_free, w->is_given, err);
    if (result != MRT_OK)
        return result;
    normalise_filled(w, weight);
    result = follow(w, weight, w->rig->bone_count, err);
    if (result == MRT_OK)
        normalise_filled(w, weight);
    return result;
}

static mrt_result fill_mobility(weights *w, float *mobility, error *err)
{
    uint32_t count = w->mesh->vertex_count;
    take_mobility(w, mobility);
    bool is_any_mobile = false;
    for (uint32_t v = 0; v < count; v++)
        is_any_mobile = is_any_mobile || (w->is_given[v] && mobility[v] > 0);
    if (!find_free(w) || !is_any_mobile) {
        for (uint32_t v = 0; v < count; v++)
            if (!w->is_given[v])
                mobility[v] = 1;
        return MRT_OK;
    }
    mrt_result result = laplace_fill(&w->laplace, mobility, 1, w->is_free, w->is_given, err);
    if (result != MRT_OK)
        return result;
    bound_filled(w, mobility);
    result = follow(w, mobility, 1, err);
    if (result == MRT_OK)
        bound_filled(w, mobility);
    return result;
}

/* ---- what is painted ---- */

static bool differs(float a, float b)
{
    return isnan(a) ? !isnan(b) : a != b;
}

static bool paints_weight(const weights *w, uint32_t v)
{
    uint32_t count = w->mesh->vertex_count;
    bool is_other = w->painted->rigid_bone[v] != w->marks->rigid_bone[v];
    for (uint32_t b = 0; b < w->rig->bone_count; b++)
        is_other = is_other || differs(w->painted->weight[(size_t)b * count + v],
                                       w->marks->weight[(size_t)b * count + v]);
    return is_other;
}

static bool paints_mobility(const weights *w, uint32_t v)
{
    return w->painted->rigid_bone[v] != w->marks->rigid_bone[v] ||
           differs(w->painted->mobility[v], w->marks->mobility[v]);
}

/* To the vertices that are given or free. */
static void add_changes(const weights *w, float *value, const float *change, uint32_t column_count)
{
    size_t count = w->mesh->vertex_count;
    for (size_t i = 0; i < column_count * count; i++)
        if (w->is_settled[i % count])
            value[i] = unit_range(value[i] + change[i]);
}

/* change: zeroed. It gets what paint makes of weight; false: nothing is painted. */
static bool take_painted_weights(weights *w, float *change, const float *weight)
{
    uint32_t count = w->mesh->vertex_count;
    bool is_any = false;
    for (uint32_t v = 0; v < count; v++) {
        float share[RIG_BONES_MAX] = {0};
        w->is_given[v] = settle_vertex(w, w->marks, share, v);
        if (!paints_weight(w, v) || !settle_vertex(w, w->painted, share, v))
            continue;
        w->is_given[v] = is_any = true;
        for (uint32_t b = 0; b < w->rig->bone_count; b++)
            change[(size_t)b * count + v] = share[b] - weight[(size_t)b * count + v];
    }
    return is_any;
}

static bool take_painted_mobility(weights *w, float *change, const float *mobility)
{
    bool is_any = false;
    take_mobility(w, change);
    for (uint32_t v = 0; v < w->mesh->vertex_count; v++) {
        float mark = w->painted->mobility[v];
        bool is_rigid = w->painted->rigid_bone[v] < w->rig->bone_count;
        change[v] = 0;
        if (!paints_mobility(w, v) || (!is_rigid && isnan(mark)))
            continue;
        w->is_given[v] = is_any = true;
        change[v] = (is_rigid ? 0 : unit_range(mark)) - mobility[v];
    }
    return is_any;
}

static mrt_result fade_changes(weights *w, float *value, float *change, uint32_t column_count,
                               error *err)
{
    (void)find_free(w);
    mrt_result result =
        laplace_fade(&w->laplace, change, column_count, w->is_free, w->is_given, err);
    if (result == MRT_OK)
        add_changes(w, value, change, column_count);
    return result;
}

/* Pieces that follow, follow what is painted now. */
static mrt_result paint_weights(weights *w, float *weight, float *change, error *err)
{
    if (!take_painted_weights(w, change, weight))
        return MRT_OK;
    mrt_result result = fade_changes(w, weight, change, w->rig->bone_count, err);
    if (result != MRT_OK)
        return result;
    share_out_filled(w, weight);
    result = follow(w, weight, w->rig->bone_count, err);
    if (result == MRT_OK)
        normalise_filled(w, weight);
    return result;
}

static mrt_result paint_mobility(weights *w, float *mobility, float *change, error *err)
{
    if (!take_painted_mobility(w, change, mobility))
        return MRT_OK;
    mrt_result result = fade_changes(w, mobility, change, 1, err);
    if (result == MRT_OK)
        result = follow(w, mobility, 1, err);
    if (result == MRT_OK)
        bound_filled(w, mobility);
    return result;
}

static mrt_result paint(weights *w, binding *out, error *err)
{
    size_t count = (size_t)w->mesh->vertex_count * w->rig->bone_count;
    float *change = calloc(count + 1, sizeof *change);
    if (change == NULL)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the weights of %u vertices",
                         w->mesh->vertex_count);
    mrt_result result = paint_weights(w, out->weight, change, err);
    if (result == MRT_OK)
        result = paint_mobility(w, out->mobility, change, err);
    free(change);
    return result;
}

static bool allocate(weights *w)
{
    size_t count = w->mesh->vertex_count + (size_t)1;
    w->component = malloc(count * sizeof *w->component);
    w->is_given = calloc(count, 1);
    w->is_free = calloc(count, 1);
    w->is_settled = calloc(count, 1);
    w->has_mark = calloc(count, 1);
    return w->component != NULL && w->is_given != NULL && w->is_free != NULL &&
           w->is_settled != NULL && w->has_mark != NULL;
}

mrt_result binding_fill(binding *out, const bind_marks *bare, const bind_marks *painted,
                        const rig *r, const mesh *m, const topology *t, error *err)
{
    if (r->bone_count == 0 || r->bone_count > RIG_BONES_MAX || t->vertex_count != m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "weights need 1 to %d bones (here %u) and the mesh's own topology",
                         RIG_BONES_MAX, r->bone_count);
    weights w = {.marks = bare, .painted = painted, .rig = r, .mesh = m, .topology = t};
    mrt_result result = MRT_OK;
    if (!allocate(&w))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the weights of %u vertices",
                           m->vertex_count);
    if (result == MRT_OK)
        result = pieces_find(w.component, &w.component_count, m, t, err);
    if (result == MRT_OK)
        result = laplace_create(&w.laplace, m, t, err);
    if (result == MRT_OK)
        result = fill_weights(&w, out->weight, err);
    if (result == MRT_OK)
        result = fill_mobility(&w, out->mobility, err);
    if (result == MRT_OK && painted != NULL)
        result = paint(&w, out, err);
    if (result == MRT_OK) {
        spread(&w, out->weight, r->bone_count);
        spread(&w, out->mobility, 1);
    }
    laplace_destroy(&w.laplace);
    free(w.component);
    free(w.is_given);
    free(w.is_free);
    free(w.is_settled);
    free(w.has_mark);
    return result;
}
